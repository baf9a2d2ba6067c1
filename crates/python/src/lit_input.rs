//! An opened input with what is computed for it once.

use atlas::UnwrapOptions;
use document::Input;
use light::LitScene;
use render::RenderError;
use std::sync::{Arc, OnceLock};

/// An input with its light, computed once for all clones, and how it is unwrapped.
#[derive(Clone)]
pub struct LitInput {
    pub input: Arc<Input>,
    pub unwrap: UnwrapOptions,
    lit: Arc<OnceLock<Arc<LitScene>>>,
}

impl LitInput {
    /// An opened input, without its light yet.
    pub fn new(input: Input, unwrap: UnwrapOptions) -> Self {
        Self { input: Arc::new(input), unwrap, lit: Arc::default() }
    }

    /// Another input of the same scene, which shares its light.
    pub fn with_input(&self, input: Input) -> Self {
        Self { input: Arc::new(input), ..self.clone() }
    }

    /// The scene, ready for rays.
    pub fn lit(&self) -> Result<Arc<LitScene>, RenderError> {
        if let Some(lit) = self.lit.get() {
            return Ok(lit.clone());
        }
        let lit = self.input.lit_scene()?;
        Ok(self.lit.get_or_init(|| lit).clone())
    }
}
