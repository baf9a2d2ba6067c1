//! Extensions of SPZ: records of type, length and content.

use super::super::bytes::Bytes;
use super::super::reading::Reading;
use crate::cloud::Axes;
use crate::cloud::Toward::{Back, Down, Forward, Left, Right, Up};

/// What the extensions of a file say.
pub(super) struct Extensions {
    pub axes: Axes,
}

/// The axes in which the numbers are stored (Adobe).
const COORDINATE_SYSTEM: u32 = 0xADBE_0003;
/// Limits for orbiting (Adobe): not needed here.
const ORBIT_LIMITS: u32 = 0xADBE_0002;

/// Reads the records; those that are malformed or unknown are ignored, with a warning.
pub(super) fn read(reading: &mut Reading<'_>, is_declared: bool, records: &[u8]) -> Extensions {
    let mut extensions = Extensions { axes: Axes::RIGHT_UP_BACK };
    let mut bytes = Bytes::new(if is_declared { records } else { &[] });
    let mut unknown = None;
    while !bytes.rest().is_empty() {
        let mut record = || Some((bytes.u32()?, bytes.u32()?));
        let Some((kind, content)) =
            record().and_then(|(kind, length)| Some((kind, bytes.take(length.into())?)))
        else {
            reading.warn(
                "its extensions are cut",
                "axes may be wrong: choose them if the scene lies on its side",
            );
            break;
        };
        match (kind, Bytes::new(content).u32().and_then(axes_of)) {
            (COORDINATE_SYSTEM, Some(axes)) => extensions.axes = axes,
            (COORDINATE_SYSTEM, None) => {
                reading.warn(
                    "its axes are none of SPZ's",
                    "right, up, back are assumed: choose others if needed",
                );
            }
            (ORBIT_LIMITS, _) => {}
            _ => unknown = Some(kind),
        }
    }
    if let Some(kind) = unknown {
        let cure = "it is ignored; export the file without extensions if it looks wrong";
        reading.warn(&format!("has the unknown extension {kind:#010x}"), cure);
    }
    extensions
}

/// The axes that a number stands for: three bits that say right, up and back, and one that exchanges the last two.
fn axes_of(number: u32) -> Option<Axes> {
    if number == 0 {
        return Some(Axes::RIGHT_UP_BACK);
    }
    let bits = number.checked_sub(1).filter(|bits| *bits < 16)?;
    let bit = |k: u32| bits >> k & 1 == 1;
    let x = if bit(0) { Right } else { Left };
    let depth = |plain, set| if bit(2) { set } else { plain };
    let vertical = if bit(1) { Up } else { Down };
    Some(Axes(if bits < 8 {
        [x, vertical, depth(Back, Forward)]
    } else {
        [x, depth(Forward, Back), vertical]
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_axes() {
        assert_eq!(axes_of(4), Some(Axes::RIGHT_UP_BACK));
        assert_eq!(axes_of(6), Some(Axes::RIGHT_DOWN_FORWARD));
        assert_eq!(axes_of(1), Some(Axes([Left, Down, Back])));
        assert_eq!(axes_of(8), Some(Axes([Right, Up, Forward])));
        assert_eq!(axes_of(12), Some(Axes([Right, Forward, Up])));
        assert_eq!(axes_of(13), Some(Axes([Left, Back, Down])));
        assert_eq!((axes_of(0), axes_of(17)), (Some(Axes::RIGHT_UP_BACK), None));
    }
}
