//! Reads numbers from accessors. Every slice is checked before it is read: the readers of the `gltf` crate (1.4.1)
//! panic on forged lengths, and they do not read quantized positions.

use std::cell::Cell;

use ::gltf::accessor::sparse::{IndexType, Sparse};
use ::gltf::accessor::{Accessor, DataType};

use crate::error::ModelError;
use sandtable_base::limits::MODEL_ELEMENTS;

use super::data::{BufferView, GltfBuffers};

pub(super) struct AccessorReader<'a> {
    buffers: &'a GltfBuffers,
    elements_read: Cell<usize>,
}

/// How one component is stored.
#[derive(Clone, Copy, Debug)]
struct Component {
    kind: DataType,
    normalized: bool,
}

impl Component {
    /// The component at the start of `bytes`, which must be long enough.
    fn read(self, bytes: &[u8]) -> f32 {
        let two = || [bytes[0], bytes[1]];
        let four = || [bytes[0], bytes[1], bytes[2], bytes[3]];
        let (value, max) = match self.kind {
            DataType::I8 => (f32::from(bytes[0] as i8), 127.0),
            DataType::U8 => (f32::from(bytes[0]), 255.0),
            DataType::I16 => (f32::from(i16::from_le_bytes(two())), 32_767.0),
            DataType::U16 => (f32::from(u16::from_le_bytes(two())), 65_535.0),
            DataType::U32 => (u32::from_le_bytes(four()) as f32, u32::MAX as f32),
            DataType::F32 => return f32::from_le_bytes(four()),
        };
        if self.normalized { (value / max).max(-1.0) } else { value }
    }
}

/// Where the elements of an accessor are in a view.
#[derive(Clone, Copy)]
struct ElementLayout {
    accessor: usize,
    count: usize,
    size: usize,
    /// Bytes before the first.
    offset: usize,
}

impl<'a> AccessorReader<'a> {
    pub(super) fn new(buffers: &'a GltfBuffers) -> Self {
        Self { buffers, elements_read: Cell::new(0) }
    }

    /// Vectors of `N` components; integers become floats as the format says.
    pub(super) fn vectors<const N: usize>(
        &self,
        accessor: &Accessor<'_>,
    ) -> Result<Vec<[f32; N]>, ModelError> {
        self.elements(accessor, N, |component, bytes| {
            let size = component.kind.size();
            std::array::from_fn(|place| component.read(&bytes[place * size..]))
        })
    }

    pub(super) fn indices(&self, accessor: &Accessor<'_>) -> Result<Vec<u32>, ModelError> {
        self.elements(accessor, 1, |component, bytes| match component.kind {
            DataType::U8 | DataType::U16 | DataType::U32 => unsigned(&bytes[..component.kind.size()]),
            _ => u32::MAX,
        })
    }

    pub(super) fn charge(&self, elements: usize) -> Result<(), ModelError> {
        let total = self.elements_read.get().saturating_add(elements);
        self.elements_read.set(total);
        if total > MODEL_ELEMENTS.count() {
            return Err(ModelError::TooLarge {
                what: "vertices, indices and joints",
                limit: &MODEL_ELEMENTS,
            });
        }
        Ok(())
    }

    fn elements<T: Clone>(
        &self,
        accessor: &Accessor<'_>,
        components: usize,
        read: impl Fn(Component, &[u8]) -> T,
    ) -> Result<Vec<T>, ModelError> {
        let component = Component { kind: accessor.data_type(), normalized: accessor.normalized() };
        let layout = ElementLayout {
            accessor: accessor.index(),
            count: accessor.count(),
            size: component.kind.size() * components,
            offset: accessor.offset(),
        };
        let stated = accessor.dimensions().multiplicity();
        if stated != components {
            return Err(layout.error(format!("it has {stated} components instead of {components}")));
        }
        if components > 1 && component.kind == DataType::U32 {
            return Err(layout.error("vectors of 32-bit integers are not allowed".into()));
        }
        self.charge(layout.count)?;
        let mut elements = match accessor.view() {
            Some(view) => {
                let slices = layout.slices(self.buffers.view(&view)?)?;
                slices.map(|bytes| read(component, bytes)).collect()
            }
            None => vec![read(component, &[0; 64]); layout.count],
        };
        if let Some(sparse) = accessor.sparse() {
            let read = |bytes: &[u8]| read(component, bytes);
            self.replace_sparse(&mut elements, layout, &sparse, read)?;
        }
        Ok(elements)
    }

    fn replace_sparse<T>(
        &self,
        elements: &mut [T],
        layout: ElementLayout,
        sparse: &Sparse<'_>,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<(), ModelError> {
        let (count, indices, values) = (sparse.count(), sparse.indices(), sparse.values());
        if count > layout.count {
            return Err(layout.error("it has more sparse elements than elements".into()));
        }
        let index_size = match indices.index_type() {
            IndexType::U8 => 1,
            IndexType::U16 => 2,
            IndexType::U32 => 4,
        };
        let of_indices = ElementLayout { count, size: index_size, offset: indices.offset(), ..layout };
        let of_values = ElementLayout { count, offset: values.offset(), ..layout };
        let indices = of_indices.slices(self.buffers.view(&indices.view())?)?;
        let values = of_values.slices(self.buffers.view(&values.view())?)?;
        for (index, value) in indices.zip(values) {
            let element = elements.get_mut(unsigned(index) as usize);
            *element.ok_or_else(|| layout.error("a sparse index is out of range".into()))? = read(value);
        }
        Ok(())
    }
}

/// A little-endian integer of at most four bytes.
fn unsigned(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u32::from(byte))
}

impl ElementLayout {
    fn error(&self, reason: String) -> ModelError {
        ModelError::gltf(format!("accessors[{}]", self.accessor), reason)
    }

    /// The bytes of each element; none is read before all are known to be in the view.
    fn slices<'a>(
        self,
        view: BufferView<'a>,
    ) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, ModelError> {
        let Self { count, size, offset, .. } = self;
        let stride = view.stride.unwrap_or(size);
        if stride < size {
            return Err(self.error(format!("its elements of {size} bytes have a stride of {stride} bytes")));
        }
        let end = match count.checked_sub(1) {
            None => Some(0),
            Some(before) => {
                before.checked_mul(stride).and_then(|start| start.checked_add(size)?.checked_add(offset))
            }
        };
        let length = view.bytes.len();
        if end.is_none_or(|end| end > length) {
            let reason = format!("{count} elements from byte {offset} reach past its view of {length} bytes");
            return Err(self.error(reason));
        }
        Ok((0..count).map(move |index| &view.bytes[offset + index * stride..][..size]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::CompanionError;
    use crate::gltf::container::GltfFile;

    struct NoCompanions;

    impl crate::Companions for NoCompanions {
        fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError> {
            Err(format!("no {name}").into())
        }
    }

    /// Reads two-component vectors from `accessor` over the eight bytes 0 to 7.
    fn read(accessor: &str) -> Result<Vec<[f32; 2]>, ModelError> {
        let json = format!(
            r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":8}}],"bufferViews":
            [{{"buffer":0,"byteLength":8}},{{"buffer":0,"byteLength":8,"byteStride":4}}],"accessors":[{accessor}]}}"#
        );
        let file = GltfFile::open(json.as_bytes())?;
        let buffers = GltfBuffers::load(&file.document, Some(&[0, 1, 2, 3, 4, 5, 6, 7]), &NoCompanions);
        let accessor = file.document.accessors().next().expect("one accessor");
        AccessorReader::new(&buffers).vectors(&accessor)
    }

    #[test]
    fn strides_and_offsets_are_followed() {
        let accessor = r#"{"bufferView":1,"byteOffset":1,"count":2,"componentType":5121,"type":"VEC2"}"#;
        assert_eq!(read(accessor).expect("sound"), [[1.0, 2.0], [5.0, 6.0]]);
    }

    #[test]
    fn normalized_integers_are_fractions() {
        let accessor = r#"{"bufferView":0,"count":1,"componentType":5121,"type":"VEC2","normalized":true}"#;
        assert_eq!(read(accessor).expect("sound"), [[0.0, 1.0 / 255.0]]);
    }

    #[test]
    fn sparse_values_replace_zeros() {
        let accessor = r#"{"count":3,"componentType":5121,"type":"VEC2","sparse":{"count":1,
            "indices":{"bufferView":0,"byteOffset":2,"componentType":5121},"values":{"bufferView":0,"byteOffset":4}}}"#;
        assert_eq!(read(accessor).expect("sound"), [[0.0; 2], [0.0; 2], [4.0, 5.0]]);
    }

    #[test]
    fn an_accessor_that_reaches_past_its_view_is_refused() {
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
