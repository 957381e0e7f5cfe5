//! Reads numbers of binary files, at fixed places and in sequence, never past the end.

/// The order of the bytes of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ByteOrder {
    /// The least significant byte first.
    Little,
    /// The most significant byte first.
    Big,
}

macro_rules! numbers {
    ($($number:ident: $bytes:literal),*) => {
        impl ByteOrder {$(
            /// The number that these bytes state.
            // Files hold millions of them.
            #[inline]
            pub fn $number(self, bytes: [u8; $bytes]) -> $number {
                match self {
                    Self::Little => $number::from_le_bytes(bytes),
                    Self::Big => $number::from_be_bytes(bytes),
                }
            }
        )*}

        impl ByteFields<'_> {$(
            /// The number that starts at byte `at`; `None` where it reaches beyond the end.
            pub fn $number(&self, at: usize) -> Option<$number> {
                Some(self.order.$number(bytes_at(self.bytes, at)?))
            }
        )*}
    };
}

numbers!(u8: 1, i16: 2, u16: 2, i32: 4, u32: 4, f32: 4, f64: 8, i64: 8, u64: 8);

/// The fields of a binary layout.
#[derive(Clone, Copy, Debug)]
pub struct ByteFields<'a> {
    bytes: &'a [u8],
    order: ByteOrder,
}

impl<'a> ByteFields<'a> {
    /// Fields with the least significant byte first.
    pub fn little_endian(bytes: &'a [u8]) -> Self {
        Self { bytes, order: ByteOrder::Little }
    }

    /// Fields with the most significant byte first.
    pub fn big_endian(bytes: &'a [u8]) -> Self {
        Self { bytes, order: ByteOrder::Big }
    }
}

/// The `N` bytes that start at `at`; `None` beyond the end.
pub fn bytes_at<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..)?.first_chunk().copied()
}

/// Reads from the front of bytes. A read of more bytes than are left returns `None` and takes nothing.
#[derive(Clone, Copy, Debug)]
pub struct ByteCursor<'a> {
    bytes: &'a [u8],
    length: usize,
}

impl<'a> ByteCursor<'a> {
    /// A cursor at the first byte.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, length: bytes.len() }
    }

    /// The number of bytes that were taken.
    pub fn position(&self) -> usize {
        self.length - self.bytes.len()
    }

    /// The bytes that are left.
    pub fn rest(&self) -> &'a [u8] {
        self.bytes
    }

    /// Whether no byte is left.
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Takes `count` bytes.
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (head, tail) = self.bytes.split_at_checked(count)?;
        self.bytes = tail;
        Some(head)
    }

    /// Takes `N` bytes.
    pub fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    /// Takes a byte.
    pub fn u8(&mut self) -> Option<u8> {
        self.array().map(u8::from_le_bytes)
    }

    /// Takes a number, the least significant byte first.
    pub fn u32_le(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    /// Takes a number, the least significant byte first.
    pub fn f64_le(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes)
    }
}
