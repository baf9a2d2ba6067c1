//! The window, acted on by pointer and keys, headless.

mod acting;
mod comparing;
mod controls;
mod documents;
mod layers;
mod painting;
mod small_scene;
