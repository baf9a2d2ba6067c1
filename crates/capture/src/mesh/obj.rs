//! Meshes in Wavefront OBJ files: vertices, their colours (`v x y z r g b`) and normals, faces. Materials and textures are ignored: colours
//! come from the photographs.

use crate::CaptureError;
use crate::files::text::{Lines, number, quoted};
use crate::mesh::polygon_fan::triangulate_fan;
use glam::{DVec3, Vec3, Vec4};
use scene::{LoadOptions, SurfaceMesh, linear_from_srgb};
use std::path::Path;

/// Reads the mesh of a file, and notes on what was ignored.
pub(crate) fn read(file: &Path, options: &LoadOptions) -> Result<(SurfaceMesh, Vec<String>), CaptureError> {
    let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut reader = Reader {
        lines: Lines::open(file)?,
        mesh: SurfaceMesh { path: file.into(), name, ..SurfaceMesh::default() },
        normals: Vec::new(),
    };
    let mut has_materials = false;
    while let Some(mut line) = reader.lines.next_filled()? {
        while line.ends_with('\\') {
            line.pop();
            line.push_str(&reader.lines.next()?.unwrap_or_default());
        }
        let mut fields = line.split_whitespace();
        match fields.next() {
            Some("v") => reader.vertex(fields)?,
            Some("vn") => reader.normal(fields)?,
            Some("f") => reader.face(fields)?,
            Some("mtllib" | "usemtl") => has_materials = true,
            _ => {}
        }
        reader.check(options)?;
    }
    let notes = has_materials
        .then(|| "its materials and textures are ignored; colours come from the photographs".into());
    // Colours are all or none.
    let mut mesh = reader.mesh;
    if mesh.colors.len() < mesh.positions.len() {
        mesh.colors.clear();
    }
    Ok((mesh, notes.into_iter().collect()))
}

struct Reader {
    lines: Lines,
    mesh: SurfaceMesh,
    /// Those of the file; a vertex has the sum of those of its corners.
    normals: Vec<Vec3>,
}

impl Reader {
    fn vertex<'a>(&mut self, fields: impl Iterator<Item = &'a str>) -> Result<(), CaptureError> {
        let mut values = [0.0; 7];
        let mut count = 0;
        for field in fields.take(7) {
            // An infinite or undefined vertex is dropped with its faces.
            let value = number(field).or_else(|| field.parse::<f64>().ok());
            values[count] =
                value.ok_or_else(|| self.lines.malformed(format!("{} is not a number", quoted(field))))?;
            count += 1;
        }
        if count < 3 {
            return Err(self.lines.malformed("a vertex has fewer than 3 numbers"));
        }
        let [x, y, z, rest @ ..] = values;
        self.mesh.positions.push(DVec3::new(x, y, z));
        // x y z r g b, or x y z w r g b.
        let color = match count {
            6 => Some([rest[0], rest[1], rest[2]]),
            7 => Some([rest[1], rest[2], rest[3]]),
            _ => None,
        };
        if let Some(color) = color {
            let [r, g, b] = color.map(linear_from_srgb);
            self.mesh.colors.push(Vec4::new(r, g, b, 1.0));
        }
        Ok(())
    }

    fn normal<'a>(&mut self, fields: impl Iterator<Item = &'a str>) -> Result<(), CaptureError> {
        let fields: Vec<&str> = fields.take(3).collect();
        let normal = crate::files::text::numbers::<3>(&fields).map(|normal| DVec3::from(normal).as_vec3());
        self.normals.push(normal.unwrap_or_default());
        Ok(())
    }

    /// A face of corners `v`, `v/vt`, `v/vt/vn` or `v//vn`, as a fan.
    fn face<'a>(&mut self, fields: impl Iterator<Item = &'a str>) -> Result<(), CaptureError> {
        let mut corners = Vec::new();
        for corner in fields {
            let mut parts = corner.split('/');
            let vertex = parts.next().and_then(|index| absolute(index, self.mesh.positions.len()));
            let Some(vertex) = vertex else {
                let vertices = self.mesh.positions.len();
                return Err(self
                    .lines
                    .malformed(format!("{} is none of the {vertices} vertices so far", quoted(corner))));
            };
            if let Some(normal) = parts.nth(1).and_then(|index| absolute(index, self.normals.len()))
                && let Some(normal) = self.normals.get(normal as usize)
                && (vertex as usize) < self.mesh.positions.len()
            {
                self.mesh.normals.resize(self.mesh.positions.len(), Vec3::ZERO);
                self.mesh.normals[vertex as usize] += *normal;
            }
            corners.push(vertex);
        }
        self.mesh.triangles.extend(triangulate_fan(&corners));
        Ok(())
    }

    /// An error if the limits are exceeded.
    fn check(&self, options: &LoadOptions) -> Result<(), CaptureError> {
        let mesh = &self.mesh;
        let bytes = 24 * mesh.positions.len()
            + 16 * mesh.colors.len()
            + 12 * (mesh.normals.len() + self.normals.len());
        let what = match () {
            () if mesh.triangles.len() as u64 > options.max_triangles => {
                format!("has more than {} triangles", options.max_triangles)
            }
            () if bytes as u64 > options.max_memory => {
                format!("its vertices take more than {} MiB", options.max_memory >> 20)
            }
            () => return Ok(()),
        };
        Err(CaptureError::TooBig { file: mesh.path.clone(), what })
    }
}

/// The index from 0 of a number counted from 1, or backwards from −1, of `count` so far. One beyond may follow later.
fn absolute(index: &str, count: usize) -> Option<u32> {
    match index.parse::<i64>().ok()? {
        0 => None,
        index if index > 0 => u32::try_from(index - 1).ok(),
        index => u32::try_from(i64::try_from(count).ok()?.checked_add(index)?).ok(),
    }
}
