//! Pictures as WebP, as small as a given error allows.

use crate::error::WebPageError;
use crate::screen_picture::ScreenPicture;
use numerics::mean_square_of_psnr;
use webp::{Decoder, Encoder, WebPConfig};

/// A picture as WebP.
#[derive(Clone, Debug)]
pub struct EncodedPicture {
    /// The file.
    pub webp: Vec<u8>,
    /// PSNR of what a browser decodes, dB; 200 if it is equal.
    pub psnr: f64,
    /// libwebp's quality, 1 to 100; one more: nearly lossless; two more: lossless.
    pub quality: u8,
    /// What a browser decodes.
    pub(crate) decoded: ScreenPicture,
}

/// The range of libwebp's lossy quality.
const MIN_QUALITY: u8 = 1;
const MAX_QUALITY: u8 = 100;
/// Not lossy: the few lowest bits of noise are flattened, but colours keep their resolution.
const NEARLY_LOSSLESS: u8 = MAX_QUALITY + 1;
const LOSSLESS: u8 = MAX_QUALITY + 2;
/// libwebp's level for it, from 100 (lossless) to 0 by 20.
const NEARLY_LOSSLESS_LEVEL: i32 = 40;

/// The first quality that is tried for a picture without a neighbour.
pub const USUAL_QUALITY: u8 = 75;

/// Encodes with the lowest quality whose PSNR is at least `min_psnr`, dB. The search starts at `first_quality`, that of a similar picture.
/// Small pictures with saturated colours often need more than the best lossy one, which halves the resolution of colours.
///
/// # Errors
/// [`WebPageError::Encoder`]: libwebp refuses the picture.
pub fn encode_picture(
    picture: &ScreenPicture,
    min_psnr: f64,
    first_quality: u8,
) -> Result<EncodedPicture, WebPageError> {
    encode_upon(None, picture, min_psnr, first_quality)
}

/// The same of the [difference](ScreenPicture::difference_from) of a picture from `base`, which the browser has. What it decodes is the sum. Where
/// they differ too much for that, the PSNR is lower than asked. Blocks of `base` that are good enough are kept, like those that a video skips:
/// what they cost serves blocks that change (the demo: a twentieth less).
///
/// # Errors
/// [`WebPageError::Encoder`]: libwebp refuses the picture.
pub(crate) fn encode_difference(
    picture: &ScreenPicture,
    base: &ScreenPicture,
    min_psnr: f64,
    first_quality: u8,
) -> Result<EncodedPicture, WebPageError> {
    encode_upon(Some(base), picture, min_psnr, first_quality)
}

fn encode_upon(
    base: Option<&ScreenPicture>,
    picture: &ScreenPicture,
    min_psnr: f64,
    first_quality: u8,
) -> Result<EncodedPicture, WebPageError> {
    let difference =
        base.map(|base| picture.with_blocks_of(base, mean_square_of_psnr(min_psnr)).difference_from(base));
    let encode = |quality: u8| {
        let encoded = encode(difference.as_ref().unwrap_or(picture), quality)?;
        let Some(base) = base else { return Ok(encoded) };
        let decoded = base.plus_difference(&encoded.decoded);
        Ok(EncodedPicture { psnr: decoded.psnr(picture), decoded, ..encoded })
    };
    let (mut failing, mut passing) = (MIN_QUALITY - 1, NEARLY_LOSSLESS);
    let (mut quality, mut step) = (first_quality.clamp(MIN_QUALITY, MAX_QUALITY), 1);
    let mut smallest = None;
    while passing - failing > 1 {
        let encoded = encode(quality)?;
        if encoded.psnr >= min_psnr {
            passing = quality;
            smallest = Some(encoded);
        } else {
            failing = quality;
        }
        quality = if passing == NEARLY_LOSSLESS {
            quality.saturating_add(step).min(MAX_QUALITY)
        } else if failing < MIN_QUALITY {
            quality.saturating_sub(step).max(MIN_QUALITY)
        } else {
            failing.midpoint(passing)
        };
        step = step.saturating_mul(2);
    }
    if let Some(smallest) = smallest {
        return Ok(smallest);
    }
    let nearly_lossless = encode(NEARLY_LOSSLESS)?;
    if nearly_lossless.psnr >= min_psnr { Ok(nearly_lossless) } else { encode(LOSSLESS) }
}

fn encode(picture: &ScreenPicture, quality: u8) -> Result<EncodedPicture, WebPageError> {
    let failed = |what: String| WebPageError::Encoder(what);
    let mut config =
        WebPConfig::new().map_err(|()| failed("libwebp is of another version than its header".into()))?;
    config.quality = f32::from(quality.min(MAX_QUALITY));
    // For the lowest error at a size: a thorough search, no texture hidden where eyes would not miss it, colours filtered. The filter that
    // libwebp finds by itself saves 2 % of this one, for five times the time.
    config.method = 6;
    config.sns_strength = 0;
    config.filter_strength = 40;
    config.filter_sharpness = 3;
    config.use_sharp_yuv = 1;
    if quality > MAX_QUALITY {
        config.lossless = 1;
        config.near_lossless = if quality == LOSSLESS { 100 } else { NEARLY_LOSSLESS_LEVEL };
        // The effort.
        config.quality = 75.0;
    }
    let [width, height] = picture.size();
    let encoder = Encoder::from_rgb(picture.pixels().as_flattened(), width, height);
    let webp = encoder.encode_advanced(&config).map_err(|error| failed(format!("{error:?}")))?.to_vec();
    let image = Decoder::new(&webp).decode().ok_or_else(|| failed("it cannot be read back".into()))?;
    let pixels = image.as_chunks::<3>().0.to_vec();
    let decoded = ScreenPicture::new([image.width(), image.height()], pixels)?;
    Ok(EncodedPicture { psnr: decoded.psnr(picture), webp, quality, decoded })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Waves of colours with some grain.
    fn waves() -> ScreenPicture {
        let wave = |x: u32, y: u32, k: u32| {
            let phase = f64::from(x * (k + 1) + y * 2) * 0.11;
            (120.0 + 90.0 * phase.sin() + f64::from((x * 7 + y * 13 + k * 5) % 11)) as u8
        };
        let pixel = |k: u32| std::array::from_fn(|c| wave(k % 80, k / 80, c as u32));
        ScreenPicture::new([80, 48], (0..80 * 48).map(pixel).collect()).unwrap()
    }

    #[test]
    fn the_lowest_quality_that_is_good_enough_is_found_from_anywhere() {
        let picture = waves();
        for min_psnr in [30.0, 38.0] {
            let encoded = encode_picture(&picture, min_psnr, 75).unwrap();
            assert!(encoded.psnr >= min_psnr && encoded.quality > 1, "{min_psnr}: {}", encoded.quality);
            assert!(encode(&picture, encoded.quality - 1).unwrap().psnr < min_psnr);
            assert_eq!(encoded.psnr, encoded.decoded.psnr(&picture));
            for first_quality in [0, 20, 100, 255] {
                let again = encode_picture(&picture, min_psnr, first_quality).unwrap();
                // PSNR does not rise with every step of quality.
                let larger = again.webp.len() as f64 / encoded.webp.len() as f64;
                assert!(again.psnr >= min_psnr && (0.85..1.15).contains(&larger), "{larger}");
            }
        }
    }

    #[test]
    fn a_difference_takes_less_and_is_as_good() {
        let picture = waves();
        let brighter = picture.pixels().iter().map(|color| color.map(|level| level + 9)).collect();
        let base = encode_picture(&ScreenPicture::new(picture.size(), brighter).unwrap(), 38.0, 75).unwrap();
        let whole = encode_picture(&picture, 38.0, 75).unwrap();
        let difference = encode_difference(&picture, &base.decoded, 38.0, 75).unwrap();
        assert!(difference.psnr >= 38.0 && difference.webp.len() < whole.webp.len() / 2);
        assert_eq!(difference.decoded.psnr(&picture), difference.psnr);
        let black = ScreenPicture::new([80, 48], vec![[0; 3]; 80 * 48]).unwrap();
        let far = encode_difference(&picture, &black, 38.0, 75).unwrap();
        assert!(far.psnr < 38.0, "too far for a difference");
    }

    #[test]
    fn what_no_quality_reaches_is_lossless() {
        // Red and blue pixels side by side are lost where colours have half the resolution.
        let pixel = |k: u32| {
            let [bright, dark] = [150 + k % 64 + k * k / 7 % 13, k / 64].map(|level| level as u8);
            if (k + k / 64).is_multiple_of(2) { [bright, dark, 0] } else { [0, dark, bright] }
        };
        let picture = ScreenPicture::new([64, 64], (0..64 * 64).map(pixel).collect()).unwrap();
        assert!(encode(&picture, MAX_QUALITY).unwrap().psnr < 20.0);
        let nearly = encode_picture(&picture, 40.0, 75).unwrap();
        assert_eq!(nearly.quality, NEARLY_LOSSLESS);
        assert!((40.0..200.0).contains(&nearly.psnr), "{}", nearly.psnr);
        let equal = encode_picture(&picture, 100.0, 75).unwrap();
        assert_eq!((equal.quality, equal.psnr, &equal.decoded), (LOSSLESS, 200.0, &picture));
        assert!(equal.webp.len() > nearly.webp.len());
    }
}
