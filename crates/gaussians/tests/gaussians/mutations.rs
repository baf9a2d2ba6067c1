//! Files with random damage: no panic, no hang, no more memory than the count needs.

use crate::allocations::peak_bytes;
use crate::encode::{
    Numbers, SpzVersion, compressed_ply, gzipped, ksplat, ply, ply_in_other_order, raw_splat, sog_files, spz,
    spz_payload, zipped,
};
use crate::read_bytes;
use crate::scene::{Random, scattered};
use std::time::Instant;

const MUTATIONS: usize = 2000;

/// What reading may hold: a window of zstd, tables of inflating, the pictures that a palette may have.
const MOST_BYTES: u64 = 24 << 20;

/// Damages bytes in one of the ways that files are damaged, or attacked.
fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    let at = random.below(bytes.len());
    match random.below(8) {
        0 => bytes.truncate(at.max(1)),
        1 => (0..=random.below(8)).for_each(|_| {
            let at = random.below(bytes.len());
            bytes[at] = random.bits() as u8;
        }),
        2 => bytes[at] ^= 1 << random.below(8),
        3 => {
            let value = [0, 1, 0x7f, 0x80, 0xff][random.below(5)];
            let end = (at + 1 + random.below(8)).min(bytes.len());
            bytes[at..end].fill(value);
        }
        4 => {
            let value =
                [u32::MAX, 0x7fc0_0000, 0x7f80_0000, 0x8000_0000, 1 << 24][random.below(5)].to_le_bytes();
            let end = (at + 4).min(bytes.len());
            bytes[at..end].copy_from_slice(&value[..end - at]);
        }
        5 => {
            let length = random.below(64).min(bytes.len() - at);
            bytes.drain(at..at + length);
            bytes.push(0);
        }
        6 => {
            let inserted: Vec<u8> = (0..random.below(64)).map(|_| random.bits() as u8).collect();
            bytes.splice(at..at, inserted);
        }
        _ => {
            // A digit of a header, of a description or anywhere.
            let digits: Vec<usize> =
                (0..bytes.len().min(4096)).filter(|k| bytes[*k].is_ascii_digit()).collect();
            if !digits.is_empty() {
                bytes[digits[random.below(digits.len())]] = b'0' + random.below(10) as u8;
            }
        }
    }
}

/// Reads `MUTATIONS` damaged files, which `damaged` makes.
fn survive(name: &str, mut damaged: impl FnMut(&mut Random) -> Vec<u8>) {
    let mut random = Random(name.len() as u64 * 1000 + u64::from(name.as_bytes()[2]));
    let (begun, mut read) = (Instant::now(), 0);
    for index in 0..MUTATIONS {
        let bytes = damaged(&mut random);
        let before = Instant::now();
        let (result, peak) = peak_bytes(|| read_bytes(&bytes, name));
        assert!(peak <= MOST_BYTES, "{name} {index}: held {peak} bytes");
        assert!(before.elapsed().as_secs() < 5, "{name} {index}: took {:?}", before.elapsed());
        match result {
            Ok(file) => {
                read += 1;
                assert!(file.cloud.means().iter().all(|mean| mean.is_finite()) && !file.cloud.is_empty());
            }
            Err(error) => {
                let error = error.to_string();
                assert!(error.starts_with(name) && error.ends_with(')') && !error.contains('\n'), "{error}");
            }
        }
    }
    println!("{name}: {read} of {MUTATIONS} were read all the same, {:.1?}", begun.elapsed());
    assert!(read < MUTATIONS, "{name}: the damage did nothing");
}

/// Damages the file itself.
fn survive_plain(name: &str, original: &[u8]) {
    survive(name, |random| {
        let mut bytes = original.to_vec();
        (0..=random.below(2)).for_each(|_| mutate(&mut bytes, random));
        bytes
    });
}

#[test]
fn damaged_ply() {
    let cloud = scattered(24, 1);
    survive_plain("a.ply", &ply(&cloud));
    survive_plain("ascii.ply", &ply_in_other_order(&cloud, Numbers::Ascii));
}

#[test]
fn damaged_compressed_ply() {
    survive_plain("a.compressed.ply", &compressed_ply(&scattered(24, 1), true));
}

#[test]
fn damaged_spz() {
    let cloud = scattered(24, 1);
    survive_plain("a.spz", &spz(&cloud, SpzVersion::Three));
    survive_plain("a.4.spz", &spz(&cloud, SpzVersion::Four));
    // Within the compressed stream.
    for version in [SpzVersion::One, SpzVersion::Two, SpzVersion::Three] {
        let payload = spz_payload(&cloud, version);
        survive("inside.spz", |random| {
            let mut bytes = payload.clone();
            mutate(&mut bytes, random);
            gzipped(&bytes)
        });
    }
}

#[test]
fn damaged_sog() {
    let cloud = scattered(24, 1);
    survive_plain("a.sog", &zipped(&sog_files(&cloud, 2)));
    for version in [1, 2] {
        let files = sog_files(&cloud, version);
        survive("inside.sog", |random| {
            let mut files = files.clone();
            // Half of the damage goes to the description.
            let index = if random.below(2) == 0 { 0 } else { random.below(files.len()) };
            mutate(&mut files[index].1, random);
            zipped(&files)
        });
    }
}

#[test]
fn damaged_splat() {
    survive_plain("a.splat", &raw_splat(&scattered(24, 0)));
}

#[test]
fn damaged_ksplat() {
    let cloud = scattered(70, 1);
    for level in 0..3 {
        let original = ksplat(&cloud, level);
        survive("a.ksplat", |random| {
            let mut bytes = original.clone();
            // Most of a header is zeros that nothing reads: half of the damage goes where numbers are.
            let at = [0, 4, 16, 20, 4096, 4104, 4108, 4112, 4116, 4120, 4128, 4132, 4136][random.below(13)];
            match random.below(2) {
                0 => bytes[at + random.below(4)] = random.bits() as u8,
                _ => mutate(&mut bytes, random),
            }
            bytes
        });
    }
}
