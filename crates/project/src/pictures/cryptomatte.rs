//! Cryptomatte 1.2 (Friedman and Jones 2015; <https://github.com/Psyop/Cryptomatte>, `specification`): for every
//! pixel, the objects (or materials) that it shows and the coverage of each.
//!
//! An object's id is the MurmurHash3 of its name, as the bits of a float that is neither subnormal, infinite nor NaN.
//! The objects of a pixel are ranked by coverage; two ranks make a layer, `CryptoObject00`: `R` and `B` are ids, `G`
//! and `A` are coverages. Attributes of the file list the names.

use crate::pictures::layer::Layer;
use serde_json::json;
use std::collections::BTreeMap;
use std::io::Cursor;

/// Prefix of the names of all its layers.
const PREFIX: &str = "Crypto";

/// Prefix of the names of all its attributes.
const METADATA: &str = "cryptomatte/";

/// The named objects of a picture, ranked by coverage in each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Cryptomatte {
    /// What is named, `Object` or `Material`: the layers are called `CryptoObject00`, `CryptoObject01`, …
    pub kind: String,
    /// The names; objects of the same name are one.
    pub names: Vec<String>,
    /// For each pixel, row by row, the object of the largest coverage; then that of the second largest; and so on.
    /// All of one length.
    pub ranks: Vec<Vec<RankedCoverage>>,
}

/// An object's coverage of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankedCoverage {
    /// Index into [`Cryptomatte::names`]; `None` if the pixel shows no further object.
    pub name_index: Option<u32>,
    /// Its share of the pixel, in [0, 1].
    pub share: f32,
}

impl RankedCoverage {
    /// No further object.
    pub const NONE: Self = Self { name_index: None, share: 0.0 };
}

impl Cryptomatte {
    /// The name of the Cryptomatte, with which the names of its layers start.
    pub fn name(&self) -> String {
        format!("{PREFIX}{}", self.kind)
    }

    /// Its layers: three pairs of ranks, or more if there are more ranks.
    pub fn layers(&self) -> Vec<Layer> {
        /// Readers expect this many pairs.
        const PAIRS: usize = 3;
        let ids: Vec<f32> = self.names.iter().map(|name| cryptomatte_id(name)).collect();
        let pixels = self.ranks.first().map_or(0, Vec::len);
        let pairs = self.ranks.len().div_ceil(2).max(PAIRS);
        let rank_channels = |rank: usize| {
            let ranked = self.ranks.get(rank);
            let id_of = |ranked: &RankedCoverage| ranked.name_index.map_or(0.0, |thing| ids[thing as usize]);
            let id_of = ranked.map_or(vec![0.0; pixels], |all| all.iter().map(id_of).collect());
            let share =
                ranked.map_or(vec![0.0; pixels], |all| all.iter().map(|ranked| ranked.share).collect());
            [id_of, share]
        };
        let pair_layers = |pair: usize| {
            let values = [rank_channels(2 * pair), rank_channels(2 * pair + 1)].into_iter().flatten();
            let name = move |channel| format!("{}{pair:02}.{channel}", self.name());
            ["R", "G", "B", "A"]
                .into_iter()
                .zip(values)
                .map(move |(channel, values)| Layer { name: name(channel), values })
        };
        (0..pairs).flat_map(pair_layers).collect()
    }

    /// The attributes of a file that contains its layers.
    pub fn attributes(&self) -> BTreeMap<String, String> {
        let name = self.name();
        let key = format!("{:08x}", murmur3_hash(&name));
        let manifest: BTreeMap<_, _> = self
            .names
            .iter()
            .map(|name| (name, json!(format!("{:08x}", cryptomatte_id(name).to_bits()))))
            .collect();
        let metadata = [
            ("name", name),
            ("hash", "MurmurHash3_32".to_string()),
            ("conversion", "uint32_to_float32".to_string()),
            ("manifest", escape_non_ascii(&json!(manifest).to_string())),
        ];
        metadata.into_iter().map(|(what, value)| (format!("{METADATA}{}/{what}", &key[..7]), value)).collect()
    }
}

/// Whether a channel belongs to a Cryptomatte.
pub(crate) fn is_cryptomatte(channel: &str) -> bool {
    channel.starts_with(PREFIX)
}

/// Whether an attribute belongs to a Cryptomatte.
pub(crate) fn is_cryptomatte_metadata(attribute: &str) -> bool {
    attribute.starts_with(METADATA)
}

/// The id of a name.
fn cryptomatte_id(name: &str) -> f32 {
    /// The lowest bit of a float's exponent.
    const EXPONENT: u32 = 1 << 23;
    let hash = murmur3_hash(name);
    let exponent = hash >> 23 & 0xFF;
    // A subnormal number, or one that is not finite, may change when it is written and read.
    f32::from_bits(if exponent == 0 || exponent == 0xFF { hash ^ EXPONENT } else { hash })
}

fn murmur3_hash(name: &str) -> u32 {
    murmur3::murmur3_32(&mut Cursor::new(name), 0).expect("bytes in memory can be read")
}

/// Escapes characters beyond ASCII, which OpenEXR's text cannot hold.
fn escape_non_ascii(json: &str) -> String {
    let mut escaped = String::with_capacity(json.len());
    for character in json.chars() {
        match character {
            '\0'..='\x7f' => escaped.push(character),
            _ => {
                let mut units = [0; 2];
                let units = character.encode_utf16(&mut units).iter();
                escaped.extend(units.map(|unit| format!("\\u{unit:04x}")));
            }
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_those_of_the_specification() {
        // MurmurHash3_x86_32 with seed 0, as `mmh3` of Python has them; of the second the exponent is all ones.
        let bits = |name| cryptomatte_id(name).to_bits();
        assert_eq!(murmur3_hash("hello"), 0x248b_fa47);
        assert_eq!(bits("hello"), 0x248b_fa47);
        let odd =
            (0..100_000).map(|k| format!("object {k}")).find(|name| murmur3_hash(name) >> 23 & 0xFF == 0xFF);
        let odd = odd.expect("one in 256");
        assert_eq!(bits(&odd), murmur3_hash(&odd) ^ 1 << 23);
        assert!((0..10_000).all(|k| cryptomatte_id(&format!("object {k}")).is_normal()));
    }

    fn matte() -> Cryptomatte {
        let ranked = |thing, share| RankedCoverage { name_index: Some(thing), share };
        Cryptomatte {
            kind: "Object".into(),
            names: vec!["card \"1\"\\ü\n🂡".into(), "wall".into()],
            ranks: vec![vec![ranked(1, 0.75), ranked(0, 1.0)], vec![ranked(0, 0.25), RankedCoverage::NONE]],
        }
    }

    #[test]
    fn ranks_become_pairs() {
        let layers = matte().layers();
        let of = |name: &str| &layers.iter().find(|layer| layer.name == name).expect("it is there").values;
        assert_eq!(layers.len(), 12);
        assert_eq!(of("CryptoObject00.R"), &[cryptomatte_id("wall"), cryptomatte_id(&matte().names[0])]);
        assert_eq!((of("CryptoObject00.G"), of("CryptoObject00.A")), (&vec![0.75, 1.0], &vec![0.25, 0.0]));
        assert_eq!(of("CryptoObject00.B"), &[cryptomatte_id(&matte().names[0]), 0.0]);
        assert_eq!(of("CryptoObject02.A"), &[0.0, 0.0]);
    }

    #[test]
    fn the_manifest_is_json_whatever_the_names() {
        let attributes = matte().attributes();
        let of = |what: &str| {
            let found = attributes.iter().find(|(key, _)| key.ends_with(&format!("/{what}")));
            found.expect("it is said").1.clone()
        };
        assert_eq!(of("name"), "CryptoObject");
        let manifest = of("manifest");
        assert!(manifest.is_ascii());
        let read: BTreeMap<String, String> = serde_json::from_str(&manifest).expect("JSON");
        for name in &matte().names {
            assert_eq!(read[name], format!("{:08x}", cryptomatte_id(name).to_bits()));
        }
        let key = attributes.keys().next().expect("one").split('/').nth(1).expect("a key");
        assert_eq!(key, &format!("{:08x}", murmur3_hash("CryptoObject"))[..7]);
    }
}
