//! Reads numbers from the front of bytes, never past their end.

/// The bytes that are still to be read. A read that needs more than there are returns `None` and takes nothing.
#[derive(Clone, Copy)]
pub(crate) struct ByteCursor<'a> {
    bytes: &'a [u8],
    length: usize,
}

impl<'a> ByteCursor<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, length: bytes.len() }
    }

    pub fn position(&self) -> usize {
        self.length - self.bytes.len()
    }

    pub fn rest(&self) -> &'a [u8] {
        self.bytes
    }

    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (head, tail) = self.bytes.split_at_checked(count)?;
        self.bytes = tail;
        Some(head)
    }

    pub fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    pub fn u8(&mut self) -> Option<u8> {
        self.array().map(u8::from_le_bytes)
    }

    pub fn u32_le(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn f64_le(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes)
    }
}
