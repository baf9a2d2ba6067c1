//! Which file a URI means.
//!
//! By the specification it is the relative path that results from percent-decoding. Exporters also write names
//! verbatim, with a bare `%`, `#` or `?`, encode spaces as `+`, encode characters as Latin-1, or separate folders by
//! backslashes. So a URI has several interpretations, in order of likelihood; the first whose file exists counts.
//! None of them leaves the scene's folder.

use crate::gltf::container::percent_encoding::percent_decoded;
use std::ffi::OsStr;
use std::path::PathBuf;

/// A relative path that a URI may mean.
#[derive(Debug, PartialEq)]
pub(crate) struct UriInterpretation {
    pub path: PathBuf,
    /// Whether the URI is well-formed and this is its specified meaning.
    pub is_well_formed: bool,
}

/// The possible meanings of a URI, likelier ones first; for an impossible one, the reason.
pub(crate) fn interpret_uri(uri: &str) -> Vec<Result<UriInterpretation, &'static str>> {
    let (decoded, is_sound) = percent_decoded(uri);
    let is_plain = is_sound && !uri.contains(['\\', '#', '?']);
    let mut readings: Vec<Result<UriInterpretation, _>> = Vec::new();
    let mut add = |name: &[u8], separators: &[u8], is_proper: bool| {
        let path = inner_path(name, separators);
        if !readings.iter().any(|other| other.as_ref().map(|other| &other.path) == path.as_ref()) {
            readings.push(path.map(|path| UriInterpretation { path, is_well_formed: is_proper }));
        }
    };
    const SEPARATORS: &[u8] = b"/\\";
    match std::str::from_utf8(&decoded) {
        Ok(_) => add(&decoded, SEPARATORS, is_plain),
        // Names in another byte encoding; then the characters of Latin-1, whose numbers are Unicode's.
        Err(_) => {
            add(&decoded, SEPARATORS, false);
            let latin1: String = decoded.iter().copied().map(char::from).collect();
            add(latin1.as_bytes(), SEPARATORS, false);
        }
    }
    // Verbatim; also with backslashes as characters of the name, as some archives are unpacked.
    add(uri.as_bytes(), SEPARATORS, false);
    add(uri.as_bytes(), b"/", false);
    if uri.contains('+') {
        add(&percent_decoded(&uri.replace('+', " ")).0, SEPARATORS, false);
    }
    // Without query and fragment, as a web server would interpret it.
    if let Some((path, _)) = uri.split_once(['?', '#']) {
        add(&percent_decoded(path).0, SEPARATORS, false);
    }
    readings
}

const OUTSIDE: &str =
    "leads outside the scene's folder (keep the file beside the scene and refer to it by a relative path)";

/// The relative path of a name, or what is wrong with it.
fn inner_path(name: &[u8], separators: &[u8]) -> Result<PathBuf, &'static str> {
    if name.is_empty() || name.contains(&0) {
        return Err("is not a file name (export the scene again)");
    }
    // A backslash may separate on some systems, whatever it means here; a colon is a scheme or a drive.
    let mut all = name.split(|byte| b"/\\".contains(byte));
    if b"/\\".contains(&name[0]) || all.any(|part| part == b".." || part.contains(&b':')) {
        return Err(OUTSIDE);
    }
    let parts = name.split(|byte| separators.contains(byte)).filter(|&part| !part.is_empty() && part != b".");
    parts.map(|part| os_str(part).ok_or("is not valid UTF-8 (export the scene again)")).collect()
}

/// The name of these bytes, on systems that allow them.
fn os_str(bytes: &[u8]) -> Option<&OsStr> {
    #[cfg(unix)]
    return Some(std::os::unix::ffi::OsStrExt::from_bytes(bytes));
    #[cfg(not(unix))]
    return std::str::from_utf8(bytes).ok().map(OsStr::new);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(uri: &str) -> Vec<String> {
        interpret_uri(uri).into_iter().flatten().map(|reading| reading.path.display().to_string()).collect()
    }

    #[test]
    fn the_proper_reading_comes_first() {
        for (uri, path) in
            [("a%20b/c.png", "a b/c.png"), ("./a//c.png", "a/c.png"), ("a b+c.png", "a b+c.png")]
        {
            let first = interpret_uri(uri).swap_remove(0);
            assert_eq!(first, Ok(UriInterpretation { path: path.into(), is_well_formed: true }), "{uri}");
        }
        assert_eq!(interpret_uri("plain.bin").len(), 1);
    }

    #[test]
    fn unusual_names_have_several_interpretations() {
        for (uri, expected) in [
            ("example 10%.bin", &["example 10%.bin"][..]),
            ("100%/a%20b.bin", &["100%/a b.bin", "100%/a%20b.bin"]),
            ("%zz.bin", &["%zz.bin"]),
            ("a#b.bin", &["a#b.bin", "a"]),
            ("a.bin?v=2#x", &["a.bin?v=2#x", "a.bin"]),
            ("a+b%2B.bin", &["a+b+.bin", "a+b%2B.bin", "a b+.bin"]),
            ("caf%e9.bin", &["caf\u{fffd}.bin", "café.bin", "caf%e9.bin"]),
        ] {
            if cfg!(unix) {
                assert_eq!(paths(uri), expected, "{uri}");
            }
            let proper = interpret_uri(uri).into_iter().flatten().any(|reading| reading.is_well_formed);
            assert_eq!(proper, uri.starts_with("a+"), "{uri}");
        }
        assert_eq!(paths("textures\\c.png")[0], "textures/c.png");
    }

    #[test]
    fn no_reading_leads_outside() {
        let outside = [
            "../a",
            "a/../../b",
            "/etc/passwd",
            "\\\\host\\share",
            "file:///etc/passwd",
            "http://x/y",
            "C:\\x",
            "..",
            "..\\a",
            "a\\..\\..\\b",
        ];
        for uri in outside {
            assert!(
                interpret_uri(uri).iter().all(|reading| *reading == Err(OUTSIDE)),
                "{uri}: {:?}",
                interpret_uri(uri)
            );
        }
        // Decoded they would; as they stand they are names like others.
        for uri in
            ["%2e%2e/a", "..%2fa", "%2Fetc/passwd", "a/..%5Cb", "%2e%2e%2f100%", "..+%2f..", "..%5ca?b"]
        {
            assert!(interpret_uri(uri)[0].is_err(), "{uri}");
            for path in interpret_uri(uri).into_iter().flatten().map(|reading| reading.path) {
                let normal = |part| matches!(part, std::path::Component::Normal(_));
                assert!(path.components().all(normal), "{uri}: {}", path.display());
            }
        }
        for uri in ["", "%00", "a%00b"] {
            assert!(interpret_uri(uri)[0].is_err(), "{uri}");
        }
    }
}
