//! A file's animations: their names, and the document as they change it over time.
//!
//! An animation is applied by writing its values into the document's JSON, at their targets: a node's translation,
//! the weights of its morph targets, a camera's angle of view, or anything that KHR_animation_pointer names
//! ([`target`]). The scene is then read like any other, so that all checks of a file also apply at every time.

mod interpolation;
pub(crate) mod pose;
mod target;
mod track;

use crate::error::Fault;
use crate::gltf::container::json_object::Object;
use crate::gltf::document::{Document, nonempty_name};
use serde::Serialize;
use serde_json::Value;
use target::Target;
use track::Track;

/// An animation of a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Animation {
    /// Its name, or `animation N`.
    pub name: String,
    /// Time of its last key, s.
    pub seconds: f64,
    /// Number of properties that it animates.
    pub channels: usize,
}

/// A time in one of a file's animations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AnimationTime {
    /// The animation's name; `None`: the first.
    pub animation: Option<String>,
    /// Time, s. Before its first key and after its last, an animation is constant.
    pub seconds: f64,
}

/// Files with more channels than this are rejected.
const MAX_CHANNELS: usize = 1 << 16;

/// The animations of a document, in order.
pub(crate) fn list_animations(document: &Document<'_>) -> Vec<Animation> {
    let summary = |index| {
        let animation = document.item("animations", index, "").ok()?;
        let channels = animation.objects("channels").unwrap_or_default();
        let samplers = animation.objects("samplers").unwrap_or_default();
        let mut seconds = 0.0_f64;
        for channel in channels.iter().take(MAX_CHANNELS) {
            if let Ok(Some(track)) = open_track(document, &samplers, channel)
                && track.end_seconds().is_finite()
            {
                seconds = seconds.max(track.end_seconds());
            }
        }
        Some(Animation { name: animation_name(&animation, index), seconds, channels: channels.len() })
    };
    (0..document.len("animations")).filter_map(summary).collect()
}

fn animation_name(animation: &Object<'_>, index: usize) -> String {
    nonempty_name(animation.text("name").ok().flatten()).unwrap_or_else(|| format!("animation {index}"))
}

/// A document changed by an animation.
pub(crate) struct AnimatedDocument {
    /// The document's JSON at the time.
    pub root: Value,
    /// Whether materials have changed.
    pub changes_materials: bool,
}

/// The document's JSON at a time. A faulty channel is reported as a warning, and its target stays at rest.
///
/// # Errors
/// The animation does not exist, or it is too large.
pub(crate) fn apply_animation(
    document: &Document<'_>,
    moment: &AnimationTime,
) -> Result<AnimatedDocument, Fault> {
    let mut animated = AnimatedDocument { root: document.cloned_root()?, changes_materials: false };
    let Some(animation) = find_animation(document, moment)? else { return Ok(animated) };
    let channels = animation.objects("channels")?;
    if channels.len() > MAX_CHANNELS {
        return Err(animation.malformed("channels", format!("has more than {MAX_CHANNELS}")));
    }
    let samplers = animation.objects("samplers")?;
    for channel in &channels {
        let value = match channel_value(document, &samplers, channel, moment.seconds) {
            Ok(Some(value)) => value,
            Ok(None) => continue,
            Err(fault @ Fault::TooBig { .. }) => return Err(fault),
            Err(fault) => {
                document.warn(format!("{fault}; what it animates stays at rest"));
                continue;
            }
        };
        let (target, value) = value;
        animated.changes_materials |= target.is_material_property();
        if !target.write(&mut animated.root, value) {
            document.warn(format!(
                "{}/target: {} does not exist; it stays at rest",
                channel.place, target.pointer
            ));
        }
    }
    Ok(animated)
}

/// The requested animation; `None` if the file has none and none was requested.
fn find_animation<'a>(
    document: &'a Document<'_>,
    moment: &AnimationTime,
) -> Result<Option<Object<'a>>, Fault> {
    let count = document.len("animations");
    let Some(requested_name) = &moment.animation else {
        return if count == 0 { Ok(None) } else { document.item("animations", 0, "").map(Some) };
    };
    let mut names = Vec::new();
    for index in 0..count {
        let animation = document.item("animations", index, "")?;
        let name = animation_name(&animation, index);
        if name == *requested_name {
            return Ok(Some(animation));
        }
        names.push(format!("{name:?}"));
    }
    /// Maximum number of names in a message.
    const MAX_LISTED: usize = 20;
    names.truncate(MAX_LISTED);
    let available =
        if names.is_empty() { "it has none".into() } else { format!("there are {}", names.join(", ")) };
    Err(Fault::NoAnimation { name: requested_name.clone(), available })
}

/// The target of a channel, and its value at a time; `None` if it does not affect the picture.
fn channel_value(
    document: &Document<'_>,
    samplers: &[Object<'_>],
    channel: &Object<'_>,
    seconds: f64,
) -> Result<Option<(Target, Vec<f64>)>, Fault> {
    let Some(target) = Target::from_channel(document, channel)? else { return Ok(None) };
    let Some(track) = open_track(document, samplers, channel)? else { return Ok(None) };
    let numbers = track.sample(document, seconds, target.is_rotation())?;
    if let Some(expected) = target.number_count().filter(|&expected| expected != numbers.len()) {
        let what =
            format!("has {} numbers per key for {}, which takes {expected}", numbers.len(), target.pointer);
        return Err(channel.malformed("sampler", what));
    }
    if !numbers.iter().all(|number| number.is_finite()) {
        return Err(channel.malformed("sampler", format!("is not finite at {seconds} s")));
    }
    Ok(Some((target, numbers)))
}

fn open_track<'a>(
    document: &'a Document<'_>,
    samplers: &[Object<'_>],
    channel: &Object<'_>,
) -> Result<Option<Track<'a>>, Fault> {
    let Some(index) = channel.index("sampler")? else { return Ok(None) };
    let sampler = samplers.get(index);
    let sampler =
        sampler.ok_or_else(|| channel.malformed("sampler", "refers to a sampler that does not exist"))?;
    Track::open(document, sampler).map(Some)
}
