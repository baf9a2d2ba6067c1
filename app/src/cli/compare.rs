//! `focus-brush compare`.

use super::arguments::CompareArguments;
use super::console::{say, say_json};
use super::failure::Failure;
use super::shot::check_picture_output;
use project::{compare, read_picture, write_error_map};
use serde_json::json;

/// Tells how far a picture is from a reference, and writes where.
pub fn run(arguments: &CompareArguments) -> Result<(), Failure> {
    if let Some(file) = &arguments.error_map {
        check_picture_output(file)?;
    }
    let (a, b) = (read_picture(&arguments.a)?, read_picture(&arguments.b)?);
    if (a.width, a.height) != (b.width, b.height) {
        let sizes = format!("{} × {}, the reference {} × {}", a.width, a.height, b.width, b.height);
        let files = format!("{} against {}", arguments.a.display(), arguments.b.display());
        return Err(Failure::bad(format!("{files}: the picture is {sizes} (compare pictures of one size)")));
    }
    let found = compare(&a, &b)?;
    if let Some(file) = &arguments.error_map {
        write_error_map(file, &a, &b)?;
    }
    if arguments.json {
        say_json(&json!(found));
        return Ok(());
    }
    say(format!("RMSE               {:.6}   (linear, clipped to [0, 1])", found.rmse));
    say(format!("relMSE             {:.6}", found.rel_mse));
    say(format!("PSNR               {:.2} dB", found.psnr));
    say(format!("FLIP               {:.4}", found.flip));
    say(format!("signed mean error  {:+.4} %", found.signed_mean_error * 100.0));
    say(format!("largest difference {:.4}", found.largest_difference));
    if found.undefined_pixels > 0 {
        let (undefined, pixels) = (found.undefined_pixels, a.width as usize * a.height as usize);
        say(format!(
            "undefined pixels   {undefined} of {pixels}   (NaN or infinite, so the rest is undefined as well)"
        ));
    }
    Ok(())
}
