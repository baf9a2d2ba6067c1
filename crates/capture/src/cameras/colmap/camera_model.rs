//! COLMAP's camera models (its `sensor/models.h`, all that its documentation lists): names, numbers and the order of their parameters.

use lens::{CalibratedLens, Distortion, Intrinsics, Projection};

/// Every model: its name and its number of parameters. Its index is its number in binary files.
const MODELS: [(&str, usize); 18] = [
    ("SIMPLE_PINHOLE", 3),
    ("PINHOLE", 4),
    ("SIMPLE_RADIAL", 4),
    ("RADIAL", 5),
    ("OPENCV", 8),
    ("OPENCV_FISHEYE", 8),
    ("FULL_OPENCV", 12),
    ("FOV", 5),
    ("SIMPLE_RADIAL_FISHEYE", 4),
    ("RADIAL_FISHEYE", 5),
    ("THIN_PRISM_FISHEYE", 12),
    ("RAD_TAN_THIN_PRISM_FISHEYE", 16),
    ("SIMPLE_DIVISION", 4),
    ("DIVISION", 5),
    ("SIMPLE_FISHEYE", 3),
    ("FISHEYE", 4),
    ("EUCM", 6),
    ("EQUIRECTANGULAR", 2),
];

/// The model of a number in binary files: its name and its number of parameters.
pub(super) fn from_number(number: i32) -> Option<(&'static str, usize)> {
    MODELS.get(usize::try_from(number).ok()?).copied()
}

/// The lens of a model's parameters.
///
/// # Errors
/// What is wrong with them.
pub(super) fn lens(model: &str, size_px: [u32; 2], parameters: &[f64]) -> Result<CalibratedLens, String> {
    let Some(&(model, count)) = MODELS.iter().find(|(name, _)| *name == model) else {
        return Err(format!("the camera model {} is not supported", crate::files::text::quoted(model)));
    };
    if parameters.len() != count {
        return Err(format!("{model} has {count} parameters, not {}", parameters.len()));
    }
    if model == "EQUIRECTANGULAR" {
        return CalibratedLens::panorama(size_px).map_err(|error| error.to_string());
    }
    // One focal length or two, the principal point, and the rest.
    let is_simple = matches!(
        model,
        "SIMPLE_PINHOLE"
            | "SIMPLE_RADIAL"
            | "RADIAL"
            | "SIMPLE_RADIAL_FISHEYE"
            | "RADIAL_FISHEYE"
            | "SIMPLE_DIVISION"
            | "SIMPLE_FISHEYE"
    );
    let (focal, rest) = parameters.split_at(if is_simple { 1 } else { 2 });
    let (principal, rest) = rest.split_at(2);
    let intrinsics = Intrinsics {
        size_px,
        focal_px: [focal[0], focal[focal.len() - 1]],
        skew_px: 0.0,
        principal_px: [principal[0], principal[1]],
    };
    let (projection, distortion) = projection_and_distortion(model, rest);
    CalibratedLens::new(intrinsics, projection, distortion).map_err(|error| error.to_string())
}

/// The projection and distortion of a model's parameters after the principal point.
fn projection_and_distortion(model: &str, rest: &[f64]) -> (Projection, Distortion) {
    use Projection::{Division, EnhancedUnified, Equidistant, FieldOfView, Perspective};
    let none = Distortion::default();
    match (model, rest) {
        ("FOV", &[omega]) => (FieldOfView { omega: omega.abs() }, none),
        ("SIMPLE_DIVISION" | "DIVISION", &[k]) => (Division { k }, none),
        ("EUCM", &[alpha, beta]) => (EnhancedUnified { alpha, beta }, none),
        ("OPENCV", &[k1, k2, p1, p2]) => {
            (Perspective, Distortion { tangential: [p1, p2], ..Distortion::radial(&[k1, k2]) })
        }
        ("FULL_OPENCV", &[k1, k2, p1, p2, k3, k4, k5, k6]) => {
            let radial = Distortion::radial(&[k1, k2, k3]);
            (Perspective, Distortion { radial_denominator: [k4, k5, k6], tangential: [p1, p2], ..radial })
        }
        ("THIN_PRISM_FISHEYE", &[k1, k2, p1, p2, k3, k4, sx1, sy1]) => {
            let radial = Distortion::radial(&[k1, k2, k3, k4]);
            (Equidistant, Distortion { tangential: [p1, p2], prism: [sx1, 0.0, sy1, 0.0], ..radial })
        }
        ("RAD_TAN_THIN_PRISM_FISHEYE", &[k0, k1, k2, k3, k4, k5, p0, p1, s0, s1, s2, s3]) => {
            let radial = Distortion::radial(&[k0, k1, k2, k3, k4, k5]);
            // Aria's p₀ is OpenCV's p₂.
            let (tangential, prism) = ([p1, p0], [s0, s1, s2, s3]);
            (Equidistant, Distortion { tangential, prism, radial_first: true, ..radial })
        }
        ("SIMPLE_RADIAL_FISHEYE" | "RADIAL_FISHEYE" | "OPENCV_FISHEYE" | "SIMPLE_FISHEYE" | "FISHEYE", _) => {
            (Equidistant, Distortion::radial(rest))
        }
        // SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL.
        _ => (Perspective, Distortion::radial(rest)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec2, DVec3};

    /// Points in COLMAP's camera axes (y down).
    const POINTS: [DVec3; 3] =
        [DVec3::new(0.1, 0.2, 1.5), DVec3::new(-0.6, 0.35, 1.0), DVec3::new(0.5, -0.4, 0.9)];

    /// A model, its parameters for pictures of 640 × 480 px, and where the points fall.
    type Case = (&'static str, &'static [f64], [[f64; 2]; 3]);

    /// By `pycolmap` 4.2.1's `Camera.img_from_cam`.
    #[rustfmt::skip]
    const BY_COLMAP: [Case; 18] = [
        ("SIMPLE_PINHOLE", &[500.0, 320.0, 240.0], [[353.3333333333333, 306.6666666666667], [20.0, 415.0], [597.7777777777778, 17.77777777777777]]),
        ("PINHOLE", &[500.0, 510.0, 318.0, 243.0], [[351.3333333333333, 311.0], [18.0, 421.5], [595.7777777777778, 16.333333333333343]]),
        ("SIMPLE_RADIAL", &[500.0, 320.0, 240.0, -0.12], [[353.24444444444447, 306.4888888888889], [37.370000000000005, 404.8675], [580.9053497942386, 31.275720164609027]]),
        ("RADIAL", &[500.0, 320.0, 240.0, -0.12, 0.03], [[353.24493827160495, 306.4898765432099], [35.27474374999997, 406.08973281249996], [583.0404409896865, 29.567647208250747]]),
        ("OPENCV", &[500.0, 510.0, 318.0, 243.0, -0.12, 0.03, 0.002, -0.003], [[351.21604938271605, 310.8514074074074], [31.050993750000032, 413.79617746875], [578.8614286440074, 30.033814967230597]]),
        ("OPENCV_FISHEYE", &[300.0, 305.0, 318.0, 243.0, -0.02, 0.01, -0.003, 0.0005], [[337.8451955510739, 283.351897620517], [161.64615633631794, 335.7265156172115], [461.9420705598511, 125.9271159446544]]),
        ("FULL_OPENCV", &[500.0, 510.0, 318.0, 243.0, 0.11, 0.03, 0.002, -0.003, 0.01, 0.2, 0.05, 0.02], [[351.23774301408184, 310.8956624153937], [29.070106981223944, 414.97480509617174], [580.668929817554, 28.55889400961658]]),
        ("FOV", &[400.0, 405.0, 318.0, 243.0, 0.9], [[346.4300003506862, 300.5707507101396], [91.09379285577711, 377.01647859455665], [526.9894583316889, 73.71853875133203]]),
        ("SIMPLE_RADIAL_FISHEYE", &[300.0, 320.0, 240.0, -0.02], [[339.84510096640446, 279.690201932809], [163.83769925153572, 331.0946754366041], [463.75300501462647, 124.9975959882988]]),
        ("RADIAL_FISHEYE", &[300.0, 320.0, 240.0, -0.02, 0.01], [[339.84519617426423, 279.6903923485285], [163.62397583449297, 331.2193474298791], [463.96482066007036, 124.82814347194368]]),
        ("THIN_PRISM_FISHEYE", &[300.0, 305.0, 318.0, 243.0, -0.02, 0.01, 0.002, -0.003, -0.003, 0.0005, 0.004, -0.002], [[337.85439292641854, 283.35724085762195], [161.0692242123849, 336.1342448739466], [461.41325687668996, 126.45052024622419]]),
        ("RAD_TAN_THIN_PRISM_FISHEYE", &[300.0, 305.0, 318.0, 243.0, -0.02, 0.01, -0.003, 0.0005, 0.0002, -0.0001, 0.002, -0.003, 0.004, -0.001, -0.002, 0.0015], [[337.87393293443785, 283.2973958936355], [162.87268892133628, 334.86961263578354], [463.1868620671877, 124.92208841911987]]),
        ("SIMPLE_DIVISION", &[500.0, 320.0, 240.0, -0.2], [[353.186487605389, 306.37297521077795], [44.42744214365547, 400.7506587495343], [574.2238235481204, 36.62094116150365]]),
        ("DIVISION", &[500.0, 510.0, 318.0, 243.0, 0.1], [[351.4077384659607, 311.1517864705598], [1.9330173855800012, 431.05985465557984], [611.471792998766, 3.5270169130070315]]),
        ("SIMPLE_FISHEYE", &[300.0, 320.0, 240.0], [[339.8537963386398, 279.7075926772797], [162.6779855194305, 331.77117511366555], [464.8608641652902, 124.11130866776783]]),
        ("FISHEYE", &[300.0, 305.0, 318.0, 243.0], [[337.8537963386398, 283.36938588856765], [160.6779855194305, 336.30069469889327], [462.8608641652902, 125.17983047889729]]),
        ("EUCM", &[450.0, 455.0, 318.0, 243.0, 0.6, 1.1], [[347.7829106361435, 303.2276637308681], [81.6432330484158, 382.40672272977696], [535.6509002873405, 66.94460510090676]]),
        ("EQUIRECTANGULAR", &[640.0, 480.0], [[326.78057748318287, 260.2080483378401], [264.9533217207582, 284.5484919543782], [371.65262950947044, 183.3817000643882]]),
    ];

    fn test_lens(model: &str, parameters: &[f64]) -> CalibratedLens {
        lens(model, [640, 480], parameters).unwrap()
    }

    #[test]
    fn every_model_projects_as_colmap_does() {
        for (number, (model, parameters, pixels)) in BY_COLMAP.into_iter().enumerate() {
            assert_eq!(from_number(number as i32), Some((model, parameters.len())));
            let lens = test_lens(model, parameters);
            for (point, [x, y]) in POINTS.into_iter().zip(pixels) {
                let projected = lens.project(DVec3::new(point.x, -point.y, point.z)).unwrap();
                assert!(
                    (projected - DVec2::new(x, y)).length() < 1e-9,
                    "{model}: {projected} instead of {x}, {y}"
                );
            }
        }
    }

    #[test]
    fn every_model_projects_back_all_over_the_picture() {
        for (model, parameters, _) in BY_COLMAP {
            let lens = test_lens(model, parameters);
            let mut met = 0;
            for (row, column) in (0..=12).flat_map(|row| (0..=16).map(move |column| (row, column))) {
                let pixel = DVec2::new(40.0 * f64::from(column), 40.0 * f64::from(row));
                let Some(direction) = lens.unproject(pixel) else { continue };
                assert!((direction.length() - 1.0).abs() < 1e-12, "{model}");
                let back =
                    lens.project(direction).unwrap_or_else(|| panic!("{model}: {pixel} at {direction}"));
                // The ends of a panorama are one.
                let is_seam =
                    model == "EQUIRECTANGULAR" && (column == 0 || column == 16 || row == 0 || row == 12);
                assert!((back - pixel).length() < 1e-9 || is_seam, "{model}: {pixel} to {back}");
                met += 1;
            }
            assert_eq!(met, 13 * 17, "{model} inverts in the whole picture");
        }
    }

    #[test]
    fn what_is_no_model_is_refused() {
        let error = |model, parameters: &[f64]| lens(model, [640, 480], parameters).unwrap_err();
        assert!(error("PINHOL", &[1.0]).contains("\"PINHOL\" is not supported"));
        assert_eq!(error("PINHOLE", &[1.0; 3]), "PINHOLE has 4 parameters, not 3");
        assert_eq!(error("PINHOLE", &[0.0; 4]), "camera: focal length must be above 0 and finite");
        assert_eq!(from_number(-1), None);
        assert_eq!(from_number(18), None);
    }
}
