//! Agisoft Metashape's (PhotoScan's) cameras as XML: File ▸ Export ▸ Export Cameras.
//!
//! ```text
//! x' = x(1 + K₁r² + K₂r⁴ + K₃r⁶ + K₄r⁸) + (P₁(r² + 2x²) + 2P₂xy)(1 + P₃r² + P₄r⁴)        y' likewise
//! u = w/2 + cx + f·x' + B₁x' + B₂y'        v = h/2 + cy + f·y'
//! ```
//!
//! (Metashape Pro's manual, appendix D; the centre of the upper left pixel is (0.5, 0.5).) A camera's matrix maps from its axes (computer
//! vision's) to its chunk's, and that of the chunk, or of its component, to the world, in which meshes are exported, too. A camera without
//! a matrix may be the slave of a `rig`.

mod elements;
mod rig;

use crate::CaptureError;
use crate::cameras::pose::{Axes, from_camera_to_world};
use crate::cameras::shot::{Shot, ShotLens, Shots};
use crate::files::text::quoted;
use elements::{below, child, values};
use glam::{DMat3, DMat4, DVec3};
use lens::{CalibratedLens, Distortion, Intrinsics, Projection};
use rig::{Rigs, sensor_to_rig};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashMap;
use std::path::Path;

/// The largest file, and the most elements: parsed, each takes some hundred bytes.
const MAX_BYTES: u64 = 32 << 20;
const MAX_NODES: u32 = 2_000_000;
/// The most attributes of an element: the parser compares each with each.
const MAX_ATTRIBUTES: usize = 1000;

/// Reads the pictures of a file's first chunk that has any.
pub(crate) fn read(file: &Path) -> Result<Shots, CaptureError> {
    let unreadable = |source| CaptureError::unreadable(file, source);
    let size = std::fs::metadata(file).map_err(unreadable)?.len();
    if size > MAX_BYTES {
        let what = format!("has {} MiB, the limit is {} MiB", size >> 20, MAX_BYTES >> 20);
        return Err(CaptureError::TooBig { file: file.into(), what });
    }
    let bytes = std::fs::read(file).map_err(unreadable)?;
    let text = String::from_utf8_lossy(&bytes);
    let text = text.trim_start_matches('\u{feff}');
    // An element's tag ends before the next begins.
    if text.split('<').any(|tag| tag.bytes().filter(|byte| *byte == b'=').count() > MAX_ATTRIBUTES) {
        let what = format!("has an element of more than {MAX_ATTRIBUTES} attributes");
        return Err(CaptureError::TooBig { file: file.into(), what });
    }
    let options = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        CaptureError::malformed(
            file,
            format!("line {}", error.pos().row),
            format!("its XML is invalid: {error}"),
        )
    })?;
    let reader = Reader { file, document: &document };
    let chunks: Vec<_> =
        document.root_element().children().filter(|node| node.has_tag_name("chunk")).collect();
    for chunk in &chunks {
        let mut shots = reader.chunk(*chunk)?;
        if !shots.shots.is_empty() {
            if chunks.len() > 1 {
                shots.notes.push(format!("has {} chunks; the first with cameras is read", chunks.len()));
            }
            return Ok(shots);
        }
    }
    Err(CaptureError::malformed(file, "document", "no chunk has an aligned camera"))
}

struct Reader<'a> {
    file: &'a Path,
    document: &'a Document<'a>,
}

impl Reader<'_> {
    fn malformed(&self, node: Node<'_, '_>, what: impl ToString) -> CaptureError {
        let place = format!("line {}", self.document.text_pos_at(node.range().start).row);
        CaptureError::malformed(self.file, place, what)
    }

    fn chunk(&self, chunk: Node<'_, '_>) -> Result<Shots, CaptureError> {
        let mut sensors = HashMap::new();
        for node in below(chunk, "sensors").filter(|node| node.has_tag_name("sensor")) {
            if let Some(id) = node.attribute("id") {
                sensors.insert(id, node);
            }
        }
        let of_chunk = child(chunk, "transform").map(|node| self.transform(node)).transpose()?;
        let mut components = HashMap::new();
        for node in below(chunk, "components").filter(|node| node.has_tag_name("component")) {
            if let (Some(id), Some(transform)) = (node.attribute("id"), child(node, "transform")) {
                components.insert(id, self.transform(transform)?);
            }
        }
        let mut lenses = HashMap::new();
        let mut shots = Shots::default();
        // Cameras may be in groups.
        let cameras: Vec<_> = below(chunk, "cameras").filter(|node| node.has_tag_name("camera")).collect();
        let rigs = Rigs::new(cameras.iter().copied());
        let mut without_master = 0;
        for &camera in &cameras {
            let label = camera.attribute("label").unwrap_or_default();
            let is_enabled = !matches!(camera.attribute("enabled"), Some("0" | "false"));
            let posed = rigs.posed(camera).filter(|_| is_enabled);
            let Some((posed, transform)) = posed.and_then(|posed| Some((posed, child(posed, "transform")?)))
            else {
                without_master += usize::from(is_enabled && Rigs::is_slave(camera));
                shots.without_camera.push(label.into());
                continue;
            };
            let wrong = |what: &str| self.malformed(camera, format!("camera {}: {what}", quoted(label)));
            if label.is_empty() {
                return Err(wrong("it has no label, which names its picture"));
            }
            let sensor_of = |camera: Node<'_, '_>| {
                let id = camera.attribute("sensor_id").ok_or_else(|| wrong("it has no sensor_id"))?;
                let sensor = sensors.get_key_value(id);
                sensor
                    .map(|(id, sensor)| (*id, *sensor))
                    .ok_or_else(|| wrong("its sensor is not in the file"))
            };
            let (id, sensor) = sensor_of(camera)?;
            let lens = match lenses.get(id) {
                Some(lens) => *lens,
                None => {
                    let lens = self.lens(sensor)?;
                    lenses.insert(id, lens);
                    lens
                }
            };
            let rows: [f64; 16] =
                values(transform).ok_or_else(|| wrong("its transform is not 16 numbers"))?;
            let mut to_chunk = DMat4::from_cols_array(&rows).transpose();
            if posed != camera {
                let to_rig = |sensor| {
                    sensor_to_rig(sensor).map_err(|what| self.malformed(sensor, of_sensor(sensor, what)))
                };
                to_chunk = to_chunk * to_rig(sensor_of(posed)?.1)?.inverse() * to_rig(sensor)?;
            }
            let component = [camera, posed].into_iter().find_map(|camera| camera.attribute("component_id"));
            let of_component = component.and_then(|id| components.get(id)).copied();
            let to_world = of_chunk.or(of_component).unwrap_or(DMat4::IDENTITY);
            let pose = from_camera_to_world(to_world * to_chunk, Axes::Vision);
            let camera_to_world = pose.ok_or_else(|| wrong("its transform is not a rigid motion"))?;
            let place = format!("camera {}", quoted(label));
            let lens = ShotLens::Calibrated(lens);
            shots.shots.push(Shot { name: label.into(), place, lens, camera_to_world, mask: None });
        }
        if without_master > 0 {
            let of_rig = if without_master == 1 { "slave of a rig has" } else { "slaves of a rig have" };
            shots.notes.push(format!(
                "{without_master} {of_rig} no pose, because the master is not aligned (align it and export the cameras again)"
            ));
        }
        Ok(shots)
    }

    /// A rotation (9 numbers), a translation and a scale.
    fn transform(&self, node: Node<'_, '_>) -> Result<DMat4, CaptureError> {
        let wrong = |what: &str| self.malformed(node, what);
        let rotation: [f64; 9] = match child(node, "rotation") {
            Some(node) => values(node).ok_or_else(|| wrong("its rotation is not 9 numbers"))?,
            None => DMat3::IDENTITY.to_cols_array(),
        };
        let translation: [f64; 3] = match child(node, "translation") {
            Some(node) => values(node).ok_or_else(|| wrong("its translation is not 3 numbers"))?,
            None => [0.0; 3],
        };
        let scale = match child(node, "scale") {
            Some(node) => values(node).filter(|[scale]| *scale > 0.0),
            None => Some([1.0]),
        };
        let [scale] = scale.ok_or_else(|| wrong("its scale is not a number above 0"))?;
        let rotation = DMat3::from_cols_array(&rotation).transpose();
        Ok(DMat4::from_mat3_translation(rotation * scale, DVec3::from(translation)))
    }

    fn lens(&self, sensor: Node<'_, '_>) -> Result<CalibratedLens, CaptureError> {
        let wrong = |what: &str| self.malformed(sensor, of_sensor(sensor, what));
        // The adjusted calibration comes last.
        let calibration = sensor.children().rev().find(|node| node.has_tag_name("calibration"));
        let calibration = calibration.ok_or_else(|| wrong("it has no calibration"))?;
        let resolution = child(calibration, "resolution").or_else(|| child(sensor, "resolution"));
        let side = |name: &str| resolution?.attribute(name)?.parse::<u32>().ok();
        let size = side("width").zip(side("height"));
        let (width, height) = size.ok_or_else(|| wrong("its resolution has no width and height"))?;
        let term = |name: &str| match child(calibration, name) {
            None => Ok(None),
            Some(node) => match values(node) {
                Some([value]) => Ok(Some(value)),
                None => Err(wrong(&format!("its {name} is not a number"))),
            },
        };
        let or_zero = |name: &str| term(name).map(Option::unwrap_or_default);
        let kind = sensor.attribute("type").or_else(|| calibration.attribute("type")).unwrap_or("frame");
        let projection = match kind {
            "frame" => Projection::Perspective,
            "fisheye" | "equidistant_fisheye" => Projection::Equidistant,
            "spherical" => {
                let lens = CalibratedLens::panorama([width, height]);
                return lens.map_err(|error| wrong(&error.to_string()));
            }
            _ => return Err(wrong(&format!("cameras of type {} are not supported", quoted(kind)))),
        };
        // Versions before 1.2 have fx and fy.
        let (focal_x, focal_y) = match (term("f")?, term("fx")?, term("fy")?) {
            (Some(focal), ..) => (focal + or_zero("b1")?, focal),
            (None, Some(focal_x), Some(focal_y)) => (focal_x, focal_y),
            _ => return Err(wrong("its calibration has no f")),
        };
        // Metashape's is an offset from the middle, except in old files, which have it from the corner.
        let is_old = child(calibration, "f").is_none();
        let middle = [width, height].map(|side| if is_old { 0.0 } else { 0.5 * f64::from(side) });
        let intrinsics = Intrinsics {
            size_px: [width, height],
            focal_px: [focal_x, focal_y],
            skew_px: if is_old { or_zero("skew")? } else { or_zero("b2")? },
            principal_px: [middle[0] + or_zero("cx")?, middle[1] + or_zero("cy")?],
        };
        let radial = [or_zero("k1")?, or_zero("k2")?, or_zero("k3")?, or_zero("k4")?];
        let distortion = Distortion {
            // Metashape's P₁ is OpenCV's p₂.
            tangential: [or_zero("p2")?, or_zero("p1")?],
            tangential_growth: [or_zero("p3")?, or_zero("p4")?],
            ..Distortion::radial(&radial)
        };
        CalibratedLens::new(intrinsics, projection, distortion).map_err(|error| wrong(&error.to_string()))
    }
}

/// A sentence about a sensor.
fn of_sensor(sensor: Node<'_, '_>, what: &str) -> String {
    format!("sensor {}: {what}", quoted(sensor.attribute("label").unwrap_or_default()))
}
