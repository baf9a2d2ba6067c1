//! Options of `export --web`.

use super::parsers::{parse_divisor, parse_size};
use clap::Args;
use std::path::PathBuf;

/// Options of `export --web`.
#[derive(Debug, Args)]
pub struct WebPageArguments {
    /// Write a web page on which anyone can refocus the picture: one file that works from a disk, in a frame and
    /// on a phone, without a server or a network. Prints how close its pictures are to rendered ones
    #[arg(long, value_name = "PAGE.html")]
    pub web: Option<PathBuf>,
    /// Put the light field and the program that draws it into the page, in place of pictures: visitors choose any
    /// distance, aperture and bokeh, and paint. For small pictures: the demo at 640x360 takes 7 MB
    #[arg(long, requires = "web", conflicts_with_all = ["apertures", "painted_only"])]
    pub engine: bool,
    /// Apertures of the page, as divisors of the camera's aperture radius: 2 is half as wide, twice the f-number.
    /// The picture without paint has only the first one
    #[arg(long, value_name = "N,…", default_value = "1,2,4", value_delimiter = ',', value_parser = parse_divisor)]
    pub apertures: Vec<f64>,
    /// Size of the page's picture in pixels, overriding the camera's
    #[arg(long, value_name = "WxH", requires = "web", value_parser = parse_size)]
    pub size: Option<[u32; 2]>,
    /// Leave out the picture without paint
    #[arg(long, requires = "web")]
    pub painted_only: bool,
    /// Title below the picture, and of the page (default: the project's file name)
    #[arg(long, value_name = "TEXT", requires = "web")]
    pub title: Option<String>,
    /// Author, below the picture
    #[arg(long, value_name = "TEXT", default_value = "", hide_default_value = true, requires = "web")]
    pub author: String,
    /// Licence, below the picture
    #[arg(long, value_name = "TEXT", default_value = "", hide_default_value = true, requires = "web")]
    pub licence: String,
    /// Rack the focus back and forth until somebody touches the page
    #[arg(long, requires = "web")]
    pub autoplay: bool,
    /// Where the page will be published, for links with a preview: also writes the still picture that they show,
    /// PAGE.poster.png, to be published beside it
    #[arg(long, value_name = "URL", requires = "web")]
    pub url: Option<String>,
    /// Allow more than 30 MB; phones run out of memory on large pages
    #[arg(long, requires = "web")]
    pub large: bool,
}
