//! A scene with strokes and a mask: what a user paints, and what should come of it.

use atlas::{Density, UnwrapOptions};
use document::{
    CameraChoice, Document, Input, NewDocumentOptions, Painter, StrokePoint, StrokeTarget, SurfaceHit, pick,
    view_ray,
};
use focus::{Brush, LayerEdit, ViewFrame};
use glam::{DMat4, DVec2, DVec3};
use lens::{Camera, FocusOffset};
use light::Resources;
use progress::Unwatched;
use project::CaptureChoices;
use serde_json::Value;
use std::path::{Path, PathBuf};
use trace::Tracer;

/// A folder of the shared reference data, if it is there.
pub fn shared(folder: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(folder);
    if path.exists() {
        return Some(path);
    }
    eprintln!("SKIPPED: {} is not there", path.display());
    None
}

/// The values of the labels in the strokes; the last keeps out.
pub fn label_values() -> [FocusOffset; 3] {
    [FocusOffset::SHARP, FocusOffset::new(0.5, 0.0), FocusOffset::STANDARD]
}

/// Unwraps to an atlas of this side, small enough for a test.
pub fn unwrap_to(side: u32) -> UnwrapOptions {
    UnwrapOptions { density: Density::Side(side), ..UnwrapOptions::default() }
}

/// An open document, seen from a view of `size` pixels.
pub struct TestScene {
    pub document: Document,
    pub view: ViewFrame,
    pub size: [u32; 2],
}

pub fn json(text: &str) -> Value {
    serde_json::from_str(text).unwrap()
}

pub fn names(value: &Value) -> Vec<String> {
    value
        .as_array()
        .map_or(Vec::new(), |all| all.iter().map(|name| name.as_str().unwrap().to_string()).collect())
}

fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|k| value[k].as_f64().unwrap())
}

impl TestScene {
    pub fn open(mask: &Value, strokes: &Value) -> Option<Self> {
        let path = shared(mask["input"].as_str()?)?;
        let path = if mask["input"] == "gltf/MixedLightingExample" {
            path.join("MixedLightingExample.gltf")
        } else {
            path
        };
        let resources = Resources::default();
        let depth = mask["depth"].as_str().and_then(shared);
        let input = match depth {
            Some(depth) => {
                let choices = CaptureChoices { depth: Some(depth), ..CaptureChoices::default() };
                Input::open_capture(&path, choices, &resources, &Unwatched).unwrap()
            }
            None => Input::open(&path, &resources, &Unwatched).unwrap(),
        };
        let photograph = mask["photograph"].as_str().map(|name| CameraChoice::Named(format!("photo:{name}")));
        let options = NewDocumentOptions { camera: photograph.as_ref(), ..NewDocumentOptions::default() };
        let unwrap = unwrap_to(1024);
        let document = Document::create_from_input(input, &options, &unwrap, &Unwatched).unwrap();
        Some(Self::of_document(document, strokes))
    }

    pub fn of_document(document: Document, strokes: &Value) -> Self {
        let [width, height] = numbers::<2>(&strokes["size"]).map(|side| side as u32);
        let mut camera = Camera { width, height, ..document.camera.clone() };
        if strokes["eye"].is_array() {
            let [eye, target] = ["eye", "target"].map(|key| DVec3::from_array(numbers(&strokes[key])));
            let back = (eye - target).normalize();
            let right = DVec3::Y.cross(back).normalize();
            let columns = [right, back.cross(right), back].map(|axis| axis.extend(0.0));
            camera.camera_to_world = DMat4::from_cols(columns[0], columns[1], columns[2], eye.extend(1.0));
            camera.yfov = strokes["yfov"].as_f64().unwrap();
        }
        Self { document, view: ViewFrame::from_camera(&camera), size: [width, height] }
    }

    /// The surface at a position in the view.
    pub fn hit_at(&self, position: DVec2) -> Option<SurfaceHit> {
        pick(self.document.stage.tracer(), &view_ray(&self.view, position))
    }

    /// The surface under every pixel, row by row.
    pub fn hits(&self) -> Vec<Option<SurfaceHit>> {
        hits(self.document.stage.tracer(), &self.view, self.size)
    }

    /// The demo, seen by its camera, in an atlas of this side.
    pub fn demo(side: u32, strokes: &Value) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/demo");
        let camera = CameraChoice::File(folder.join("demo.camera.json"));
        let options = NewDocumentOptions { camera: Some(&camera), ..NewDocumentOptions::default() };
        let (file, resources) = (folder.join("demo.glb"), Resources::default());
        let document = Document::create(&file, &options, &unwrap_to(side), &resources, &Unwatched).unwrap();
        Self::of_document(document, strokes)
    }

    /// Paints the strokes on a new layer, `values` by label.
    pub fn paint(&mut self, strokes: &Value, values: &[FocusOffset]) {
        self.document.edit_layers(LayerEdit::AddPaint).unwrap();
        for stroke in strokes["strokes"].as_array().unwrap() {
            let corners: Vec<DVec2> = stroke["path"]
                .as_array()
                .unwrap()
                .iter()
                .map(|point| DVec2::from_array(numbers(point)))
                .collect();
            let label = stroke["label"].as_u64().unwrap() as usize;
            let path: Vec<DVec2> = corners
                .windows(2)
                .flat_map(|pair| (0..=40).map(|step| pair[0].lerp(pair[1], f64::from(step) / 40.0)))
                .collect();
            let tracer = self.document.stage.tracer().clone();
            let first = path.iter().find_map(|at| pick(&tracer, &view_ray(&self.view, *at)));
            let depth = first.expect("the stroke meets a surface").distance;
            let pixel = 2.0 * (self.view.yfov / 2.0).tan() * depth / f64::from(self.size[1]);
            let radius = stroke["radius_px"].as_f64().unwrap() * pixel;
            let normal_limit_degrees = 180.0;
            self.document.brush = Brush {
                radius,
                hardness: 1.0,
                target: values[label],
                normal_limit_degrees,
                ..Brush::default()
            };
            let point =
                |at: &DVec2| StrokePoint { target: StrokeTarget::View(self.view, *at), pressure: 1.0 };
            let mut painter = Painter::begin(&self.document, &point(&path[0])).unwrap();
            for at in &path {
                painter.extend(&mut self.document, &point(at));
            }
            assert!(painter.commit(&mut self.document), "a stroke changes something");
        }
    }

    /// [t, anchor, mask] of the active layer at a hit.
    pub fn layer_at(&self, hit: &SurfaceHit) -> [f64; 3] {
        let map = &self.document.layers.active().map;
        let [x, y] =
            self.document.stage.atlas.position_of(hit.point).floor().to_array().map(|x| x.max(0.0) as u32);
        let [width, height] = map.size();
        let (x, y) = (x.min(width - 1), y.min(height - 1));
        let [t, anchor] = map.texel(x, y);
        [t, anchor, map.mask_at(x, y)].map(f64::from)
    }
}

pub fn hits(tracer: &Tracer, view: &ViewFrame, [width, height]: [u32; 2]) -> Vec<Option<SurfaceHit>> {
    let size = DVec2::new(f64::from(width), f64::from(height));
    let center =
        |index: u32| DVec2::new(f64::from(index % width) + 0.5, f64::from(index / width) + 0.5) / size;
    (0..width * height).map(|index| pick(tracer, &view_ray(view, center(index)))).collect()
}

/// Name of the node or the material of a hit.
pub fn owner_names(scene: &scene::Scene, hit: &SurfaceHit) -> [String; 2] {
    let part = &scene.parts[scene.triangles[hit.point.triangle as usize].part as usize];
    let name = |name: &str| name.to_string();
    [name(&scene.nodes[part.node as usize].name), name(&scene.materials[part.material as usize].name)]
}

/// Which pixels a mask covers; `None` for a pixel that shows nothing.
pub fn truth(scene: &TestScene, mask: &Value) -> Vec<Option<bool>> {
    let [width, _] = scene.size;
    if let Some(outline) = mask["outline_px"].as_array() {
        let outline: Vec<DVec2> = outline.iter().map(|point| DVec2::from_array(numbers(point))).collect();
        let at = |(index, hit): (usize, &Option<SurfaceHit>)| {
            let pixel = DVec2::new((index as u32 % width) as f64 + 0.5, (index as u32 / width) as f64 + 0.5);
            hit.as_ref().map(|_| is_inside(&outline, pixel))
        };
        return scene.hits().iter().enumerate().map(at).collect();
    }
    let reference = mask["nodes_of"].as_str().map(|file| {
        let input = Input::open(&shared(file).unwrap(), &Resources::default(), &Unwatched).unwrap();
        Tracer::new(input.scene.clone())
    });
    let tracer = reference.as_ref().unwrap_or_else(|| scene.document.stage.tracer());
    let view = match &reference {
        // Pose and angle of the camera that took the capture, which has its own origin: 50 mm on 36 mm.
        Some(reference) => {
            let yfov = 2.0 * (0.36 / scene.view.aspect).atan();
            ViewFrame { camera_to_world: reference.scene().cameras[0].camera_to_world, yfov, ..scene.view }
        }
        None => scene.view,
    };
    let (nodes, materials) = (names(&mask["nodes"]), names(&mask["materials"]));
    let is_meant = |hit: &SurfaceHit| {
        let [node, material] = owner_names(tracer.scene(), hit);
        nodes.contains(&node) || materials.contains(&material)
    };
    hits(tracer, &view, scene.size).iter().map(|hit| hit.as_ref().map(is_meant)).collect()
}

fn is_inside(outline: &[DVec2], position: DVec2) -> bool {
    let mut is_inside = false;
    for (k, &a) in outline.iter().enumerate() {
        let b = outline[(k + 1) % outline.len()];
        if (a.y > position.y) != (b.y > position.y)
            && position.x < a.x + (position.y - a.y) / (b.y - a.y) * (b.x - a.x)
        {
            is_inside = !is_inside;
        }
    }
    is_inside
}
