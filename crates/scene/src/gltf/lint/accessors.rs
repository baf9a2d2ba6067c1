//! Buffers, their views, and accessors: sizes, alignment, and whether the declared bounds are true.

use crate::error::Fault;
use crate::gltf::container::json_object::Object;
use crate::gltf::document::Document;
use crate::gltf::geometry::accessor::{Accessor, Component, Shape, component_from_code};

pub(super) fn lint(document: &Document<'_>) {
    lint_buffers(document);
    for index in 0..document.len("bufferViews") {
        if let Ok(view) = document.item("bufferViews", index, "") {
            lint_buffer_view(document, &view);
        }
    }
    for index in 0..document.len("accessors") {
        if let Ok(accessor) = document.item("accessors", index, "") {
            lint_layout(document, &accessor);
            match Accessor::open(document, index, "") {
                Ok(open) if open.has_data() => lint_values(document, &accessor, &open),
                Ok(_) => {}
                // The data comes from elsewhere, or the defect is reported with the properties.
                Err(Fault::NoData { .. } | Fault::TooBig { .. }) => {}
                Err(fault) => document.warn(fault.to_string()),
            }
        }
    }
}

/// A whole number, or the default if missing or malformed.
fn integer(object: &Object<'_>, key: &str, default: u64) -> u64 {
    object.whole_number(key).ok().flatten().unwrap_or(default)
}

fn lint_buffers(document: &Document<'_>) {
    for index in 0..document.len("buffers") {
        match document.buffer(index, "") {
            Ok(_) | Err(Fault::NoData { .. }) => {}
            Err(fault) => document.warn(fault.to_string()),
        }
    }
    // Up to three bytes pad the chunk to a multiple of 4.
    let Some(chunk) = document.chunk else { return };
    let first = document.item("buffers", 0, "").ok().filter(|buffer| buffer.get("uri").is_none());
    match first.map(|buffer| integer(&buffer, "byteLength", 0)) {
        Some(length) if chunk.len() as u64 > length.saturating_add(3) => {
            document.warn(format!(
                "/buffers/0: the binary chunk has {} bytes, {length} are declared",
                chunk.len()
            ));
        }
        Some(_) => {}
        None if chunk.is_empty() => {}
        None => document.warn("the binary chunk is not used"),
    }
}

fn lint_buffer_view(document: &Document<'_>, view: &Object<'_>) {
    const ELEMENT_ARRAY: u64 = 34963;
    let (offset, length) = (integer(view, "byteOffset", 0), integer(view, "byteLength", 0));
    if let Ok(Some(buffer)) = view.index("buffer")
        && let Ok(buffer) = document.item("buffers", buffer, "")
        && offset.saturating_add(length) > integer(&buffer, "byteLength", u64::MAX)
    {
        document.warn(format!("{}: bytes {offset} + {length} do not fit {}", view.place, buffer.place));
    }
    if let Ok(Some(stride)) = view.whole_number("byteStride") {
        if stride > length {
            document
                .warn(format!("{}/byteStride: {stride} is more than the byteLength {length}", view.place));
        }
        if integer(view, "target", 0) == ELEMENT_ARRAY {
            document.warn(format!("{}/byteStride: only views of vertices can have one", view.place));
        }
    }
}

/// The declared layout of the elements.
fn lint_layout(document: &Document<'_>, accessor: &Object<'_>) {
    let warn = |what: String| document.warn(format!("{}: {what}", accessor.place));
    let component = accessor.whole_number("componentType").ok().flatten().and_then(component_from_code);
    let shape = accessor.text("type").ok().flatten().and_then(Shape::from_name);
    let (Some(component), Some(shape)) = (component, shape) else { return };
    let count = integer(accessor, "count", 0);
    if matches!(component, Component::F32 | Component::U32) && accessor.flag("normalized").unwrap_or(false) {
        warn("only 8 and 16 bit integers can be normalised".into());
    }
    for key in ["min", "max"] {
        if let Ok(Some(bounds)) = accessor.number_list(key)
            && bounds.len() != shape.components()
        {
            warn(format!("{key} has {} numbers instead of {}", bounds.len(), shape.components()));
        }
    }
    lint_placement(document, accessor, component, count, shape.size(component), shape.is_matrix());
    let Ok(Some(sparse)) = accessor.object("sparse") else { return };
    let replaced = integer(&sparse, "count", 0);
    if replaced > count {
        document.warn(format!("{}/count: {replaced} is more than the accessor's {count}", sparse.place));
    }
    for (key, component, size) in [("indices", None, 0), ("values", Some(component), shape.size(component))] {
        let Ok(Some(part)) = sparse.object(key) else { continue };
        let index_component = part.whole_number("componentType").ok().flatten().and_then(component_from_code);
        let Some(component) = component.or(index_component) else { continue };
        lint_placement(document, &part, component, replaced, size.max(component.size()), false);
        let view = part
            .index("bufferView")
            .ok()
            .flatten()
            .and_then(|view| document.item("bufferViews", view, "").ok());
        if view.is_some_and(|view| view.get("byteStride").is_some() || view.get("target").is_some()) {
            document.warn(format!(
                "{}/bufferView: only views of vertices can have a byteStride or target",
                part.place
            ));
        }
    }
}

/// Alignment and extent of elements in their view.
fn lint_placement(
    document: &Document<'_>,
    owner: &Object<'_>,
    component: Component,
    count: u64,
    size: usize,
    matrix: bool,
) {
    let Ok(Some(view)) = owner.index("bufferView") else { return };
    let Ok(view) = document.item("bufferViews", view, "") else { return };
    let warn = |what: String| document.warn(format!("{}: {what}", owner.place));
    let (offset, unit) = (integer(owner, "byteOffset", 0), component.size() as u64);
    let total = offset.saturating_add(integer(&view, "byteOffset", 0));
    if offset % unit != 0 || total % unit != 0 {
        warn(format!("its byteOffset {offset} (in the buffer {total}) is not a multiple of {unit}"));
    } else if matrix && total % 4 != 0 {
        warn(format!("the byteOffset {total} of its matrices is not a multiple of 4"));
    }
    let size = size as u64;
    let stride = view.whole_number("byteStride").ok().flatten();
    if let Some(stride) = stride.filter(|&stride| stride < size || stride % unit != 0) {
        warn(format!("the byteStride {stride} of its view does not suit elements of {size} bytes"));
    }
    let end = offset
        .saturating_add(count.saturating_sub(1).saturating_mul(stride.unwrap_or(size)))
        .saturating_add(size);
    let length = integer(&view, "byteLength", u64::MAX);
    if end > length {
        warn(format!("{count} elements from byte {offset} do not fit {} of {length} bytes", view.place));
    }
}

/// The values of the elements: the declared bounds must be exact, and floats finite.
fn lint_values(document: &Document<'_>, object: &Object<'_>, accessor: &Accessor<'_>) {
    let components = accessor.shape.components();
    if !document.budget.try_take_checks(accessor.count * components) {
        return;
    }
    let (mut low, mut high, mut finite) =
        (vec![f64::INFINITY; components], vec![f64::NEG_INFINITY; components], true);
    for i in 0..accessor.count {
        for k in 0..components {
            let value = accessor.raw_value(i, k);
            finite &= value.is_finite();
            low[k] = low[k].min(value);
            high[k] = high[k].max(value);
        }
    }
    if !finite {
        document.warn(format!("{}: has infinite or undefined numbers", accessor.place));
    }
    if !accessor.replacements_increase() {
        document.warn(format!("{}/sparse/indices: do not increase", accessor.place));
    }
    for (key, real) in [("min", low), ("max", high)] {
        let Ok(Some(declared)) = object.number_list(key) else { continue };
        for (k, (&declared, &real)) in declared.iter().zip(&real).enumerate() {
            let declared =
                if accessor.component == Component::F32 { f64::from(declared as f32) } else { declared };
            if declared != real {
                document
                    .warn(format!("{}/{key}/{k}: is declared as {declared}, but is {real}", accessor.place));
            }
        }
    }
}
