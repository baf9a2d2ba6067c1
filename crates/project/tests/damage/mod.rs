//! Checks that every format's reader has to pass.

use std::path::Path;

/// Reads damaged copies of `file` with `read`: cut off after each eighth of its length, which must be an
/// error, and with a byte changed there, which must not panic. Returns how many changed copies were read
/// nevertheless.
pub fn damage<T, E: std::fmt::Display>(file: &Path, read: impl Fn(&Path) -> Result<T, E>) -> usize {
    let whole = std::fs::read(file).unwrap();
    let name = file.file_name().unwrap().to_string_lossy();
    let damaged = file.with_file_name(format!("damaged-{name}"));
    let mut read_nevertheless = 0;
    for eighth in 0..8 {
        let place = whole.len() * eighth / 8;
        std::fs::write(&damaged, &whole[..place]).unwrap();
        match read(&damaged) {
            Ok(_) => panic!("{name} cut off after {eighth}/8 was read"),
            Err(error) => is_one_line(&error.to_string(), &damaged),
        }
        let mut changed = whole.clone();
        changed[place] ^= 0x55;
        std::fs::write(&damaged, &changed).unwrap();
        match read(&damaged) {
            Ok(_) => read_nevertheless += 1,
            Err(error) => is_one_line(&error.to_string(), &damaged),
        }
    }
    std::fs::remove_file(&damaged).unwrap();
    read_nevertheless
}

/// Checks the form `FILE: what is wrong (what to do)`.
pub fn is_one_line(message: &str, file: &Path) {
    let form =
        message.starts_with(&file.display().to_string()) && message.ends_with(')') && message.contains(" (");
    assert!(form && !message.contains('\n'), "not `FILE: what is wrong (what to do)`: {message}");
}
