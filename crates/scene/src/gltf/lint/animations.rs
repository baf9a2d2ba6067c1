//! Animations. Their defects are reported whether they are played or not.

use crate::gltf::container::json_object::Object;
use crate::gltf::document::Document;
use crate::gltf::geometry::accessor::{Accessor, Component};

pub(super) fn lint(document: &Document<'_>) {
    for index in 0..document.len("animations") {
        let Ok(animation) = document.item("animations", index, "") else { continue };
        let samplers = animation.objects("samplers").unwrap_or_default();
        let mut targets = Vec::new();
        for channel in animation.objects("channels").unwrap_or_default() {
            let Ok(Some(index)) = channel.index("sampler") else { continue };
            match samplers.get(index) {
                Some(sampler) => lint_channel(document, &channel, sampler),
                None => document
                    .warn(format!("{}/sampler: refers to a sampler that does not exist", channel.place)),
            }
            let Ok(Some(target)) = channel.object("target") else { continue };
            if let (Ok(Some(node)), Ok(Some(path))) = (target.index("node"), target.text("path")) {
                targets.push((node, path));
            }
        }
        targets.sort_unstable();
        if let Some(twice) = targets.windows(2).find(|pair| pair[0] == pair[1]) {
            document.warn(format!(
                "{}/channels: two animate {} of node {}",
                animation.place, twice[0].1, twice[0].0
            ));
        }
        samplers.iter().for_each(|sampler| lint_input(document, sampler));
    }
}

/// The times: floats, not negative, increasing.
fn lint_input(document: &Document<'_>, sampler: &Object<'_>) {
    let place = format!("{}/input", sampler.place);
    let Some(input) = open_accessor(document, sampler, "input") else { return };
    let warn = |what: &str| document.warn(format!("{place}: {what}"));
    if input.shape.components() != 1 || input.component != Component::F32 {
        return warn("times must be SCALAR floats");
    }
    let Ok(object) = sampler.index("input").and_then(|i| document.item("accessors", i.unwrap_or(0), ""))
    else {
        return;
    };
    if object.get("min").is_none() || object.get("max").is_none() {
        warn("its accessor must have min and max");
    }
    if !document.budget.try_take_checks(input.count) {
        return;
    }
    let time = |i: usize| input.doubles::<1>(i)[0];
    if (0..input.count).any(|i| time(i) < 0.0) {
        warn("has negative times");
    }
    if (1..input.count).any(|i| time(i) <= time(i - 1)) {
        warn("its times do not increase");
    }
}

/// The values: format and number must suit the path.
fn lint_channel(document: &Document<'_>, channel: &Object<'_>, sampler: &Object<'_>) {
    let Ok(Some(target)) = channel.object("target") else { return };
    let (Some(input), Some(output)) =
        (open_accessor(document, sampler, "input"), open_accessor(document, sampler, "output"))
    else {
        return;
    };
    let Ok(Some(path)) = target.text("path") else { return };
    let node = target.index("node").ok().flatten().and_then(|node| document.item("nodes", node, "").ok());
    if let Some(node) = &node {
        if path != "weights" && node.get("matrix").is_some() {
            document.warn(format!("{}: animates a node that has a matrix", target.place));
        }
        let mesh = node.index("mesh").ok().flatten().and_then(|mesh| document.item("meshes", mesh, "").ok());
        let primitives = mesh.and_then(|mesh| mesh.objects("primitives").ok()).unwrap_or_default();
        if path == "weights" && !primitives.iter().any(|primitive| primitive.get("targets").is_some()) {
            document.warn(format!("{}: animates weights of a node without morph targets", target.place));
        }
    }
    let (components, integers) = match path {
        "translation" | "scale" => (3, false),
        "rotation" => (4, true),
        "weights" => (1, true),
        _ => return,
    };
    let fits = output.component == Component::F32
        || integers && output.normalized && output.component != Component::U32;
    if output.shape.components() != components || !fits {
        document.warn(format!("{}/output: its format does not suit {path}", sampler.place));
    }
    let spline = sampler.text("interpolation").ok().flatten() == Some("CUBICSPLINE");
    let expected = input.count * if spline { 3 } else { 1 };
    let wrong = match path {
        "weights" => output.count % expected.max(1) != 0,
        _ => output.count != expected,
    };
    if wrong {
        let (n, m) = (output.count, input.count);
        document.warn(format!("{}/output: has {n} values for {m} times", sampler.place));
    }
}

fn open_accessor<'a>(document: &'a Document<'_>, sampler: &Object<'_>, key: &str) -> Option<Accessor<'a>> {
    Accessor::open(document, sampler.index(key).ok()??, &sampler.place).ok()
}
