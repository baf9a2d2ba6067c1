use std::{path::Path, sync::Arc, time::Instant};
use glam::{DVec3, Vec3};
use lens::*; use scene::*; use trace::*;
struct Unlit(Arc<Scene>, Vec3);
impl Radiance for Unlit {
    fn toward(&self, p: SurfacePoint, _e: DVec3) -> Vec3 { if self.0.material_of(p.triangle).unlit { self.0.base_color(p).truncate() } else { self.0.emitted(p) } }
    fn from_infinity(&self, _d: DVec3) -> Vec3 { self.1 }
}
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let scene = Arc::new(scene::load(Path::new(&a[1]), &LoadOptions::default(), &progress::Unwatched).unwrap());
    let c = &scene.cameras[0];
    let cam0 = Camera { yfov: c.yfov, camera_to_world: c.camera_to_world, focus_distance: c.focus_distance, ..Default::default() };
    let cam = project::read_camera(Path::new(&a[2]), &cam0).unwrap();
    let focus = if a[3] == "-" { focus::FocusRecipe::default() } else { project::read_recipe(Path::new(&a[3])).unwrap() }.evaluate(&scene).unwrap();
    let t = Instant::now();
    let tracer = Tracer::new(scene.clone());
    println!("bvh {:.2}", t.elapsed().as_secs_f64());
    let bg = cam.background.map(|c| c as f32);
    let rad = Unlit(scene.clone(), bg.into());
    let t = Instant::now();
    let pic = if a[5] == "truth" {
        let spp = a[6].parse().unwrap();
        trace::truth::render(&tracer, &rad, &focus, &cam, &truth::TruthOptions { samples_per_pixel: spp, ..Default::default() }, &progress::Unwatched).unwrap()
    } else {
        let o = salf::BakeOptions::for_focus(&tracer, &cam, &focus);
        println!("margin {:?} {:.2}", o, t.elapsed().as_secs_f64());
        let s = Arc::new(salf::bake(&tracer, &rad, &cam, &o, &progress::Unwatched).unwrap());
        println!("bake {:.2} {:?} margin {}", t.elapsed().as_secs_f64(), s.statistics(), s.margin_px);
        let mut sp = splat::Splatter::new(s);
        let t = Instant::now();
        sp.render(&cam, &focus, &progress::Unwatched).unwrap();
        println!("splat {:.3}", t.elapsed().as_secs_f64());
        sp.picture().clone()
    };
    println!("{} {:.2}", a[5], t.elapsed().as_secs_f64());
    project::write_picture(Path::new(&a[4]), &pic, &[project::Layer::coverage(&pic)], project::PictureOptions { exposure: Exposure::Conserve, half: false }).unwrap();
    let mut c: Vec<f32> = pic.coverage.iter().map(|c| (c - 1.0).abs()).collect();
    c.sort_by(f32::total_cmp);
    println!("coverage |c-1| p50 {:.5} p90 {:.5} p99 {:.5} p999 {:.5} max {:.4}", c[c.len()/2], c[c.len()*9/10], c[c.len()*99/100], c[c.len()*999/1000], c[c.len()-1]);
    if a.len() > 7 || (a.len() > 6 && a[5] != "truth") {
        let r = project::read_picture(Path::new(a.last().unwrap())).unwrap();
        println!("{:?}", project::compare(&project::LinearPicture::of(&pic, Exposure::Conserve), &r).unwrap());
    }
}
