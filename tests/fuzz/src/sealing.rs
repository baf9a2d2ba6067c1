//! Changes within files that have checksums or lengths: a part is taken out, changed by libFuzzer, and put back with right ones.

use flate2::Compression;
use flate2::read::GzDecoder;
use flate2::write::GzEncoder;
use libfuzzer_sys::fuzzer_mutate;
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};
use std::io::{Cursor, Read, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

/// Changes a part of a file.
pub type Change<'a> = &'a mut dyn FnMut(&[u8]) -> Vec<u8>;
/// Changes a part, chosen by a number, of a file, and makes the file complete again; `None` if this is no such file.
pub type Mutate = fn(&[u8], u32, Change<'_>) -> Option<Vec<u8>>;

/// The most by which a change lengthens a part, bytes.
const GROWTH: usize = 64;
/// The most that is taken out of a compressed file, bytes.
const MAX_INFLATED: u64 = 1 << 20;

/// Changes the file in `data[..size]`: mostly within its parts, else anywhere. Returns its new size, at most `max_size`.
pub fn mutated(data: &mut [u8], size: usize, max_size: usize, seed: u32, mutate: Mutate) -> usize {
    let mut change = |part: &[u8]| {
        let mut changed = part.to_vec();
        changed.resize(part.len() + GROWTH, 0);
        let length = fuzzer_mutate(&mut changed, part.len(), part.len() + GROWTH);
        changed.truncate(length);
        changed
    };
    // One change in eight is to the bytes as they are.
    let new = (seed % 8 != 0).then(|| mutate(&data[..size], seed / 8, &mut change)).flatten();
    match new {
        Some(new) if new.len() <= max_size => {
            data[..new.len()].copy_from_slice(&new);
            new.len()
        }
        _ => fuzzer_mutate(data, size, max_size),
    }
}

/// A project: an entry of it, with the manifest's checksums.
pub fn project(bytes: &[u8], seed: u32, change: Change<'_>) -> Option<Vec<u8>> {
    let mut entries = unzipped(bytes)?;
    let manifest = entries.iter().position(|(name, _)| name == "manifest.json")?;
    // Half of the changes are to the manifest, whose fields decide most.
    let chosen = if seed % 2 == 0 { manifest } else { (seed / 2) as usize % entries.len() };
    entries[chosen].1 = change(&entries[chosen].1);
    if let Ok(mut fields) = serde_json::from_slice::<Map<String, Value>>(&entries[manifest].1) {
        if let Some(sums) = fields.get_mut("checksums").and_then(Value::as_object_mut) {
            for (name, content) in &entries {
                if let Some(sum) = sums.get_mut(name) {
                    *sum = hex::encode(Sha256::digest(content)).into();
                }
            }
            entries[manifest].1 = serde_json::to_vec(&fields).ok()?;
        }
    }
    zipped(&entries)
}

/// An archive: an entry of it, half of the time its first, which describes the others.
pub fn zip(bytes: &[u8], seed: u32, change: Change<'_>) -> Option<Vec<u8>> {
    let mut entries = unzipped(bytes)?;
    let chosen = if seed % 2 == 0 { 0 } else { (seed / 2) as usize % entries.len().max(1) };
    let entry = entries.get_mut(chosen)?;
    entry.1 = change(&entry.1);
    zipped(&entries)
}

/// A gzip stream: what it holds.
pub fn gzip(bytes: &[u8], _: u32, change: Change<'_>) -> Option<Vec<u8>> {
    let mut content = Vec::new();
    GzDecoder::new(bytes).take(MAX_INFLATED).read_to_end(&mut content).ok()?;
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(&change(&content)).ok()?;
    encoder.finish().ok()
}

/// Names and contents of an archive.
fn unzipped(bytes: &[u8]) -> Option<Vec<(String, Vec<u8>)>> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).ok()?;
    let mut entries = Vec::new();
    for index in 0..archive.len() {
        let entry = archive.by_index(index).ok()?;
        let (name, mut content) = (entry.name().ok()?.into_owned(), Vec::new());
        entry.take(MAX_INFLATED).read_to_end(&mut content).ok()?;
        entries.push((name, content));
    }
    Some(entries)
}

/// An archive that is not compressed.
fn zipped(entries: &[(String, Vec<u8>)]) -> Option<Vec<u8>> {
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default());
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in entries {
        archive.start_file(name.as_str(), options).ok()?;
        archive.write_all(content).ok()?;
    }
    Some(archive.finish().ok()?.into_inner())
}

/// A part of a picture, or a light field: what is before the SHA-256 at its end.
pub fn sealed(bytes: &[u8], _: u32, change: Change<'_>) -> Option<Vec<u8>> {
    let body = bytes.get(..bytes.len().checked_sub(32)?)?;
    let mut new = change(body);
    let seal = Sha256::digest(&new);
    new.extend(seal);
    Some(new)
}

/// A binary glTF file: its JSON or its buffer, with right lengths.
pub fn glb(bytes: &[u8], seed: u32, change: Change<'_>) -> Option<Vec<u8>> {
    let (json, buffer) = glb_chunks(bytes)?;
    Some(match seed % 2 {
        0 => glb_of(&change(json), buffer),
        _ => glb_of(json, &change(buffer)),
    })
}

/// A binary glTF file: its buffer, in which compressed meshes and textures are.
pub fn glb_buffer(bytes: &[u8], seed: u32, change: Change<'_>) -> Option<Vec<u8>> {
    // One change in 16 is to the JSON, which has counts and modes.
    let (json, buffer) = glb_chunks(bytes)?;
    Some(if seed % 16 == 0 { glb_of(&change(json), buffer) } else { glb_of(json, &change(buffer)) })
}

/// JSON and buffer.
fn glb_chunks(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let rest = bytes.strip_prefix(b"glTF\x02\0\0\0")?.get(4..)?;
    // A chunk is its length, its kind, and its bytes.
    let chunk = |from: &[u8]| -> Option<usize> {
        let length = u32::from_le_bytes(*from.first_chunk()?) as usize;
        from.get(8..)?.get(..length).map(|_| length)
    };
    let (json, rest) = rest.get(8..)?.split_at(chunk(rest)?);
    let buffer = chunk(rest).map_or(&[][..], |length| &rest[8..8 + length]);
    Some((json, buffer))
}

fn glb_of(json: &[u8], buffer: &[u8]) -> Vec<u8> {
    let padded = |bytes: &[u8], filler: u8| {
        let mut bytes = bytes.to_vec();
        bytes.resize(bytes.len().next_multiple_of(4), filler);
        bytes
    };
    let (json, buffer) = (padded(json, b' '), padded(buffer, 0));
    let mut file = b"glTF\x02\0\0\0".to_vec();
    file.extend(((12 + 8 + json.len() + 8 + buffer.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &buffer)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}
