//! `KHR_gaussian_splatting` in a file: alone, beside meshes, of several nodes, in motion, and what is wrong with it.

mod data;
mod handmade;
mod mutation;

use glam::{DMat3, DVec3};
use handmade::Glb;
use mutation::{Random, damage};
use progress::Unwatched;
use scene::{AnimatedScene, AnimationTime, Fault, LoadOptions, SceneError, load};
use serde_json::json;
use std::sync::Arc;

const COUNT: usize = 5;

impl Glb {
    /// Adds a mesh of splats of degree 1, in a row along x at z = 2; returns its index.
    fn add_splats(&mut self) -> usize {
        let own = |name: &str| format!("KHR_gaussian_splatting:{name}");
        let repeat = |values: &[f32]| values.repeat(COUNT);
        let means: Vec<f32> = (0..COUNT).flat_map(|k| [k as f32, 0.0, 2.0]).collect();
        let mut attributes = json!({
            "POSITION": self.accessor(&means, "VEC3"),
            own("ROTATION"): self.raw_accessor(&[0, 0, 0, 127].repeat(COUNT), 5120, "VEC4", COUNT),
            own("SCALE"): self.accessor(&repeat(&[0.3, 0.2, 0.0]), "VEC3"),
            own("OPACITY"): self.raw_accessor(&[204, 0, 0, 0].repeat(COUNT), 5121, "SCALAR", COUNT),
            own("SH_DEGREE_0_COEF_0"): self.accessor(&repeat(&[0.5, -0.5, 0.25]), "VEC3"),
        });
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        let index = |value: &serde_json::Value| value.as_u64().unwrap() as usize;
        accessors[index(&attributes["POSITION"])]["min"] = json!([0, 0, 2]);
        accessors[index(&attributes["POSITION"])]["max"] = json!([COUNT - 1, 0, 2]);
        accessors[index(&attributes[own("ROTATION")])]["normalized"] = json!(true);
        let opacity = index(&attributes[own("OPACITY")]);
        accessors[opacity]["normalized"] = json!(true);
        let view = accessors[opacity]["bufferView"].as_u64().unwrap() as usize;
        self.json["bufferViews"][view]["byteStride"] = json!(4);
        for k in 0..3 {
            attributes[own(&format!("SH_DEGREE_1_COEF_{k}"))] =
                json!(self.accessor(&repeat(&[0.1 * k as f32; 3]), "VEC3"));
        }
        let extension = json!({"kernel": "ellipse", "colorSpace": "srgb_rec709_display",
            "sortingMethod": "cameraDistance", "projection": "perspective"});
        let mesh = json!({"primitives": [{"mode": 0, "attributes": attributes,
            "extensions": {"KHR_gaussian_splatting": extension}}]});
        self.json["extensionsUsed"] = json!(["KHR_gaussian_splatting"]);
        let meshes = self.json["meshes"].as_array_mut().unwrap();
        meshes.push(mesh);
        meshes.len() - 1
    }

    /// A triangle, and splats on a node of their own, moved, turned and scaled.
    fn with_splats() -> Self {
        let mut glb = Self::triangle();
        let mesh = glb.add_splats();
        let node = json!({"name": "scan", "mesh": mesh, "translation": [0, 5, 0], "scale": [2, 2, 2],
            "rotation": [0, 0.5f64.sqrt(), 0, 0.5f64.sqrt()]});
        glb.json["nodes"].as_array_mut().unwrap().push(node);
        glb.json["scenes"][0]["nodes"] = json!([0, 1]);
        glb
    }

    fn primitive(&mut self) -> &mut serde_json::Value {
        &mut self.json["meshes"][1]["primitives"][0]
    }
}

#[test]
fn splats_stand_beside_meshes_where_their_node_puts_them() {
    let scene = Glb::with_splats().clean();
    let splats = scene.splats.clone().unwrap();
    assert_eq!((scene.surface_triangles(), splats.triangles()), (0..1, 1..1 + COUNT as u32));
    assert_eq!((splats.cloud.len(), splats.cloud.degree()), (COUNT, 1));
    let splat = splats.cloud.splat(1);
    assert!((splat.opacity - 0.8).abs() < 1e-6 && (splat.log_scale.x - 0.3f32.ln()).abs() < 1e-6);
    assert_eq!(splat.base_color.to_array(), [0.5, -0.5, 0.25]);
    assert_eq!(splats.cloud.coefficients(1)[6].to_f32(), 0.199_951_17);
    // A quarter turn about y takes x to −z and z to x.
    let mean = splats.placement.point(splat.mean.as_dvec3());
    assert!(mean.distance(DVec3::new(4.0, 5.0, -2.0)) < 1e-6, "{mean}");
    assert_eq!(scene.nodes[scene.part_of(2).node as usize].name, "scan");
}

#[test]
fn splats_are_a_scene_of_their_own() {
    let mut glb = Glb::with_splats();
    glb.json["scenes"][0]["nodes"] = json!([1]);
    let scene = glb.load().unwrap();
    assert!(scene.surface_triangles().is_empty() && scene.triangles.len() == COUNT);
    assert!(scene.has_default_camera && scene.cameras.len() == 1);
}

#[test]
fn splats_of_several_nodes_are_one_cloud() {
    let mut glb = Glb::with_splats();
    glb.json["nodes"].as_array_mut().unwrap().push(json!({"name": "second", "mesh": 1}));
    glb.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let splats = glb.load().unwrap().splats.unwrap();
    assert_eq!((splats.cloud.len(), splats.placement.rotation), (2 * COUNT, DMat3::IDENTITY));
    let mean = |index: usize| splats.cloud.splat(index).mean.as_dvec3();
    assert!(
        mean(1).distance(DVec3::new(4.0, 5.0, -2.0)) < 1e-5 && mean(COUNT + 1) == DVec3::new(1.0, 0.0, 2.0)
    );
    assert!((splats.cloud.splat(1).log_scale.x - 0.6f32.ln()).abs() < 1e-5);

    glb.json["nodes"][1]["scale"] = json!([-1, 1, 1]);
    let scene = glb.load().unwrap();
    assert_eq!(scene.splats.as_ref().unwrap().cloud.len(), COUNT);
    assert!(
        scene.warnings.iter().any(|w| w.contains("/nodes/1: its splats are left out")),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn splats_stand_still_while_meshes_move() {
    let mut glb = Glb::with_splats();
    let (input, output) =
        (glb.accessor(&[0.0, 1.0], "SCALAR"), glb.accessor(&[0.0, 0.0, 0.0, 3.0, 0.0, 0.0], "VEC3"));
    glb.json["animations"] = json!([{"samplers": [{"input": input, "output": output}],
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]}]);
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("moving.glb");
    std::fs::write(&file, glb.bytes()).unwrap();
    let rest = Arc::new(load(&file, &LoadOptions::default(), &Unwatched).unwrap());
    let animated = AnimatedScene::open(rest.clone(), &LoadOptions::default(), &Unwatched).unwrap();
    let posed = animated.pose_at(&AnimationTime { animation: None, seconds: 1.0 }, &Unwatched).unwrap();
    assert_eq!(posed.scene.positions[0], DVec3::new(3.0, 0.0, 0.0));
    let splats = posed.scene.splats.as_ref().unwrap();
    assert!(Arc::ptr_eq(&splats.cloud, &rest.splats.as_ref().unwrap().cloud));
    assert_eq!(posed.rest_triangles.len(), rest.triangles.len());
    assert!(posed.matches_rest());
    assert_eq!(posed.scene.material_of(3).name, rest.material_of(3).name);
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let fault = |change: &dyn Fn(&mut Glb)| {
        let mut glb = Glb::with_splats();
        change(&mut glb);
        glb.load().unwrap_err().to_string()
    };
    let attribute = |name: &'static str| {
        move |glb: &mut Glb| drop(glb.primitive()["attributes"].as_object_mut().unwrap().remove(name))
    };
    for name in ["KHR_gaussian_splatting:SCALE", "KHR_gaussian_splatting:SH_DEGREE_1_COEF_1", "POSITION"] {
        let fault = fault(&attribute(name));
        assert!(fault.contains(name) && fault.contains("is missing"), "{name}: {fault}");
    }
    let kernel = fault(&|glb| {
        glb.primitive()["extensions"]["KHR_gaussian_splatting"]["kernel"] = json!("box");
    });
    assert!(kernel.contains("/meshes/1/primitives/0") && kernel.contains("kernel"), "{kernel}");
    let short = fault(&|glb| {
        let short = glb.accessor(&[0.1; 3], "VEC3");
        glb.primitive()["attributes"]["KHR_gaussian_splatting:SCALE"] = json!(short);
    });
    assert!(short.contains("has 1 elements for 5 positions"), "{short}");
    let many = fault(&|glb| {
        let index = glb.primitive()["attributes"]["POSITION"].as_u64().unwrap() as usize;
        glb.json["accessors"][index]["count"] = json!(4_000_000_000u64);
    });
    assert!(many.contains("do not fit"), "{many}");
}

#[test]
fn points_without_the_extension_are_no_splats() {
    let mut glb = Glb::with_splats();
    glb.primitive().as_object_mut().unwrap().remove("extensions");
    assert!(glb.load().unwrap().splats.is_none());
}

#[test]
fn damaged_files_are_read_or_refused_with_a_sentence() {
    const MUTATIONS: u64 = 2000;
    let original = Glb::with_splats().bytes();
    let options = LoadOptions { max_memory: 16 << 20, ..LoadOptions::default() };
    let mut read = 0;
    for seed in 0..MUTATIONS {
        let mut bytes = original.clone();
        damage(&mut bytes, &mut Random(seed));
        match handmade::load_bytes(&bytes, &options) {
            Ok(scene) => {
                read += 1;
                let (low, high) = scene.bounds();
                assert!(low.is_finite() && high.is_finite(), "{seed}");
            }
            Err(SceneError::Bad { fault: Fault::Panicked(panic), .. }) => panic!("{seed}: {panic}"),
            Err(error) => {
                let error = error.to_string();
                assert!(error.ends_with(')') && !error.contains('\n'), "{seed}: {error}");
            }
        }
    }
    assert!((MUTATIONS / 20..MUTATIONS).contains(&read), "{read} of {MUTATIONS} were read all the same");
}
