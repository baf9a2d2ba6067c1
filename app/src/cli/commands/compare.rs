//! `focus-brush compare`.

use crate::cli::arguments::CompareArguments;
use crate::cli::console::{print_json, print_line};
use crate::cli::failure::Failure;
use crate::cli::input::check_picture_output;
use project::{compare, read_picture, write_error_map, z_test};
use serde_json::json;

/// Prints how far a picture is from a reference, and writes an error map if requested.
///
/// # Errors
/// A picture cannot be read, their sizes differ, or the error map cannot be written.
pub fn run(arguments: &CompareArguments) -> Result<(), Failure> {
    if let Some(file) = &arguments.error_map {
        check_picture_output(file)?;
    }
    let (a, b) = (read_picture(&arguments.a)?, read_picture(&arguments.b)?);
    if (a.width, a.height) != (b.width, b.height) {
        let sizes = format!("{} × {}, the reference {} × {}", a.width, a.height, b.width, b.height);
        let files = format!("{} against {}", arguments.a.display(), arguments.b.display());
        return Err(Failure::bad_input(format!(
            "{files}: the picture is {sizes} (compare pictures of one size)"
        )));
    }
    let errors = compare(&a, &b)?;
    let agreement = arguments.z_test.then(|| z_test(&a, &b)).transpose()?;
    if let Some(file) = &arguments.error_map {
        write_error_map(file, &a, &b)?;
    }
    if arguments.json {
        let mut object = json!(errors);
        if let (Some(object), Some(serde_json::Value::Object(agreement))) =
            (object.as_object_mut(), agreement.map(|agreement| json!(agreement)))
        {
            object.extend(agreement);
        }
        print_json(&object);
        return Ok(());
    }
    print_line(format!("RMSE               {:.6}   (linear, clipped to [0, 1])", errors.rmse));
    print_line(format!("relMSE             {:.6}", errors.rel_mse));
    print_line(format!("PSNR               {:.2} dB", errors.psnr));
    print_line(format!("FLIP               {:.4}", errors.flip));
    print_line(format!("signed mean error  {:+.4} %", errors.signed_mean_error * 100.0));
    print_line(format!("largest difference {:.4}", errors.largest_difference));
    if let Some(z) = agreement {
        let [values, luminance, pixels] = [z.values, z.luminance, z.pixels].map(|share| share * 100.0);
        print_line("within three standard errors");
        print_line(format!("  values           {values:.3} %   (99.73 % by chance)"));
        print_line(format!("  luminance        {luminance:.3} %   of the pixels"));
        print_line(format!("  whole pixels     {pixels:.3} %"));
        print_line(format!("  distance, rms    {:.3} standard errors", z.rms));
    }
    if errors.undefined_pixels > 0 {
        let (undefined, pixels) = (errors.undefined_pixels, a.width as usize * a.height as usize);
        print_line(format!(
            "undefined pixels   {undefined} of {pixels}   (NaN or infinite, so the rest is undefined as well)"
        ));
    }
    Ok(())
}
