//! The parsed document with everything reading it needs: its folder, its budget, its warnings.

use crate::LoadOptions;
use crate::container::{self, Container};
use crate::error::Fault;
use crate::json_object::{Object, integer};
use crate::mending::{self, Faults};
use serde_json::Value;
use std::cell::{Cell, OnceCell, RefCell};
use std::path::{Path, PathBuf};

/// A glTF document.
pub(crate) struct Document<'a> {
    root: Value,
    typed: gltf::Document,
    faults: Faults,
    /// The binary chunk of a .glb.
    pub chunk: Option<&'a [u8]>,
    /// The folder that every file it refers to must lie in; canonical.
    pub folder: PathBuf,
    pub budget: Budget,
    warnings: RefCell<Warnings>,
    /// The buffers that were needed so far.
    pub buffers: Vec<OnceCell<Vec<u8>>>,
}

/// More warnings than this are counted, not kept.
const MAX_WARNINGS: usize = 100;

#[derive(Default)]
struct Warnings {
    kept: Vec<String>,
    dropped: usize,
}

impl<'a> Document<'a> {
    /// Parses the bytes of a scene file that lies in `folder`.
    pub fn parse(bytes: &'a [u8], folder: PathBuf, options: &LoadOptions) -> Result<Self, Fault> {
        let budget = Budget::new(options);
        budget.memory(bytes.len() as u64, "the file")?;
        let mut warnings = Vec::new();
        let Container { json, chunk, is_glb } =
            container::split(bytes, &mut |warning| warnings.push(warning))?;
        let size = container::parsed_size(json);
        budget.memory(2 * size, "the parsed document")?;
        let root: Value = serde_json::from_slice(json).map_err(|error| {
            let known = is_glb || json.iter().find(|b| !b.is_ascii_whitespace()) == Some(&b'{');
            Fault::NotGltf(if known {
                format!("its JSON is invalid: {error}")
            } else {
                "it is neither GLB nor JSON".into()
            })
        })?;
        if !root.is_object() {
            return Err(Fault::NotGltf("its JSON is not an object".into()));
        }
        check_version(&Object::new(&root, String::new())?)?;
        let (typed, faults) = mending::typed(&root, &budget)?;
        let buffers = (0..mending::len(&root, "buffers")).map(|_| OnceCell::new()).collect();
        let document =
            Self { root, typed, faults, chunk, folder, budget, warnings: RefCell::default(), buffers };
        for warning in warnings {
            document.warn(warning);
        }
        Ok(document)
    }

    /// The document as the `gltf` crate sees it. Every index in it exists, unless there is a fault at its place:
    /// ask [`Self::sound`] or [`Self::sound_below`] first.
    pub fn typed(&self) -> &gltf::Document {
        &self.typed
    }

    /// An error if the file is wrong exactly at `place`, a JSON pointer.
    pub fn sound(&self, place: &str) -> Result<(), Fault> {
        self.faults.at(place)
    }

    /// An error if the file is wrong at `place` or anywhere inside.
    pub fn sound_below(&self, place: &str) -> Result<(), Fault> {
        self.faults.below(place)
    }

    /// The index at a JSON pointer, for what the typed document does not hold.
    pub fn index_at(&self, place: &str) -> Option<usize> {
        usize::try_from(integer(self.root.pointer(place)?)?).ok()
    }

    /// The place of an entry of a collection, which `place` refers to.
    pub fn entry(&self, collection: &str, index: usize, place: &str) -> Result<String, Fault> {
        if index < self.len(collection) {
            Ok(format!("/{collection}/{index}"))
        } else {
            Err(Self::absent(collection, index, place))
        }
    }

    fn absent(collection: &str, index: usize, place: &str) -> Fault {
        Fault::Malformed {
            place: place.into(),
            what: format!("refers to {collection}[{index}], which does not exist"),
        }
    }

    /// The document's outermost object.
    pub fn root(&self) -> Object<'_> {
        // That it is an object was checked when it was parsed.
        match Object::new(&self.root, String::new()) {
            Ok(object) => object,
            Err(_) => unreachable!("the root of a parsed document is an object"),
        }
    }

    /// The outermost value.
    pub fn value(&self) -> &Value {
        &self.root
    }

    /// How many entries a collection such as `meshes` has.
    pub fn len(&self, collection: &str) -> usize {
        mending::len(&self.root, collection)
    }

    /// An entry of a collection, which `place` refers to.
    pub fn item(&self, collection: &str, index: usize, place: &str) -> Result<Object<'_>, Fault> {
        match self.root.get(collection).and_then(|list| list.get(index)) {
            Some(value) => Object::new(value, format!("/{collection}/{index}")),
            None => Err(Self::absent(collection, index, place)),
        }
    }

    /// Notes a flaw that does no harm.
    pub fn warn(&self, warning: impl Into<String>) {
        let (mut warnings, warning) = (self.warnings.borrow_mut(), warning.into());
        if warnings.kept.len() >= MAX_WARNINGS {
            warnings.dropped += 1;
        } else if !warnings.kept.contains(&warning) {
            warnings.kept.push(warning);
        }
    }

    /// All warnings so far.
    pub fn warnings(&self) -> Vec<String> {
        let warnings = self.warnings.borrow();
        let mut all = warnings.kept.clone();
        if warnings.dropped > 0 {
            all.push(format!("… and {} more", warnings.dropped));
        }
        all
    }
}

/// A name, unless it is empty.
pub(crate) fn named(name: Option<&str>) -> Option<String> {
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

/// What loading may still use.
pub(crate) struct Budget {
    memory: Cell<u64>,
    triangles: Cell<u64>,
    work: Cell<u64>,
    checks: Cell<u64>,
    pub options: LoadOptions,
}

/// Values that may be read or computed in all: some seconds' worth.
const MAX_WORK: u64 = 1 << 30;

/// Values that may be looked at only to tell of flaws: some tenths of a second's worth.
const MAX_CHECKS: u64 = 1 << 27;

impl Budget {
    pub fn new(options: &LoadOptions) -> Self {
        Self {
            memory: Cell::new(options.max_memory),
            triangles: Cell::new(options.max_triangles),
            work: Cell::new(MAX_WORK),
            checks: Cell::new(MAX_CHECKS),
            options: *options,
        }
    }

    /// Takes `bytes` for `what`.
    pub fn memory(&self, bytes: u64, what: &str) -> Result<(), Fault> {
        let limit = self.options.max_memory >> 20;
        take(&self.memory, bytes, || {
            format!("{what} takes {} MiB of a limit of {limit} MiB in all", bytes >> 20)
        })
    }

    /// What is left.
    pub fn memory_left(&self) -> u64 {
        self.memory.get()
    }

    /// Gives `bytes` back.
    pub fn release(&self, bytes: u64) {
        self.memory.set(self.memory.get() + bytes);
    }

    /// Takes `count` triangles.
    pub fn triangles(&self, count: u64) -> Result<(), Fault> {
        take(&self.triangles, count, || format!("it has more than {} triangles", self.options.max_triangles))
    }

    /// Takes the time for `count` values, for `place`.
    pub fn work(&self, count: u64, place: &str) -> Result<(), Fault> {
        take(&self.work, count, || format!("{place}: reading the scene takes too many steps"))
    }

    /// Takes the time to look at `count` values for flaws; false if it is used up and they are to be passed over.
    pub fn check(&self, count: usize) -> bool {
        let left = self.checks.get().checked_sub(count as u64);
        self.checks.set(left.unwrap_or(self.checks.get()));
        left.is_some()
    }
}

fn take(cell: &Cell<u64>, amount: u64, what: impl Fn() -> String) -> Result<(), Fault> {
    let left = cell.get().checked_sub(amount).ok_or_else(|| Fault::TooBig { what: what() })?;
    cell.set(left);
    Ok(())
}

/// The canonical folder of a file.
pub(crate) fn folder_of(file: &Path) -> std::io::Result<PathBuf> {
    let file = file.canonicalize()?;
    Ok(file.parent().map(Path::to_path_buf).unwrap_or(file))
}
