//! Files of Gaussian splats from opening to pictures: the light field against the ground truth, unpainted and painted.

use atlas::UnwrapOptions;
use document::{Input, write_splat_focus};
use focus::{Focus, FocusMap};
use gaussians::{CloudBuilder, CloudTraits, Splat, write_ply};
use glam::{DVec3, Quat, Vec3, Vec4};
use lens::{Camera, Exposure, FocusOffset, Picture};
use light::{LightOptions, LitScene, Resources};
use progress::Unwatched;
use project::Layer;
use render::{Aov, RenderOptions, Rendered, Renderer, render, render_input};
use scene::{LoadOptions, Scene, SurfaceMesh};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;
use trace::Tracer;

/// A wall at a depth of 4 with a pattern of colours, and the bars of a fence at 2, which hide a third of it.
fn fence(folder: &Path, color: impl Fn(u32) -> Vec3) -> PathBuf {
    let mut builder = CloudBuilder::new(0, 4000);
    let mut push = |mean: Vec3, width: f32, opacity: f32, number: u32| {
        builder.push(
            Splat {
                mean,
                rotation: Quat::from_rotation_z(number as f32),
                log_scale: Vec3::new(width, width, 0.1 * width).map(f32::ln),
                opacity,
                base_color: color(number).map(Splat::base_of_color),
            },
            &[],
        );
    };
    for k in 0..70 * 54 {
        let (column, row) = ((k % 70) as f32 - 34.5, (k / 70) as f32 - 26.5);
        push(Vec3::new(0.07 * column, 0.07 * row, 4.0), 0.06, 0.98, k);
    }
    for k in 0..8 * 40 {
        let (bar, row) = ((k % 8) as f32 - 3.5, (k / 8) as f32 - 19.5);
        push(Vec3::new(0.22 * bar, 0.05 * row, 2.0), 0.025, 0.95, k + 5);
    }
    let file = folder.join("fence.ply");
    let cloud = builder.finish(CloudTraits::default());
    write_ply(&mut std::fs::File::create(&file).unwrap(), &cloud).unwrap();
    file
}

fn pattern(number: u32) -> Vec3 {
    let channel = |step: u32| 0.15 + 0.7 * ((number / 3 * step % 7) as f32 / 6.0);
    Vec3::new(channel(1), channel(2), channel(4))
}

/// It looks along the z axis of the file: a circle of confusion of 7 px at the fence.
fn camera() -> Camera {
    Camera {
        width: 96,
        height: 72,
        yfov: 0.7,
        focus_distance: 4.0,
        aperture_radius: 0.14,
        ..Camera::default()
    }
}

fn opened(file: &Path) -> Input {
    Input::open(file, &Resources::default(), &Unwatched).unwrap()
}

fn rendered(input: &Input, focus: &Focus, renderer: Renderer, aovs: &[Aov]) -> Rendered {
    let mut options = RenderOptions { renderer, aovs: aovs.into(), ..RenderOptions::default() };
    options.truth.samples_per_pixel = 256;
    render_input(input, &camera(), focus, &options, &Unwatched).unwrap()
}

fn psnr(a: &Picture, b: &Picture, exposure: Exposure) -> f64 {
    let (a, b) = (a.exposed(exposure), b.exposed(exposure));
    let square = |(a, b): (&f32, &f32)| f64::from(a.clamp(0.0, 1.0) - b.clamp(0.0, 1.0)).powi(2);
    let sum: f64 = a.as_flattened().iter().zip(b.as_flattened()).map(square).sum();
    -10.0 * (sum / (3 * a.len()) as f64).log10()
}

fn unpainted(input: &Input) -> Focus {
    Focus::constant(input.scene.clone(), FocusOffset::STANDARD)
}

/// The fence with the focus of each splat from a table: the bars are sharp, the wall is not.
fn painted(input: &Input, folder: &Path) -> Focus {
    let unwrap = UnwrapOptions::default();
    let atlas = input.atlas(&unwrap, &Unwatched).unwrap();
    let mut map = FocusMap::new(atlas.width, atlas.height, FocusOffset::STANDARD);
    let splats = input.scene.splats.as_ref().unwrap();
    for (splat, mean) in (0..).zip(splats.cloud.means()) {
        let position = atlas.position_of(splats.address(splat));
        let offset = if mean.z < 3.0 { FocusOffset::new(1.0, 1.0) } else { FocusOffset::new(1.06, 1.0) };
        map.set(position.x as u32, position.y as u32, [offset.t as f32, offset.anchor as f32]);
    }
    let table = folder.join("focus.ply");
    write_splat_focus(&table, &input.scene, &atlas, &map).unwrap();
    input.focus(Some(&table), &unwrap, &Unwatched).unwrap()
}

#[test]
fn the_light_field_is_the_truth_unpainted_and_painted() {
    let folder = TempDir::new().unwrap();
    let input = opened(&fence(folder.path(), pattern));
    assert_eq!(input.scene.splats.as_ref().unwrap().cloud.len(), 70 * 54 + 8 * 40);
    let [plain, painted] = [unpainted(&input), painted(&input, folder.path())];
    let [truth, splat] =
        [Renderer::Truth, Renderer::Splat].map(|renderer| rendered(&input, &plain, renderer, &[]).picture);
    let unpainted = psnr(&truth, &splat, Exposure::Normalise);
    let [painted_truth, painted_splat] =
        [Renderer::Truth, Renderer::Splat].map(|renderer| rendered(&input, &painted, renderer, &[]).picture);
    let normalised = psnr(&painted_truth, &painted_splat, Exposure::Normalise);
    let conserved = psnr(&painted_truth, &painted_splat, Exposure::Conserve);
    let control = psnr(&painted_truth, &splat, Exposure::Normalise);
    println!(
        "unpainted {unpainted:.1} dB, painted {normalised:.1} dB, conserved {conserved:.1} dB; control {control:.1} dB"
    );
    assert!(unpainted >= 38.0 && normalised >= 36.0 && conserved >= 34.0);
    assert!(control < 30.0, "paint changes the picture");
}

/// Splats stand between two meshes: one half hides them, and they hide a part of the other.
#[test]
fn meshes_and_splats_hide_each_other() {
    let folder = TempDir::new().unwrap();
    let splats = opened(&fence(folder.path(), pattern)).scene.splats.clone().unwrap();
    let square = |x: [f64; 2], z: f64, first: u32| {
        let corners = [[x[0], -2.0], [x[1], -2.0], [x[1], 2.0], [x[0], 2.0]];
        let positions = corners.map(|[x, y]| DVec3::new(x, y, z));
        (positions, [[first, first + 1, first + 2], [first, first + 2, first + 3]])
    };
    // Behind the fence and before the wall; before the fence.
    let (a, b) = (square([-2.0, 0.1], -3.0, 0), square([0.3, 2.0], -1.2, 4));
    let mesh = SurfaceMesh {
        positions: [a.0, b.0].concat(),
        colors: [[Vec4::new(0.1, 0.6, 0.2, 1.0); 4], [Vec4::new(0.7, 0.2, 0.1, 1.0); 4]].concat(),
        triangles: [a.1, b.1].concat(),
        ..SurfaceMesh::default()
    };
    let mut scene = Scene::from_mesh(mesh, &LoadOptions::default()).unwrap();
    scene.add_splats("fence".into(), splats.cloud.clone(), splats.placement, "PLY");
    let lit =
        LitScene::new(Arc::new(Tracer::new(Arc::new(scene))), LightOptions::default(), &Resources::default());
    let focus = Focus::constant(lit.scene().clone(), FocusOffset::STANDARD);
    let [truth, splat, pinhole] = [(Renderer::Truth, 1.0), (Renderer::Splat, 1.0), (Renderer::Truth, 0.0)]
        .map(|(renderer, share)| {
            let mut options = RenderOptions { renderer, ..RenderOptions::default() };
            options.truth.samples_per_pixel = 256;
            let camera = Camera { aperture_radius: share * camera().aperture_radius, ..camera() };
            render(&lit, &camera, &focus, &options, &Unwatched).unwrap().picture
        });
    let (figure, control) =
        (psnr(&truth, &splat, Exposure::Normalise), psnr(&truth, &pinhole, Exposure::Normalise));
    println!("beside meshes {figure:.1} dB; control without the aperture {control:.1} dB");
    assert!(figure >= 36.0 && control < 30.0, "{figure} {control}");
    let coverage = |at: usize| splat.coverage[36 * 96 + at];
    assert!([10, 30, 60, 85].iter().all(|at| (coverage(*at) - 1.0).abs() < 0.05));
}

#[test]
fn white_splats_cover_evenly_and_alpha_is_their_share() {
    let folder = TempDir::new().unwrap();
    let input = opened(&fence(folder.path(), |_| Vec3::ONE));
    let focus = unpainted(&input);
    for renderer in [Renderer::Truth, Renderer::Splat] {
        let Rendered { picture, layers, .. } =
            rendered(&input, &focus, renderer, &[Aov::Alpha, Aov::Crypto, Aov::Depth]);
        let mut coverage = picture.coverage.clone();
        coverage.sort_by(f32::total_cmp);
        let quantile = |share: f64| coverage[(share * (coverage.len() - 1) as f64) as usize];
        println!("{renderer:?}: coverage {} {} {}", quantile(0.01), quantile(0.5), quantile(0.99));
        assert!((quantile(0.5) - 1.0).abs() < 0.01 && quantile(0.01) > 0.9 && quantile(0.99) < 1.1);
        let layer = |name: &str| -> &Layer {
            layers.iter().find(|layer| layer.name == name).unwrap_or_else(|| panic!("no {name}"))
        };
        let alpha = &layer(Layer::ALPHA).values;
        let least = alpha.iter().copied().fold(1.0, f32::min);
        assert!(least > 0.9 && alpha.iter().sum::<f32>() > 0.99 * alpha.len() as f32, "{least}");
        let depth = &layer("depth.Z").values;
        let near = depth.iter().filter(|z| (**z - 2.0).abs() < 0.02).count();
        let far = depth.iter().filter(|z| (**z - 4.0).abs() < 0.02).count();
        assert!(near > depth.len() / 8 && far > depth.len() / 3 && near + far == depth.len(), "{near} {far}");
    }
}
