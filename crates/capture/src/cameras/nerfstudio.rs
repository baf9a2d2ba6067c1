//! `transforms.json` of nerfstudio and instant-ngp: poses in OpenGL's axes, one lens for all pictures or one for
//! each.

use crate::CaptureError;
use crate::cameras::pose::{Axes, from_camera_to_world};
use crate::cameras::shot::{Focal, Shot, ShotLens, Shots};
use crate::files::text::quoted;
use glam::{DMat4, DVec3};
use lens::{CalibratedLens, CameraError, Distortion, Intrinsics, Projection};
use serde_json::{Map, Value};
use std::io::Read;
use std::path::Path;

/// The largest file, and the most objects and values in it: parsed, an object takes some 700 bytes, a value 64.
const MAX_BYTES: u64 = 32 << 20;
const MAX_OBJECTS: usize = 200_000;
const MAX_VALUES: usize = 4_000_000;

/// The keys of the lens, of a frame or of the file for all frames.
const LENS_KEYS: [&str; 21] = [
    "camera_model",
    "is_fisheye",
    "fl_x",
    "fl_y",
    "cx",
    "cy",
    "w",
    "h",
    "k1",
    "k2",
    "k3",
    "k4",
    "k5",
    "k6",
    "p1",
    "p2",
    "camera_angle_x",
    "camera_angle_y",
    "x_fov",
    "y_fov",
    "orientation_override",
];
/// Other keys, which are of no use here.
const IGNORED_KEYS: [&str; 24] = [
    "frames",
    "applied_transform",
    "applied_scale",
    "ply_file_path",
    "aabb_scale",
    "scale",
    "offset",
    "aabb",
    "file_path",
    "transform_matrix",
    "mask_path",
    "depth_file_path",
    "colmap_im_id",
    "sharpness",
    "depth_path",
    "time",
    "rolling_shutter",
    "train_filenames",
    "val_filenames",
    "test_filenames",
    "from_na",
    "up",
    "render_aabb",
    "rotation",
];

/// Reads the pictures of a file.
pub(crate) fn read(file: &Path) -> Result<Shots, CaptureError> {
    let root = parsed(file)?;
    let malformed = |place: &str, what: String| CaptureError::malformed(file, place, what);
    let Some(root) = root.as_object() else { return Err(malformed("/", "is not an object".into())) };
    let frames = root.get("frames").and_then(Value::as_array);
    let frames = frames.ok_or_else(|| malformed("/frames", "is not a list of pictures".into()))?;
    let mut shots = Shots::default();
    for (index, frame) in frames.iter().enumerate() {
        let place = format!("/frames/{index}");
        let Some(frame) = frame.as_object() else { return Err(malformed(&place, "is not an object".into())) };
        let Some(name) = frame.get("file_path").and_then(Value::as_str) else {
            return Err(malformed(&format!("{place}/file_path"), "is not the path of a picture".into()));
        };
        let matrix = frame.get("transform_matrix").and_then(matrix);
        let Some(camera_to_world) = matrix.and_then(|matrix| from_camera_to_world(matrix, Axes::Gltf)) else {
            let what = format!(
                "picture {}: is not the matrix of a rigid motion with 4 rows of 4 numbers",
                quoted(name)
            );
            return Err(malformed(&format!("{place}/transform_matrix"), what));
        };
        let lens = Properties { frame, root }.lens();
        let lens = lens.map_err(|what| malformed(&place, format!("picture {}: {what}", quoted(name))))?;
        let mask = frame.get("mask_path").and_then(Value::as_str).map(String::from);
        shots.shots.push(Shot { name: name.into(), place, lens, camera_to_world, mask });
    }
    if root.contains_key("applied_transform") {
        shots.notes.push(
            "its world is that of the program that solved the cameras, moved by applied_transform".into(),
        );
    }
    let is_unknown =
        |key: &&String| !LENS_KEYS.contains(&key.as_str()) && !IGNORED_KEYS.contains(&key.as_str());
    let unknown: Vec<_> = root.keys().filter(is_unknown).take(5).map(|key| quoted(key)).collect();
    if !unknown.is_empty() {
        shots.notes.push(format!("has unknown keys, which are ignored: {}", unknown.join(", ")));
    }
    Ok(shots)
}

fn parsed(file: &Path) -> Result<Value, CaptureError> {
    let unreadable = |source| CaptureError::unreadable(file, source);
    let mut input = std::fs::File::open(file).map_err(unreadable)?;
    let size = input.metadata().map_err(unreadable)?.len();
    if size > MAX_BYTES {
        let what = format!("has {} MiB, the limit is {} MiB", size >> 20, MAX_BYTES >> 20);
        return Err(CaptureError::TooBig { file: file.into(), what });
    }
    let mut bytes = Vec::with_capacity(size as usize);
    (&mut input).take(size).read_to_end(&mut bytes).map_err(unreadable)?;
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&bytes);
    let number = |symbols: &[u8]| text.iter().filter(|byte| symbols.contains(byte)).count();
    if number(b"{") > MAX_OBJECTS || number(b"[,") > MAX_VALUES {
        let what = format!("has more than {MAX_OBJECTS} objects or {MAX_VALUES} values");
        return Err(CaptureError::TooBig { file: file.into(), what });
    }
    serde_json::from_slice(text).map_err(|error| {
        let place = format!("line {}", error.line());
        CaptureError::malformed(file, place, format!("its JSON is invalid: {error}"))
    })
}

/// The motion that was applied to the cameras of a file, with its scale: from the world of the program that solved them.
pub(crate) fn applied_transform(file: &Path) -> Result<Option<DMat4>, CaptureError> {
    let root = parsed(file)?;
    let Some(applied) = root.get("applied_transform").filter(|applied| !applied.is_null()) else {
        return Ok(None);
    };
    let motion = matrix(applied).filter(|motion| motion.determinant().abs() > f64::MIN_POSITIVE);
    let motion = motion.ok_or_else(|| {
        CaptureError::malformed(
            file,
            "/applied_transform",
            "is not an invertible matrix of 3 rows of 4 numbers",
        )
    })?;
    let scale = root.get("applied_scale").and_then(Value::as_f64).filter(|scale| *scale > 0.0).unwrap_or(1.0);
    Ok(Some(DMat4::from_scale(DVec3::splat(scale)) * motion))
}

/// A matrix of 4 rows (or 3), as nested lists or as one.
pub(crate) fn matrix(value: &Value) -> Option<DMat4> {
    let rows = value.as_array()?;
    let mut entries = Vec::with_capacity(16);
    for row in rows.iter().take(16) {
        match row.as_array() {
            Some(row) => entries.extend(row.iter().take(5).map(Value::as_f64)),
            None => entries.push(row.as_f64()),
        }
    }
    let mut entries: Vec<f64> = entries.into_iter().collect::<Option<_>>()?;
    if entries.len() == 12 {
        entries.extend([0.0, 0.0, 0.0, 1.0]);
    }
    let rows: [f64; 16] = entries.try_into().ok()?;
    let is_motion = rows[12..15] == [0.0; 3] && rows[15] == 1.0;
    is_motion.then(|| DMat4::from_cols_array(&rows).transpose())
}

/// The properties of a frame, or else of the file.
struct Properties<'a> {
    frame: &'a Map<String, Value>,
    root: &'a Map<String, Value>,
}

impl Properties<'_> {
    fn value(&self, key: &str) -> Option<&Value> {
        self.frame.get(key).or_else(|| self.root.get(key)).filter(|value| !value.is_null())
    }

    /// A number, or text that is one.
    fn number(&self, key: &str) -> Result<Option<f64>, String> {
        self.number_if(key, |_| true)
    }

    /// The same of the frame, or else of the file, if it is a usable one. Programs write 0 for what they do not know.
    fn number_if(&self, key: &str, is_usable: impl Fn(f64) -> bool) -> Result<Option<f64>, String> {
        for properties in [self.frame, self.root] {
            let Some(value) = properties.get(key).filter(|value| !value.is_null()) else { continue };
            let number = value.as_f64().or_else(|| value.as_str().and_then(crate::files::text::number));
            let number = number.filter(|number| number.is_finite());
            let number = number.ok_or_else(|| format!("{key} is not a number"))?;
            if is_usable(number) {
                return Ok(Some(number));
            }
        }
        Ok(None)
    }

    fn lens(&self) -> Result<ShotLens, String> {
        let (projection, distortion) = self.projection_and_distortion()?;
        let not_0 = |key: &str| self.number_if(key, |number| number != 0.0);
        let size = match (not_0("w")?, not_0("h")?) {
            (Some(width), Some(height)) => {
                let side =
                    |side: f64| (side >= 1.0 && side <= f64::from(u32::MAX)).then_some(side.round() as u32);
                let size = side(width).zip(side(height));
                let (width, height) = size.ok_or("w and h are not numbers of pixels")?;
                Some([width, height])
            }
            _ => None,
        };
        let message = |error: CameraError| error.to_string();
        if projection == Projection::Equirectangular {
            let size = size.ok_or("a panorama needs w and h")?;
            return CalibratedLens::panorama(size).map(ShotLens::Calibrated).map_err(message);
        }
        let [focal_x, focal_y] = [not_0("fl_x")?, not_0("fl_y")?];
        let angle = |key: &str| -> Result<Option<f64>, String> {
            let angle = self.number_if(key, |angle| angle > 0.0 && angle < std::f64::consts::PI)?;
            // Beside a focal length angles are not needed.
            let is_wrong = angle.is_none() && focal_x.or(focal_y).is_none() && not_0(key)?.is_some();
            (!is_wrong).then_some(angle).ok_or_else(|| format!("{key} is not an angle between 0 and π"))
        };
        let [across, down] = [angle("camera_angle_x")?, angle("camera_angle_y")?];
        let principal_px = [not_0("cx")?, not_0("cy")?];
        let unknown = "neither fl_x nor camera_angle_x gives its focal length (0 counts as missing)";
        let Some(size_px) = size else {
            let focal = match (focal_x.or(focal_y), across) {
                (Some(focal), _) => Focal::Pixels([focal_x.unwrap_or(focal), focal_y.unwrap_or(focal)]),
                (None, Some(angle)) => Focal::AngleAcross(angle),
                (None, None) => return Err(unknown.into()),
            };
            return Ok(ShotLens::OfAnySize { focal, principal_px, projection, distortion });
        };
        let [width, height] = size_px.map(f64::from);
        let by_angle = |angle: Option<f64>, side: f64| angle.map(|angle| 0.5 * side / (0.5 * angle).tan());
        let focal_x = focal_x.or(by_angle(across, width)).or(focal_y).or(by_angle(down, height));
        let focal_x = focal_x.ok_or(unknown)?;
        let focal_y = focal_y.or(by_angle(down, height)).unwrap_or(focal_x);
        let [x, y] = principal_px;
        let principal_px = [x.unwrap_or(0.5 * width), y.unwrap_or(0.5 * height)];
        let intrinsics = Intrinsics { size_px, focal_px: [focal_x, focal_y], skew_px: 0.0, principal_px };
        CalibratedLens::new(intrinsics, projection, distortion).map(ShotLens::Calibrated).map_err(message)
    }

    /// Projection and distortion. nerfstudio's `OPENCV` has k₃ and k₄ as further radial terms.
    fn projection_and_distortion(&self) -> Result<(Projection, Distortion), String> {
        let term = |key: &str| self.number(key).map(Option::unwrap_or_default);
        let radial = [term("k1")?, term("k2")?, term("k3")?, term("k4")?];
        let tangential = [term("p1")?, term("p2")?];
        let is_fisheye = self.value("is_fisheye").and_then(Value::as_bool).unwrap_or(false);
        let model = match self.value("camera_model") {
            None if is_fisheye => "OPENCV_FISHEYE",
            None => "OPENCV",
            Some(model) => model.as_str().ok_or("camera_model is not a name")?,
        };
        match model.to_uppercase().as_str() {
            "PINHOLE" | "SIMPLE_PINHOLE" | "PERSPECTIVE" | "SIMPLE_RADIAL" | "RADIAL" | "OPENCV" => {
                Ok((Projection::Perspective, Distortion { tangential, ..Distortion::radial(&radial) }))
            }
            "OPENCV_FISHEYE" | "FISHEYE" | "SIMPLE_RADIAL_FISHEYE" | "RADIAL_FISHEYE" => {
                Ok((Projection::Equidistant, Distortion::radial(&radial)))
            }
            "EQUIRECTANGULAR" => Ok((Projection::Equirectangular, Distortion::default())),
            _ => Err(format!("the camera_model {} is not supported", quoted(model))),
        }
    }
}
