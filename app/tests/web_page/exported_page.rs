//! Reads what an exported page holds.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::RgbImage;
use serde_json::Value;
use std::path::Path;

/// A page that was exported.
pub struct ExportedPage {
    pub html: String,
    /// What its viewer shows.
    pub data: Value,
}

/// A slice.
pub struct Shown {
    pub inverse_distance: f64,
    /// What a browser shows of it.
    pub picture: RgbImage,
}

impl ExportedPage {
    pub fn read(file: &Path) -> Self {
        Self::read_as(file, "showPage")
    }

    /// Reads a page that is shown by this function.
    pub fn read_as(file: &Path, function: &str) -> Self {
        let html = std::fs::read_to_string(file).unwrap();
        let (_, data) = html.rsplit_once(&format!("\n{function}(")).unwrap();
        let (data, _) = data.split_once(");\n</script>").unwrap();
        Self { data: from_script(data), html }
    }

    /// What is shown first; its picture is in the document.
    pub fn opening(&self) -> Shown {
        let [stack, slice] =
            ["stack", "slice"].map(|name| self.data["opening"][name].as_u64().unwrap() as usize);
        assert_eq!(self.data["stacks"][stack]["slices"][slice], Value::Null);
        self.slice(stack, slice)
    }

    pub fn slice(&self, stack: usize, slice: usize) -> Shown {
        let stack = &self.data["stacks"][stack];
        let poster = self.html.split_once("id=\"poster\" src=\"data:image/webp;base64,").unwrap().1;
        let poster = poster.split_once('"').unwrap().0;
        let decoded = |slice: usize| {
            let webp = match stack["slices"][slice].as_str() {
                Some(text) => decode_base122(text),
                None => STANDARD.decode(poster).unwrap(),
            };
            image::load_from_memory(&webp).unwrap().into_rgb8()
        };
        let mut picture = decoded(slice);
        if let Some(base) = stack["bases"][slice].as_u64() {
            let base = decoded(base as usize);
            for (level, under) in picture.iter_mut().zip(base.iter()) {
                *level = (i16::from(*level) + i16::from(*under) - 128).clamp(0, 255) as u8;
            }
        }
        Shown { inverse_distance: stack["inverseDistances"][slice].as_f64().unwrap(), picture }
    }

    /// How many slices are differences from the one before them, and from the one after them.
    pub fn differences(&self) -> [usize; 2] {
        let stacks = self.data["stacks"].as_array().unwrap();
        let bases = stacks.iter().flat_map(|stack| stack["bases"].as_array().unwrap().iter().enumerate());
        let bases: Vec<_> =
            bases.filter_map(|(slice, base)| Some((slice, base.as_u64()? as usize))).collect();
        let count = |is_kind: fn(&(usize, usize)) -> bool| bases.iter().filter(|pair| is_kind(pair)).count();
        [count(|(slice, base)| *base + 1 == *slice), count(|(slice, base)| *base == *slice + 1)]
    }

    /// The slice nearest to a reciprocal distance.
    pub fn nearest_slice(&self, stack: usize, inverse_distance: f64) -> usize {
        let distances = self.data["stacks"][stack]["inverseDistances"].as_array().unwrap();
        let off = |index: &usize| (distances[*index].as_f64().unwrap() - inverse_distance).abs();
        (0..distances.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap()
    }
}

/// Bytes of text in base 122: seven bits a character of ASCII, the lowest first; others join a group that is none with the next.
pub fn decode_base122(text: &str) -> Vec<u8> {
    const JOINED: [u32; 6] = [0, 10, 13, 34, 60, 92];
    let groups = text.chars().map(u32::from).flat_map(|code| match code {
        ..128 => vec![code],
        896.. => vec![JOINED[code as usize - 896]],
        _ => vec![JOINED[code as usize / 128 - 1], code % 128],
    });
    let (mut bytes, mut bits, mut count) = (Vec::new(), 0, 0);
    for group in groups {
        bits |= group << count;
        count += 7;
        if count >= 8 {
            bytes.push(bits as u8);
            bits >>= 8;
            count -= 8;
        }
    }
    bytes
}

/// JSON as it is written into the page, whose strings hold control characters as they are.
fn from_script(text: &str) -> Value {
    let escaped = |c: char| if c.is_ascii_control() { format!("\\u{:04x}", u32::from(c)) } else { c.into() };
    serde_json::from_str(&text.chars().map(escaped).collect::<String>()).unwrap()
}
