//! What exporters get wrong in ways that leave no doubt what they mean: it opens, with a warning.

mod handmade;

use handmade::{Glb, load_bytes};
use scene::LoadOptions;

/// A .glb of these chunks.
fn glb_of(chunks: &[(&[u8], &[u8])]) -> Vec<u8> {
    let chunks: Vec<u8> = (chunks.iter())
        .flat_map(|(kind, body)| [&(body.len() as u32).to_le_bytes()[..], kind, body].concat())
        .collect();
    [&b"glTF"[..], &2u32.to_le_bytes(), &(12 + chunks.len() as u32).to_le_bytes(), &chunks].concat()
}

#[test]
fn json_chunks_are_filled_up_by_anything() {
    let glb = Glb::triangle();
    let expected = glb.clean();
    let json = glb.json.to_string().into_bytes();
    for filling in [b'\0', b'\n', b'\t', 0x0c, 0xff, 0xcd] {
        let mut json = json.clone();
        json.resize(json.len().next_multiple_of(4) + 4, filling);
        let bytes = glb_of(&[(b"JSON", &json), (b"BIN\0", &glb.bin)]);
        let scene = load_bytes(&bytes, &LoadOptions::default()).unwrap_or_else(|e| panic!("{filling}: {e}"));
        assert_eq!(
            (scene.positions, scene.triangles),
            (expected.positions.clone(), expected.triangles.clone())
        );
        // Line ends and tabs are white space to JSON.
        let is_odd = !filling.is_ascii_whitespace() || filling == 0x0c;
        assert_eq!(!scene.warnings.is_empty(), is_odd, "{filling}: {:?}", scene.warnings);
    }
}

#[test]
fn chunks_may_be_more_and_files_longer() {
    let glb = Glb::triangle();
    let json = [b"\xEF\xBB\xBF", glb.json.to_string().as_bytes()].concat();
    let mut bytes = glb_of(&[(b"JSON", &json), (b"what", b"ever"), (b"BIN\0", &glb.bin), (b"more", b"")]);
    bytes.extend([0; 37]);
    let scene = load_bytes(&bytes, &LoadOptions::default()).unwrap();
    assert_eq!(scene.triangles.len(), 1);
    for what in ["byte order mark", "unknown type", "the GLB header declares", "after the last GLB chunk"] {
        assert!(scene.warnings.iter().any(|warning| warning.contains(what)), "{what}: {:?}", scene.warnings);
    }
}
