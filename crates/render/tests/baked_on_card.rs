//! Light fields baked on a graphics card, also one in software: the processor's pictures, also if the card is lost on the way.

use focus::Focus;
use graphics_card::{BackendChoice, Gpu};
use lens::{Camera, Exposure, FocusOffset, Picture};
use light::{Resources, Steps};
use progress::{Progress, Unwatched};
use render::{RenderOptions, render_input};
use salf::BakedOn;
use std::path::Path;
use std::sync::Mutex;

/// A card; says so where there is none.
fn gpu() -> Option<Gpu> {
    match Gpu::open(BackendChoice::Gpu, None) {
        Ok(gpu) => gpu,
        Err(absent) => {
            eprintln!("skipped: {absent}");
            None
        }
    }
}

/// The demo with its camera, made small.
struct Demo {
    input: document::Input,
    camera: Camera,
    focus: Focus,
}

impl Demo {
    fn open() -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/demo");
        let input =
            document::Input::open(&folder.join("demo.glb"), &Resources::default(), &Unwatched).unwrap();
        let camera = project::read_camera(&folder.join("demo.camera.json"), &Camera::default()).unwrap();
        let focus = Focus::constant(input.scene.clone(), FocusOffset::STANDARD);
        Self { camera: Camera { width: 160, height: 90, ..camera }, input, focus }
    }

    fn rendered(&self, bake_on: Option<Gpu>, steps: &dyn Steps) -> (Picture, BakedOn) {
        let options = RenderOptions { bake_on, ..RenderOptions::default() };
        let rendered = render_input(&self.input, &self.camera, &self.focus, &options, steps).unwrap();
        (rendered.picture, rendered.cost.baked_on)
    }
}

fn psnr(a: &Picture, b: &Picture) -> f64 {
    let (a, b) = (a.exposed(Exposure::Normalise), b.exposed(Exposure::Normalise));
    let square = |(a, b): (&f32, &f32)| f64::from(a.clamp(0.0, 1.0) - b.clamp(0.0, 1.0)).powi(2);
    let sum: f64 = a.as_flattened().iter().zip(b.as_flattened()).map(square).sum();
    -10.0 * (sum / (3 * a.len()) as f64).log10()
}

#[test]
fn a_card_bakes_the_processors_picture() {
    let Some(gpu) = gpu() else { return };
    let demo = Demo::open();
    let (here, on_processor) = demo.rendered(None, &Unwatched);
    let (there, on_card) = demo.rendered(Some(gpu), &Unwatched);
    assert_eq!([on_processor, on_card], [BakedOn::Processor, BakedOn::Card]);
    let agreement = psnr(&here, &there);
    println!("{agreement:.1} dB");
    assert!(agreement >= 60.0, "{agreement}");
    // The control: a picture that sees a little more.
    let wider = Camera { aperture_radius: 1.02 * demo.camera.aperture_radius, ..demo.camera.clone() };
    let (wider, _) = Demo { camera: wider, ..demo }.rendered(None, &Unwatched);
    assert!(psnr(&here, &wider) < 60.0);
}

/// Destroys a card once a bake has come so far, and takes note of what is told.
struct Doom {
    gpu: Mutex<Option<Gpu>>,
    at: f32,
    notices: Mutex<Vec<String>>,
}

impl Steps for Doom {
    fn begin(&self, label: &str) -> Box<dyn Progress + '_> {
        if label == "baking" { Box::new(Baking(self)) } else { Box::new(Unwatched) }
    }

    fn notice(&self, sentence: &str) {
        self.notices.lock().unwrap().push(sentence.into());
    }
}

struct Baking<'a>(&'a Doom);

impl Progress for Baking<'_> {
    fn report(&self, done: f32) {
        if done >= self.0.at
            && let Some(gpu) = self.0.gpu.lock().unwrap().take()
        {
            gpu.destroy();
        }
    }

    fn cancelled(&self) -> bool {
        false
    }
}

#[test]
fn a_lost_card_costs_no_picture() {
    let demo = Demo::open();
    let (whole, _) = demo.rendered(None, &Unwatched);
    // From before its first answer to after most of them.
    for k in 0..10u32 {
        let Some(gpu) = gpu() else { return };
        let at = 0.05 + 0.09 * k as f32;
        let doom = Doom { gpu: Mutex::new(Some(gpu.clone())), at, notices: Mutex::default() };
        let (picture, _) = demo.rendered(Some(gpu.clone()), &doom);
        assert!(gpu.is_lost(), "{k}");
        let agreement = psnr(&whole, &picture);
        assert!(agreement >= 60.0, "{k}: {agreement}");
        let notices = doom.notices.into_inner().unwrap();
        let of_card = notices.iter().filter(|text| text.contains(gpu.name())).count();
        assert_eq!(of_card, 1, "{k}: {notices:?}");
    }
}
