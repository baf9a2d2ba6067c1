//! The window, driven headlessly by pointer and keys.

mod accessible;
mod acting;
mod arranging;
mod captures;
#[allow(dead_code, reason = "shared by several tests")]
#[path = "../card_light_field/mod.rs"]
mod card_light_field;
mod commands;
mod comparing;
mod controls;
mod documents;
mod dragging;
mod fitting;
mod glyphs;
mod key_maps;
mod keyboard;
mod layers;
mod light_fields;
mod on_card;
mod painting;
mod panels;
mod presets;
mod quality;
mod small_scene;
mod snapshots;
mod surface_menu;
mod timeline;
#[allow(dead_code, reason = "shared by several tests")]
#[path = "../../../crates/session/tests/tiny_glb/mod.rs"]
mod tiny_glb;
mod variants;
#[allow(dead_code, reason = "shared by several tests")]
#[path = "../wall_capture/mod.rs"]
mod wall_capture;
