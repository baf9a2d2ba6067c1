//! Focus of each splat, written as a table and read again.

use crate::read_bytes;
use gaussians::{GaussianCloud, read_focus_table, write_focus_table};
use lens::FocusOffset;
use progress::Unwatched;

/// Three splats of which the second cannot be drawn.
fn cloud() -> GaussianCloud {
    let row = "0 0 {z} 0 0 0 2 -3 -3 -3 1 0 0 0\n";
    let names = [
        "x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0",
        "rot_1", "rot_2", "rot_3",
    ];
    let mut text = String::from("ply\nformat ascii 1.0\nelement vertex 3\n");
    names.iter().for_each(|name| text += &format!("property float {name}\n"));
    text += "end_header\n";
    ["1", "nan", "3"].iter().for_each(|z| text += &row.replace("{z}", z));
    let file = read_bytes(text.as_bytes(), "three.ply").unwrap();
    assert!(
        file.warnings[0].starts_with("three.ply: 1 splats are left out: 1 have no finite place"),
        "{:?}",
        file.warnings
    );
    file.cloud
}

#[test]
fn a_table_has_a_row_for_each_row_of_the_file() {
    let cloud = cloud();
    let focus = [FocusOffset::new(1.25, 0.5).with_gloss(1.0), FocusOffset::new(0.75, 0.0)];
    let mut table = Vec::new();
    write_focus_table(&mut table, &cloud, &focus).unwrap();
    assert!(
        String::from_utf8_lossy(&table)
            .contains("element vertex 3\nproperty float t\nproperty float anchor\nproperty float gloss")
    );
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.ply");
    std::fs::write(&path, &table).unwrap();
    assert_eq!(read_focus_table(&path, &cloud, &Unwatched).unwrap(), focus);
}

#[test]
fn tables_of_other_scenes_and_values_are_refused() {
    let cloud = cloud();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.ply");
    let read = |rows: &str, properties: &str| {
        let count = rows.lines().count();
        std::fs::write(
            &path,
            format!("ply\nformat ascii 1.0\nelement vertex {count}\n{properties}end_header\n{rows}"),
        )
        .unwrap();
        read_focus_table(&path, &cloud, &Unwatched)
    };
    let t = "property float t\n";
    assert_eq!(read("1.5\n1\n2\n", t).unwrap(), [FocusOffset::new(1.5, 0.0), FocusOffset::new(2.0, 0.0)]);
    for (rows, properties, part) in [
        ("1\n1\n", t, "has 2 rows, but the scene has 3 splats"),
        ("1\nx\n1\n", t, "has no number for t"),
        ("nan\n1\n1\n", t, "row 0: t must be finite"),
        (
            "1 2\n1 0\n1 0\n",
            "property float t\nproperty float anchor\n",
            "row 0: t must be finite, anchor and gloss",
        ),
        ("1\n1\n1\n", "property float u\n", "has no property t"),
    ] {
        let error = read(rows, properties).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}
