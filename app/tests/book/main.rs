//! The book (`docs`) is correct: its page of commands is the program's own help, its links are valid, its
//! commands run, and the program accepts the commands of its figures.

#[path = "../card_light_field/mod.rs"]
mod card_light_field;
mod commands;
mod figures;
mod links;
mod pages;
#[path = "../program/mod.rs"]
mod program;
mod running;
#[path = "../../../crates/session/tests/tiny_glb/mod.rs"]
mod tiny_glb;
#[path = "../wall_capture/mod.rs"]
mod wall_capture;
mod workplace;
