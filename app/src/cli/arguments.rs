//! What can be typed.

mod names;

pub use names::{BackendName, EstimatorName, ExposureName, KindName, ProgressName, SamplerName, StereoName};

use super::parsers::{
    aov, camera_parser, integers, name_parser, named, not_negative, photograph_output, place, positive, size,
};
use super::sequence_arguments::{KeysArguments, SequenceArguments};
use clap::{Args, Parser};
use project::{ColorSpace, Compression};
use scene::{BackFaces, PhotoLookup};
use session::{Aov, CameraChoice, CocConvention, LightQuality, Renderer, TileGrid, VariantChoice};
use splat::Integers;
use std::ffi::OsString;
use std::path::PathBuf;

/// Paint onto a 3D scene how it is focused.
#[derive(Debug, Parser)]
#[command(
    name = "focus-brush",
    version,
    args_conflicts_with_subcommands = true,
    after_help = "Exit codes: 0 done, 2 wrong usage, 3 bad input, 4 partly done, 5 asked-for GPU absent, 75 try again."
)]
pub struct Arguments {
    /// Opens the window with this scene (.glb, .gltf) or project (.fbrush); without one, with the demo.
    pub file: Option<PathBuf>,
    /// Plays what was recorded (`Export strokes…`) in the window
    #[arg(long, value_name = "STROKES.json")]
    pub replay: Option<PathBuf>,
    /// Writes how long every point of the played strokes took to be seen, as JSON, and closes the window
    #[arg(long, value_name = "FILE.json", requires = "replay")]
    pub trace: Option<PathBuf>,
    /// Longest side of the live picture in pixels, instead of the setting
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u32).range(16..=8192))]
    pub preview_size: Option<u32>,
    /// Where the live picture is summed; it is the same. auto: on the window's graphics card, and on the processor rather
    /// than on a card that is one in software
    #[arg(long, value_enum, default_value_t = BackendName::Auto)]
    pub backend: BackendName,
    /// What to do without a window.
    #[command(subcommand)]
    pub command: Option<Subcommand>,
}

/// What to do without a window.
#[derive(Debug, clap::Subcommand)]
pub enum Subcommand {
    /// What is in a file, the health of its mesh, what would be baked
    Info(InfoArguments),
    /// Make a project of a scene, with a camera and a focus to begin with
    New(NewArguments),
    /// Make a project of a capture: photographs with their cameras, and a mesh
    Import(ImportArguments),
    /// Paint what was recorded (`Export strokes…` in the window writes it) on a project or a scene
    Replay(ReplayArguments),
    /// Set keys of a project's lens and layers, or list them
    Keys(KeysArguments),
    /// Write a scene with the atlas as its second UV set (TEXCOORD_1)
    Unwrap(UnwrapArguments),
    /// Bake the light field of a scene or project into a file
    Bake(BakeArguments),
    /// Render a picture of a scene, project or light field
    Render(Box<RenderArguments>),
    /// Merge the tiles of a picture (render --tiles --shard) to the same bytes as the whole
    Merge(MergeArguments),
    /// How far picture A is from the reference B: RMSE, relMSE, PSNR, FLIP, signed mean error
    Compare(CompareArguments),
    /// Measure every renderer against the ground truth: speed, error, memory, as tables, plots and a page
    Report(ReportArguments),
    /// Write parts of a project: its focus map, its unwrapped scene, its picture in layers
    Export(ExportArguments),
    /// The presets of brushes, lenses and bokeh
    Presets(PresetsArguments),
    /// The small picture of a project or a light field, as file managers show it
    Thumbnail(ThumbnailArguments),
    /// Adapters, libraries, what is missing and how to get it
    Doctor(DoctorArguments),
}

/// How a scene is seen and lit.
#[derive(Clone, Debug, Default, Args)]
pub struct AppearanceArguments {
    /// Whether faces that are not double sided are seen from behind (default: the project's, or hide, as glTF asks for). show:
    /// for files whose faces are turned, and to compare with renderers that show them
    #[arg(long, value_name = "show|hide", value_parser = named(BackFaces::ALL))]
    pub back_faces: Option<BackFaces>,
    /// What lies beyond all surfaces, and lights them: a world file, or an equirectangular .hdr or .exr (default: the project's, or
    /// the scene's own; a scene without light has a studio)
    #[arg(long, value_name = "WORLD.json|SKY.hdr|exr")]
    pub world: Option<PathBuf>,
    /// The variant of the scene's materials (KHR_materials_variants), by name; info lists them. "" is the scene's own materials
    /// (default: the project's, or the scene's own; a light field is of the one it was baked in)
    #[arg(long, value_name = "NAME", value_parser = name_parser())]
    pub variant: Option<String>,
    /// Leave out light that meets microfacets more than once, to compare with renderers that do
    #[arg(long)]
    pub single_scattering: bool,
    /// Where the light of a capture's photographs is looked up: at texels, which they were resampled to, or direct, in the photographs
    /// themselves for each point (slower; what texels cannot show finely enough)
    #[arg(long, value_name = "texels|direct", default_value = "texels", value_parser = named(PhotoLookup::ALL))]
    pub photos: PhotoLookup,
}

/// How well light is found.
#[derive(Debug, Args)]
pub struct LightArguments {
    /// Refine the light by so many passes of paths: without, it is as what is kept for every camera tells it, at once and a little
    /// off; with them it is off by their noise alone, half as much for four times as many (0: none; a pass is four paths a pixel)
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1 << 16))]
    pub light_passes: u32,
}

impl LightArguments {
    /// How well light is to be found.
    pub fn light_quality(&self) -> LightQuality {
        match self.light_passes {
            0 => LightQuality::Fine,
            passes => LightQuality::Refined { passes },
        }
    }
}

impl AppearanceArguments {
    /// The variant that was asked for.
    pub fn variant(&self) -> VariantChoice {
        match self.variant.as_deref() {
            None => VariantChoice::AsSaved,
            Some("") => VariantChoice::Own,
            Some(name) => VariantChoice::Named(name.into()),
        }
    }
}

/// `info`.
#[derive(Debug, Args)]
pub struct InfoArguments {
    /// A scene (.glb, .gltf), project (.fbrush), light field (.salf) or the folder of a capture
    pub file: PathBuf,
    /// Bake a small picture's light field and count what of the scene is modelled
    #[arg(long)]
    pub bake: bool,
    #[command(flatten)]
    pub appearance: AppearanceArguments,
    /// Write JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// `new`.
#[derive(Debug, Args)]
pub struct NewArguments {
    /// The scene (.glb, .gltf)
    pub scene: PathBuf,
    /// Where to write the project
    #[arg(short, long, value_name = "PROJECT.fbrush")]
    pub output: PathBuf,
    /// A camera file, or the name of a camera in the scene (default: the scene's first)
    #[arg(long, value_name = "CAM.json|NAME", value_parser = camera_parser())]
    pub camera: Option<CameraChoice>,
    /// How it is focused to begin with: a recipe (.json) or a focus map (.exr, .png) (default: the ordinary lens)
    #[arg(long, value_name = "RECIPE.json|MAP.exr|png")]
    pub focus: Option<PathBuf>,
    /// A project whose paint is carried over by surface: to the nearest point of the node of the same name that looks the same way.
    /// The project stays as it is; what finds no partner is listed and selected
    #[arg(long, value_name = "OLD.fbrush", conflicts_with = "focus")]
    pub paint_from: Option<PathBuf>,
    #[command(flatten)]
    pub appearance: AppearanceArguments,
}

/// `import`.
#[derive(Debug, Args)]
pub struct ImportArguments {
    /// The folder of the capture (COLMAP's, nerfstudio's, Bundler's, VisualSFM's or Metashape's cameras, pictures and a mesh; the views
    /// of a light field), or a picture that holds its depth or has it beside it
    pub capture: PathBuf,
    /// Where to write the project
    #[arg(short, long, value_name = "PROJECT.fbrush")]
    pub output: PathBuf,
    /// The mesh (.ply, .obj, .glb) (default: the one in the folder)
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// Photographs that are only compared with, by name: no light is made of them
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub leave_out: Vec<String>,
    /// What it is taken for (default: what it is found to be)
    #[arg(long, value_enum, value_name = "KIND")]
    pub kind: Option<KindName>,
    /// The disparity map of a light field's middle view, or of a picture (.pfm, .exr, .png) (default: the one that lies beside it)
    #[arg(long, value_name = "FILE", conflicts_with = "depth")]
    pub disparity: Option<PathBuf>,
    /// The depth map of a picture (.pfm, .exr, .png) (default: the one in it or beside it)
    #[arg(long, value_name = "FILE")]
    pub depth: Option<PathBuf>,
    /// Which end of a relative depth map is near, or the distances of black and of white in metres
    #[arg(long, value_name = "white|black|LOW,HIGH")]
    pub near: Option<String>,
}

/// `replay`.
#[derive(Debug, Args)]
pub struct ReplayArguments {
    /// A project (.fbrush) or a scene (.glb, .gltf)
    pub file: PathBuf,
    /// The strokes
    #[arg(value_name = "STROKES.json")]
    pub strokes: PathBuf,
    /// Where to write the painted project
    #[arg(short, long, value_name = "OUT.fbrush")]
    pub output: PathBuf,
    /// Write counts and timings as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// `unwrap`.
#[derive(Debug, Args)]
pub struct UnwrapArguments {
    /// The scene (.glb, .gltf)
    pub scene: PathBuf,
    /// Where to write it
    #[arg(short, long, value_name = "OUT.glb")]
    pub output: PathBuf,
    #[command(flatten)]
    pub atlas: AtlasArguments,
    /// Write counts and timings as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// How a scene is unwrapped.
#[derive(Debug, Args)]
pub struct AtlasArguments {
    /// Texels per unit of length (default: an atlas of 1024² to 2048² texels)
    #[arg(long, value_name = "TEXELS", value_parser = positive)]
    pub density: Option<f64>,
    /// The densest atlas that fits a square of this side in texels
    #[arg(long, value_name = "TEXELS", conflicts_with = "density", value_parser = clap::value_parser!(u32).range(16..=8192))]
    pub side: Option<u32>,
    /// Unwrap every part, also those with sound texture coordinates of their own
    #[arg(long)]
    pub ignore_uv: bool,
}

/// `bake`.
#[derive(Debug, Args)]
pub struct BakeArguments {
    /// A scene (.glb, .gltf) or project (.fbrush)
    pub file: PathBuf,
    /// Where to write the light field
    #[arg(short, long, value_name = "X.salf")]
    pub output: PathBuf,
    #[command(flatten)]
    pub shot: ShotArguments,
    #[command(flatten)]
    pub light: LightArguments,
    /// Write counts and timings as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// From where, and how focused.
#[derive(Debug, Args)]
pub struct ShotArguments {
    /// A camera file, or the name of a camera in the scene; photo:NAME is that of a photograph, as a pinhole,
    /// photo:A..B@0.5 is halfway between two (default: the
    /// project's, or the scene's first)
    #[arg(long, value_name = "CAM.json|NAME", value_parser = camera_parser())]
    pub camera: Option<CameraChoice>,
    /// The aperture's radius in scene units instead of the camera's; 0 is a pinhole
    #[arg(long, value_name = "R", value_parser = not_negative)]
    pub aperture_radius: Option<f64>,
    /// A lens instead of the camera's: the name of a preset (focus-brush presets lists them) or its file
    #[arg(long, value_name = "NAME|FILE.json")]
    pub lens: Option<OsString>,
    /// An aperture's shape instead of the camera's: the name of a preset or its file
    #[arg(long, value_name = "NAME|FILE.json")]
    pub bokeh: Option<OsString>,
    /// How it is focused: a recipe (.json) or a focus map (.exr, .png) (default: as the project is painted, or the
    /// ordinary lens)
    #[arg(long, value_name = "RECIPE.json|MAP.exr|png")]
    pub focus: Option<PathBuf>,
    /// Picture size in pixels instead of the camera's
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    #[command(flatten)]
    pub appearance: AppearanceArguments,
}

/// `render`.
#[derive(Debug, Args)]
pub struct RenderArguments {
    /// A scene (.glb, .gltf), project (.fbrush), light field (.salf) or the folder of a capture
    pub file: PathBuf,
    /// Where to write the picture; EXR is linear, PNG is sRGB
    #[arg(short, long, value_name = "OUT.exr|png")]
    pub output: PathBuf,
    #[command(flatten)]
    pub shot: ShotArguments,
    #[command(flatten)]
    pub light: LightArguments,
    /// What draws it: the splatted light field or the ray-traced ground truth; or, to compare with: a blur of the pinhole
    /// picture by depth, the same in layers, shifted pinhole views, or every ray of the light field thrown at one pixel
    #[arg(long, value_name = "NAME", default_value = "splat", value_parser = named(Renderer::ALL))]
    pub renderer: Renderer,
    /// Where the splat runs; the picture is the same. auto: on a graphics card if there is one, and on the processor rather
    /// than on a card that is one in software
    #[arg(long, value_enum, default_value_t = BackendName::Auto)]
    pub backend: BackendName,
    /// Only a graphics adapter whose name contains this, also one in software (focus-brush doctor lists them)
    #[arg(long, value_name = "NAME", value_parser = name_parser())]
    pub adapter: Option<String>,
    /// How coarse, in pixels, the light field may be: what partly hidden points see of the aperture, and which samples
    /// are joined where they are out of focus. Smaller is more exact and slower; 0 joins none, and takes 3 cells (default: 2
    /// for the first, 0 for the second)
    #[arg(long, value_name = "PX", value_parser = not_negative)]
    pub tolerance: Option<f64>,
    /// Samples the light field on a grid of N × N cells a pixel: less is softened, for N² times the time and memory. For what
    /// is not baked yet (default: 1, at --tolerance 0 3)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=session::MAX_CELLS_A_SIDE as i64))]
    pub cells: Option<u32>,
    /// Rays a pixel of the ground truth
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub spp: u32,
    /// Where rays of the ground truth start: at the sensor, or at the surfaces (an independent check, and slower)
    #[arg(long, value_enum, default_value_t = EstimatorName::Sensor)]
    pub estimator: EstimatorName,
    /// What the ground truth's samples are drawn from: Owen-scrambled Sobol' points, or independent numbers
    #[arg(long, value_enum, default_value_t = SamplerName::LowDiscrepancy)]
    pub sampler: SamplerName,
    /// Slices of depth that `--renderer layers` cuts the pinhole picture to
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub layers: u32,
    /// Views a side of the aperture's square that `--renderer views` shifts and adds
    #[arg(long, value_name = "M", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub views: u32,
    /// Rays that `--renderer scatter` throws for each sample of the light field
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    pub rays: u32,
    /// Pictures that come along: alpha (the share that is not background; the colours are multiplied by it), crypto (Cryptomatte of
    /// objects and materials), pinhole (everything sharp, to be blurred by others), coverage (the sum for a scene of radiance 1),
    /// coc (the circle of confusion), depth (axial, depth.Z; inf for the background), t (and anchor), seen (of a capture: 1 photographed, 0 filled in), stderr (the ground truth's standard error: of radiance, luminance and
    /// coverage, and of their ratios)
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = aov)]
    pub aov: Vec<Aov>,
    /// How coc is told: signed-px (its diameter, below 0 when nearer than the focus), or as nodes that blur by it want it: nuke
    /// and magicdefocus (its radius, below 0 nearer or farther), flame (0.5 in focus, 0 nearest, 1 farthest)
    #[arg(long, value_name = "NAME", default_value = "signed-px", value_parser = named(CocConvention::ALL))]
    pub coc_convention: CocConvention,
    /// Pixels that are computed around the frame on each side: an EXR's data window is that much larger than its display window
    #[arg(long, value_name = "PX", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=4096))]
    pub overscan: u32,
    /// How an EXR is compressed; dwaa loses what is hardly seen of the colours
    #[arg(long, value_name = "NAME", default_value = "zip", value_parser = named(Compression::ALL))]
    pub compression: Compression,
    /// Halves instead of floats in an EXR where that suffices: colours, alpha, coverage
    #[arg(long)]
    pub half: bool,
    /// The linear colour space of an EXR
    #[arg(long, value_name = "NAME", default_value = "rec709", value_parser = named(ColorSpace::ALL))]
    pub color_space: ColorSpace,
    /// normalise keeps a white scene white; conserve is the model's energy as it is (default: the project's, or
    /// normalise)
    #[arg(long, value_enum)]
    pub exposure: Option<ExposureName>,
    /// Two pictures for two eyes, the lens's through two parts of its aperture: beside each other, or in red and cyan
    #[arg(long, value_enum, value_name = "FORM", conflicts_with_all = ["aov", "overscan"])]
    pub stereo: Option<StereoName>,
    /// How far the eyes are apart, as a share of the aperture's diameter, at most 0.9375
    #[arg(long, value_name = "SHARE", default_value_t = 0.5, requires = "stereo")]
    pub eyes: f64,
    /// The place of the picture that both eyes look at, px: it has no disparity (default: what the camera is focused on)
    #[arg(long, value_name = "X,Y", requires = "stereo", value_parser = place)]
    pub fixate: Option<glam::DVec2>,
    /// Seed of the ground truth's rays, and of scattered ones
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u32,
    /// Draws the picture in columns and rows of tiles, each within the memory of a tile, to the same bytes: of an .exr, by splat, on the
    /// processor. With --shard to parts beside it, which `merge` puts together; finished ones are skipped
    #[arg(long, value_name = "CxR", conflicts_with_all = ["frame", "frames", "stereo"])]
    pub tiles: Option<TileGrid>,
    /// Bits behind the point of the sums of tiles, at most: unpainted and painted, as merge asks for them where a picture is covered many
    /// times
    #[arg(long, value_name = "BITS,BITS", requires = "tiles", value_parser = integers)]
    pub integers: Option<Integers>,
    #[command(flatten)]
    pub sequence: SequenceArguments,
    /// What is told on stderr meanwhile; json is a line of JSON a step
    #[arg(long, value_enum, value_name = "FORM", default_value_t = ProgressName::Text)]
    pub progress: ProgressName,
    /// Write timings and counts as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// `merge`.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// The parts of all tiles, in any order
    #[arg(required = true, value_name = "PART")]
    pub parts: Vec<PathBuf>,
    /// Where to write the picture
    #[arg(short, long, value_name = "OUT.exr")]
    pub output: PathBuf,
    /// What is told on stderr meanwhile; json is a line of JSON a step
    #[arg(long, value_enum, value_name = "FORM", default_value_t = ProgressName::Text)]
    pub progress: ProgressName,
    /// Write timings and counts as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// `compare`.
#[derive(Debug, Args)]
pub struct CompareArguments {
    /// A picture (.exr, .png, .hdr)
    pub a: PathBuf,
    /// The reference, of the same size
    pub b: PathBuf,
    /// Write where they differ: FLIP in false colours (.png), or difference and FLIP as layers (.exr)
    #[arg(long, value_name = "OUT.png|exr")]
    pub error_map: Option<PathBuf>,
    /// Tell how much lies within three standard errors, with those that the files hold (`render --renderer truth --aov
    /// stderr,coverage`); a file without any counts as exact
    #[arg(long)]
    pub z_test: bool,
    /// Write JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// `report`.
#[derive(Debug, Args)]
pub struct ReportArguments {
    /// Scenes (.glb, .gltf) or projects (.fbrush); without any the demo, or nothing but the hard cases with --hard
    pub scenes: Vec<PathBuf>,
    /// The folder of the report; a run that was stopped goes on there
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    #[command(flatten)]
    pub shot: ShotArguments,
    /// Rays a pixel of the reference pictures (default: 1024, with --quick 512, with --engine 256)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1 << 20))]
    pub spp: Option<u32>,
    /// Measure only a few points of every sweep
    #[arg(long)]
    pub quick: bool,
    /// Run the numerically hard cases as well: hard.json, and a table on the page
    #[arg(long)]
    pub hard: bool,
    /// Measure the splat engine alone instead: times at every tolerance with their errors, and the ray tracer at the same
    /// error, 1920x1080 unless --size says otherwise
    #[arg(long, conflicts_with_all = ["hard", "quick"])]
    pub engine: bool,
    /// What the engine is measured on. auto: the processor, and then a graphics card, too, if there is one
    #[arg(long, value_enum, requires = "engine", default_value_t = BackendName::Auto)]
    pub backend: BackendName,
    /// Only a graphics adapter whose name contains this, also one in software (focus-brush doctor lists them)
    #[arg(long, value_name = "NAME", requires = "engine", value_parser = name_parser())]
    pub adapter: Option<String>,
    /// Write what was done as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// `export`.
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// The project (.fbrush)
    pub project: PathBuf,
    /// Write the focus map: EXR, or 16-bit PNG with a .json beside it
    #[arg(long, value_name = "MAP.exr|png", required_unless_present_any = ["glb", "layers", "photo"])]
    pub focus_map: Option<PathBuf>,
    /// Write the scene with the atlas as its second UV set
    #[arg(long, value_name = "OUT.glb")]
    pub glb: Option<PathBuf>,
    /// Write the picture with coverage, coc, depth, t and anchor as layers
    #[arg(long, value_name = "OUT.exr")]
    pub layers: Option<PathBuf>,
    /// Write a photograph of a capture as its camera photo:NAME shows the scene: undistorted, linear, its exposure as solved, with the
    /// layer seen
    #[arg(long, value_name = "NAME=OUT.exr", value_parser = photograph_output)]
    pub photo: Vec<(String, PathBuf)>,
}

/// `presets`.
#[derive(Debug, Args)]
pub struct PresetsArguments {
    /// Write JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// `thumbnail`.
#[derive(Debug, Args)]
pub struct ThumbnailArguments {
    /// A project (.fbrush), which holds what it looked like when it was saved, or a light field (.salf), which is drawn
    pub file: PathBuf,
    /// Where to write it
    #[arg(short, long, value_name = "PNG")]
    pub output: PathBuf,
    /// Its longer side in pixels, at most
    #[arg(long, value_name = "PX", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=512))]
    pub size: u32,
}

/// `doctor`.
#[derive(Debug, Args)]
pub struct DoctorArguments {
    /// Write JSON to stdout
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }
}
