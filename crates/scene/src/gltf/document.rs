//! The parsed document with everything needed to read it: folder, budget, warnings.

use crate::LoadOptions;
use crate::error::Fault;
use crate::gltf::budget::Budget;
use crate::gltf::container::glb_chunks::{self, Container};
use crate::gltf::container::json_object::{Object, as_whole_number};
use crate::gltf::container::json_text;
use crate::gltf::repair::{self, Faults};
use serde_json::Value;
use std::cell::{OnceCell, RefCell};
use std::path::{Path, PathBuf};

/// A glTF document.
pub(crate) struct Document<'a> {
    root: Value,
    /// Upper bound of the root's memory, bytes.
    root_bytes: u64,
    typed: gltf::Document,
    faults: Faults,
    /// The binary chunk of a .glb.
    pub chunk: Option<&'a [u8]>,
    /// The canonical folder that must contain every file it refers to.
    pub folder: PathBuf,
    pub budget: Budget,
    warnings: RefCell<Warnings>,
    /// The buffers loaded so far.
    pub cached_buffers: Vec<OnceCell<Vec<u8>>>,
    /// Extensions that it used and required and that have been decoded ([`Self::with_decoded_buffer`]).
    pub decoded: [Vec<&'static str>; 2],
}

/// Further warnings are only counted.
const MAX_WARNINGS: usize = 100;

#[derive(Default)]
struct Warnings {
    messages: Vec<String>,
    dropped: usize,
}

impl<'a> Document<'a> {
    /// Parses the bytes of a glTF or GLB file in `folder`, against which its URIs are resolved.
    ///
    /// # Errors
    /// The file is malformed, requires an extension that is not read, or exceeds the limits of `options`.
    pub fn parse(bytes: &'a [u8], folder: PathBuf, options: &LoadOptions) -> Result<Self, Fault> {
        let budget = Budget::new(options);
        budget.take_file(bytes.len() as u64, "the file")?;
        let mut warnings = Vec::new();
        let mut warn = |warning| warnings.push(warning);
        let Container { json, chunk, is_glb } = glb_chunks::split_chunks(bytes, &mut warn)?;
        let root = json_text::parse(json, is_glb, &budget, &mut warn)?;
        let root_bytes = json_text::parsed_size(json);
        if !root.is_object() {
            return Err(Fault::NotGltf("its JSON is not an object".into()));
        }
        check_version(&Object::new(&root, String::new())?)?;
        let (typed, faults) = repair::repair_document(&root, &budget)?;
        let buffers = (0..repair::len(&root, "buffers")).map(|_| OnceCell::new()).collect();
        let (warnings_so_far, decoded) = (RefCell::default(), Default::default());
        let document = Self {
            root,
            root_bytes,
            typed,
            faults,
            chunk,
            folder,
            budget,
            warnings: warnings_so_far,
            cached_buffers: buffers,
            decoded,
        };
        for warning in warnings {
            document.warn(warning);
        }
        Ok(document)
    }

    /// The same with another root, an additional buffer of these bytes, and without the decoded extensions.
    ///
    /// # Errors
    /// The new root is malformed, or the budget is exhausted.
    pub fn with_decoded_buffer(
        mut self,
        mut root: Value,
        bytes: Vec<u8>,
        extensions: &[&'static str],
    ) -> Result<Self, Fault> {
        for (list, decoded) in ["extensionsUsed", "extensionsRequired"].into_iter().zip(&mut self.decoded) {
            let Some(Value::Array(names)) = root.get_mut(list) else { continue };
            let has = |extension: &&str| names.iter().any(|name| name == extension);
            decoded.extend(extensions.iter().copied().filter(has));
            names.retain(|name| !decoded.iter().any(|extension| name == extension));
            if names.is_empty() {
                root.as_object_mut().map(|root| root.remove(list));
            }
        }
        self.budget.take_memory(bytes.len() as u64, "its compressed meshes")?;
        if let Some(Value::Array(buffers)) = root.get_mut("buffers") {
            buffers.push(serde_json::json!({ "byteLength": bytes.len() }));
            self.cached_buffers.push(OnceCell::from(bytes));
        }
        (self.typed, self.faults) = repair::repair_document(&root, &self.budget)?;
        self.root = root;
        Ok(self)
    }

    /// The same with another root, in which only numbers differ.
    ///
    /// # Errors
    /// The new root is malformed, or the budget is exhausted.
    pub fn with_root(mut self, root: Value) -> Result<Self, Fault> {
        (self.typed, self.faults) = repair::repair_document(&root, &self.budget)?;
        self.root = root;
        Ok(self)
    }

    /// The document as typed by the `gltf` crate. Every index in it exists, unless there is a fault at its place:
    /// call [`Self::check_at`] or [`Self::check_below`] first.
    pub fn typed(&self) -> &gltf::Document {
        &self.typed
    }

    /// Checks that there is no fault exactly at `place`, a JSON pointer.
    ///
    /// # Errors
    /// The fault.
    pub fn check_at(&self, place: &str) -> Result<(), Fault> {
        self.faults.check_at(place)
    }

    /// Checks that there is no fault at `place`, a JSON pointer, or anywhere inside.
    ///
    /// # Errors
    /// The first fault.
    pub fn check_below(&self, place: &str) -> Result<(), Fault> {
        self.faults.check_below(place)
    }

    /// The index at a JSON pointer, for properties that the typed document lacks.
    pub fn index_at(&self, place: &str) -> Option<usize> {
        usize::try_from(as_whole_number(self.root.pointer(place)?)?).ok()
    }

    /// The place (JSON pointer) of the entry of a collection to which `place` refers.
    ///
    /// # Errors
    /// The collection has fewer entries.
    pub fn entry(&self, collection: &str, index: usize, place: &str) -> Result<String, Fault> {
        if index < self.len(collection) {
            Ok(format!("/{collection}/{index}"))
        } else {
            Err(Self::missing_entry(collection, index, place))
        }
    }

    fn missing_entry(collection: &str, index: usize, place: &str) -> Fault {
        Fault::Malformed {
            place: place.into(),
            what: format!("refers to {collection}[{index}], which does not exist"),
        }
    }

    /// The root as an object.
    pub fn root_object(&self) -> Object<'_> {
        // Checked when it was parsed.
        match Object::new(&self.root, String::new()) {
            Ok(object) => object,
            Err(_) => unreachable!("the root of a parsed document is an object"),
        }
    }

    /// The root as a value.
    pub fn root_value(&self) -> &Value {
        &self.root
    }

    /// A copy of the root.
    ///
    /// # Errors
    /// The budget of memory is exhausted.
    pub fn cloned_root(&self) -> Result<Value, Fault> {
        self.budget.take_memory(self.root_bytes, "the animated document")?;
        Ok(self.root.clone())
    }

    /// The number of entries of a collection such as `meshes`.
    pub fn len(&self, collection: &str) -> usize {
        repair::len(&self.root, collection)
    }

    /// The entry of a collection to which `place` refers.
    ///
    /// # Errors
    /// The collection has fewer entries, or the entry is not an object.
    pub fn item(&self, collection: &str, index: usize, place: &str) -> Result<Object<'_>, Fault> {
        match self.root.get(collection).and_then(|list| list.get(index)) {
            Some(value) => Object::new(value, format!("/{collection}/{index}")),
            None => Err(Self::missing_entry(collection, index, place)),
        }
    }

    /// Records a warning about a harmless defect.
    pub fn warn(&self, warning: impl Into<String>) {
        let (mut warnings, warning) = (self.warnings.borrow_mut(), warning.into());
        if warnings.messages.len() >= MAX_WARNINGS {
            warnings.dropped += 1;
        } else if !warnings.messages.contains(&warning) {
            warnings.messages.push(warning);
        }
    }

    /// All warnings so far, in the order in which they were recorded.
    pub fn warnings(&self) -> Vec<String> {
        let warnings = self.warnings.borrow();
        let mut all = warnings.messages.clone();
        if warnings.dropped > 0 {
            all.push(format!("… and {} more", warnings.dropped));
        }
        all
    }
}

/// A name, unless it is empty.
pub(crate) fn nonempty_name(name: Option<&str>) -> Option<String> {
    name.filter(|name| !name.is_empty()).map(String::from)
}

fn check_version(root: &Object<'_>) -> Result<(), Fault> {
    let asset = root.object("asset")?;
    let Some(version) = asset.as_ref().map(|asset| asset.text("version")).transpose()?.flatten() else {
        return Err(Fault::NotGltf("asset.version is missing".into()));
    };
    if version.split('.').next() != Some("2") {
        return Err(Fault::NotGltf(format!("it is glTF {version:?}")));
    }
    Ok(())
}

/// The canonical folder of a file.
pub(crate) fn canonical_folder(file: &Path) -> std::io::Result<PathBuf> {
    let file = file.canonicalize()?;
    Ok(file.parent().map(Path::to_path_buf).unwrap_or(file))
}
