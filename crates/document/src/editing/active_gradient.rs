//! A gradient in progress.

use crate::error::DocumentError;
use crate::open_document::Document;
use focus::{FocusMap, Gradient};

/// A gradient in progress. Each change draws it anew over the original layer.
pub struct ActiveGradient {
    before: FocusMap,
    gradient: Gradient,
}

impl ActiveGradient {
    /// Begins a gradient on the active layer and draws it.
    ///
    /// # Errors
    /// The layer cannot be painted on, or the gradient is invalid.
    pub fn begin(document: &mut Document, gradient: Gradient) -> Result<Self, DocumentError> {
        let before = document.layers.active().map.clone();
        document.draw_gradient(&before, &gradient)?;
        Ok(Self { before, gradient })
    }

    /// Replaces the gradient by another.
    ///
    /// # Errors
    /// The layer cannot be painted on, or the gradient is invalid.
    pub fn change(&mut self, document: &mut Document, gradient: Gradient) -> Result<(), DocumentError> {
        document.draw_gradient(&self.before, &gradient)?;
        self.gradient = gradient;
        Ok(())
    }

    /// Ends the gradient as one undo step, unless nothing changed. Returns whether anything changed.
    pub fn commit(self, document: &mut Document) -> bool {
        document.finish_gradient(&self.before, self.gradient)
    }

    /// Cancels the gradient and restores the layer.
    pub fn abort(self, document: &mut Document) {
        document.layers.active_mut().map = self.before;
    }
}
