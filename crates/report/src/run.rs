//! Runs the measurements; each is saved as soon as it is finished.

use crate::fingerprint::{self, Fingerprint};
use crate::measurement::band::OutlineBand;
use crate::measurement::contender::{Contender, Shot};
use crate::measurement::machine::Machine;
use crate::measurement::measure::{Comparison, MeasurementNames, measure};
use crate::measurement::memory::PeakMemory;
use crate::measurement::record::{Record, Series};
use crate::measurement::reference::{conserved_picture, trace_reference};
use crate::options::{ReportOptions, SceneRequest};
use crate::output::write::write_report;
use crate::plan::{Setting, plan_settings};
use crate::report::{Measured, Report};
use crate::store::{Store, file_name_part};
use crate::studies::left_out_photographs::{self, Photographs};
use crate::studies::light_field_views::Views;
use crate::studies::live_preview::{self, ShownPicture};
use crate::studies::refined_light::RefinedLight;
use crate::subject::subdivision::subdivide;
use crate::subject::{Subject, trace_first_hits};
use crate::summary::{FocusSummary, ModelledScene, Reference, SceneSummary};
use focus::Focus;
use light::LitScene;
use light::Steps;
use numerics::quantile;
use progress::Progress;
use project::{LinearPicture, compare, read_picture, write_error_map, write_rgb};
use render::{Modelled, RenderOptions, bake, bake_unpacked};
use salf::Salf;
use session::SessionError;
use splat::Splatter;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Instant;
use trace::Tracer;

/// Version of stored results; results of other versions are not reused.
const FORMAT_VERSION: &str = "3";

/// The tolerance of the finest light field, px.
const FINEST_TOLERANCE_PX: f64 = 0.0;

/// Measures and writes the report to `folder`, which is created if necessary. `note` receives a line per
/// measurement.
///
/// If interrupted, it leaves every finished measurement in `folder/measurements`, and the same call resumes
/// from there. A measurement is reused only for the same scene, camera, focus, size, reference and build of the
/// program.
///
/// # Errors
/// A scene cannot be opened or rendered, a file cannot be written, or the run is cancelled.
pub fn run(
    requests: &[SceneRequest],
    options: &ReportOptions,
    folder: &Path,
    steps: &dyn Steps,
    note: &dyn Fn(&str),
) -> Result<Report, SessionError> {
    let start = Instant::now();
    let store = Store::open(&folder.join("measurements"))?;
    let runner = ReportRunner { options, store: &store, steps, note };
    let mut report = Report {
        machine: Machine::current(),
        scenes: Vec::new(),
        measured: Vec::new(),
        hard: None,
        new: 0,
        files: Vec::new(),
        seconds: 0.0,
    };
    for request in requests {
        runner.measure_scene(request, &mut report)?;
    }
    if options.with_hard_cases {
        let bar = steps.begin("hard cases");
        report.hard = Some(hard_cases::run("", hard_cases::Effort::Full, &*bar)?);
    }
    report.files = write_report(&report, folder)?;
    report.seconds = start.elapsed().as_secs_f64();
    Ok(report)
}

struct ReportRunner<'a> {
    options: &'a ReportOptions,
    store: &'a Store,
    steps: &'a dyn Steps,
    note: &'a dyn Fn(&str),
}

/// A setting, with the fingerprints that identify its results.
struct SettingContext<'a> {
    subject: &'a Subject,
    setting: &'a Setting,
    scene_print: &'a str,
    focus_print: &'a str,
}

impl ReportRunner<'_> {
    fn measure_scene(&self, request: &SceneRequest, report: &mut Report) -> Result<(), SessionError> {
        let mut subject = Subject::open(request, self.options, self.steps)?;
        let same_name = report.scenes.iter().filter(|scene| scene.name == subject.name).count();
        if same_name > 0 {
            subject.name = format!("{} ({})", subject.name, same_name + 1);
        }
        subject.warnings.iter().for_each(|warning| (self.note)(&format!("warning: {warning}")));
        let scene_print = fingerprint::scene_fingerprint(&subject.scene, subject.input.light);
        let focus_prints: Vec<_> =
            subject.focuses.iter().map(|named| fingerprint::focus_fingerprint(&named.focus)).collect();
        let live = self.live(request, &subject, &scene_print)?;
        let photographs = self.photographs(&subject, &scene_print)?;
        let views = Views::measure(&subject.input, &subject.name, self.steps)?;
        let settings = plan_settings(&subject, self.options);
        let total: usize = settings.iter().map(|setting| setting.contenders.len()).sum();
        let mut done = 0;
        let mut focuses = Vec::new();
        // The subdivided scene, created when needed.
        let mut cut: Option<(u32, Arc<LitScene>)> = None;
        for setting in &settings {
            let place = SettingContext {
                subject: &subject,
                setting,
                scene_print: &scene_print,
                focus_print: &focus_prints[setting.focus],
            };
            let (mut reference, mut band) = (None, None);
            for &contender in &setting.contenders {
                done += 1;
                let name = self.measurement_name(&place, contender);
                let stored = self.stored_measurement(&name, setting.series);
                let measured = match stored {
                    Some(measured) => measured,
                    None => {
                        let (picture, reference_summary) = match &mut reference {
                            Some(reference) => reference,
                            None => reference.insert(self.reference(&place)?),
                        };
                        let band = band.get_or_insert_with(|| {
                            OutlineBand::from_scene(subject.lit.tracer(), &setting.camera)
                        });
                        let (error, coc_px) = (reference_summary.error, reference_summary.circles_px[2]);
                        let against = Comparison { picture, error, coc_px, band: band.clone() };
                        let lit = self.cut_scene(&place, &mut cut)?;
                        report.new += 1;
                        let count = [done, total];
                        self.measure(&place, contender, &lit, &against, &name, count)?
                    }
                };
                report.measured.push(measured);
            }
            if setting.series == Series::Knob {
                let about = match reference {
                    Some((_, about)) => about,
                    None => self.reference(&place)?.1,
                };
                let named = &subject.focuses[setting.focus];
                focuses.push(FocusSummary {
                    name: named.name.into(),
                    what: named.what.clone(),
                    reference: about,
                    picture: self.store.file(&self.reference_name(&place), "png"),
                });
            }
        }
        let modelled = self.modelled(&subject, &scene_print)?;
        let light = self.light(&subject, &scene_print)?;
        let Subject { camera, .. } = &subject;
        report.scenes.push(SceneSummary {
            name: subject.name.clone(),
            file: subject.file.file_name().unwrap_or_default().to_string_lossy().into(),
            triangles: subject.scene.triangles.len(),
            parts: subject.scene.parts.len(),
            lights: subject.scene.lights.len(),
            camera: camera.clone(),
            size: [camera.width, camera.height],
            aperture_radius: camera.aperture_radius,
            f_number: camera.f_number(),
            focus_distance: camera.focus_distance.is_finite().then_some(camera.focus_distance),
            lens: subject.lens.clone(),
            prepare_seconds: subject.prepare_seconds,
            hierarchy_bytes: subject.lit.tracer().bytes(),
            focuses,
            live,
            photographs,
            views,
            light,
            modelled,
            warnings: subject.warnings.clone(),
        });
        Ok(())
    }

    /// A measurement of an earlier run, if its record and pictures exist.
    fn stored_measurement(&self, name: &str, series: Series) -> Option<Measured> {
        let record = Record { series, ..self.store.get(name)? };
        let pictures = (series == Series::Knob).then(|| self.picture_files(name));
        let complete = pictures.iter().flatten().all(|file| file.is_file());
        complete.then_some(Measured { record, pictures })
    }

    fn picture_files(&self, name: &str) -> [PathBuf; 2] {
        [self.store.file(name, "png"), self.store.file(name, "flip.png")]
    }

    fn measure(
        &self,
        place: &SettingContext<'_>,
        contender: Contender,
        lit: &Arc<LitScene>,
        against: &Comparison<'_>,
        name: &str,
        [done, total]: [usize; 2],
    ) -> Result<Measured, SessionError> {
        let SettingContext { subject, setting, .. } = place;
        let focus = &subject.focuses[setting.focus];
        let label = format!("{}, {}: {} [{done}/{total}]", subject.name, focus.name, contender.renderer());
        let bar = self.steps.begin(&label);
        let one = SharedBar { bar: &*bar, furthest_fraction: Mutex::new(0.0) };
        // A subdivided scene is measured with the standard focus only; its parts are the same.
        let cut_focus = Focus { scene: lit.scene().clone(), ..focus.focus.clone() };
        let shot = Shot { lit, camera: &setting.camera, focus: &cut_focus };
        let named = MeasurementNames { scene: &subject.name, focus: focus.name, series: setting.series };
        let (record, picture) = measure(contender, shot, against, &named, &one)?;
        let pictures = if setting.series == Series::Knob {
            let [png, flip] = self.picture_files(name);
            let [width, height] = [picture.width, picture.height];
            write_rgb(&png, width, height, &picture.rgb)?;
            write_error_map(&flip, &picture, against.picture)?;
            Some([png, flip])
        } else {
            None
        };
        self.store.put(name, &record)?;
        drop(bar);
        let Record { seconds, psnr, value, .. } = record;
        let knob = match record.knob.as_str() {
            "" => String::new(),
            knob => format!(" {knob} {value}"),
        };
        (self.note)(&format!("{label}{knob}: {seconds:.3} s, {psnr:.2} dB"));
        Ok(Measured { record, pictures })
    }

    /// The tracer of a setting's scene, subdivided if necessary.
    fn cut_scene(
        &self,
        place: &SettingContext<'_>,
        cut: &mut Option<(u32, Arc<LitScene>)>,
    ) -> Result<Arc<LitScene>, SessionError> {
        let cuts = place.setting.cuts;
        if cuts == 0 {
            return Ok(place.subject.lit.clone());
        }
        if let Some((_, lit)) = cut.as_ref().filter(|(have, _)| *have == cuts) {
            return Ok(lit.clone());
        }
        let mut scene = place.subject.scene.as_ref().clone();
        for _ in 0..cuts {
            let too_many = || {
                SessionError::bad_file(&place.subject.file, "too many vertices to subdivide its triangles")
            };
            scene = subdivide(&scene).ok_or_else(too_many)?;
        }
        let Subject { input, .. } = place.subject;
        let tracer = Arc::new(Tracer::new(Arc::new(scene)));
        let lit = LitScene::new(tracer, input.light, &input.resources);
        *cut = Some((cuts, lit.clone()));
        Ok(lit)
    }

    /// The reference of a setting, from an earlier run or traced now.
    fn reference(&self, place: &SettingContext<'_>) -> Result<(LinearPicture, Reference), SessionError> {
        let name = self.reference_name(place);
        let file = self.store.file(&name, "exr");
        if let (Some(about), Ok(picture)) = (self.store.get::<Reference>(&name), read_picture(&file)) {
            return Ok((picture, about));
        }
        let SettingContext { subject, setting, .. } = place;
        let focus = &subject.focuses[setting.focus];
        let bar = self.steps.begin(&format!("{}, {}: reference", subject.name, focus.name));
        let one = SharedBar { bar: &*bar, furthest_fraction: Mutex::new(0.0) };
        let shot = Shot { lit: &subject.lit, camera: &setting.camera, focus: &focus.focus };
        let (picture, error) = trace_reference(shot, setting.reference_spp, &one)?;
        let hits = trace_first_hits(shot.lit.tracer(), shot.focus, shot.camera, &one)?;
        // The background is at infinity, where blur is not visible.
        let circles = hits.circle_of_confusion_px(shot.camera).into_iter().zip(&hits.depth);
        let circles = circles.filter(|(_, depth)| depth.is_finite());
        let mut circles: Vec<f64> = circles.map(|(circle, _)| f64::from(circle.abs())).collect();
        let circles_px = [0.5, 0.9, 0.99].map(|share| quantile(&mut circles, share).unwrap_or(0.0));
        let about = Reference { error, circles_px };
        let [width, height] = [picture.width, picture.height];
        write_rgb(&file, width, height, &picture.rgb)?;
        write_rgb(&self.store.file(&name, "png"), width, height, &picture.rgb)?;
        self.store.put(&name, &about)?;
        Ok((picture, about))
    }

    /// How well photographs of a capture are reconstructed from the others; `None` if there are too few.
    fn photographs(&self, subject: &Subject, scene_print: &str) -> Result<Option<Photographs>, SessionError> {
        if subject.scene.views.len() <= left_out_photographs::LEFT_OUT_COUNT {
            return Ok(None);
        }
        let print = self.scene_and_camera_fingerprint(subject, scene_print).hex_name();
        let name = format!("{}-photographs-{print}", file_name_part(&subject.name));
        if let Some(mut stored) = self.store.get::<Photographs>(&name) {
            stored.find_pictures(&name, self.store);
            if stored.pictures.iter().flatten().all(|file| file.is_file()) {
                return Ok(Some(stored));
            }
        }
        let memory = PeakMemory::watch();
        let left_out = render::leave_photographs_out(
            &subject.input,
            left_out_photographs::LEFT_OUT_COUNT,
            &self.options.unwrap,
            self.steps,
        )?;
        let measured = Photographs::from_left_out(
            &subject.scene,
            &left_out,
            memory.peak_increase_bytes(),
            &name,
            self.store,
        )?;
        self.store.put(&name, &measured)?;
        Ok(Some(measured))
    }

    /// What the live preview shows over time. Empty with single scattering, for which the window has no
    /// setting.
    fn live(
        &self,
        request: &SceneRequest,
        subject: &Subject,
        scene_print: &str,
    ) -> Result<Vec<ShownPicture>, SessionError> {
        if request.light.scattering == light::Scattering::Single {
            return Ok(Vec::new());
        }
        let print = self
            .scene_and_camera_fingerprint(subject, scene_print)
            .add(&(rayon::current_num_threads() as u64).to_le_bytes())
            .hex_name();
        let name = format!("{}-live-{print}", file_name_part(&subject.name));
        if let Some(stored) = self.store.get(&name) {
            return Ok(stored);
        }
        let bar = self.steps.begin(&format!("{}: the live preview", subject.name));
        let live = live_preview::watch_preview(request, subject, &self.options.unwrap, &*bar)?;
        self.store.put(&name, &live)?;
        Ok(live)
    }

    /// The error of the cached light; `None` if the light cannot be refined.
    fn light(&self, subject: &Subject, scene_print: &str) -> Result<Option<RefinedLight>, SessionError> {
        if !subject.lit.can_be_refined() {
            return Ok(None);
        }
        let passes: u32 = if self.options.is_quick { 16 } else { 64 };
        let print =
            self.scene_and_camera_fingerprint(subject, scene_print).add(&passes.to_le_bytes()).hex_name();
        let name = format!("{}-light-{print}", file_name_part(&subject.name));
        if let Some(stored) = self.store.get(&name) {
            return Ok(Some(stored));
        }
        let bar = self.steps.begin(&format!("{}: its light", subject.name));
        let one = SharedBar { bar: &*bar, furthest_fraction: Mutex::new(0.0) };
        let standard = &subject.focuses[0].focus;
        let measured = RefinedLight::measure(&subject.lit, &subject.camera, standard, passes, &one)?;
        self.store.put(&name, &measured)?;
        Ok(Some(measured))
    }

    /// What is modelled under the standard lens, and the error of the compact form.
    fn modelled(&self, subject: &Subject, scene_print: &str) -> Result<ModelledScene, SessionError> {
        let standard = &subject.focuses[0].focus;
        let print = self.scene_and_camera_fingerprint(subject, scene_print).hex_name();
        let name = format!("{}-modelled-{print}", file_name_part(&subject.name));
        if let Some(stored) = self.store.get(&name) {
            return Ok(stored);
        }
        let bar = self.steps.begin(&format!("{}: what was modelled", subject.name));
        let one = SharedBar { bar: &*bar, furthest_fraction: Mutex::new(0.0) };
        let atlas = subject.input.atlas(&self.options.unwrap, &one)?;
        let tolerance_px = RenderOptions::default().tolerance_px;
        let drawn = |salf: Salf| {
            let salf = Arc::new(salf);
            let mut splatter = Splatter::new(salf.clone());
            splatter.render(&subject.camera, standard, &*one.begin("splatting"))?;
            Ok::<_, SessionError>((salf, conserved_picture(splatter.picture())))
        };
        let Subject { lit, camera, .. } = subject;
        let (salf, picture) = drawn(bake(lit, camera, standard, tolerance_px, &one)?)?;
        let finest = bake_unpacked(lit, camera, standard, FINEST_TOLERANCE_PX, &one)?;
        let (finest, finest_picture) = drawn(finest)?;
        let cost = compare(&picture, &finest_picture)?;
        let scene = ModelledScene {
            modelled: Modelled::measure(&salf, subject.lit.tracer(), Some(&atlas)),
            tolerance_px,
            saving_psnr: cost.psnr,
            saving_flip: cost.flip,
            finest_bytes: finest.statistics().bytes,
        };
        self.store.put(&name, &scene)?;
        Ok(scene)
    }

    /// Fingerprint of a scene and its camera.
    fn scene_and_camera_fingerprint(&self, subject: &Subject, scene_print: &str) -> Fingerprint {
        Fingerprint::new()
            .add(FORMAT_VERSION.as_bytes())
            .add(self.options.build.as_bytes())
            .add(scene_print.as_bytes())
            .add(fingerprint::camera_fingerprint(&subject.camera).as_bytes())
    }

    fn reference_name(&self, place: &SettingContext<'_>) -> String {
        let SettingContext { subject, setting, .. } = place;
        let print = self.picture_fingerprint(place).add(&setting.reference_spp.to_le_bytes()).hex_name();
        let focus = subject.focuses[setting.focus].name;
        format!("{}-{focus}-reference-{print}", file_name_part(&subject.name))
    }

    fn measurement_name(&self, place: &SettingContext<'_>, contender: Contender) -> String {
        let SettingContext { subject, setting, .. } = place;
        let (renderer, value) = (contender.renderer(), contender.knob_value());
        let print = self
            .picture_fingerprint(place)
            .add(&setting.reference_spp.to_le_bytes())
            .add(&setting.cuts.to_le_bytes())
            .add(renderer.as_bytes())
            .add(contender.knob_name().as_bytes())
            .add(&value.to_le_bytes())
            .add(&(rayon::current_num_threads() as u64).to_le_bytes())
            .hex_name();
        let focus = subject.focuses[setting.focus].name;
        file_name_part(&format!("{}-{focus}-{renderer}-{value}-{print}", subject.name))
    }

    /// Fingerprint of the drawn picture.
    fn picture_fingerprint(&self, place: &SettingContext<'_>) -> Fingerprint {
        Fingerprint::new()
            .add(FORMAT_VERSION.as_bytes())
            .add(self.options.build.as_bytes())
            .add(place.scene_print.as_bytes())
            .add(fingerprint::camera_fingerprint(&place.setting.camera).as_bytes())
            .add(place.focus_print.as_bytes())
    }
}

/// Lets several steps share one progress bar; each takes a fixed share of the rest.
struct SharedBar<'a> {
    bar: &'a dyn Progress,
    furthest_fraction: Mutex<f32>,
}

/// The share of the rest that a step takes.
const STEP_SHARE: f32 = 0.6;

impl Steps for SharedBar<'_> {
    fn begin(&self, _label: &str) -> Box<dyn Progress + '_> {
        let mut furthest = self.furthest_fraction.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let start = *furthest;
        *furthest += (1.0 - start) * STEP_SHARE;
        Box::new(progress::Stage::new(self.bar, start, *furthest))
    }
}
