//! The EXIF data of a picture: orientation, exposure and focal length.

use ::exif::{In, Reader, Tag, Value};

/// The EXIF data that is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Exif {
    /// 1 to 8.
    pub orientation: u8,
    /// log₂(t·S/N²): exposure time in s, ISO speed, f-number.
    pub exposure: Option<f64>,
    /// The focal length that has the same angle of view on a film of 36 × 24 mm, mm.
    pub focal_length_35mm: Option<f64>,
}

impl Default for Exif {
    fn default() -> Self {
        Self { orientation: 1, exposure: None, focal_length_35mm: None }
    }
}

impl Exif {
    /// Parses the raw data, a TIFF structure; fields that cannot be read are missing.
    pub fn parse(data: &[u8]) -> Self {
        let data = data.strip_prefix(b"Exif\0\0").unwrap_or(data);
        let Ok(exif) = Reader::new().read_raw(data.to_vec()) else { return Self::default() };
        let value = |tag| exif.get_field(tag, In::PRIMARY).map(|field| &field.value);
        let number = |tag| {
            let number = match value(tag)? {
                Value::Rational(values) => values.first()?.to_f64(),
                value => f64::from(value.get_uint(0)?),
            };
            (number > 0.0 && number.is_finite()).then_some(number)
        };
        let orientation = value(Tag::Orientation).and_then(|value| value.get_uint(0));
        let orientation = orientation.filter(|orientation| (1..=8).contains(orientation)).unwrap_or(1) as u8;
        let speed = number(Tag::PhotographicSensitivity).or_else(|| number(Tag::ISOSpeed));
        let exposure = match (number(Tag::ExposureTime), speed, number(Tag::FNumber)) {
            (Some(time), Some(speed), Some(f_number)) => Some((time * speed / (f_number * f_number)).log2()),
            _ => None,
        };
        Self { orientation, exposure, focal_length_35mm: number(Tag::FocalLengthIn35mmFilm) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A TIFF structure with an orientation, and 1/125 s at ISO 200 and f/8 in its EXIF directory.
    fn data() -> Vec<u8> {
        let entry = |tag: u16, kind: u16, value: u32| {
            [&tag.to_le_bytes()[..], &kind.to_le_bytes(), &1u32.to_le_bytes(), &value.to_le_bytes()].concat()
        };
        let (short, long, rational) = (3, 4, 5);
        let mut data = b"II*\0\x08\0\0\0".to_vec();
        data.extend(
            [&2u16.to_le_bytes()[..], &entry(0x0112, short, 6), &entry(0x8769, long, 38), &[0; 4]].concat(),
        );
        data.extend(3u16.to_le_bytes());
        data.extend(
            [entry(0x829A, rational, 80), entry(0x829D, rational, 88), entry(0x8827, short, 200)].concat(),
        );
        data.extend([0; 4]);
        [1u32, 125, 8, 1].into_iter().for_each(|number| data.extend(number.to_le_bytes()));
        data
    }

    #[test]
    fn orientation_and_exposure() {
        let exif = Exif::parse(&data());
        assert_eq!(exif.orientation, 6);
        let expected = (200.0f64 / 125.0 / 64.0).log2();
        assert!((exif.exposure.unwrap() - expected).abs() < 1e-12, "{exif:?}");
    }

    #[test]
    fn what_is_broken_is_not_there() {
        let whole = data();
        for end in 0..whole.len() {
            let exif = Exif::parse(&whole[..end]);
            assert!(exif.exposure.is_none() || end > 88, "{end}");
        }
        assert_eq!(Exif::parse(b"nonsense"), Exif::default());
    }
}
