//! A gradient while it is being drawn.

use crate::open_document::Document;
use crate::error::DocumentError;
use focus::{FocusMap, Gradient};

/// A gradient being drawn: drawn anew from what was there, until it pleases.
pub struct ActiveGradient {
    before: FocusMap,
    gradient: Gradient,
}

impl ActiveGradient {
    /// Draws the first one.
    pub fn begin(document: &mut Document, gradient: Gradient) -> Result<Self, DocumentError> {
        let before = document.layers.active().map.clone();
        document.draw_gradient(&before, &gradient)?;
        Ok(Self { before, gradient })
    }

    /// Draws another one in its place.
    pub fn change(&mut self, document: &mut Document, gradient: Gradient) -> Result<(), DocumentError> {
        document.draw_gradient(&self.before, &gradient)?;
        self.gradient = gradient;
        Ok(())
    }

    /// Ends it: one step of undo, or nothing if it changed nothing. Whether it changed anything.
    pub fn commit(self, document: &mut Document) -> bool {
        document.finish_gradient(&self.before, self.gradient)
    }

    /// Takes it back.
    pub fn abort(self, document: &mut Document) {
        document.layers.active_mut().map = self.before;
    }
}
