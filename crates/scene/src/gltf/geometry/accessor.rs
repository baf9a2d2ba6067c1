//! Reading accessors: every element is checked to lie inside its buffer before the first one is read.
//!
//! An [`Accessor`] is a checked view: count, component type, shape, position of the elements, and its sparse
//! replacements ready for lookup. Elements are read one at a time and never copied as a whole, because many
//! primitives may share one large accessor.

use crate::error::Fault;
use crate::gltf::document::Document;
use gltf::accessor::Dimensions;
use gltf::json::accessor::sparse::Sparse;
use gltf::json::validation::Checked;

/// glTF's component types.
pub(crate) use gltf::accessor::DataType as Component;

/// The component type of glTF's number.
pub(crate) fn component_from_code(code: u64) -> Option<Component> {
    Some(match code {
        5120 => Component::I8,
        5121 => Component::U8,
        5122 => Component::I16,
        5123 => Component::U16,
        5125 => Component::U32,
        5126 => Component::F32,
        _ => return None,
    })
}

/// The value at the start of `bytes`, as stored. All of them are exact in f64.
pub(crate) fn read_component(component: Component, bytes: &[u8]) -> f64 {
    match component {
        Component::I8 => f64::from(bytes[0] as i8),
        Component::U8 => f64::from(bytes[0]),
        Component::I16 => f64::from(i16::from_le_bytes([bytes[0], bytes[1]])),
        Component::U16 => f64::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        Component::U32 => f64::from(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
        Component::F32 => f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
    }
}

/// The number that a stored value represents if normalised (glTF 2.0 §3.11.2).
fn normalized(component: Component, value: f64) -> f64 {
    match component {
        Component::I8 => (value / 127.0).max(-1.0),
        Component::U8 => value / 255.0,
        Component::I16 => (value / 32767.0).max(-1.0),
        Component::U16 => value / 65535.0,
        Component::U32 | Component::F32 => value,
    }
}

/// The layout of an element's components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shape {
    rows: usize,
    columns: usize,
}

impl Shape {
    /// The shape with this name in glTF, such as VEC3; `None` if there is none.
    pub fn from_name(name: &str) -> Option<Self> {
        Some(Self::from(match name {
            "SCALAR" => Dimensions::Scalar,
            "VEC2" => Dimensions::Vec2,
            "VEC3" => Dimensions::Vec3,
            "VEC4" => Dimensions::Vec4,
            "MAT2" => Dimensions::Mat2,
            "MAT3" => Dimensions::Mat3,
            "MAT4" => Dimensions::Mat4,
            _ => return None,
        }))
    }

    /// The number of components of an element.
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

    /// The bytes of an element whose components are of this type.
    pub fn size(self, component: Component) -> usize {
        self.columns * self.column_size(component)
    }

    /// Byte offset of a component.
    fn offset(self, component: Component, index: usize) -> usize {
        index / self.rows * self.column_size(component) + index % self.rows * component.size()
    }
}

impl From<Dimensions> for Shape {
    fn from(dimensions: Dimensions) -> Self {
        let (rows, columns) = match dimensions {
            Dimensions::Scalar => (1, 1),
            Dimensions::Vec2 => (2, 1),
            Dimensions::Vec3 => (3, 1),
            Dimensions::Vec4 => (4, 1),
            Dimensions::Mat2 => (2, 2),
            Dimensions::Mat3 => (3, 3),
            Dimensions::Mat4 => (4, 4),
        };
        Self { rows, columns }
    }
}

/// Elements in a buffer view.
struct ElementView<'a> {
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
    base: Option<ElementView<'a>>,
    /// Replaced elements, sorted by index, and their values.
    replaced: Vec<(u32, u32)>,
    replacements_increase: bool,
    values: Option<ElementView<'a>>,
}

impl<'a> Accessor<'a> {
    /// Opens and checks accessor `index`, to which `place` refers.
    ///
    /// # Errors
    /// It does not exist, is faulty, or reaches beyond its buffers.
    pub fn open(document: &'a Document<'_>, index: usize, place: &str) -> Result<Self, Fault> {
        let place = document.entry("accessors", index, place)?;
        document.check_below(&place)?;
        let file = document.typed().accessors().nth(index);
        let json = document.typed().as_json().accessors.get(index);
        let (Some(file), Some(json)) = (file, json) else { return Err(Fault::NoData { place }) };
        let (component, shape) = (file.data_type(), Shape::from(file.dimensions()));
        let count = file.count();
        let base = match json.buffer_view {
            Some(view) => Some(element_view(
                document,
                &place,
                view.value(),
                file.offset(),
                count,
                shape.size(component),
            )?),
            None => None,
        };
        let mut accessor = Self {
            place,
            count,
            component,
            shape,
            normalized: file.normalized(),
            base,
            replaced: Vec::new(),
            replacements_increase: true,
            values: None,
        };
        if count >= u32::MAX as usize {
            return Err(Fault::Malformed {
                place: format!("{}/count", accessor.place),
                what: format!("{count} is too large"),
            });
        }
        if let Some(sparse) = &json.sparse {
            accessor.open_sparse(document, sparse)?;
        }
        Ok(accessor)
    }

    fn open_sparse(&mut self, document: &'a Document<'_>, sparse: &Sparse) -> Result<(), Fault> {
        let place = format!("{}/sparse", self.place);
        let malformed =
            |key: &str, what: String| Err(Fault::Malformed { place: format!("{place}/{key}"), what });
        let (indices, values) = (&sparse.indices, &sparse.values);
        let component = match &indices.component_type {
            Checked::Valid(component) => component.0,
            Checked::Invalid => {
                return malformed("indices/componentType", "is not an unsigned integer type".into());
            }
        };
        let count = usize::try_from(sparse.count.0).unwrap_or(usize::MAX);
        if count > self.count {
            return malformed("count", format!("{count} is more than the accessor's {}", self.count));
        }
        let part = |key: &str, view: usize, offset: u64, size: usize| {
            let offset = usize::try_from(offset).unwrap_or(usize::MAX);
            element_view(document, &format!("{place}/{key}"), view, offset, count, size)
        };
        let index_elements =
            part("indices", indices.buffer_view.value(), indices.byte_offset.0, component.size())?;
        let size = self.shape.size(self.component);
        self.values = Some(part("values", values.buffer_view.value(), values.byte_offset.0, size)?);
        document.budget.take_memory(8 * count as u64, &self.place)?;
        for i in 0..count {
            let index = read_component(component, &index_elements.bytes[i * index_elements.stride..]) as u32;
            if index as usize >= self.count {
                return malformed(
                    "indices/bufferView",
                    format!("replaces element {index} of {} elements", self.count),
                );
            }
            self.replaced.push((index, i as u32));
        }
        self.replacements_increase = self.replaced.windows(2).all(|pair| pair[0].0 < pair[1].0);
        self.replaced.sort_unstable();
        Ok(())
    }

    /// Whether it has data; otherwise it is all zeros, which an extension may fill in.
    pub fn has_data(&self) -> bool {
        self.base.is_some() || self.values.is_some()
    }

    /// Whether the indices of its sparse replacements increase, as they must.
    pub fn replacements_increase(&self) -> bool {
        self.replacements_increase
    }

    /// The stored value of component `component` of element `index`, which must be below `count`.
    pub fn raw_value(&self, index: usize, component: usize) -> f64 {
        let at = self.shape.offset(self.component, component);
        match self.element(index) {
            Some(bytes) => read_component(self.component, &bytes[at..]),
            None => 0.0,
        }
    }

    /// A component of element `index` as a number, normalised if the accessor says so.
    pub fn value(&self, index: usize, component: usize) -> f64 {
        let stored = self.raw_value(index, component);
        if self.normalized { normalized(self.component, stored) } else { stored }
    }

    /// The bytes from the start of an element on; `None` if the element is zero. `index` must be below `count`.
    pub fn element(&self, index: usize) -> Option<&'a [u8]> {
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

    /// The first N components of element `index` as numbers, normalised if the accessor is.
    pub fn floats<const N: usize>(&self, index: usize) -> [f32; N] {
        self.doubles(index).map(|value| value as f32)
    }

    /// The components of element `index`, as [`Self::floats`], in f64.
    pub fn doubles<const N: usize>(&self, index: usize) -> [f64; N] {
        let Some(bytes) = self.element(index) else { return [0.0; N] };
        std::array::from_fn(|i| {
            let value = read_component(self.component, &bytes[self.shape.offset(self.component, i)..]);
            if self.normalized { normalized(self.component, value) } else { value }
        })
    }

    /// An error that says what is wrong with the accessor.
    pub fn malformed(&self, what: impl Into<String>) -> Fault {
        Fault::Malformed { place: self.place.clone(), what: what.into() }
    }

    /// Checks that elements have one of the `allowed` numbers of components; `role` says in an error what they are
    /// for.
    ///
    /// # Errors
    /// They have another number.
    pub fn expect_components(self, allowed: &[usize], role: &str) -> Result<Self, Fault> {
        if self.shape.columns == 1 && allowed.contains(&self.shape.rows) {
            Ok(self)
        } else {
            Err(self.malformed(format!("{role} cannot be of this type")))
        }
    }
}

/// `count` elements of `size` bytes, which must lie in the buffer view that `owner` refers to.
fn element_view<'a>(
    document: &'a Document<'_>,
    owner: &str,
    view: usize,
    offset: usize,
    count: usize,
    size: usize,
) -> Result<ElementView<'a>, Fault> {
    let (bytes, stride) = document.buffer_view(view, &format!("{owner}/bufferView"))?;
    let stride = stride.unwrap_or(size);
    if stride < size {
        return Err(Fault::Malformed {
            place: format!("{owner}/bufferView"),
            what: format!("the stride {stride} of its view is less than the {size} bytes of an element"),
        });
    }
    let end = match count {
        0 => Some(offset),
        _ => (count - 1).checked_mul(stride).and_then(|n| n.checked_add(size)?.checked_add(offset)),
    };
    if end.is_none_or(|end| end > bytes.len()) {
        return Err(Fault::Malformed {
            place: owner.into(),
            what: format!(
                "{count} elements from byte {offset} do not fit its buffer view of {} bytes",
                bytes.len()
            ),
        });
    }
    Ok(ElementView { bytes: &bytes[offset..], stride })
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
        assert_eq!((0..4).map(|i| matrix.raw_value(0, i)).collect::<Vec<_>>(), [0.0, 1.0, 4.0, 5.0]);
    }

    #[test]
    fn sparse_without_a_base_is_zero_elsewhere() {
        let document = document(
            r#"{"componentType":5121,"type":"SCALAR","count":9,"sparse":{"count":2,
               "indices":{"bufferView":0,"byteOffset":3,"componentType":5121},"values":{"bufferView":0,"byteOffset":6}}}"#,
        );
        let sparse = Accessor::open(&document, 0, "").unwrap();
        let all: Vec<f64> = (0..9).map(|i| sparse.raw_value(i, 0)).collect();
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
