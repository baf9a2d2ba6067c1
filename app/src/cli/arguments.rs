//! Arguments of the command line.

mod names;
mod parsers;
mod sequence;
mod web_page;

pub use names::{
    BackendName, BakeDeviceName, EstimatorName, ExposureName, KindName, ProgressName, SamplerName, StereoName,
};

use parsers::{
    camera_parser, choice_parser, name_parser, parse_aov, parse_integers, parse_non_negative,
    parse_photograph_output, parse_position, parse_positive, parse_size,
};
pub use sequence::{KeysArguments, SequenceArguments};
pub use web_page::WebPageArguments;

use clap::{Args, Parser};
use document::{CameraChoice, VariantChoice};
use light::LightQuality;
use light::{LightOptions, PhotoLookup, Scattering};
use project::{ColorSpace, Compression};
use render::{Aov, CocConvention, Renderer, TileGrid};
use scene::BackFaces;
use splat::Integers;
use std::ffi::OsString;
use std::path::PathBuf;

/// Paint the focus of a 3D scene.
#[derive(Debug, Parser)]
#[command(
    name = "focus-brush",
    version,
    args_conflicts_with_subcommands = true,
    after_help = "Exit codes: 0 done, 2 wrong usage, 3 bad input, 4 partly done, 5 requested GPU not \
                  available, 75 try again."
)]
pub struct Arguments {
    /// Opens the window with this scene (.glb, .gltf) or project (.fbrush); without a file, with the demo.
    pub file: Option<PathBuf>,
    /// Plays a recording (`Export strokes…`) in the window
    #[arg(long, value_name = "STROKES.json")]
    pub replay: Option<PathBuf>,
    /// Writes the latency of every point of the played strokes as JSON, then closes the window
    #[arg(long, value_name = "FILE.json", requires = "replay")]
    pub trace: Option<PathBuf>,
    /// Longest side of the live picture in pixels, instead of the setting
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u32).range(16..=8192))]
    pub preview_size: Option<u32>,
    /// Device that sums the live picture; the result is the same. auto: the window's graphics card, or the
    /// processor if the adapter is a software one
    #[arg(long, value_enum, default_value_t = BackendName::Auto)]
    pub backend: BackendName,
    /// Commands that run without a window.
    #[command(subcommand)]
    pub command: Option<Subcommand>,
}

/// Commands that run without a window.
#[derive(Debug, clap::Subcommand)]
pub enum Subcommand {
    /// Show what a file contains, the health of its mesh, and what would be baked
    Info(InfoArguments),
    /// Make a project from a scene, with an initial camera and focus
    New(NewArguments),
    /// Make a project from a capture: photographs with their cameras, and a mesh
    Import(ImportArguments),
    /// Apply recorded strokes (`Export strokes…` in the window) to a project or a scene
    Replay(ReplayArguments),
    /// Set keyframes of a project's lens and layers, or list them
    Keys(KeysArguments),
    /// Write a scene with the atlas as its second UV set (TEXCOORD_1)
    Unwrap(UnwrapArguments),
    /// Bake the light field of a scene or project into a file
    Bake(BakeArguments),
    /// Render a picture of a scene, project or light field
    Render(Box<RenderArguments>),
    /// Merge the tiles of a picture (render --tiles --shard); the result is byte-identical to an untiled render
    Merge(MergeArguments),
    /// Compare picture A with the reference B: RMSE, relMSE, PSNR, FLIP, signed mean error
    Compare(CompareArguments),
    /// Measure every renderer against the ground truth: speed, error and memory as tables, plots and an HTML
    /// page
    Report(ReportArguments),
    /// Write parts of a project: its focus map, its unwrapped scene, its picture in layers, a web page to refocus
    Export(ExportArguments),
    /// List the presets for brushes, lenses and bokeh
    Presets(PresetsArguments),
    /// Write the thumbnail of a project or a light field, as file managers show it
    Thumbnail(ThumbnailArguments),
    /// Check graphics adapters and libraries, and show how to install what is missing
    Doctor(DoctorArguments),
}

/// Options that affect how a scene looks and is lit.
#[derive(Clone, Debug, Default, Args)]
pub struct AppearanceArguments {
    /// Whether single-sided faces are visible from behind (default: the project's setting, or hide, as glTF
    /// specifies). Use show for files with inverted faces, or to compare with renderers that show back faces
    #[arg(long, value_name = "show|hide", value_parser = choice_parser(BackFaces::ALL))]
    pub back_faces: Option<BackFaces>,
    /// The environment that surrounds and lights the scene: a world file, an equirectangular .hdr or .exr, or studio, overcast or evening
    /// (default: the project's, or the scene's own; a scene without any light gets a studio)
    #[arg(long, value_name = "WORLD.json|SKY.hdr|exr|NAME")]
    pub world: Option<PathBuf>,
    /// The variant of the scene's materials (KHR_materials_variants), by name; info lists them. "" selects the
    /// default materials (default: the project's variant, or the default materials; a light field has the
    /// variant it was baked with)
    #[arg(long, value_name = "NAME", value_parser = name_parser())]
    pub variant: Option<String>,
    /// Gaussian splats beside the scene's meshes, or how the splats of the scene are shown: a file of splats, or one that says where it
    /// stands and which of its splats are hidden (default: those of the scene or the project)
    #[arg(long, value_name = "SPLATS.json|SCAN.ply|spz|…")]
    pub splats: Option<PathBuf>,
    /// Put a matte floor under the scene that looks like the backdrop and catches shadows (default: the project's setting)
    #[arg(long)]
    pub floor: bool,
    /// Leave out light scattered by microfacets more than once, to compare with renderers that do so
    #[arg(long)]
    pub single_scattering: bool,
    /// Where the light of a capture's photographs is looked up: texels, to which the photographs were
    /// resampled, or direct, in the photographs themselves at each point (slower; resolves detail finer than a
    /// texel)
    #[arg(long, value_name = "texels|direct", default_value = "texels", value_parser = choice_parser(PhotoLookup::ALL))]
    pub photos: PhotoLookup,
}

/// Quality of the global illumination.
#[derive(Debug, Args)]
pub struct LightArguments {
    /// Refine the light with this many passes of path tracing. 0 uses the cached irradiance: immediate,
    /// slightly biased. With passes the only error is noise, which halves for four times as many passes (a pass
    /// is four paths per pixel)
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=1 << 16))]
    pub light_passes: u32,
}

impl LightArguments {
    /// The light quality these options select.
    pub fn light_quality(&self) -> LightQuality {
        LightQuality::from_passes(self.light_passes)
    }
}

impl AppearanceArguments {
    /// How light is to be modelled.
    pub fn light(&self) -> LightOptions {
        let scattering = if self.single_scattering { Scattering::Single } else { Scattering::Multiple };
        LightOptions { scattering, photo_lookup: self.photos }
    }

    /// The requested variant.
    pub fn variant(&self) -> VariantChoice {
        VariantChoice::from_argument(self.variant.as_deref())
    }
}

/// `info`.
#[derive(Debug, Args)]
pub struct InfoArguments {
    /// A scene (.glb, .gltf), a project (.fbrush), a light field (.salf), Gaussian splats (.ply, .spz, .sog,
    /// .splat, .ksplat) or the folder of a capture
    pub file: PathBuf,
    /// For a picture with depth: the layer of an EXR with several, by name (default: the first one with depth)
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,
    /// Bake the light field of a small picture and count which parts of the scene are modelled
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
    /// The initial focus: a recipe (.json) or a focus map (.exr, .png; .ply for Gaussian splats) (default: the
    /// ordinary lens)
    #[arg(long, value_name = "RECIPE.json|MAP.exr|png|ply")]
    pub focus: Option<PathBuf>,
    /// A project whose paint is transferred to this scene: each point takes the paint of the nearest point of
    /// the node of the same name that faces the same way. The old project is not changed; points without a
    /// counterpart are listed and selected
    #[arg(long, value_name = "OLD.fbrush", conflicts_with = "focus")]
    pub paint_from: Option<PathBuf>,
    #[command(flatten)]
    pub appearance: AppearanceArguments,
}

/// `import`.
#[derive(Debug, Args)]
pub struct ImportArguments {
    /// The folder of the capture (cameras from COLMAP, nerfstudio, Bundler, VisualSFM or Metashape with
    /// pictures and a mesh; or the views of a light field), or a picture with embedded depth or a depth map
    /// beside it; or a file of Gaussian splats (.ply, .spz, .sog, .splat, .ksplat)
    pub capture: PathBuf,
    /// Where to write the project
    #[arg(short, long, value_name = "PROJECT.fbrush")]
    pub output: PathBuf,
    /// For Gaussian splats: a file that says where they stand and which of them are hidden
    #[arg(long, value_name = "SPLATS.json")]
    pub splats: Option<PathBuf>,
    /// The mesh (.ply, .obj, .glb) (default: the one in the folder)
    #[arg(long, value_name = "FILE")]
    pub mesh: Option<PathBuf>,
    /// Photographs used for comparison only, by name: their light is not used
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub leave_out: Vec<String>,
    /// The kind of capture (default: detected)
    #[arg(long, value_enum, value_name = "KIND")]
    pub kind: Option<KindName>,
    /// The disparity map of a light field's central view, or of a picture (.pfm, .exr, .png) (default: the
    /// one beside it)
    #[arg(long, value_name = "FILE", conflicts_with = "depth")]
    pub disparity: Option<PathBuf>,
    /// The depth map of a picture (.pfm, .exr, .png) (default: the one in it or beside it)
    #[arg(long, value_name = "FILE")]
    pub depth: Option<PathBuf>,
    /// The layer of an EXR with several pictures and their depths, by name (default: the first one with depth)
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,
    /// Which end of a relative depth map is near, or the distances of black and white in metres
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
    /// Output file
    #[arg(short, long, value_name = "OUT.glb")]
    pub output: PathBuf,
    #[command(flatten)]
    pub atlas: AtlasArguments,
    /// Write counts and timings as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// Options for unwrapping a scene.
#[derive(Debug, Args)]
pub struct AtlasArguments {
    /// Texels per unit of length (default: an atlas of 1024² to 2048² texels)
    #[arg(long, value_name = "TEXELS", value_parser = parse_positive)]
    pub density: Option<f64>,
    /// Use the densest atlas that fits a square with this side, in texels
    #[arg(long, value_name = "TEXELS", conflicts_with = "density", value_parser = clap::value_parser!(u32).range(16..=8192))]
    pub side: Option<u32>,
    /// Unwrap every part, even those with usable texture coordinates of their own
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
    /// Device that bakes: what of the aperture is visible is computed with the precision of a graphics card's floats
    #[arg(long, value_enum, default_value_t = BakeDeviceName::Cpu)]
    pub bake_on: BakeDeviceName,
    /// Bake on the graphics adapter whose name contains this (focus-brush doctor lists them)
    #[arg(long, value_name = "NAME", value_parser = name_parser())]
    pub adapter: Option<String>,
    /// Write counts and timings as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// Camera, lens and focus of a picture.
#[derive(Debug, Args)]
pub struct ShotArguments {
    /// A camera file, or the name of a camera in the scene. photo:NAME is the camera of a photograph, as a
    /// pinhole; photo:A..B@0.5 lies halfway between two (default: the project's camera, or the scene's first)
    #[arg(long, value_name = "CAM.json|NAME", value_parser = camera_parser())]
    pub camera: Option<CameraChoice>,
    /// Aperture radius in scene units, overriding the camera's; 0 is a pinhole
    #[arg(long, value_name = "R", value_parser = parse_non_negative)]
    pub aperture_radius: Option<f64>,
    /// A lens, overriding the camera's: the name of a preset (focus-brush presets lists them) or its file
    #[arg(long, value_name = "NAME|FILE.json")]
    pub lens: Option<OsString>,
    /// An aperture shape, overriding the camera's: the name of a preset or its file
    #[arg(long, value_name = "NAME|FILE.json")]
    pub bokeh: Option<OsString>,
    /// The focus: a recipe (.json) or a focus map (.exr, .png; .ply for Gaussian splats) (default: as the
    /// project is painted, or the ordinary lens)
    #[arg(long, value_name = "RECIPE.json|MAP.exr|png|ply")]
    pub focus: Option<PathBuf>,
    /// Picture size in pixels, overriding the camera's
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    #[command(flatten)]
    pub appearance: AppearanceArguments,
}

/// `render`.
#[derive(Debug, Args)]
pub struct RenderArguments {
    /// A scene (.glb, .gltf), a project (.fbrush), a light field (.salf) or the folder of a capture
    pub file: PathBuf,
    /// Where to write the picture; EXR is linear, PNG is sRGB
    #[arg(short, long, value_name = "OUT.exr|png")]
    pub output: PathBuf,
    /// For a picture with depth: the layer of an EXR with several, by name (default: the first one with depth)
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,
    #[command(flatten)]
    pub shot: ShotArguments,
    #[command(flatten)]
    pub light: LightArguments,
    /// The renderer: the splatted light field (splat) or the ray-traced ground truth (truth); for comparison: a
    /// depth-dependent blur of the pinhole picture (blur), the same in layers (layers), shifted pinhole views
    /// (views), Gaussian splats made larger, as other programs blur them (dilation), or the light field scattered
    /// ray by ray (scatter)
    #[arg(long, value_name = "NAME", default_value = "splat", value_parser = choice_parser(Renderer::ALL))]
    pub renderer: Renderer,
    /// Device that runs the splat; the picture is the same. auto: a graphics card if there is one, otherwise
    /// the processor; software adapters are not used
    #[arg(long, value_enum, default_value_t = BackendName::Auto)]
    pub backend: BackendName,
    /// Device that bakes the light field: what of the aperture is visible is then computed with the precision of the
    /// graphics card's floats
    #[arg(long, value_enum, default_value_t = BakeDeviceName::Cpu)]
    pub bake_on: BakeDeviceName,
    /// Use the graphics adapter whose name contains this, even a software one (focus-brush doctor lists them)
    #[arg(long, value_name = "NAME", value_parser = name_parser())]
    pub adapter: Option<String>,
    /// How coarse, in pixels, the light field may be: the visibility of the aperture from partly hidden points,
    /// and which out-of-focus samples are merged. Smaller is more exact and slower; 0 merges none and uses 3
    /// cells (default: 2 for visibility, 0 for merging)
    #[arg(long, value_name = "PX", value_parser = parse_non_negative)]
    pub tolerance: Option<f64>,
    /// Sample the light field on a grid of N × N cells per pixel: sharper, for N² times the time and memory.
    /// Not for baked light fields (default: 1; 3 at --tolerance 0)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=render::MAX_CELLS_A_SIDE as i64))]
    pub cells: Option<u32>,
    /// Rays per pixel of the ground truth
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub spp: u32,
    /// Where the rays of the ground truth start: at the sensor, or at the surfaces (an independent check;
    /// slower)
    #[arg(long, value_enum, default_value_t = EstimatorName::Sensor)]
    pub estimator: EstimatorName,
    /// Source of the ground truth's samples: Owen-scrambled Sobol' points, or independent random numbers
    #[arg(long, value_enum, default_value_t = SamplerName::LowDiscrepancy)]
    pub sampler: SamplerName,
    /// Depth slices that `--renderer layers` cuts the pinhole picture into
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=256))]
    pub layers: u32,
    /// Views per side of the aperture's square that `--renderer views` shifts and adds
    #[arg(long, value_name = "M", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=64))]
    pub views: u32,
    /// Rays that `--renderer scatter` traces for each sample of the light field
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=1 << 16))]
    pub rays: u32,
    /// Additional output channels: alpha (the share that is not background; colours are premultiplied), crypto
    /// (Cryptomatte of objects and materials), pinhole (everything sharp, to be blurred by other programs),
    /// coverage (the sum for a scene of radiance 1), coc (the circle of confusion), depth (axial, depth.Z; inf
    /// for the background), t (and anchor), seen (for captures: 1 photographed, 0 filled in), stderr (the
    /// ground truth's standard error of radiance, luminance and coverage, and of their ratios)
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = parse_aov)]
    pub aov: Vec<Aov>,
    /// Convention of the coc channel: signed-px (diameter, negative when nearer than the focus), or what
    /// compositing nodes expect: nuke and magicdefocus (radius; negative means nearer or farther,
    /// respectively), flame (0.5 in focus, 0 nearest, 1 farthest)
    #[arg(long, value_name = "NAME", default_value = "signed-px", value_parser = choice_parser(CocConvention::ALL))]
    pub coc_convention: CocConvention,
    /// Extra pixels to render on each side of the frame: the data window of the EXR is that much larger than
    /// its display window
    #[arg(long, value_name = "PX", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=4096))]
    pub overscan: u32,
    /// Compression of the EXR; dwaa is lossy, with hardly visible errors in the colours
    #[arg(long, value_name = "NAME", default_value = "zip", value_parser = choice_parser(Compression::ALL))]
    pub compression: Compression,
    /// Store colours, alpha and coverage in the EXR as half floats
    #[arg(long)]
    pub half: bool,
    /// The linear colour space of an EXR
    #[arg(long, value_name = "NAME", default_value = "rec709", value_parser = choice_parser(ColorSpace::ALL))]
    pub color_space: ColorSpace,
    /// normalise keeps a white scene white; conserve keeps the energy of the model (default: the project's, or
    /// normalise)
    #[arg(long, value_enum)]
    pub exposure: Option<ExposureName>,
    /// A stereo pair, seen through two parts of the lens's aperture: side by side, or as a red-cyan anaglyph
    #[arg(long, value_enum, value_name = "FORM", conflicts_with_all = ["aov", "overscan"])]
    pub stereo: Option<StereoName>,
    /// Distance between the eyes as a share of the aperture's diameter, at most 0.9375
    #[arg(long, value_name = "SHARE", default_value_t = 0.5, requires = "stereo")]
    pub eyes: f64,
    /// The pixel position that both eyes fixate: it has zero disparity (default: what the camera is focused on)
    #[arg(long, value_name = "X,Y", requires = "stereo", value_parser = parse_position)]
    pub fixate: Option<glam::DVec2>,
    /// Seed of the rays of --renderer truth and scatter
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u32,
    /// Render the picture in columns × rows of tiles, using the memory of one tile; the .exr is byte-identical
    /// to an untiled render. Splat on the processor only. With --shard, writes parts beside the output for
    /// `merge`; finished parts are skipped
    #[arg(long, value_name = "CxR", conflicts_with_all = ["frame", "frames", "stereo"])]
    pub tiles: Option<TileGrid>,
    /// Maximum fraction bits of the tiles' fixed-point sums, unpainted and painted; needed only if merge
    /// reports an overflow because a picture is covered many times
    #[arg(long, value_name = "BITS,BITS", requires = "tiles", value_parser = parse_integers)]
    pub integers: Option<Integers>,
    #[command(flatten)]
    pub sequence: SequenceArguments,
    /// Format of progress reports on stderr; json writes one line of JSON per step
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
    /// Format of progress reports on stderr; json writes one line of JSON per step
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
    /// Write an error map: FLIP in false colours (.png), or difference and FLIP as layers (.exr)
    #[arg(long, value_name = "OUT.png|exr")]
    pub error_map: Option<PathBuf>,
    /// Report how much lies within three standard errors, using the standard errors stored in the files
    /// (`render --renderer truth --aov stderr,coverage`); a file without them counts as exact
    #[arg(long)]
    pub z_test: bool,
    /// Write JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// `report`.
#[derive(Debug, Args)]
pub struct ReportArguments {
    /// Scenes (.glb, .gltf) or projects (.fbrush). Default: the demo; with --hard, only the hard cases
    pub scenes: Vec<PathBuf>,
    /// The folder of the report; an interrupted run resumes there
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    #[command(flatten)]
    pub shot: ShotArguments,
    /// Rays per pixel of the reference pictures (default: 1024; with --quick 512, with --engine 256)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=1 << 20))]
    pub spp: Option<u32>,
    /// Measure only a few points of every sweep
    #[arg(long)]
    pub quick: bool,
    /// Also run the numerically hard cases: hard.json, and a table on the page
    #[arg(long)]
    pub hard: bool,
    /// Measure only the splat engine: time and error at every tolerance, and the ray tracer at equal error;
    /// 1920x1080 unless --size is given
    #[arg(long, conflicts_with_all = ["hard", "quick"])]
    pub engine: bool,
    /// Device that the engine is measured on. auto: the processor, then also a graphics card if there is one
    #[arg(long, value_enum, requires = "engine", default_value_t = BackendName::Auto)]
    pub backend: BackendName,
    /// Use the graphics adapter whose name contains this, even a software one (focus-brush doctor lists them)
    #[arg(long, value_name = "NAME", requires = "engine", value_parser = name_parser())]
    pub adapter: Option<String>,
    /// Write a summary as JSON to stdout
    #[arg(long)]
    pub json: bool,
}

/// `export`.
#[derive(Debug, Args)]
pub struct ExportArguments {
    /// The project (.fbrush)
    pub project: PathBuf,
    /// Write the focus map: EXR, or 16-bit PNG with a .json beside it; of Gaussian splats also a PLY table
    #[arg(long, value_name = "MAP.exr|png|ply", required_unless_present_any = ["glb", "layers", "photo", "web"])]
    pub focus_map: Option<PathBuf>,
    /// Write the scene with the atlas as its second UV set
    #[arg(long, value_name = "OUT.glb")]
    pub glb: Option<PathBuf>,
    /// Write the picture with coverage, coc, depth, t and anchor as layers
    #[arg(long, value_name = "OUT.exr")]
    pub layers: Option<PathBuf>,
    /// Write a photograph of a capture as its camera photo:NAME shows the scene: undistorted, linear, with its
    /// solved exposure and the layer seen
    #[arg(long, value_name = "NAME=OUT.exr", value_parser = parse_photograph_output)]
    pub photo: Vec<(String, PathBuf)>,
    #[command(flatten)]
    pub page: WebPageArguments,
    /// Write the files, and what was measured of a web page, as JSON to stdout
    #[arg(long)]
    pub json: bool,
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
    /// A project (.fbrush), whose stored thumbnail is used, or a light field (.salf), which is rendered
    pub file: PathBuf,
    /// Output file
    #[arg(short, long, value_name = "PNG")]
    pub output: PathBuf,
    /// Maximum length of the longer side in pixels
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
