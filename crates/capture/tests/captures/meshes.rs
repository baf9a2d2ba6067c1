//! Meshes in PLY, OBJ and glTF: the same tetrahedron in every encoding, and the choice among several files.

use crate::made::{PLY, cameras, colmap, open, pictures_and_mesh, refused};
use capture::CaptureOptions;
use glam::DVec3;
use progress::Unwatched;
use scene::{LoadOptions, Scene};
use std::fs::{remove_file, write};
use std::path::Path;

/// The scene of a capture whose mesh is this file.
fn scene_of(name: &str, bytes: impl AsRef<[u8]>) -> Scene {
    let folder = colmap(&["a.jpg"]);
    remove_file(folder.path().join("mesh.ply")).unwrap();
    write(folder.path().join(name), bytes).unwrap();
    let capture = open(folder.path()).unwrap();
    assert_eq!(capture.mesh, folder.path().join(name));
    capture.scene
}

/// The error of a capture whose mesh is this file.
fn refusal_of(name: &str, bytes: impl AsRef<[u8]>) -> String {
    let folder = colmap(&["a.jpg"]);
    remove_file(folder.path().join("mesh.ply")).unwrap();
    write(folder.path().join(name), bytes).unwrap();
    refused(folder.path())
}

fn assert_tetrahedron(scene: &Scene) {
    let corners = [[-1.0, -0.5, -0.5], [1.0, -0.5, -0.5], [0.0, -0.5, 1.0], [0.0, 1.0, 0.0]].map(DVec3::from);
    assert_eq!(scene.positions, corners);
    let triangles: Vec<_> = scene.triangles.iter().map(|triangle| triangle.vertices).collect();
    assert_eq!(triangles, [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]);
    assert!(scene.materials[0].double_sided);
}

#[test]
fn ply_as_text_with_nothing_but_positions() {
    let scene = scene_of("mesh.ply", PLY);
    assert_tetrahedron(&scene);
    assert!(scene.colors.is_empty() && scene.normals.is_empty() && !scene.materials[0].unlit);
    assert_tetrahedron(&scene_of("odd name.PLY", PLY.replace('\n', " \r\n")));
}

/// A binary PLY with properties in an unusual order, of unusual types, and superfluous ones.
fn binary_ply(is_big: bool) -> Vec<u8> {
    let name = if is_big { "binary_big_endian" } else { "binary_little_endian" };
    let mut ply = format!(
        "ply\nformat {name} 1.0\nobj_info x\nelement other 2\nproperty list uchar short values\nelement vertex 4\nproperty uchar blue\n\
         property double z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty ushort green\nproperty double x\n\
         property float y\nproperty uint8 red\nproperty float quality\nelement face 4\nproperty int flags\n\
         property list uint8 int8 vertex_index\nproperty list uchar float texcoord\nend_header\n"
    )
    .into_bytes();
    let mut push = |mut bytes: Vec<u8>| {
        if is_big {
            bytes.reverse();
        }
        ply.extend(bytes);
    };
    for length in [1u8, 2] {
        push(vec![length]);
        (0..length).for_each(|value| push(i16::from(value).to_le_bytes().to_vec()));
    }
    for [x, y, z] in [[-1.0, -0.5, -0.5], [1.0, -0.5, -0.5], [0.0, -0.5, 1.0], [0.0, 1.0, 0.0f64]] {
        push(vec![255]);
        push(z.to_le_bytes().to_vec());
        [0.0f32, 0.0, 2.0].iter().for_each(|n| push(n.to_le_bytes().to_vec()));
        push(0u16.to_le_bytes().to_vec());
        push(x.to_le_bytes().to_vec());
        push((y as f32).to_le_bytes().to_vec());
        push(vec![188]);
        push(0.5f32.to_le_bytes().to_vec());
    }
    for corners in [[0u8, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]] {
        push(9i32.to_le_bytes().to_vec());
        push(vec![3]);
        corners.iter().for_each(|corner| push(vec![*corner]));
        push(vec![1]);
        push(0.5f32.to_le_bytes().to_vec());
    }
    ply
}

#[test]
fn ply_of_either_byte_order_with_colours_and_normals_in_any_order() {
    for is_big in [false, true] {
        let scene = scene_of("mesh.ply", binary_ply(is_big));
        assert_tetrahedron(&scene);
        assert!(
            scene.normals.iter().all(|normal| *normal == glam::Vec3::Z),
            "of any length in the file, of one here"
        );
        let color = scene.colors[0];
        assert!(
            (color.x - 0.5029).abs() < 1e-4 && color.y == 0.0 && color.z == 1.0,
            "sRGB to linear: {color}"
        );
        assert!(scene.materials[0].unlit, "its colours are what is seen");
    }
}

#[test]
fn ply_colours_as_floats() {
    let head = "property float z\nproperty float red\nproperty float green\nproperty float blue\n";
    let ply = PLY.replace("property float z\n", head);
    let (head, body) = ply.split_once("end_header\n").unwrap();
    let body: String = body
        .lines()
        .enumerate()
        .map(|(i, line)| if i < 4 { format!("{line} 1 0.5 0\n") } else { format!("{line}\n") })
        .collect();
    let scene = scene_of("mesh.ply", format!("{head}end_header\n{body}"));
    assert!((scene.colors[3].y - 0.21404).abs() < 1e-4, "{}", scene.colors[3]);
}

#[test]
fn ply_faces_of_many_corners_are_fans() {
    let ply = PLY.replace("element face 4", "element face 3").split_once("\n3 0 1 2\n").unwrap().0.to_owned();
    let scene = scene_of("mesh.ply", ply + "\n4 0 1 2 3\n2 0 1\n3 0 1 2\n");
    let triangles: Vec<_> = scene.triangles.iter().map(|triangle| triangle.vertices).collect();
    assert_eq!(triangles, [[0, 1, 2], [0, 2, 3], [0, 1, 2]]);
}

/// A PLY of the tetrahedron whose faces are triangle strips, as in Stanford's scans.
fn ply_of_strips(format: &str, strips: &[i32]) -> Vec<u8> {
    let mut ply = format!(
        "ply\nformat {format} 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\n\
         property list int int vertex_indices\nend_header\n"
    )
    .into_bytes();
    let corners = [[-1.0f32, -0.5, -0.5], [1.0, -0.5, -0.5], [0.0, -0.5, 1.0], [0.0, 1.0, 0.0]];
    if format == "ascii" {
        let words = corners.iter().flatten().map(f32::to_string);
        let words = words.chain([strips.len().to_string()]).chain(strips.iter().map(i32::to_string));
        ply.extend(words.collect::<Vec<_>>().join(" ").into_bytes());
        return ply;
    }
    let is_big = format == "binary_big_endian";
    let word = |bytes: [u8; 4]| if is_big { [bytes[3], bytes[2], bytes[1], bytes[0]] } else { bytes };
    ply.extend(corners.iter().flatten().flat_map(|value| word(value.to_le_bytes())));
    let integers = [strips.len() as i32].into_iter().chain(strips.iter().copied());
    ply.extend(integers.flat_map(|value| word(value.to_le_bytes())));
    ply
}

#[test]
fn ply_of_triangle_strips() {
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let strips = [0, 1, 2, -1, 0, 3, 1, -1, 1, 3, 2, 0, -1];
        let scene = scene_of("bunny.ply", ply_of_strips(format, &strips));
        let triangles: Vec<_> = scene.triangles.iter().map(|triangle| triangle.vertices).collect();
        assert_eq!(triangles, [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]], "{format}");
        let outside = refusal_of("bunny.ply", ply_of_strips(format, &[0, 1, -2]));
        assert!(
            outside.contains("1 of 1 triangles have a vertex that does not exist"),
            "{format}: {outside}"
        );
        let empty = refusal_of("bunny.ply", ply_of_strips(format, &[0, 1, -1, 2, 3]));
        assert!(empty.contains("no triangle"), "{format}: {empty}");
        let cut = ply_of_strips(format, &strips);
        assert!(
            refusal_of("bunny.ply", &cut[..cut.len() - 5]).contains("the file ends too early"),
            "{format}"
        );
    }
    let nameless =
        String::from_utf8(ply_of_strips("ascii", &[0, 1, 2])).unwrap().replace("vertex_indices", "x");
    assert!(refusal_of("bunny.ply", nameless).contains("its triangle strips have no list of vertex_indices"));
}

#[test]
fn ply_that_is_malformed_names_its_place() {
    for (from, to, what) in [
        ("ascii", "text", "line 2: the format \"text\" is not supported"),
        ("float z", "number z", "line 7: is not a property of a known type"),
        ("vertex 4", "vertex many", "line 4: \"many\" is not a count"),
        ("property float z\n", "", "its vertices have no x, y and z"),
        ("0 1 0", "0 one 0", "line 14: \"one\" is not a number"),
        ("3 2 3 0\n", "", "the file ends too early"),
        ("vertex 4", "vertex 4000000000000", "rows of \"vertex\" do not fit the"),
        ("3 0 3 1", "1e9 0 3 1", "line 16: a list of 1000000000 does not fit the file"),
        ("vertex_indices", "corners", "its faces have no list of vertex_indices"),
    ] {
        let text = refusal_of("mesh.ply", PLY.replace(from, to));
        assert!(text.contains("mesh.ply: ") && text.contains(what), "{text}");
    }
    let binary = binary_ply(false);
    let text = refusal_of("mesh.ply", &binary[..binary.len() - 9]);
    assert!(
        text.contains(&format!("mesh.ply: byte {}: the file ends too early", binary.len() - 9)),
        "{text}"
    );
}

#[test]
fn obj_with_negative_indices_colours_normals_and_materials() {
    let obj = "# made by hand\nmtllib a.mtl\nv -1 -0.5 -0.5 1 0 0\nv 1 -0.5 -0.5 1 0 0\nv 0 -0.5 1 1 0 0\nv 0 1 0 0 0,5 1\n\
        vt 0 0\nvn 0 0 3\nusemtl m\ns off\nf 1/1/1 2/1/1 3/1/1\nf -4 -1 -3\nf 2//1 4//1 \\\n3//1\nf 3/1 4/1 1/1\n";
    let scene = scene_of("model.obj", obj);
    assert_tetrahedron(&scene);
    assert!(scene.normals.iter().all(|normal| *normal == glam::Vec3::Z));
    assert!((scene.colors[3].y - 0.21404).abs() < 1e-4 && scene.colors[0].truncate() == glam::Vec3::X);

    let folder = colmap(&["a.jpg"]);
    remove_file(folder.path().join("mesh.ply")).unwrap();
    write(folder.path().join("model.obj"), obj).unwrap();
    let remarks = open(folder.path()).unwrap().remarks;
    assert!(
        remarks.len() == 1 && remarks[0].text.contains("materials and textures are ignored"),
        "{remarks:?}"
    );
}

#[test]
fn obj_faces_of_many_corners_are_fans_and_lone_colours_are_none() {
    let scene = scene_of("a.obj", "v 0 0 0\nv 1 0 0 1 1 1\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    let triangles: Vec<_> = scene.triangles.iter().map(|triangle| triangle.vertices).collect();
    assert_eq!(triangles, [[0, 1, 2], [0, 2, 3]]);
    assert!(scene.colors.is_empty());
}

#[test]
fn obj_that_is_malformed_names_its_place() {
    for (obj, what) in [
        ("v 0 0\n", "line 1: a vertex has fewer than 3 numbers"),
        ("v 0 0 a\n", "line 1: \"a\" is not a number"),
        ("v 0 0 0\n\nf 0 1 1\n", "line 3: \"0\" is none of the 1 vertices so far"),
        ("v 0 0 0\nf 1 1 -2\n", "line 2: \"-2\" is none of the 1 vertices"),
        ("v 0 0 0\n", "no triangle"),
        ("v 0 0 0\nf 1 2 3\n", "1 of 1 triangles have a vertex that does not exist"),
    ] {
        let text = refusal_of("a.obj", obj);
        assert!(text.contains("a.obj: ") && text.contains(what), "{text}");
    }
}

/// A glTF of the tetrahedron with embedded data.
fn gltf() -> String {
    let positions = [[-1.0f32, -0.5, -0.5], [1.0, -0.5, -0.5], [0.0, -0.5, 1.0], [0.0, 1.0, 0.0]];
    let mut bytes: Vec<u8> = positions.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect();
    bytes.extend([0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0]);
    let hex: String = bytes.iter().map(|byte| format!("%{byte:02x}")).collect();
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "material": 0}}]}}], "materials": [{{"doubleSided": true}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-1, -0.5, -0.5], "max": [1, 1, 1]}},
        {{"bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 12}}],
        "buffers": [{{"byteLength": 60, "uri": "data:application/octet-stream,{hex}"}}]}}"#
    )
}

#[test]
fn gltf_is_read_as_scenes_are() {
    assert_tetrahedron(&scene_of("place.gltf", gltf()));
}

#[test]
fn the_surface_is_the_mesh_of_the_likeliest_name_and_never_points() {
    let folder = colmap(&["a.jpg"]);
    let points = PLY.split_once("element face").unwrap().0.to_owned() + "end_header\n";
    write(folder.path().join("fused.ply"), &points).unwrap();
    write(folder.path().join("meshed-poisson.ply"), PLY).unwrap();
    write(folder.path().join("a.obj"), "nonsense").unwrap();
    let capture = open(folder.path()).unwrap();
    assert_eq!(capture.mesh, folder.path().join("mesh.ply"));
    assert!(
        capture.remarks[0].text.contains("there are also") && capture.remarks[0].names.len() == 2,
        "{:?}",
        capture.remarks
    );
    remove_file(folder.path().join("mesh.ply")).unwrap();
    assert_eq!(open(folder.path()).unwrap().mesh, folder.path().join("meshed-poisson.ply"));
    remove_file(folder.path().join("meshed-poisson.ply")).unwrap();
    remove_file(folder.path().join("a.obj")).unwrap();
    let text = refused(folder.path());
    assert!(text.contains("fused.ply has points and no faces"), "{text}");
}

#[test]
fn without_a_mesh_the_error_explains_how_to_make_one() {
    let folder = colmap(&["a.jpg"]);
    remove_file(folder.path().join("mesh.ply")).unwrap();
    let text = refused(folder.path());
    for command in ["colmap delaunay_mesher", "needs no CUDA", "colmap poisson_mesher", "ReconstructMesh"] {
        assert!(text.contains(command), "{text}");
    }
}

#[test]
fn a_mesh_and_pictures_may_be_named_wherever_they_are() {
    let (folder, elsewhere) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let cameras = cameras(&["a.jpg"]);
    crate::made::colmap_text(folder.path(), &cameras);
    pictures_and_mesh(elsewhere.path(), &cameras);
    let named = |pictures: &Path, mesh: &Path| {
        let options = CaptureOptions {
            pictures: Some(pictures.into()),
            mesh: Some(mesh.into()),
            ..CaptureOptions::default()
        };
        capture::open(folder.path(), &options, &Unwatched)
    };
    let capture = named(&elsewhere.path().join("images"), &elsewhere.path().join("mesh.ply")).unwrap();
    assert_tetrahedron(&capture.scene);
    assert_eq!(capture.views[0].picture, elsewhere.path().join("images/a.jpg"));
    let no_mesh = named(&elsewhere.path().join("images"), &elsewhere.path().join("images/a.jpg"))
        .unwrap_err()
        .to_string();
    assert!(no_mesh.contains("meshes in \"jpg\" files cannot be read"), "{no_mesh}");
}

#[test]
fn meshes_beyond_the_limits_are_refused() {
    let folder = colmap(&["a.jpg"]);
    let options = |load| CaptureOptions { load, ..CaptureOptions::default() };
    let refusal = |load| capture::open(folder.path(), &options(load), &Unwatched).unwrap_err().to_string();
    let few = LoadOptions { max_triangles: 3, ..LoadOptions::default() };
    assert!(refusal(few.clone()).contains("has more than 3 triangles"));
    let small = LoadOptions { max_memory: 90, ..LoadOptions::default() };
    assert!(refusal(small.clone()).contains("4 vertices take"));
    remove_file(folder.path().join("mesh.ply")).unwrap();
    write(folder.path().join("a.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4 1 2\n").unwrap();
    assert!(refusal(few).contains("has more than 3 triangles"));
    assert!(refusal(small).contains("its vertices take more than 0 MiB"));
}
