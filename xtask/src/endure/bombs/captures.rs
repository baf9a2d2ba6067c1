//! Captures of other programs.

use super::super::harness::made_files::{picture, put};
use super::bomb::{Bomb, bomb};
use std::path::Path;

const INFO: &str = "info c";

/// Bombs in captures.
pub const BOMBS: &[Bomb] = &[
    bomb("a PLY of 2⁴⁰ vertices", INFO, |to| {
        nerfstudio(to)?;
        put(to, "c/mesh.ply", ply(1 << 40, 1))
    }),
    bomb("a PLY with a face of 2³² − 1 corners", INFO, |to| {
        nerfstudio(to)?;
        put(to, "c/mesh.ply", [&ply(0, 1)[..], &u32::MAX.to_le_bytes()].concat())
    }),
    bomb("COLMAP's images, 2⁶³ of them", INFO, |to| {
        photographs(to)?;
        put(to, "c/sparse/0/cameras.bin", [&1u64.to_le_bytes()[..], &[0; 48]].concat())?;
        put(to, "c/sparse/0/points3D.bin", [0; 8])?;
        put(to, "c/sparse/0/images.bin", [&(1u64 << 63).to_le_bytes()[..], &[0; 64]].concat())
    }),
    bomb("Metashape's XML with entities that expand a billion times", INFO, |to| {
        photographs(to)?;
        let mut text =
            String::from("<?xml version=\"1.0\"?>\n<!DOCTYPE document [<!ENTITY a0 \"aaaaaaaaaa\">");
        for level in 1..10 {
            text += &format!("<!ENTITY a{level} \"{}\">", format!("&a{};", level - 1).repeat(10));
        }
        text += "]>\n<document version=\"1.5.0\"><chunk label=\"&a9;\"/></document>";
        put(to, "c/cameras.xml", text)
    }),
];

fn photographs(to: &Path) -> Result<(), String> {
    put(to, "c/images/readme.txt", "")?;
    picture(&to.join("c/images/1.png"), [8, 8])?;
    picture(&to.join("c/images/2.png"), [8, 8])
}

fn nerfstudio(to: &Path) -> Result<(), String> {
    photographs(to)?;
    let pose = "[[1,0,0,0],[0,1,0,0],[0,0,1,3],[0,0,0,1]]";
    let frame = |name: &str| format!("{{\"file_path\":\"images/{name}\",\"transform_matrix\":{pose}}}");
    let frames = [frame("1.png"), frame("2.png")].join(",");
    let head = "\"w\":8,\"h\":8,\"fl_x\":8,\"fl_y\":8,\"cx\":4,\"cy\":4,\"camera_model\":\"PINHOLE\"";
    put(to, "c/transforms.json", format!("{{{head},\"frames\":[{frames}]}}"))
}

fn ply(vertices: u64, faces: u64) -> Vec<u8> {
    let properties = "property float x\nproperty float y\nproperty float z\n";
    let list = "property list uint uint vertex_indices\n";
    let text = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n{properties}element face {faces}\n{list}end_header\n"
    );
    text.into_bytes()
}
