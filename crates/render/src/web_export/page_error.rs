//! Errors of pages as errors of an export.

use crate::error::RenderError;
use crate::web_export::options::WebPageOptions;
use std::path::Path;
use web_page::WebPageError;

/// An error of the page that is to be written to `path`, with a cure.
pub fn page_error(path: &Path, error: WebPageError) -> RenderError {
    match error {
        WebPageError::TooLarge => {
            let megabytes = WebPageOptions::USUAL_BYTES / 1_000_000;
            let what = format!(
                "the page would be larger than {megabytes} MB, more than phones can open (use fewer apertures, a smaller size, or --large)"
            );
            RenderError::bad_file(path, what)
        }
        WebPageError::Template(_) | WebPageError::Inconsistent(_) => {
            RenderError::Internal(format!("{}: {error}", path.display()))
        }
        WebPageError::Size(..) | WebPageError::Encoder(_) => RenderError::bad_file(path, error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_that_is_too_large_names_the_cures() {
        let RenderError::BadInput(text) = page_error(Path::new("page.html"), WebPageError::TooLarge) else {
            panic!("it is the input's fault")
        };
        assert!(
            text.starts_with("page.html: ") && text.contains("30 MB") && text.contains("--large"),
            "{text}"
        );
    }
}
