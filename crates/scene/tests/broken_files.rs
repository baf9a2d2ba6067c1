//! Malformed files: a file whose report has no errors opens; another opens with a warning that names the flaw, or
//! gives one error. Never a panic, never long.

mod data;

use scene::{Inspection, SceneError, inspect};
use std::path::Path;
use std::time::{Duration, Instant};

fn timed(file: &Path) -> Result<Inspection, SceneError> {
    let start = Instant::now();
    let result = inspect(file, &Default::default());
    assert!(start.elapsed() < Duration::from_secs(2), "{}: {:?}", file.display(), start.elapsed());
    if let Err(error) = &result {
        let text = error.to_string();
        assert!(!text.contains('\n') && text.contains(file.file_name().unwrap().to_str().unwrap()), "{text}");
        assert!(!text.contains("the decoder failed"), "{text}");
    }
    result
}

#[test]
fn validator_files_obey_the_contract() {
    let Some(folder) = data::folder("gltf-broken/validator") else { return };
    let (mut wrong, mut count) = (Vec::new(), 0);
    for file in data::scenes(&folder) {
        let report = std::fs::read(format!("{}.report.json", file.display())).unwrap();
        let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
        let errors = report["issues"]["numErrors"].as_u64().unwrap();
        let flaws: Vec<(String, String)> = report["issues"]["messages"]
            .as_array()
            .unwrap()
            .iter()
            .filter(|message| message["severity"] == 0)
            .map(|message| {
                let pointer = message["pointer"].as_str().unwrap_or("");
                let object: Vec<&str> = pointer.split('/').take(3).collect();
                (object.join("/"), format!("{} {pointer}: {}", message["code"], message["message"]))
            })
            .collect();
        let name = file.strip_prefix(&folder).unwrap().display().to_string();
        count += 1;
        match timed(&file) {
            Ok(_) if errors == 0 => {}
            Ok(inspection) if inspection.warnings.is_empty() => {
                wrong.push(format!("{name}: no warning of {flaws:#?}"))
            }
            Ok(inspection) => println!("{name}: {:#?}\n    for {flaws:#?}", inspection.warnings),
            Err(error) if errors == 0 => wrong.push(format!("{name} should open: {error}")),
            Err(error) => println!("{error}\n    for {flaws:#?}"),
        }
    }
    assert!(wrong.is_empty(), "{} of {count}:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn other_broken_files_obey_the_contract() {
    let Some(folder) = data::folder("gltf-broken/assimp") else { return };
    for file in data::scenes(&folder) {
        match timed(&file) {
            Ok(inspection) => {
                println!("{}: {:?}", file.display(), inspection.warnings);
                assert!(!inspection.warnings.is_empty(), "{}", file.display());
            }
            Err(error) => println!("{error}"),
        }
    }
}
