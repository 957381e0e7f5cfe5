//! Numbers out of accessors, every slice checked; integers become floats as the format says.

use std::cell::Cell;

use ::gltf::json::Root;
use ::gltf::json::accessor::{Accessor, ComponentType, Type};
use ::gltf::json::validation::Checked;

use crate::model::error::ModelError;

use super::data::{BufferView, GltfBuffers};

/// The most elements read from all accessors of a model, instances counted each time; bounds time and memory.
const MAX_ELEMENTS: usize = 1 << 25;

/// Reads accessors of one document.
pub(super) struct Accessors<'a> {
    root: &'a Root,
    data: &'a GltfBuffers,
    read: Cell<usize>,
}

/// How one component is stored.
#[derive(Clone, Copy, Debug)]
struct Component {
    kind: ComponentType,
    normalized: bool,
}

impl Component {
    /// The component at the start of `bytes`, which must be long enough.
    fn read(self, bytes: &[u8]) -> f32 {
        let two = || [bytes[0], bytes[1]];
        let four = || [bytes[0], bytes[1], bytes[2], bytes[3]];
        let (value, most) = match self.kind {
            ComponentType::I8 => (f32::from(bytes[0] as i8), 127.0),
            ComponentType::U8 => (f32::from(bytes[0]), 255.0),
            ComponentType::I16 => (f32::from(i16::from_le_bytes(two())), 32_767.0),
            ComponentType::U16 => (f32::from(u16::from_le_bytes(two())), 65_535.0),
            ComponentType::U32 => (u32::from_le_bytes(four()) as f32, u32::MAX as f32),
            ComponentType::F32 => return f32::from_le_bytes(four()),
        };
        if self.normalized { (value / most).max(-1.0) } else { value }
    }
}

/// How many elements of what accessor are read, and how they lie.
struct AccessorLayout {
    count: usize,
    component: Component,
    /// Bytes of one element.
    size: usize,
    /// Bytes from one element to the next where the view does not say.
    offset: usize,
}

impl<'a> Accessors<'a> {
    /// A reader that has read nothing yet.
    pub(super) fn new(root: &'a Root, data: &'a GltfBuffers) -> Self {
        Self { root, data, read: Cell::new(0) }
    }

    /// Vectors of `N` components.
    ///
    /// # Errors
    /// [`ModelError::Gltf`] where the accessor is of another type or does not hold what it states.
    pub(super) fn vectors<const N: usize>(&self, index: usize) -> Result<Vec<[f32; N]>, ModelError> {
        self.elements(index, N, |component, bytes| {
            let size = component.kind.size();
            std::array::from_fn(|place| component.read(&bytes[place * size..]))
        })
    }

    /// Indices of vertices.
    ///
    /// # Errors
    /// As [`Accessors::vectors`].
    pub(super) fn indices(&self, index: usize) -> Result<Vec<u32>, ModelError> {
        self.elements(index, 1, |component, bytes| match component.kind {
            ComponentType::U8 => u32::from(bytes[0]),
            ComponentType::U16 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            ComponentType::U32 => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
            _ => u32::MAX,
        })
    }

    /// How many components an element of accessor `index` has.
    pub(super) fn components(&self, index: usize) -> usize {
        match self.root.accessors.get(index).map(|accessor| accessor.type_) {
            Some(Checked::Valid(kind)) => kind.multiplicity(),
            _ => 0,
        }
    }

    /// Counts `elements` against what one model may read.
    ///
    /// # Errors
    /// [`ModelError::TooLarge`].
    pub(super) fn charge(&self, elements: usize) -> Result<(), ModelError> {
        let read = self.read.get().saturating_add(elements);
        self.read.set(read);
        if read > MAX_ELEMENTS {
            return Err(ModelError::TooLarge { what: "vertices, indices and joints", limit: MAX_ELEMENTS });
        }
        Ok(())
    }

    fn elements<T: Clone>(
        &self,
        index: usize,
        components: usize,
        one: impl Fn(Component, &[u8]) -> T,
    ) -> Result<Vec<T>, ModelError> {
        let fail = |reason: String| ModelError::gltf(format!("accessors[{index}]"), reason);
        let accessor = self.root.accessors.get(index).ok_or_else(|| fail("it is not there".into()))?;
        let layout = self.layout(accessor, components).map_err(&fail)?;
        self.charge(layout.count)?;
        let mut elements = match accessor.buffer_view {
            Some(view) => {
                let view = self.data.view(self.root, view.value())?;
                let bytes = slices(view, &layout).map_err(&fail)?;
                bytes.map(|bytes| one(layout.component, bytes)).collect()
            }
            None => vec![one(layout.component, &[0; 64]); layout.count],
        };
        if let Some(sparse) = &accessor.sparse {
            let count = usize::try_from(sparse.count.0).ok().filter(|&count| count <= layout.count);
            let count = count.ok_or_else(|| fail("more of it is sparse than there is".into()))?;
            let values = self.data.view(self.root, sparse.values.buffer_view.value())?;
            let values = slices(values, &layout.sparse(count, sparse.values.byte_offset.0)).map_err(&fail)?;
            let places = self.sparse_places(sparse, count).map_err(&fail)?;
            for (place, bytes) in places.into_iter().zip(values) {
                let slot =
                    elements.get_mut(place).ok_or_else(|| fail("a sparse index is too large".into()))?;
                *slot = one(layout.component, bytes);
            }
        }
        Ok(elements)
    }

    fn layout(&self, accessor: &Accessor, components: usize) -> Result<AccessorLayout, String> {
        let (Checked::Valid(kind), Checked::Valid(component)) = (accessor.type_, accessor.component_type)
        else {
            return Err("its type is none of those allowed".into());
        };
        if kind.multiplicity() != components {
            return Err(format!("it has {} components where {components} are needed", kind.multiplicity()));
        }
        let component = Component { kind: component.0, normalized: accessor.normalized };
        if kind != Type::Scalar && component.kind == ComponentType::U32 {
            return Err("vectors of 32-bit integers are not allowed".into());
        }
        let count = usize::try_from(accessor.count.0).ok().filter(|&count| count <= MAX_ELEMENTS);
        let count = count.ok_or_else(|| format!("{} elements are too many", accessor.count.0))?;
        let offset = usize::try_from(accessor.byte_offset.unwrap_or_default().0);
        let offset = offset.map_err(|_| "its offset is too large".to_owned())?;
        Ok(AccessorLayout { count, component, size: component.kind.size() * components, offset })
    }

    fn sparse_places(
        &self,
        sparse: &::gltf::json::accessor::sparse::Sparse,
        count: usize,
    ) -> Result<Vec<usize>, String> {
        let Checked::Valid(kind) = sparse.indices.component_type else {
            return Err("its sparse indices have a type that is not allowed".into());
        };
        let component = Component { kind: kind.0, normalized: false };
        let offset = usize::try_from(sparse.indices.byte_offset.0).map_err(|_| "an offset is too large")?;
        let layout = AccessorLayout { count, component, size: kind.0.size(), offset };
        let view = self
            .data
            .view(self.root, sparse.indices.buffer_view.value())
            .map_err(|error| error.to_string())?;
        let place = |bytes: &[u8]| bytes.iter().rev().fold(0, |place, &byte| place << 8 | usize::from(byte));
        Ok(slices(view, &layout)?.map(place).collect())
    }
}

impl AccessorLayout {
    fn sparse(&self, count: usize, offset: u64) -> Self {
        Self { count, offset: usize::try_from(offset).unwrap_or(usize::MAX), ..*self }
    }
}

/// The bytes of each element, once it is certain that all are there.
fn slices<'a>(
    view: BufferView<'a>,
    layout: &AccessorLayout,
) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, String> {
    let stride = view.stride.unwrap_or(layout.size);
    let &AccessorLayout { count, size, offset, .. } = layout;
    if stride < size {
        return Err(format!("its elements of {size} bytes lie {stride} bytes apart"));
    }
    let end = match count.checked_sub(1) {
        None => Some(0),
        Some(before) => {
            before.checked_mul(stride).and_then(|start| start.checked_add(size)?.checked_add(offset))
        }
    };
    if end.is_none_or(|end| end > view.bytes.len()) {
        let have = view.bytes.len();
        return Err(format!("{count} elements from byte {offset} reach past its view of {have} bytes"));
    }
    Ok((0..count).map(move |index| &view.bytes[offset + index * stride..][..size]))
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Nothing;

    impl crate::model::Companions for Nothing {
        fn load(&self, name: &str) -> Result<Vec<u8>, String> {
            Err(format!("no {name}"))
        }
    }

    /// Reads two-component vectors from `accessor` over the eight bytes 0 to 7.
    fn read(accessor: &str) -> Result<Vec<[f32; 2]>, ModelError> {
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":8}}],"bufferViews":
            [{{"buffer":0,"byteLength":8}},{{"buffer":0,"byteLength":8,"byteStride":4}}],"accessors":[{accessor}]}}"#
        );
        let root: Root = serde_json::from_str(&json).expect("sound JSON");
        let data = GltfBuffers::load(&root, Some(&[0, 1, 2, 3, 4, 5, 6, 7]), &Nothing);
        Accessors::new(&root, &data).vectors(0)
    }

    #[test]
    fn strides_and_offsets_are_kept_to() {
        let accessor = r#"{"bufferView":1,"byteOffset":1,"count":2,"componentType":5121,"type":"VEC2"}"#;
        assert_eq!(read(accessor), Ok(vec![[1.0, 2.0], [5.0, 6.0]]));
    }

    #[test]
    fn normalized_integers_are_shares_of_one() {
        let accessor = r#"{"bufferView":0,"count":1,"componentType":5121,"type":"VEC2","normalized":true}"#;
        assert_eq!(read(accessor), Ok(vec![[0.0, 1.0 / 255.0]]));
    }

    #[test]
    fn sparse_values_replace_zeros() {
        let accessor = r#"{"count":3,"componentType":5121,"type":"VEC2","sparse":{"count":1,
            "indices":{"bufferView":0,"byteOffset":2,"componentType":5121},"values":{"bufferView":0,"byteOffset":4}}}"#;
        assert_eq!(read(accessor), Ok(vec![[0.0; 2], [0.0; 2], [4.0, 5.0]]));
    }

    #[test]
    fn what_reaches_past_its_view_is_refused() {
        for forged in [
            r#"{"bufferView":0,"count":5,"componentType":5121,"type":"VEC2"}"#,
            r#"{"bufferView":0,"count":2,"byteOffset":5,"componentType":5121,"type":"VEC2"}"#,
            r#"{"bufferView":0,"count":18446744073709551615,"componentType":5121,"type":"VEC2"}"#,
            r#"{"bufferView":0,"count":30000000,"byteOffset":18446744073709551615,"componentType":5121,"type":"VEC2"}"#,
            r#"{"count":33554433,"componentType":5121,"type":"VEC2"}"#,
            r#"{"bufferView":0,"count":1,"componentType":5121,"type":"VEC3"}"#,
        ] {
            assert!(read(forged).is_err(), "{forged}");
        }
    }
}
