//! Disparities of light fields whose truth is known.

mod captures;
mod field;
mod palettes;
mod score;
mod still_life;
mod still_lives;
mod unusable;
