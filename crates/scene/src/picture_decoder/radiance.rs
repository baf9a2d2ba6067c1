//! Pictures of the Radiance format (`.hdr`): RGB with a common exponent.
//!
//! ```text
//! #?RADIANCE                       or #?RGBE, or another program's name
//! FORMAT=32-bit_rle_rgbe           variables and comments, a line each
//!                                  an empty line
//! -Y 512 +X 1024                   512 scanlines from top to bottom, each of 1024 pixels from left to right
//! scanlines
//! ```

mod header;
mod scanlines;

use header::Header;
use image::error::{DecodingError, ImageFormatHint};
use image::{ColorType, ImageDecoder, ImageError, ImageFormat, ImageResult};
use std::io::{BufRead, Read, Seek, SeekFrom};

/// A decoder for the crate `image`. Its pixels are linear RGB.
pub(super) struct RadianceDecoder<R> {
    header: Header,
    /// At the first scanline.
    input: R,
}

impl<R: BufRead + Seek> RadianceDecoder<R> {
    /// Whether the input begins as a Radiance picture does. Its position is unchanged.
    ///
    /// # Errors
    /// The input cannot be read.
    pub fn is_radiance(input: &mut R) -> std::io::Result<bool> {
        let start = input.stream_position()?;
        let mut first = Vec::new();
        input.by_ref().take(2).read_to_end(&mut first)?;
        input.seek(SeekFrom::Start(start))?;
        Ok(first == *b"#?")
    }
}

impl<R: BufRead> RadianceDecoder<R> {
    /// Reads the header; pixels are decoded later.
    ///
    /// # Errors
    /// The input cannot be read, or is no Radiance picture.
    pub fn open(mut input: R) -> ImageResult<Self> {
        let header = Header::read(&mut input)?.map_err(damaged)?;
        Ok(Self { header, input })
    }
}

impl<R: BufRead> ImageDecoder for RadianceDecoder<R> {
    fn dimensions(&self) -> (u32, u32) {
        self.header.size().into()
    }

    fn color_type(&self) -> ColorType {
        ColorType::Rgb32F
    }

    fn read_image(self, buffer: &mut [u8]) -> ImageResult<()> {
        let Self { header, input } = self;
        let mut data = Vec::new();
        input.take(scanlines::max_bytes(&header)).read_to_end(&mut data)?;
        let (pixels, _) = buffer.as_chunks_mut::<12>();
        let width = header.size()[0] as usize;
        let place = |scanline: usize, at: usize, pixel: [u8; 4]| {
            let [x, y] = header.place(scanline, at);
            let channels = rgb(pixel).map(f32::to_ne_bytes);
            pixels[y * width + x].as_chunks_mut::<4>().0.copy_from_slice(&channels);
        };
        scanlines::decode(&data, &header, place).map_err(damaged)
    }

    fn read_image_boxed(self: Box<Self>, buffer: &mut [u8]) -> ImageResult<()> {
        (*self).read_image(buffer)
    }
}

fn damaged(what: String) -> ImageError {
    ImageError::Decoding(DecodingError::new(ImageFormatHint::Exact(ImageFormat::Hdr), what))
}

/// The light of a stored pixel: three mantissas, and an exponent that is 0 for black.
fn rgb([red, green, blue, exponent]: [u8; 4]) -> [f32; 3] {
    if exponent == 0 {
        return [0.0; 3];
    }
    // 2 to this less 128 and the 8 bits of the mantissa, by the bits of a double; the products fit a float exactly.
    let unit = f64::from_bits((u64::from(exponent) + 1023 - 128 - 8) << 52);
    [red, green, blue].map(|mantissa| (f64::from(mantissa) * unit) as f32)
}

#[cfg(test)]
mod tests {
    use crate::open_picture;
    use image::{DynamicImage, Limits};
    use std::io::Cursor;

    /// Four rows of twelve pixels, all different.
    fn pixel(x: usize, y: usize) -> [u8; 4] {
        [128 + 12 * y as u8 + x as u8, 3 * x as u8, 40 * y as u8, 120 + (x / 5) as u8]
    }

    const WIDTH: usize = 12;
    const HEIGHT: usize = 4;

    fn read(file: &[u8]) -> Result<Vec<[f32; 3]>, String> {
        let decode = || DynamicImage::from_decoder(open_picture(Cursor::new(file), Limits::default())?);
        let picture = decode().map_err(|error| error.to_string())?;
        Ok(picture.into_rgb32f().pixels().map(|pixel| pixel.0).collect())
    }

    fn expected() -> Vec<[f32; 3]> {
        let pixels = (0..WIDTH * HEIGHT).map(|k| pixel(k % WIDTH, k / WIDTH));
        pixels.map(|[r, g, b, e]| [r, g, b].map(|c| f32::from(c) * 2f32.powi(i32::from(e) - 136))).collect()
    }

    /// Header and pixels of the picture, uncoded.
    fn flat(head: &str) -> Vec<u8> {
        let pixels = (0..WIDTH * HEIGHT).flat_map(|k| pixel(k % WIDTH, k / WIDTH));
        head.bytes().chain(pixels).collect()
    }

    /// The same, each channel of a scanline by itself, in runs of 1 and pieces as they are.
    fn run_length_coded() -> Vec<u8> {
        let mut file = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 12\n".to_vec();
        for y in 0..HEIGHT {
            file.extend([2, 2, 0, WIDTH as u8]);
            for channel in 0..4 {
                let values: Vec<u8> = (0..WIDTH).map(|x| pixel(x, y)[channel]).collect();
                let mut rest = &values[..];
                while let Some(first) = rest.first() {
                    let run = rest.iter().take_while(|value| *value == first).count();
                    let taken = if run > 1 { run } else { rest.len().min(3) };
                    if run > 1 {
                        file.extend([128 + run as u8, *first]);
                    } else {
                        file.push(taken as u8);
                        file.extend(&rest[..taken]);
                    }
                    rest = &rest[taken..];
                }
            }
        }
        file
    }

    #[test]
    fn headers_as_programs_write_them() {
        for head in [
            "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 12\n",
            "#?RGBE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 12\n",
            "#?AUTOPANO\n# made by a program\n\n-Y 4 +X 12\n",
            "#?RADIANCE\r\nFORMAT=32-bit_rle_rgbe\r\n\r\n-Y 4 +X 12\r\n",
            "#?RADIANCE\noconv a.rad > a.oct\n\tFORMAT = 32-bit_rle_rgbe \nEXPOSURE= 2.0\nEXPOSURE=half\n\
             COLORCORR= 1.0 2.0 3.0\nPIXASPECT=1\nVIEW= -vtv \u{e9}\nGAMMA=1\n\n  -Y  4   +X 12 \n",
        ] {
            assert_eq!(read(&flat(head)).unwrap(), expected(), "{head}");
        }
    }

    #[test]
    fn scanlines_in_any_direction() {
        let at = |x: usize, y: usize| expected()[y * WIDTH + x];
        for (axes, by_columns, left_to_right, top_to_bottom) in [
            ("-Y 4 +X 12", false, true, true),
            ("-Y 4 -X 12", false, false, true),
            ("+Y 4 +X 12", false, true, false),
            ("+Y 4 -X 12", false, false, false),
            ("+X 12 -Y 4", true, true, true),
            ("-X 12 -Y 4", true, false, true),
            ("+X 12 +Y 4", true, true, false),
            ("-X 12 +Y 4", true, false, false),
        ] {
            let mut file = format!("#?RADIANCE\n\n{axes}\n").into_bytes();
            let (count, length) = if by_columns { (WIDTH, HEIGHT) } else { (HEIGHT, WIDTH) };
            for (scanline, k) in (0..count).flat_map(|scanline| (0..length).map(move |k| (scanline, k))) {
                let [x, y] = if by_columns { [scanline, k] } else { [k, scanline] };
                let x = if left_to_right { x } else { WIDTH - 1 - x };
                let y = if top_to_bottom { y } else { HEIGHT - 1 - y };
                file.extend(pixel(x, y));
            }
            let pixels = read(&file).unwrap();
            for (k, pixel) in pixels.iter().enumerate() {
                assert_eq!(*pixel, at(k % WIDTH, k / WIDTH), "{axes}: pixel {k}");
            }
        }
    }

    #[test]
    fn axes_that_are_none() {
        for axes in
            ["\u{fffd}Y 4 +X 12", "*Y 4 +X 12", "Y 4 X 12", "-Y 4 +\u{e9} 12", "-Y 4 +Y 12", "+ 4 - 12"]
        {
            let error = read(&flat(&format!("#?RADIANCE\n\n{axes}\n"))).unwrap_err();
            assert!(error.contains("not like '-Y 512 +X 1024'"), "{axes}: {error}");
        }
    }

    #[test]
    fn either_coding() {
        assert_eq!(read(&run_length_coded()).unwrap(), expected());
        // Runs of whole pixels: 1, 1, 1 and a count, the next such pixel counting 256 times as much.
        let mut file = b"#?RADIANCE\n\n-Y 2 +X 600\n".to_vec();
        file.extend([200, 100, 50, 129, 1, 1, 1, 80, 1, 1, 1, 2, 7, 7, 7, 136, 1, 1, 1, 6]);
        file.extend([10, 20, 30, 136, 1, 1, 1, 87, 1, 1, 1, 2]);
        let pixels = read(&file).unwrap();
        let first = [200.0, 100.0, 50.0].map(|c| c / 128.0);
        assert_eq!(pixels[..593], vec![first; 593]);
        assert_eq!(pixels[593..600], [[7.0; 3]; 7]);
        assert_eq!(pixels[600..], vec![[10.0, 20.0, 30.0]; 600]);
    }

    #[test]
    fn uncoded_pixels_that_look_like_a_coding() {
        for lookalike in [[2, 2, 0, 120], [2, 2, 200, 120], [2, 2, 0, WIDTH as u8], [1, 1, 1, 130]] {
            let mut file = flat("#?RADIANCE\n\n-Y 4 +X 12\n");
            let start = file.len() - WIDTH * HEIGHT * 4;
            for place in [0, WIDTH * 4, WIDTH * 8 + 20] {
                file[start + place..][..4].copy_from_slice(&lookalike);
            }
            let mut pixels = expected();
            let [r, g, b, e] = lookalike;
            for place in [0, WIDTH, WIDTH * 2 + 5] {
                pixels[place] = [r, g, b].map(|c| f32::from(c) * 2f32.powi(i32::from(e) - 136));
            }
            assert_eq!(read(&file).unwrap(), pixels, "{lookalike:?}");
        }
        // Scanlines of fewer than 8 pixels are never coded by channel.
        let mut file = b"#?RADIANCE\n\n-Y 1 +X 4\n".to_vec();
        file.extend([2, 2, 0, 4, 9, 9, 9, 136, 8, 8, 8, 136, 7, 7, 7, 136]);
        assert_eq!(read(&file).unwrap()[1..], [[9.0; 3], [8.0; 3], [7.0; 3]]);
    }

    #[test]
    fn extremes_of_the_exponent() {
        let mut file = b"#?RADIANCE\n\n-Y 1 +X 3\n".to_vec();
        file.extend([255, 128, 1, 255, 255, 128, 0, 1, 255, 255, 255, 0]);
        let brightest = 2f64.powi(119) as f32;
        let darkest = 2f64.powi(-135) as f32;
        assert_eq!(
            read(&file).unwrap(),
            [
                [255.0 * brightest, 128.0 * brightest, brightest],
                [255.0 * darkest, 128.0 * darkest, 0.0],
                [0.0; 3]
            ]
        );
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (file, part) in [
            (&b"#?RADIANCE\n"[..], "ends within its header"),
            (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n", "ends within its header"),
            (b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n1234", "ra_xyze -r"),
            (b"#?RADIANCE\nFORMAT=16-bit\n\n-Y 1 +X 1\n1234", "FORMAT=16-bit"),
            (b"#?RADIANCE\n\n-Y 1 +Y 1\n1234", "-Y 1 +Y 1"),
            (b"#?RADIANCE\n\n1024 512\n", "1024 512"),
            (b"#?RADIANCE\n\n-Y 0 +X 8\n", "-Y 0 +X 8"),
            (b"#?RADIANCE\n\n-Y 99999999999 +X 8\n", "-Y 99999999999 +X 8"),
            (b"#?RADIANCE\n\n-Y 2 +X 1\n1234", "scanline 2 of 2"),
            (b"#?RADIANCE\n\n-Y 1 +X 8\n\x02\x02\x00\x08\x00", "a run of no pixel"),
            (b"#?RADIANCE\n\n-Y 1 +X 8\n\x02\x02\x00\x08\x8a\x01", "beyond its end"),
            (b"#?RADIANCE\n\n-Y 1 +X 8\n\x01\x01\x01\x02", "begins with a run"),
            (b"#?RADIANCE\n\n-Y 1 +X 3\n\x07\x07\x07\x80\x01\x01\x01\x03", "beyond its end"),
        ] {
            let error = read(file).unwrap_err();
            assert!(error.contains(part), "{}: {error}", String::from_utf8_lossy(file));
        }
        let whole = run_length_coded();
        let start = whole.len() - 100;
        for length in start..whole.len() {
            assert!(read(&whole[..length]).is_err(), "cut to {length} bytes");
        }
        // Bytes after the last scanline do no harm.
        assert_eq!(read(&[&whole[..], b"\n"].concat()).unwrap(), expected());
    }

    #[test]
    fn a_header_without_end_is_not_read_to_the_end() {
        let endless = [b"#?RADIANCE\n".to_vec(), b"# comment\n".repeat(1 << 18)].concat();
        assert!(read(&endless).unwrap_err().contains("header is longer"));
        let line = [b"#?RADIANCE".to_vec(), vec![b'x'; 3 << 20]].concat();
        assert!(read(&line).unwrap_err().contains("header is longer"));
    }

    #[test]
    fn limits_are_checked_before_pixels_are_read() {
        let mut limits = Limits::default();
        limits.max_image_width = Some(100);
        let file = b"#?RADIANCE\n\n-Y 4 +X 101\n";
        assert!(open_picture(Cursor::new(&file[..]), limits).is_err());
    }
}
