//! Display transforms of the OpenColorIO configuration in `$OCIO`.
//!
//! Applying a view to every pixel of a live picture would be too slow. Each view is therefore sampled once by the `ocio` crate, on a grid over
//! logarithmic light, and interpolated tetrahedrally. The mean error is below 0.2 of a screen's 256 steps; 98 % of values are off by less
//! than 2 steps, and colours so saturated that the view itself is discontinuous by less than 20.

use ocio::{Config, CpuProcessor};
use rayon::prelude::*;
use std::panic::AssertUnwindSafe;
use std::sync::{LazyLock, OnceLock};

/// Grid points along each channel.
const GRID_POINTS: usize = 49;

/// The upper end of the grid.
const BRIGHTEST: f32 = 128.0;

/// The offset of the logarithmic scale: light is mapped to log2(1 + light / `DARKEST`).
const DARKEST: f32 = 1.0 / 256.0;

/// Names of linear Rec. 709 in configurations.
const LINEAR_REC709: [&str; 9] = [
    "Linear Rec.709 (sRGB)",
    "lin_rec709",
    "lin_rec709_scene",
    "Linear Rec.709",
    "lin_srgb",
    "Linear sRGB",
    "Utility - Linear - sRGB",
    "Utility - Linear - Rec.709",
    "Linear",
];

/// The views of `$OCIO`.
static ENVIRONMENT_VIEWS: LazyLock<OcioViews> = LazyLock::new(|| match std::env::var("OCIO") {
    Ok(path) if !path.is_empty() => OcioViews::open(&path),
    _ => OcioViews::default(),
});

/// The display views of an OpenColorIO configuration.
#[derive(Default)]
pub struct OcioViews {
    path: String,
    views: Vec<View>,
    /// Why the configuration could not be used, if so.
    pub problem: Option<String>,
}

struct View {
    display: String,
    view: String,
    /// Display and view, for menus.
    name: String,
    table: OnceLock<Option<Table>>,
}

impl OcioViews {
    /// The views of the configuration in `$OCIO`; empty if it is not set.
    pub fn from_environment() -> &'static Self {
        &ENVIRONMENT_VIEWS
    }

    /// Opens a configuration: a file, an archive or a built-in one (`ocio://…`).
    fn open(path: &str) -> Self {
        let opened = guarded(|| {
            let config = Config::create_from_file(path).map_err(|error| error.to_string())?;
            linear_space(&config).ok_or("it has no linear Rec. 709 colour space")?;
            let displays = (0..config.num_displays()).map(|k| config.display(k));
            let views_of = |display: String| {
                let views: Vec<_> =
                    (0..config.num_views(&display)).map(|k| config.view(&display, k)).collect();
                views.into_iter().map(move |view| (display.clone(), view))
            };
            Ok(displays.flat_map(views_of).collect::<Vec<_>>())
        });
        match opened {
            Ok(names) => {
                let view = |(display, view): (String, String)| View {
                    name: format!("{display}: {view}"),
                    display,
                    view,
                    table: OnceLock::new(),
                };
                Self { path: path.into(), views: names.into_iter().map(view).collect(), problem: None }
            }
            Err(problem) => Self { problem: Some(format!("$OCIO: {path}: {problem}")), ..Self::default() },
        }
    }

    /// The number of views.
    pub fn len(&self) -> usize {
        self.views.len()
    }

    /// Whether there are no views.
    pub fn is_empty(&self) -> bool {
        self.views.is_empty()
    }

    /// The name of the view with this number, for menus; `None` if there is none.
    pub fn name(&self, view: u16) -> Option<&str> {
        self.views.get(usize::from(view)).map(|view| view.name.as_str())
    }

    /// Transforms linear light by a view, to the display's encoding in [0, 1]. `None` if there is no such view or it cannot be used.
    pub(crate) fn shown(&self, view: u16, rgb: [f32; 3]) -> Option<[f32; 3]> {
        let view = self.views.get(usize::from(view))?;
        let table = view.table.get_or_init(|| self.table(view)).as_ref()?;
        Some(table.at(rgb))
    }

    fn table(&self, view: &View) -> Option<Table> {
        let made = guarded(|| Ok(Table::from_processor(&self.processor(view)?)));
        made.map_err(|problem| tracing::warn!("{}: {}: {problem}", self.path, view.name)).ok()
    }

    fn processor(&self, view: &View) -> Result<CpuProcessor, String> {
        let config = Config::create_from_file(&self.path).map_err(|error| error.to_string())?;
        let from = linear_space(&config).ok_or("it has no linear Rec. 709 colour space")?;
        let processor = config.get_display_view_processor(&from, &view.display, &view.view);
        Ok(processor.map_err(|error| error.to_string())?.default_cpu_processor())
    }
}

fn linear_space(config: &Config) -> Option<String> {
    let linear = LINEAR_REC709.into_iter().find(|name| config.get_color_space(name).is_some());
    linear.map(str::to_owned)
}

/// Turns a panic of the third-party reader, on a damaged configuration, into an error.
fn guarded<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    std::panic::catch_unwind(AssertUnwindSafe(work))
        .unwrap_or_else(|_| Err("its content is inconsistent".into()))
}

/// A view sampled on a grid.
struct Table(Vec<[f32; 3]>);

impl Table {
    fn from_processor(processor: &CpuProcessor) -> Self {
        let light = |place: usize| {
            let share = place as f32 / (GRID_POINTS - 1) as f32;
            DARKEST * ((1.0 + BRIGHTEST / DARKEST).powf(share) - 1.0)
        };
        let mut colors: Vec<[f32; 3]> = (0..GRID_POINTS.pow(3))
            .map(|k| {
                [
                    light(k % GRID_POINTS),
                    light(k / GRID_POINTS % GRID_POINTS),
                    light(k / (GRID_POINTS * GRID_POINTS)),
                ]
            })
            .collect();
        colors.par_iter_mut().with_min_len(GRID_POINTS).for_each(|color| processor.apply_rgb(color));
        let within = |color: [f32; 3]| color.map(|c| if c.is_nan() { 0.0 } else { c.clamp(0.0, 1.0) });
        Self(colors.into_iter().map(within).collect())
    }

    /// Interpolates at a colour; NaN counts as black.
    fn at(&self, rgb: [f32; 3]) -> [f32; 3] {
        let scale = (GRID_POINTS - 1) as f32 / (1.0 + BRIGHTEST / DARKEST).log2();
        let light = rgb.map(|c| if c > 0.0 { c.min(BRIGHTEST) } else { 0.0 });
        let places = light.map(|c| (1.0 + c / DARKEST).log2() * scale);
        let first = places.map(|place| (place as usize).min(GRID_POINTS - 2));
        let beyond = [0, 1, 2].map(|c| places[c] - first[c] as f32);
        // Walks from the lower to the upper corner, along the channels by descending fraction.
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| beyond[b].total_cmp(&beyond[a]));
        const STRIDES: [usize; 3] = [1, GRID_POINTS, GRID_POINTS * GRID_POINTS];
        let mut corner: usize = (0..3).map(|c| first[c] * STRIDES[c]).sum();
        let mut rest = 1.0;
        let mut shown = [0.0; 3];
        for next in order.map(Some).into_iter().chain([None]) {
            let weight = next.map_or(rest, |c: usize| rest - beyond[c]);
            (0..3).for_each(|c| shown[c] += weight * self.0[corner][c]);
            if let Some(c) = next {
                rest = beyond[c];
                corner += STRIDES[c];
            }
        }
        shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIGHT: [[f32; 3]; 5] =
        [[0.18; 3], [1.0; 3], [0.8, 0.1, 0.05], [0.02, 0.3, 6.0], [0.001, 0.002, 0.0005]];

    /// What OpenColorIO 2.6 (`opencolorio` on PyPI) makes of [`LIGHT`].
    const PUBLISHED: [(&str, &str, [[f32; 3]; 5]); 5] = [
        (
            "ocio://cg-config-v2.2.0_aces-v1.3_ocio-v2.4",
            "sRGB - Display: ACES 1.0 - SDR Video",
            [
                [0.35595, 0.35595, 0.35595],
                [0.81197, 0.81198, 0.81197],
                [0.74398, 0.25993, 0.16196],
                [0.55992, 0.54878, 0.99914],
                [0.00000, 0.00000, 0.00000],
            ],
        ),
        (
            "ocio://cg-config-v2.2.0_aces-v1.3_ocio-v2.4",
            "Display P3 - Display: Un-tone-mapped",
            [
                [0.46135, 0.46135, 0.46135],
                [1.00001, 1.00001, 1.00001],
                [0.84103, 0.38595, 0.28586],
                [0.29277, 0.57551, 2.08912],
                [0.01522, 0.02542, 0.00798],
            ],
        ),
        (
            "ocio://cg-config-v4.0.0_aces-v2.0_ocio-v2.5",
            "sRGB - Display: ACES 2.0 - SDR 100 nits (Rec.709)",
            [
                [0.34919, 0.34919, 0.34919],
                [0.70668, 0.70668, 0.70668],
                [0.72058, 0.26366, 0.17904],
                [0.50815, 0.58876, 1.00001],
                [0.00009, 0.00019, 0.00004],
            ],
        ),
        (
            "ocio://cg-config-v4.0.0_aces-v2.0_ocio-v2.5",
            "Rec.2100-PQ - Display: ACES 2.0 - HDR 1000 nits (P3 D65)",
            [
                [0.32984, 0.32984, 0.32984],
                [0.51447, 0.51447, 0.51447],
                [0.43961, 0.31922, 0.25261],
                [0.42021, 0.41476, 0.68376],
                [0.00702, 0.00876, 0.00462],
            ],
        ),
        (
            "ocio://studio-config-v2.2.0_aces-v1.3_ocio-v2.4",
            "sRGB - Display: ACES 1.0 - SDR Video (D60 sim on D65)",
            [
                [0.35610, 0.34737, 0.33369],
                [0.81228, 0.79387, 0.76501],
                [0.73568, 0.25193, 0.14529],
                [0.56260, 0.53719, 0.94495],
                [0.00000, 0.00000, 0.00000],
            ],
        ),
    ];

    fn view<'a>(views: &'a OcioViews, name: &str) -> &'a View {
        views.views.iter().find(|view| view.name == name).expect("it is there")
    }

    #[test]
    fn five_views_are_opencolorios() {
        for (path, name, published) in PUBLISHED {
            let views = OcioViews::open(path);
            assert_eq!(views.problem, None);
            let processor = views.processor(view(&views, name)).expect("a view");
            for (light, published) in LIGHT.into_iter().zip(published) {
                let mut shown = light;
                processor.apply_rgb(&mut shown);
                for c in 0..3 {
                    assert!(
                        (shown[c] - published[c]).abs() <= 1e-4,
                        "{name}: {light:?}: {shown:?} {published:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_grid_is_close_to_the_view() {
        let (path, name, _) = PUBLISHED[0];
        let views = OcioViews::open(path);
        let index = views.views.iter().position(|view| view.name == name).expect("it is there") as u16;
        let processor = views.processor(&views.views[usize::from(index)]).expect("a view");
        let mut errors = Vec::new();
        for k in 0..4000u32 {
            let mixed = k.wrapping_mul(2_654_435_761);
            let color = [mixed, mixed >> 9, mixed >> 18].map(|c| ((c % 512) as f32 / 32.0 - 11.0).exp2());
            let mut exact = color;
            processor.apply_rgb(&mut exact);
            let shown = views.shown(index, color).expect("a view");
            errors.extend((0..3).map(|c| 255.0 * (shown[c] - exact[c].clamp(0.0, 1.0)).abs()));
        }
        errors.sort_by(f32::total_cmp);
        let mean = errors.iter().sum::<f32>() / errors.len() as f32;
        let [most, worst] = [errors[errors.len() * 98 / 100], errors[errors.len() - 1]];
        // Steps of a screen; the worst are colours as saturated as 1 to 2¹⁰, where the view itself has edges.
        assert!(mean < 0.2 && most < 2.0 && worst < 20.0, "mean {mean}, 98 % below {most}, worst {worst}");
        let invalid = views.shown(index, [f32::NAN, -1.0, f32::INFINITY]).expect("a view");
        assert!(invalid.iter().all(|c| (0.0..=1.0).contains(c)), "{invalid:?}");
    }

    #[test]
    fn what_is_no_configuration_is_told() {
        assert!(OcioViews::default().is_empty() && OcioViews::default().problem.is_none());
        for path in ["none/config.ocio", "ocio://no-such-config", "Cargo.toml"] {
            let views = OcioViews::open(path);
            assert!(views.is_empty() && views.problem.as_ref().is_some_and(|problem| problem.contains(path)));
            assert_eq!(views.shown(0, [1.0; 3]), None);
        }
    }
}
