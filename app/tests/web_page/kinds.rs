//! Every kind of input as a page, of slices and of the engine; in a sandboxed frame, too.

use crate::chromium::Chromium;
use crate::program::done;
use crate::{card_light_field, tiny_glb, wall_capture};
use std::fmt::Write;
use std::path::Path;

/// Twenty Gaussian splats of standard 3DGS form: a wall of them at depth 4.
fn write_splats(file: &Path) {
    const NAMES: [&str; 14] = [
        "x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0",
        "rot_1", "rot_2", "rot_3",
    ];
    let mut text = "ply\nformat ascii 1.0\nelement vertex 20\n".to_owned();
    NAMES.iter().for_each(|name| writeln!(text, "property float {name}").unwrap());
    text.push_str("end_header\n");
    for k in 0..20 {
        let [x, y] = [f64::from(k % 5) - 2.0, f64::from(k / 5) - 1.5].map(|at| 0.4 * at);
        let color = f64::from(k % 3) - 1.0;
        writeln!(text, "{x} {y} {} {color} 0.5 {} 3 -1.6 -1.6 -3 1 0 0 0", 0.2 * x, -color).unwrap();
    }
    std::fs::write(file, text).unwrap();
}

/// Opens a page, at the top or in a sandboxed frame, waits for its picture and clicks its middle.
fn open(folder: &Path, page: &str, is_framed: bool) -> Option<()> {
    let address = |name: &str| format!("file://{}", folder.join(name).display());
    let mut browser = Chromium::start()?;
    let host = if is_framed { "host.html" } else { page };
    let frame = format!(
        "<!doctype html><link rel='icon' href='data:,'><style>body {{ margin: 0 }} iframe {{ border: 0 }}</style>
        <iframe sandbox='allow-scripts' src='{page}' width='700' height='500'></iframe>"
    );
    if is_framed {
        std::fs::write(folder.join(host), frame).unwrap();
    }
    browser.open(&address(host));
    let context = is_framed.then(|| *browser.contexts().last().unwrap());
    browser.wait_for_in(context, "document.getElementById('viewer').dataset.drawn !== undefined");
    if is_framed {
        assert_eq!(browser.evaluate_in(context, "window.origin"), "null", "{page}: it is sandboxed");
    }
    let middle = "(() => { const r = document.getElementById('stage').getBoundingClientRect(); return [r.left + r.width / 2, r.top + r.height / 2]; })()";
    let middle = browser.evaluate_in(context, middle);
    browser.click([0, 1].map(|axis| middle[axis].as_f64().unwrap()));
    browser.wait_for_in(context, "document.getElementById('message').textContent.startsWith('Focused at ')");
    browser.wait_for_in(context, "document.getElementById('screen').ariaBusy === 'false'");
    assert_eq!(browser.complaints(&[&address(host), &address(page)]), Vec::<String>::new(), "{page}");
    Some(())
}

#[test]
fn a_mesh_splats_a_light_field_and_a_capture() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    tiny_glb::write(&place.join("mesh.glb"));
    write_splats(&place.join("splats.ply"));
    card_light_field::write(&place.join("card"));
    wall_capture::write(&place.join("wall"));
    let camera = serde_json::json!({"width": 96, "height": 64, "focus_distance": 2.0, "aperture_radius": 0.1, "sensor_height": 0.1});
    std::fs::write(place.join("camera.json"), camera.to_string()).unwrap();
    for (name, command) in [
        ("mesh", "new mesh.glb --camera camera.json"),
        ("splats", "new splats.ply"),
        ("light-field", "import card"),
        ("capture", "import wall"),
    ] {
        done(place, &format!("{command} -o {name}.fbrush"));
        done(place, &format!("export {name}.fbrush --web {name}.html --size 96x64 --apertures 1"));
        done(place, &format!("export {name}.fbrush --web {name}-engine.html --engine --size 96x64"));
        for page in [format!("{name}.html"), format!("{name}-engine.html")] {
            if open(place, &page, name == "mesh").is_none() {
                return;
            }
        }
    }
}
