//! What all pages have around their pictures: texts, a poster, what links show.

use crate::encoding::encode_picture;
use crate::error::WebPageError;
use crate::escaping::escape_html;
use crate::screen_picture::ScreenPicture;
use crate::template::fill_template;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use std::borrow::Cow;

const STYLE: &str = include_str!("viewer/page.css");
const TEMPLATE: &str = include_str!("viewer/page.html");
/// The controls of the focus, which all pages have.
const RACK_BAR: &str = include_str!("viewer/rack_bar.html");

/// The longest side of the picture in `og:image` where the page has no public address, px, and its error.
const THUMBNAIL_SIDE_PX: u32 = 320;
const THUMBNAIL_PSNR: f64 = 32.0;

/// Texts below the picture. An empty one is left out.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Caption {
    /// The picture's title; also the page's.
    pub title: String,
    /// Who made it.
    pub author: String,
    /// What others may do with it.
    pub licence: String,
}

/// Where the page is going to be published, for those who link to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PublicAddress {
    /// Of the page.
    pub page: String,
    /// Of a still picture beside it.
    pub poster: String,
}

impl PublicAddress {
    /// The address of a page, with that of a file beside it. `None` if `page` is no address of a page on a server.
    pub fn new(page: &str, poster_file_name: &str) -> Option<Self> {
        let (scheme, rest) = page.split_once("://")?;
        let path = rest.split(['?', '#']).next().unwrap_or_default();
        let (folder, _) = path.rsplit_once('/')?;
        let is_on_server =
            matches!(scheme, "http" | "https") && !folder.is_empty() && !folder.starts_with('/');
        let poster = format!("{scheme}://{folder}/{}", percent_encoded(poster_file_name));
        is_on_server.then(|| Self { page: page.into(), poster })
    }
}

/// A file's name as a part of an address.
fn percent_encoded(name: &str) -> String {
    let encoded = |byte: u8| match byte {
        b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' => char::from(byte).to_string(),
        _ => format!("%{byte:02X}"),
    };
    name.bytes().map(encoded).collect()
}

/// A page but for its content.
pub struct PageFrame<'a> {
    pub caption: &'a Caption,
    /// What is shown first.
    pub picture: &'a ScreenPicture,
    /// That picture as a WebP file.
    pub poster: &'a [u8],
    pub address: Option<&'a PublicAddress>,
}

/// What kinds of pages differ in.
pub struct PageContent<'a> {
    /// From where scripts may come, and what they may do: a value of the policy `script-src`.
    pub policy: &'a str,
    /// What the visitor can do, over the picture until it is touched.
    pub hint: &'a str,
    /// The controls below the picture beside those of the focus, HTML.
    pub bar: &'a str,
    /// The parts of the script, in order.
    pub viewer: &'a [&'a str],
    /// The function that shows the page.
    pub call: &'a str,
    /// Its argument, an expression.
    pub data: String,
}

impl Caption {
    /// The title of the page.
    pub(crate) fn page_title(&self) -> &str {
        if self.title.trim().is_empty() { "A picture to refocus" } else { &self.title }
    }
}

impl PageFrame<'_> {
    /// The page as HTML.
    ///
    /// # Errors
    /// [`WebPageError::Template`]: the template lacks a hole. [`WebPageError::Encoder`]: the thumbnail cannot be encoded.
    pub fn fill(&self, content: &PageContent) -> Result<String, WebPageError> {
        let [width, height] = self.picture.size().map(|side| side.to_string());
        fill_template(
            TEMPLATE,
            &[
                ("title", &escape_html(self.caption.page_title())),
                ("head", &self.head()?),
                ("policy", content.policy),
                ("style", STYLE),
                ("width", &width),
                ("height", &height),
                ("poster", &data_uri(self.poster)),
                ("hint", content.hint),
                ("bar", &[RACK_BAR, content.bar].concat()),
                ("caption", &self.caption_html()),
                ("viewer", &content.viewer.concat()),
                ("call", content.call),
                ("data", &content.data),
            ],
        )
    }

    /// Elements of the head that tell others about the page.
    fn head(&self) -> Result<String, WebPageError> {
        let Caption { author, licence, .. } = self.caption;
        let title = self.caption.page_title();
        let description = [title, author, licence].map(str::trim);
        let description: Vec<_> = description.into_iter().filter(|text| !text.is_empty()).collect();
        let thumbnail = self.picture.reduced(THUMBNAIL_SIDE_PX);
        let (page, image, [width, height]) = match self.address {
            Some(address) => (Some(&address.page), Cow::Borrowed(&address.poster), self.picture.size()),
            None => {
                let encoded = encode_picture(&thumbnail, THUMBNAIL_PSNR, 60)?;
                (None, Cow::Owned(data_uri(&encoded.webp)), thumbnail.size())
            }
        };
        let named = |attribute: &str, name: &str, content: &str| {
            format!("<meta {attribute}=\"{name}\" content=\"{}\">\n", escape_html(content))
        };
        let mut head = named("name", "description", &description.join(" · "));
        if !author.trim().is_empty() {
            head.push_str(&named("name", "author", author));
        }
        head.push_str(&named("name", "twitter:card", "summary_large_image"));
        if let Some(page) = page {
            head.push_str(&named("property", "og:url", page));
        }
        for (name, content) in [
            ("og:type", "website"),
            ("og:title", title),
            ("og:description", &description.join(" · ")),
            ("og:image", &image),
            ("og:image:width", &width.to_string()),
            ("og:image:height", &height.to_string()),
        ] {
            head.push_str(&named("property", name, content));
        }
        Ok(head)
    }

    fn caption_html(&self) -> String {
        let Caption { title, author, licence } = self.caption;
        let parts = [("title", title), ("author", author), ("licence", licence)];
        let parts = parts.into_iter().filter(|(_, text)| !text.trim().is_empty());
        parts.map(|(class, text)| format!("<span class=\"{class}\">{}</span>", escape_html(text))).collect()
    }
}

fn data_uri(webp: &[u8]) -> String {
    format!("data:image/webp;base64,{}", STANDARD.encode(webp))
}
