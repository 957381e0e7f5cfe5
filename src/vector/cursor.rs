//! Reads numbers off the front of bytes, never past their end.

/// What is still to be read.
#[derive(Clone, Copy)]
pub(crate) struct ByteCursor<'a> {
    bytes: &'a [u8],
    start: usize,
}

impl<'a> ByteCursor<'a> {
    /// All of `bytes`.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, start: bytes.len() }
    }

    /// How many bytes have been read.
    pub fn at(&self) -> usize {
        self.start - self.bytes.len()
    }

    /// What is left.
    pub fn rest(&self) -> &'a [u8] {
        self.bytes
    }

    /// The next `count` bytes; `None`, and nothing is read, where there are not that many.
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (head, tail) = self.bytes.split_at_checked(count)?;
        self.bytes = tail;
        Some(head)
    }

    /// The next `N` bytes.
    pub fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    /// The next byte.
    pub fn byte(&mut self) -> Option<u8> {
        self.array::<1>().map(|[byte]| byte)
    }

    /// The next four bytes, little-endian.
    pub fn u32_le(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    /// The next eight bytes, little-endian.
    pub fn f64_le(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes)
    }
}
