//! Reading accessors: every element is known to lie inside its buffer before the first one is read.
//!
//! An [`Accessor`] is a checked view: count, component type, shape and where the elements lie, its sparse
//! replacements ready to be looked up. Elements are read one at a time and never copied as a whole, because
//! many primitives may share one large accessor.

use crate::document::Document;
use crate::error::Fault;
use crate::json_object::Object;

/// glTF's component types.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    /// By glTF's number.
    pub fn of(code: u64) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    /// Bytes.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The value at the start of `bytes`, as stored. Every one of them is exact in f64.
    fn read(self, bytes: &[u8]) -> f64 {
        match self {
            Self::I8 => f64::from(bytes[0] as i8),
            Self::U8 => f64::from(bytes[0]),
            Self::I16 => f64::from(i16::from_le_bytes([bytes[0], bytes[1]])),
            Self::U16 => f64::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            Self::U32 => f64::from(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
            Self::F32 => f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
        }
    }

    /// A stored value as the number it stands for if normalised (glTF 2.0 §3.11.2).
    fn normalized(self, value: f64) -> f64 {
        match self {
            Self::I8 => (value / 127.0).max(-1.0),
            Self::U8 => value / 255.0,
            Self::I16 => (value / 32767.0).max(-1.0),
            Self::U16 => value / 65535.0,
            Self::U32 | Self::F32 => value,
        }
    }
}

/// Where the components of an element lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    rows: usize,
    columns: usize,
}

impl Shape {
    /// By glTF's name.
    pub fn of(name: &str) -> Option<Self> {
        let (rows, columns) = match name {
            "SCALAR" => (1, 1),
            "VEC2" => (2, 1),
            "VEC3" => (3, 1),
            "VEC4" => (4, 1),
            "MAT2" => (2, 2),
            "MAT3" => (3, 3),
            "MAT4" => (4, 4),
            _ => return None,
        };
        Some(Self { rows, columns })
    }

    /// Numbers an element.
    pub fn components(self) -> usize {
        self.rows * self.columns
    }

    /// Whether it is a matrix.
    pub fn is_matrix(self) -> bool {
        self.columns > 1
    }

    /// Bytes from column to column: a matrix's columns start at multiples of 4.
    fn column_size(self, component: Component) -> usize {
        let size = self.rows * component.size();
        if self.columns > 1 { size.next_multiple_of(4) } else { size }
    }

    /// Bytes an element.
    pub fn size(self, component: Component) -> usize {
        self.columns * self.column_size(component)
    }

    /// Byte offset of a component.
    fn offset(self, component: Component, index: usize) -> usize {
        index / self.rows * self.column_size(component) + index % self.rows * component.size()
    }
}

/// Elements in a buffer view.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
}

/// A checked accessor.
pub(crate) struct Accessor<'a> {
    /// JSON pointer.
    pub place: String,
    pub count: usize,
    pub component: Component,
    pub shape: Shape,
    pub normalized: bool,
    /// Absent: zeros.
    base: Option<Elements<'a>>,
    /// Replaced elements, sorted by index, and their values.
    replaced: Vec<(u32, u32)>,
    replacements_increase: bool,
    values: Option<Elements<'a>>,
}

impl<'a> Accessor<'a> {
    /// Checks accessor `index`, which `place` refers to.
    pub fn open(document: &'a Document<'_>, index: usize, place: &str) -> Result<Self, Fault> {
        let object = document.item("accessors", index, place)?;
        let component = object.required("componentType", object.integer("componentType")?)?;
        let component = Component::of(component)
            .ok_or_else(|| object.malformed("componentType", format!("{component} is unknown")))?;
        let shape = object.required("type", object.text("type")?)?;
        let shape =
            Shape::of(shape).ok_or_else(|| object.malformed("type", format!("{shape:?} is unknown")))?;
        let count = object.required("count", object.integer("count")?)?;
        let offset = object.integer("byteOffset")?.unwrap_or(0);
        let base = match object.index("bufferView")? {
            Some(view) => Some(elements(document, &object, view, offset, count, shape.size(component))?),
            None => None,
        };
        let count = usize::try_from(count)
            .ok()
            .filter(|&count| count < u32::MAX as usize)
            .ok_or_else(|| object.malformed("count", format!("{count} is too large")))?;
        let mut accessor = Self {
            place: object.place.clone(),
            count,
            component,
            shape,
            normalized: object.flag("normalized")?,
            base,
            replaced: Vec::new(),
            replacements_increase: true,
            values: None,
        };
        if let Some(sparse) = object.object("sparse")? {
            accessor.open_sparse(document, &sparse)?;
        }
        Ok(accessor)
    }

    fn open_sparse(&mut self, document: &'a Document<'_>, sparse: &Object<'_>) -> Result<(), Fault> {
        let count = sparse.required("count", sparse.integer("count")?)?;
        if count > self.count as u64 {
            return Err(
                sparse.malformed("count", format!("{count} is more than the accessor's {}", self.count))
            );
        }
        let indices = sparse.required("indices", sparse.object("indices")?)?;
        let code = indices.required("componentType", indices.integer("componentType")?)?;
        let component = match Component::of(code) {
            Some(component @ (Component::U8 | Component::U16 | Component::U32)) => component,
            _ => {
                return Err(indices.malformed("componentType", format!("{code} is no unsigned integer type")));
            }
        };
        let part = |object: &Object<'_>, size: usize| -> Result<Elements<'a>, Fault> {
            let view = object.required("bufferView", object.index("bufferView")?)?;
            let offset = object.integer("byteOffset")?.unwrap_or(0);
            elements(document, object, view, offset, count, size)
        };
        let found = part(&indices, component.size())?;
        let values = sparse.required("values", sparse.object("values")?)?;
        self.values = Some(part(&values, self.shape.size(self.component))?);
        document.budget.memory(8 * count, &self.place)?;
        for i in 0..count as usize {
            let index = component.read(&found.bytes[i * found.stride..]) as u32;
            if index as usize >= self.count {
                return Err(indices.malformed(
                    "bufferView",
                    format!("replaces element {index} of {} elements", self.count),
                ));
            }
            self.replaced.push((index, i as u32));
        }
        self.replacements_increase = self.replaced.windows(2).all(|pair| pair[0].0 < pair[1].0);
        self.replaced.sort_unstable();
        Ok(())
    }

    /// Whether it has data of its own; else it is all zeros, to be filled in by an extension perhaps.
    pub fn has_data(&self) -> bool {
        self.base.is_some() || self.values.is_some()
    }

    /// Whether the indices of its sparse replacements increase, as they must.
    pub fn replacements_increase(&self) -> bool {
        self.replacements_increase
    }

    /// The stored value of component `component` of element `index`, which must be below `count`.
    pub fn stored(&self, index: usize, component: usize) -> f64 {
        let at = self.shape.offset(self.component, component);
        match self.element(index) {
            Some(bytes) => self.component.read(&bytes[at..]),
            None => 0.0,
        }
    }

    /// The bytes of an element, or nothing if it is zero.
    fn element(&self, index: usize) -> Option<&'a [u8]> {
        if let Some(values) = &self.values {
            // Of several replacements of one element the last counts.
            let after = self.replaced.partition_point(|&(element, _)| element as usize <= index);
            if let Some(&(_, i)) =
                self.replaced[..after].last().filter(|&&(element, _)| element as usize == index)
            {
                return Some(&values.bytes[i as usize * values.stride..]);
            }
        }
        self.base.as_ref().map(|base| &base.bytes[index * base.stride..])
    }

    /// The first N components of element `index`: as numbers, normalised if the accessor says so.
    pub fn floats<const N: usize>(&self, index: usize) -> [f32; N] {
        self.doubles(index).map(|value| value as f32)
    }

    /// As [`Self::floats`], in f64.
    pub fn doubles<const N: usize>(&self, index: usize) -> [f64; N] {
        let Some(bytes) = self.element(index) else { return [0.0; N] };
        std::array::from_fn(|i| {
            let value = self.component.read(&bytes[self.shape.offset(self.component, i)..]);
            if self.normalized { self.component.normalized(value) } else { value }
        })
    }

    /// An error about it.
    pub fn malformed(&self, what: impl Into<String>) -> Fault {
        Fault::Malformed { place: self.place.clone(), what: what.into() }
    }

    /// Checks that elements have one of these numbers of components.
    pub fn expect_components(self, allowed: &[usize], role: &str) -> Result<Self, Fault> {
        if self.shape.columns == 1 && allowed.contains(&self.shape.rows) {
            Ok(self)
        } else {
            Err(self.malformed(format!("{role} cannot be of this type")))
        }
    }
}

/// `count` elements of `size` bytes, which must lie in the buffer view.
fn elements<'a>(
    document: &'a Document<'_>,
    owner: &Object<'_>,
    view: usize,
    offset: u64,
    count: u64,
    size: usize,
) -> Result<Elements<'a>, Fault> {
    let (bytes, stride) = document.buffer_view(view, &format!("{}/bufferView", owner.place))?;
    let stride = match stride {
        None | Some(0) => size,
        Some(stride) if stride < size => {
            return Err(owner.malformed(
                "bufferView",
                format!("the stride {stride} of its view is less than the {size} bytes of an element"),
            ));
        }
        Some(stride) => stride,
    };
    let end = match count {
        0 => Some(offset),
        _ => (count - 1)
            .checked_mul(stride as u64)
            .and_then(|n| n.checked_add(size as u64)?.checked_add(offset)),
    };
    if end.is_none_or(|end| end > bytes.len() as u64) {
        return Err(Fault::Malformed {
            place: owner.place.clone(),
            what: format!(
                "{count} elements from byte {offset} do not fit its buffer view of {} bytes",
                bytes.len()
            ),
        });
    }
    Ok(Elements { bytes: &bytes[offset as usize..], stride })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LoadOptions;

    fn document(accessors: &str) -> Document<'static> {
        let text = format!(
            r#"{{"asset":{{"version":"2.0"}},
            "buffers":[{{"byteLength":12,"uri":"data:;base64,AAECAwQFgIGC/v//"}}],
            "bufferViews":[{{"buffer":0,"byteLength":12}},{{"buffer":0,"byteLength":12,"byteStride":4}},
                           {{"buffer":0,"byteOffset":8,"byteLength":5}}],
            "accessors":[{accessors}]}}"#
        );
        Document::parse(Box::leak(text.into_boxed_str()).as_bytes(), "/".into(), &LoadOptions::default())
            .unwrap()
    }

    #[test]
    fn normalised_integers() {
        let document = document(
            r#"{"bufferView":0,"componentType":5120,"normalized":true,"type":"VEC2","count":6},
               {"bufferView":0,"componentType":5121,"normalized":true,"type":"VEC2","count":6},
               {"bufferView":0,"componentType":5123,"type":"SCALAR","count":6}"#,
        );
        let signed = Accessor::open(&document, 0, "").unwrap();
        assert_eq!(signed.floats::<2>(3), [-1.0, -1.0]);
        assert_eq!(signed.floats::<2>(1), [2.0 / 127.0, 3.0 / 127.0]);
        assert_eq!(Accessor::open(&document, 1, "").unwrap().floats::<2>(5), [1.0, 1.0]);
        assert_eq!(Accessor::open(&document, 2, "").unwrap().floats::<1>(5), [65535.0]);
    }

    #[test]
    fn columns_of_small_matrices_are_padded() {
        let document = document(r#"{"bufferView":0,"componentType":5121,"type":"MAT2","count":1}"#);
        let matrix = Accessor::open(&document, 0, "").unwrap();
        assert_eq!((0..4).map(|i| matrix.stored(0, i)).collect::<Vec<_>>(), [0.0, 1.0, 4.0, 5.0]);
    }

    #[test]
    fn sparse_without_a_base_is_zero_elsewhere() {
        let document = document(
            r#"{"componentType":5121,"type":"SCALAR","count":9,"sparse":{"count":2,
               "indices":{"bufferView":0,"byteOffset":3,"componentType":5121},"values":{"bufferView":0,"byteOffset":6}}}"#,
        );
        let sparse = Accessor::open(&document, 0, "").unwrap();
        let all: Vec<f64> = (0..9).map(|i| sparse.stored(i, 0)).collect();
        assert_eq!(all, [0.0, 0.0, 0.0, 128.0, 129.0, 0.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let document = document(
            r#"{"bufferView":0,"componentType":5126,"type":"VEC3","count":4000000000},
               {"bufferView":0,"componentType":5126,"type":"MAT4","count":9007199254740991},
               {"bufferView":1,"componentType":5126,"type":"VEC2","count":1},
               {"bufferView":0,"byteOffset":9007199254740991,"componentType":5121,"type":"SCALAR","count":1},
               {"bufferView":2,"componentType":5121,"type":"SCALAR","count":1},
               {"bufferView":7,"componentType":5121,"type":"SCALAR","count":1},
               {"bufferView":1,"componentType":5121,"type":"SCALAR","count":4},
               {"componentType":5121,"type":"SCALAR","count":5000000000}"#,
        );
        for (index, what) in [
            (0, "do not fit"),
            (1, "do not fit"),
            (2, "the stride 4 of its view is less"),
            (3, "do not fit"),
            (4, "/bufferViews/2: bytes 8 + 5 do not fit"),
            (5, "bufferViews[7], which does not exist"),
            (6, "do not fit"),
            (7, "too large"),
            (8, "accessors[8], which does not exist"),
        ] {
            let fault = Accessor::open(&document, index, "/x").err().unwrap().to_string();
            assert!(fault.contains(what), "{index}: {fault}");
        }
    }
}
