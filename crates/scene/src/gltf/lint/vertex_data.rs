//! The values of attributes and indices.

use crate::gltf::container::json_object::Object;
use crate::gltf::document::Document;
use crate::gltf::geometry::accessor::{Accessor, Component};

/// Tolerance of the length of a unit vector.
fn length_tolerance(component: Component) -> f64 {
    match component {
        Component::I8 => 0.03,
        _ => 5e-4,
    }
}

/// Unit vectors must have length 1, signs be ±1, colours lie in [0, 1].
pub(super) fn lint_values(document: &Document<'_>, place: &str, name: &str, accessor: &Accessor<'_>) {
    if !document.budget.try_take_checks(4 * accessor.count) {
        return;
    }
    let components = accessor.shape.components();
    let warn = |what: &str| document.warn(format!("{place}: {what}"));
    match (name, components) {
        ("NORMAL", 3) | ("TANGENT", 4) => {
            let tolerance = length_tolerance(accessor.component);
            let is_unit = |i: usize| {
                let [x, y, z] = accessor.doubles::<3>(i);
                ((x * x + y * y + z * z).sqrt() - 1.0).abs() <= tolerance
            };
            if let Some(i) = (0..accessor.count).find(|&i| !is_unit(i)) {
                warn(&format!("vector {i} is not of unit length"));
            }
            let has_sign = |i: usize| components == 3 || accessor.doubles::<4>(i)[3].abs() == 1.0;
            if let Some(i) = (0..accessor.count).find(|&i| !has_sign(i)) {
                warn(&format!("the sign of vector {i} is neither 1 nor −1"));
            }
        }
        ("COLOR_0", 3 | 4) => {
            let fits = |i: usize| match components {
                3 => accessor.doubles::<3>(i).iter().all(|v| (0.0..=1.0).contains(v)),
                _ => accessor.doubles::<4>(i).iter().all(|v| (0.0..=1.0).contains(v)),
            };
            if let Some(i) = (0..accessor.count).find(|&i| !fits(i)) {
                warn(&format!("colour {i} is not between 0 and 1"));
            }
        }
        _ => {}
    }
}

/// Indices must exist, and the highest number of their type must not occur: it restarts a primitive.
pub(super) fn lint_indices(document: &Document<'_>, place: &str, indices: &Accessor<'_>, count: u64) {
    if !document.budget.try_take_checks(indices.count) {
        return;
    }
    let restart = match indices.component {
        Component::U8 => u64::from(u8::MAX),
        Component::U16 => u64::from(u16::MAX),
        _ => u64::from(u32::MAX),
    };
    let index = |i: usize| indices.raw_value(i, 0) as u64;
    if let Some(i) = (0..indices.count).find(|&i| index(i) == restart) {
        document.warn(format!("{place}: index {i} is {restart}, which restarts a primitive"));
    } else if let Some(i) = (0..indices.count).find(|&i| index(i) >= count) {
        document.warn(format!("{place}: index {i} is {}, beyond the {count} vertices", index(i)));
    }
}

/// Weights must not be negative and must sum to 1; each joint has one weight.
pub(super) fn lint_weights(document: &Document<'_>, attributes: &Object<'_>) {
    let open = |name: String| {
        let place = format!("{}/{name}", attributes.place);
        let accessor = Accessor::open(document, attributes.index(&name).ok()??, &place).ok()?;
        accessor.expect_components(&[4], &name).ok().filter(Accessor::has_data)
    };
    let sets = |base: &str| (0..4).map_while(|set| open(format!("{base}_{set}"))).collect::<Vec<_>>();
    let (joints, weights) = (sets("JOINTS"), sets("WEIGHTS"));
    let Some(count) = weights.iter().chain(&joints).map(|accessor| accessor.count).min() else { return };
    if !document.budget.try_take_checks(count.saturating_mul(32 * weights.len())) {
        return;
    }
    // As in the Khronos validator; its 1/255 per weight for quantised weights would be too strict for floats.
    let tolerance = |component: Component| match component {
        Component::F32 => 2e-7 * 4.0 * weights.len() as f64,
        _ => 0.0,
    };
    for i in 0..count {
        let vertex_weights: Vec<f64> = weights.iter().flat_map(|set| set.doubles::<4>(i)).collect();
        let sum: f64 = vertex_weights.iter().sum();
        let tolerance = weights.iter().map(|set| tolerance(set.component)).fold(1e-9, f64::max);
        if vertex_weights.iter().any(|&weight| weight < 0.0) {
            return document.warn(format!("{}: weights of vertex {i} are negative", attributes.place));
        }
        if !vertex_weights.is_empty() && sum != 0.0 && (sum - 1.0).abs() > tolerance {
            return document.warn(format!("{}: weights of vertex {i} sum to {sum}, not 1", attributes.place));
        }
        let mut used: Vec<u32> = (joints.iter().zip(&weights))
            .flat_map(|(joints, weights)| {
                (0..4).map(move |k| (joints.raw_value(i, k) as u32, weights.raw_value(i, k)))
            })
            .filter(|&(_, weight)| weight > 0.0)
            .map(|(joint, _)| joint)
            .collect();
        used.sort_unstable();
        if used.windows(2).any(|pair| pair[0] == pair[1]) {
            return document.warn(format!("{}: vertex {i} has a joint twice", attributes.place));
        }
    }
}
