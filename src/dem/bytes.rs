//! Numbers at fixed places of binary files.

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ByteOrder {
    Little,
    Big,
}

/// The fields of a binary layout. A field that reaches beyond the end is `None`.
#[derive(Clone, Copy)]
pub(crate) struct ByteFields<'a> {
    bytes: &'a [u8],
    order: ByteOrder,
}

macro_rules! fields {
    ($($number:ident),*) => {$(
        /// The number that starts at byte `at`.
        pub fn $number(&self, at: usize) -> Option<$number> {
            let raw = bytes_at(self.bytes, at)?;
            Some(match self.order {
                ByteOrder::Little => $number::from_le_bytes(raw),
                ByteOrder::Big => $number::from_be_bytes(raw),
            })
        }
    )*};
}

impl<'a> ByteFields<'a> {
    pub fn little_endian(bytes: &'a [u8]) -> Self {
        Self { bytes, order: ByteOrder::Little }
    }

    pub fn big_endian(bytes: &'a [u8]) -> Self {
        Self { bytes, order: ByteOrder::Big }
    }

    fields!(i16, u16, i32, u32, f32, f64);
    #[cfg(feature = "las")]
    fields!(i64, u64);
}

/// The `N` bytes that start at `at`; `None` beyond the end.
pub(crate) fn bytes_at<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..at.checked_add(N)?)?.try_into().ok()
}
