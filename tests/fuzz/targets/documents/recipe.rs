//! Recipes of focus.
#![no_main]

fuzz::target!(fuzz::documents::recipe);
