//! The window, acted on by pointer and keys, headless.

mod accessible;
mod acting;
mod arranging;
mod commands;
mod comparing;
mod controls;
mod documents;
mod dragging;
mod key_maps;
mod layers;
mod on_card;
mod painting;
mod panels;
mod presets;
mod quality;
mod small_scene;
