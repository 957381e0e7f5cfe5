//! Chunks, and a cursor over a chunk's body; every length is checked against its parent's.

use glam::Vec3;

use crate::error::ModelError;

/// Bytes of a chunk's header: id and length.
const HEADER: usize = 6;

/// A chunk: `id: u16, length: u32` (header included), then its body.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chunk<'a> {
    pub id: u16,
    body: &'a [u8],
    offset: usize,
}

impl<'a> Chunk<'a> {
    pub(super) fn first(bytes: &'a [u8]) -> Result<Self, ModelError> {
        ChunkCursor { bytes, offset: 0 }
            .chunk()?
            .ok_or_else(|| ModelError::three_ds(0, "the file ends before its first chunk"))
    }

    /// The chunks in the body, for a chunk that has nothing else.
    pub(super) fn children(&self) -> impl Iterator<Item = Result<Chunk<'a>, ModelError>> + use<'a> {
        self.read().chunks()
    }

    pub(super) fn read(&self) -> ChunkCursor<'a> {
        ChunkCursor { bytes: self.body, offset: self.offset }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct ChunkCursor<'a> {
    bytes: &'a [u8],
    offset: usize,
}

impl<'a> ChunkCursor<'a> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], ModelError> {
        let (head, rest) = self.bytes.split_first_chunk::<N>().ok_or_else(|| {
            let left = self.bytes.len();
            ModelError::three_ds(self.offset, format!("a value has {left} of {N} bytes"))
        })?;
        self.bytes = rest;
        self.offset += N;
        Ok(*head)
    }

    pub(super) fn u8(&mut self) -> Result<u8, ModelError> {
        Ok(self.take::<1>()?[0])
    }

    pub(super) fn u16(&mut self) -> Result<u16, ModelError> {
        self.take().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, ModelError> {
        self.take().map(u32::from_le_bytes)
    }

    pub(super) fn f32(&mut self) -> Result<f32, ModelError> {
        self.take().map(f32::from_le_bytes)
    }

    pub(super) fn vec3(&mut self) -> Result<Vec3, ModelError> {
        Ok(Vec3::new(self.f32()?, self.f32()?, self.f32()?))
    }

    /// A text that ends with a zero byte, as Latin-1.
    pub(super) fn text(&mut self) -> Result<String, ModelError> {
        let length = self
            .bytes
            .iter()
            .position(|&byte| byte == 0)
            .ok_or_else(|| ModelError::three_ds(self.offset, "a name does not end in its chunk"))?;
        let text = self.bytes[..length].iter().map(|&byte| char::from(byte)).collect();
        self.skip(length + 1)?;
        Ok(text)
    }

    pub(super) fn skip(&mut self, count: usize) -> Result<(), ModelError> {
        self.bytes = self
            .bytes
            .get(count..)
            .ok_or_else(|| ModelError::three_ds(self.offset, "a chunk ends in its fixed part"))?;
        self.offset += count;
        Ok(())
    }

    /// `count` values of `size` bytes each; their length is checked before memory is allocated.
    pub(super) fn list<T>(
        &mut self,
        count: usize,
        size: usize,
        mut read: impl FnMut(&mut Self) -> Result<T, ModelError>,
    ) -> Result<Vec<T>, ModelError> {
        let left = self.bytes.len();
        if count.checked_mul(size).is_none_or(|needed| needed > left) {
            let reason = format!("{count} values of {size} bytes are stated, but {left} bytes are left");
            return Err(ModelError::three_ds(self.offset, reason));
        }
        (0..count).map(|_| read(self)).collect()
    }

    /// The chunks up to the end of the body. Fewer bytes than a header at the end are ignored, as in other readers.
    pub(super) fn chunks(mut self) -> impl Iterator<Item = Result<Chunk<'a>, ModelError>> + use<'a> {
        std::iter::from_fn(move || {
            let next = self.chunk().transpose();
            if matches!(next, Some(Err(_))) {
                self.bytes = &[];
            }
            next
        })
    }

    fn chunk(&mut self) -> Result<Option<Chunk<'a>>, ModelError> {
        if self.bytes.len() < HEADER {
            return Ok(None);
        }
        let start = self.offset;
        let (id, length) = (self.u16()?, self.u32()? as usize);
        let left = self.bytes.len();
        let Some(body) = length.checked_sub(HEADER).and_then(|length| self.bytes.get(..length)) else {
            let left = left + HEADER;
            let reason = format!("chunk {id:04X} states {length} bytes, but its parent has {left} left");
            return Err(ModelError::three_ds(start, reason));
        };
        let chunk = Chunk { id, body, offset: self.offset };
        self.skip(body.len())?;
        Ok(Some(chunk))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chunk of id 1 with one child of id 2 that holds the byte 7.
    const NESTED: [u8; 13] = [1, 0, 13, 0, 0, 0, 2, 0, 7, 0, 0, 0, 7];

    #[test]
    fn a_child_lies_within_its_parent() {
        let chunk = Chunk::first(&NESTED).expect("a chunk");
        let child = chunk.children().next().expect("one child").expect("a sound child");
        assert_eq!((chunk.id, child.id, child.read().u8().expect("one byte")), (1, 2, 7));
    }

    #[test]
    fn a_child_that_reaches_past_its_parent_is_refused_once() {
        for length in [0, 5, 8, 255] {
            let mut bytes = NESTED;
            bytes[8] = length;
            let chunk = Chunk::first(&bytes).expect("the parent is sound");
            let children: Vec<_> = chunk.children().collect();
            assert!(matches!(children[..], [Err(ModelError::ThreeDs { offset: 6, .. })]), "{length}");
        }
    }

    #[test]
    fn a_list_longer_than_its_chunk_is_refused_before_it_is_allocated() {
        let mut cursor = Chunk::first(&NESTED).expect("a chunk").read();
        assert!(cursor.list(usize::MAX, 12, ChunkCursor::vec3).is_err());
        assert!(cursor.list(8, 1, ChunkCursor::u8).is_err());
        assert_eq!(cursor.list(7, 1, ChunkCursor::u8).expect("seven bytes").len(), 7);
    }

    #[test]
    fn a_name_without_an_end_is_refused() {
        let mut cursor = ChunkCursor { bytes: b"ab\0cd", offset: 0 };
        assert_eq!(cursor.text().expect("ended"), "ab");
        assert!(cursor.text().is_err());
    }
}
