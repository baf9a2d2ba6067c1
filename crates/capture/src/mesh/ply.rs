//! Meshes in PLY files (Turk 1994): ASCII or binary of either byte order, properties of any type in any order.
//!
//! The vertices' `x y z`, normals `nx ny nz` and colours `red green blue` (or `r g b`, `diffuse_red` …), and the list `vertex_indices` (or
//! `vertex_index`) of the faces or of the triangle strips are read; everything else is skipped. Colours are taken as sRGB, as scanning
//! programs write them; faces of more than three corners become fans.

mod body;
mod header;

use crate::CaptureError;
use crate::mesh::polygon_fan::triangulate_fan;
use crate::mesh::triangle_strip::strip_triangles;
use body::Body;
use glam::{DVec3, Vec3, Vec4};
use header::{DataType, Element, Header};
use scene::{LoadOptions, SurfaceMesh, linear_from_srgb};
use std::path::Path;

/// The elements that a surface consists of: polygons, and triangle strips as Stanford's scans have them (the others are
/// rarer names of theirs).
const SURFACES: [&str; 4] = ["face", "tristrips", "tri_strips", "tristrip"];

/// Whether a PLY file has faces, or is too broken to tell.
pub(crate) fn may_have_faces(file: &Path) -> bool {
    let header = Header::open(file);
    let has_rows = |header: &Header, name| header.element(name).is_some_and(|element| element.count > 0);
    header.map_or(true, |(header, _)| SURFACES.iter().any(|name| has_rows(&header, name)))
}

/// Reads the mesh of a file.
pub(crate) fn read(file: &Path, options: &LoadOptions) -> Result<SurfaceMesh, CaptureError> {
    let (header, rest) = Header::open(file)?;
    let mut body = Body::new(file, header.format, rest);
    let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let mut mesh = SurfaceMesh { path: file.into(), name, ..SurfaceMesh::default() };
    let used = ["vertex"].into_iter().chain(SURFACES).collect::<Vec<_>>();
    for (element, is_used) in header.until(&used) {
        body.check_count(element)?;
        match element.name.as_str() {
            "vertex" if is_used => vertices(&mut mesh, element, &mut body, options)?,
            "face" if is_used => {
                surface(&mut mesh, element, &mut body, options, |corners| {
                    triangulate_fan(corners).collect()
                })?;
            }
            _ if is_used => {
                surface(&mut mesh, element, &mut body, options, |corners| {
                    strip_triangles(corners).collect()
                })?;
            }
            _ => body.skip(element)?,
        }
    }
    Ok(mesh)
}

fn vertices(
    mesh: &mut SurfaceMesh,
    element: &Element,
    body: &mut Body,
    options: &LoadOptions,
) -> Result<(), CaptureError> {
    let columns = |names: [&str; 3]| {
        let columns = names.map(|name| element.properties.iter().position(|property| property.name == name));
        let is_number = |column: usize| matches!(element.properties[column].data_type, DataType::Scalar(_));
        match columns {
            [Some(x), Some(y), Some(z)] if [x, y, z].into_iter().all(is_number) => Some([x, y, z]),
            _ => None,
        }
    };
    let Some(position) = columns(["x", "y", "z"]) else {
        return Err(body.malformed("its vertices have no x, y and z"));
    };
    let normal = columns(["nx", "ny", "nz"]);
    let color = [["red", "green", "blue"], ["diffuse_red", "diffuse_green", "diffuse_blue"], ["r", "g", "b"]];
    let color = color.into_iter().find_map(columns);
    let each = 24 + if normal.is_some() { 12 } else { 0 } + if color.is_some() { 16 } else { 0 };
    body.check_memory(element, each, options)?;
    let count = element.count as usize;
    mesh.positions.reserve_exact(count);
    mesh.normals.reserve_exact(if normal.is_some() { count } else { 0 });
    mesh.colors.reserve_exact(if color.is_some() { count } else { 0 });
    let whites = color.map(|columns| columns.map(|column| element.properties[column].data_type.white()));
    let mut row = vec![0.0; element.properties.len()];
    for _ in 0..count {
        body.row(element, &mut row, None)?;
        mesh.positions.push(DVec3::from(position.map(|column| row[column])));
        if let Some(columns) = normal {
            mesh.normals.push(Vec3::from(columns.map(|column| row[column] as f32)));
        }
        if let (Some(columns), Some(whites)) = (color, whites) {
            let [r, g, b] = [0, 1, 2].map(|k| linear_from_srgb(row[columns[k]] / whites[k]));
            mesh.colors.push(Vec4::new(r, g, b, 1.0));
        }
    }
    Ok(())
}

/// Reads an element whose rows list corners, of which `triangulate` makes triangles.
fn surface(
    mesh: &mut SurfaceMesh,
    element: &Element,
    body: &mut Body,
    options: &LoadOptions,
    triangulate: impl Fn(&[i64]) -> Vec<[i64; 3]>,
) -> Result<(), CaptureError> {
    let is_list = |name: &str| {
        let named = |property: &header::Property| {
            property.name == name && matches!(property.data_type, DataType::List { .. })
        };
        element.properties.iter().position(named)
    };
    let Some(column) = is_list("vertex_indices").or_else(|| is_list("vertex_index")) else {
        let what = match element.name.as_str() {
            "face" => "its faces have no list of vertex_indices",
            _ => "its triangle strips have no list of vertex_indices",
        };
        return Err(body.malformed(what));
    };
    let mut row = vec![0.0; element.properties.len()];
    let (mut corners, mut indices) = (Vec::new(), Vec::new());
    for _ in 0..element.count {
        body.row(element, &mut row, Some((column, &mut corners)))?;
        indices.clear();
        // A fraction is no index of a vertex either.
        indices.extend(
            corners.iter().map(|corner| if corner.fract() == 0.0 { *corner as i64 } else { i64::MAX }),
        );
        // An index that cannot be one becomes one that does not exist.
        let vertex = |corner: i64| u32::try_from(corner).unwrap_or(u32::MAX);
        mesh.triangles.extend(triangulate(&indices).into_iter().map(|triangle| triangle.map(vertex)));
        if mesh.triangles.len() as u64 > options.max_triangles {
            let what = format!("has more than {} triangles", options.max_triangles);
            return Err(CaptureError::TooBig { file: mesh.path.clone(), what });
        }
    }
    Ok(())
}
