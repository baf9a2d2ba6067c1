//! The shaders without a graphics card: they are valid, and read their structs as Rust lays them out.

use super::shader_source;
use super::shader_structs::{FieldLayout, StructLayout, layouts};
use naga::proc::Layouter;
use naga::valid::{Capabilities, ModuleInfo, SubgroupOperationSet, ValidationFlags, Validator};
use naga::{AddressSpace, Module, ShaderStage, TypeInner};
use std::collections::BTreeMap;

/// Every module that a card is given, by name.
fn sources() -> [(&'static str, String); 4] {
    [
        ("list", shader_source::list()),
        ("draw", shader_source::draw()),
        ("resolve", shader_source::resolve(false)),
        ("resolve by subgroups", shader_source::resolve(true)),
    ]
}

fn parsed(name: &str, source: &str) -> Module {
    naga::front::wgsl::parse_str(source)
        .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(source)))
}

fn validated(name: &str, module: &Module, capabilities: Capabilities) -> ModuleInfo {
    let mut validator = Validator::new(ValidationFlags::all(), capabilities);
    validator
        .subgroup_stages(naga::valid::ShaderStages::COMPUTE)
        .subgroup_operations(SubgroupOperationSet::all());
    validator.validate(module).unwrap_or_else(|error| panic!("{name}: {error:?}"))
}

/// The layouts that naga gives the structs in uniform and storage buffers, and the structs within them, by name.
fn layouts_of(module: &Module) -> BTreeMap<String, StructLayout> {
    let mut layouter = Layouter::default();
    layouter.update(module.to_ctx()).expect("a valid module has a layout");
    let in_buffers = module.global_variables.iter().map(|(_, variable)| variable);
    let in_buffers = in_buffers
        .filter(|variable| matches!(variable.space, AddressSpace::Uniform | AddressSpace::Storage { .. }));
    let mut open: Vec<_> = in_buffers.map(|variable| variable.ty).collect();
    let mut found = BTreeMap::new();
    while let Some(handle) = open.pop() {
        let of_type = &module.types[handle];
        match &of_type.inner {
            TypeInner::Array { base, .. } => open.push(*base),
            TypeInner::Struct { members, .. } => {
                let name = of_type.name.clone().expect("structs have names");
                let field = |member: &naga::StructMember| {
                    open.push(member.ty);
                    FieldLayout {
                        name: member.name.clone().expect("members have names"),
                        offset: member.offset as usize,
                        size: layouter[member.ty].size as usize,
                    }
                };
                let fields = members.iter().map(field).collect();
                let layout =
                    StructLayout { name: name.clone(), size: layouter[handle].size as usize, fields };
                found.insert(name, layout);
            }
            _ => (),
        }
    }
    found
}

/// The structs of modules whose layouts differ from Rust's, and those that Rust does not have.
fn differing(modules: &[Module]) -> Vec<String> {
    let of_rust: BTreeMap<String, StructLayout> =
        layouts().into_iter().map(|layout| (layout.name.clone(), layout)).collect();
    let of_wgsl = modules.iter().flat_map(layouts_of);
    let is_other = |(name, layout): &(String, StructLayout)| of_rust.get(name) != Some(layout);
    of_wgsl.filter(is_other).map(|(name, _)| name).collect()
}

#[test]
fn shaders_are_valid() {
    for (name, source) in sources() {
        let module = parsed(name, &source);
        let capabilities =
            if name.contains("subgroups") { Capabilities::SUBGROUP } else { Capabilities::empty() };
        validated(name, &module, capabilities);
        assert!(module.entry_points.iter().all(|entry| entry.stage == ShaderStage::Compute), "{name}");
        assert!(!module.entry_points.is_empty(), "{name}: nothing to run");
    }
}

#[test]
fn structs_in_buffers_are_laid_out_as_in_rust() {
    let modules = sources().map(|(name, source)| parsed(name, &source));
    assert_eq!(differing(&modules), [""; 0]);
    let in_buffers: BTreeMap<_, _> = modules.iter().flat_map(layouts_of).collect();
    let unused: Vec<_> =
        layouts().into_iter().filter(|layout| !in_buffers.contains_key(&layout.name)).collect();
    assert_eq!(unused, [], "no shader reads them");
}

/// The control: a shader in which two fields have changed places is found out, and one that has a field more.
#[test]
fn a_moved_field_is_found_out() {
    let moved = |source: String, from: &str, to: &str| {
        assert!(source.contains(from), "{from}");
        differing(&[parsed("moved", &source.replacen(from, to, 1))])
    };
    let (stop, per_stop) = ("    stop: i32,\n", "    per_stop: u32,\n");
    let swapped = format!("{per_stop}{stop}");
    assert_eq!(moved(shader_source::draw(), &format!("{stop}{per_stop}"), &swapped), ["Pen"]);
    let more = "    node_count: u32,\n    more: u32,\n";
    assert_eq!(moved(shader_source::list(), "    node_count: u32,\n", more), ["Chunk"]);
    assert_eq!(moved(shader_source::resolve(false), "quantum: f32", "quantum: vec2<f32>"), ["Frame"]);
}

#[test]
fn constants_keep_their_values() {
    let module = parsed("list", &shader_source::list());
    let value = |name: &str| {
        let mut constants = module.constants.iter().map(|(_, constant)| constant);
        let constant = constants.find(|constant| constant.name.as_deref() == Some(name));
        module.global_expressions[constant.unwrap_or_else(|| panic!("{name}")).init].clone()
    };
    let literal = |literal| naga::Expression::Literal(literal);
    assert_eq!(value("FLAT"), literal(naga::Literal::F32(crate::lens_in_use::FLAT)));
    assert_eq!(value("LARGEST_OFFSET"), literal(naga::Literal::F32(crate::lens_in_use::LARGEST_OFFSET)));
    assert_eq!(value("PIXEL"), literal(naga::Literal::I32(crate::canvas::PIXEL)));
    assert_eq!(value("NO_PARENT"), literal(naga::Literal::U32(super::formats::NO_PARENT)));
}
