//! As much of protocol buffers as OpenStreetMap's need: fields of numbers and of bytes, and numbers in a row.
//!
//! A message is fields one after another, each a number `field << 3 | wire type` and a value: 0 a number of seven
//! bits a byte, 1 eight bytes, 2 a length and that many bytes, 5 four bytes.

use crate::vector::cursor::ByteCursor;

/// The message is cut short, or no message.
#[derive(Debug)]
pub(super) struct Malformed;

/// A field's value.
#[derive(Clone, Copy)]
pub(super) enum FieldValue<'a> {
    /// A number.
    Number(u64),
    /// Text, a message, or numbers in a row.
    Bytes(&'a [u8]),
    /// Of a type that no field here has.
    Other,
}

impl<'a> FieldValue<'a> {
    /// The number that it is.
    pub fn number(self) -> Result<u64, Malformed> {
        match self {
            Self::Number(number) => Ok(number),
            Self::Bytes(_) | Self::Other => Err(Malformed),
        }
    }

    /// The bytes that it is.
    pub fn bytes(self) -> Result<&'a [u8], Malformed> {
        match self {
            Self::Bytes(bytes) => Ok(bytes),
            Self::Number(_) | Self::Other => Err(Malformed),
        }
    }
}

/// The fields of a message, in its order.
pub(super) fn fields<'a>(
    message: &'a [u8],
) -> impl Iterator<Item = Result<(u64, FieldValue<'a>), Malformed>> {
    let mut cursor = ByteCursor::new(message);
    std::iter::from_fn(move || {
        if cursor.rest().is_empty() {
            return None;
        }
        let field = field(&mut cursor).ok_or(Malformed);
        if field.is_err() {
            // Nothing that follows means anything.
            cursor = ByteCursor::new(&[]);
        }
        Some(field)
    })
}

fn field<'a>(cursor: &mut ByteCursor<'a>) -> Option<(u64, FieldValue<'a>)> {
    let key = varint(cursor)?;
    let value = match key & 7 {
        0 => FieldValue::Number(varint(cursor)?),
        1 => cursor.take(8).map(|_| FieldValue::Other)?,
        2 => {
            let length = usize::try_from(varint(cursor)?).ok()?;
            FieldValue::Bytes(cursor.take(length)?)
        }
        5 => cursor.take(4).map(|_| FieldValue::Other)?,
        _ => return None,
    };
    Some((key >> 3, value))
}

/// A number, least significant seven bits first.
fn varint(cursor: &mut ByteCursor<'_>) -> Option<u64> {
    let mut number = 0;
    for shift in (0..64).step_by(7) {
        let byte = cursor.byte()?;
        number |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Some(number);
        }
    }
    None
}

/// Numbers in a row; ends at the first that is cut short, which [`Packed::is_whole`] tells.
pub(super) struct Packed<'a>(ByteCursor<'a>);

impl<'a> Packed<'a> {
    /// The numbers in `bytes`.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(ByteCursor::new(bytes))
    }

    /// The number after the last one; `None` where there is none.
    pub fn next_unsigned(&mut self) -> Option<u64> {
        varint(&mut self.0)
    }

    /// As [`Packed::next_unsigned`], with the sign in the lowest bit.
    pub fn next_signed(&mut self) -> Option<i64> {
        self.next_unsigned().map(signed)
    }

    /// Whether nothing is left.
    pub fn is_whole(&self) -> bool {
        self.0.rest().is_empty()
    }
}

/// A number whose sign is its lowest bit.
pub(super) fn signed(number: u64) -> i64 {
    (number >> 1) as i64 ^ -((number & 1) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_with_their_sign() {
        let mut packed = Packed::new(&[0, 1, 2, 3, 0xac, 0x02]);
        let read: Vec<i64> = std::iter::from_fn(|| packed.next_signed()).collect();
        assert_eq!(read, [0, -1, 1, -2, 150]);
        assert!(packed.is_whole());
        assert_eq!(signed(u64::MAX), i64::MIN);
    }

    #[test]
    fn fields_are_told_apart_and_what_is_cut_short_is_malformed() {
        let message = [0x08, 0x96, 0x01, 0x12, 0x02, b'o', b'k', 0x1d, 0, 0, 0, 0];
        let read: Vec<_> = fields(&message).map(|field| field.expect("whole").0).collect();
        assert_eq!(read, [1, 2, 3]);
        assert!(fields(&message[..6]).any(|field| field.is_err()));
        assert!(fields(&[0xff; 11]).any(|field| field.is_err()), "eleven bytes are no number");
    }
}
