//! The window, acted on by pointer and keys, headless.

mod acting;
mod controls;
mod documents;
mod layers;
mod painting;
mod small_scene;
