//! The part of protocol buffers that OpenStreetMap uses: fields of numbers and of bytes, and packed numbers.
//!
//! A message is fields one after another, each a number `field << 3 | wire type` and a value: 0 a number of seven bits
//! a byte, 1 eight bytes, 2 a length and that many bytes, 5 four bytes. Nothing is allocated for unused fields.

use sandtable_base::bytes::ByteCursor;

/// The message is cut short, or not a message.
#[derive(Debug, thiserror::Error)]
#[error("a block is cut short or contradicts itself")]
pub(super) struct MalformedMessage;

/// A field's value.
#[derive(Clone, Copy)]
pub(super) enum FieldValue<'a> {
    /// The message does not have the field.
    Absent,
    Number(u64),
    /// Text, a message, or packed numbers.
    Bytes(&'a [u8]),
    /// Four or eight bytes, which no field here has.
    Fixed,
}

impl<'a> FieldValue<'a> {
    /// Returns the number, or `default` for an absent field.
    pub fn number_or(self, default: u64) -> Result<u64, MalformedMessage> {
        match self {
            Self::Absent => Ok(default),
            Self::Number(number) => Ok(number),
            Self::Bytes(_) | Self::Fixed => Err(MalformedMessage),
        }
    }

    /// Returns the bytes, none for an absent field.
    pub fn bytes(self) -> Result<&'a [u8], MalformedMessage> {
        match self {
            Self::Absent => Ok(&[]),
            Self::Bytes(bytes) => Ok(bytes),
            Self::Number(_) | Self::Fixed => Err(MalformedMessage),
        }
    }
}

/// Returns the fields of a message, each its number and its value, in order. The first error ends them.
pub(super) fn fields(
    message: &[u8],
) -> impl Iterator<Item = Result<(u64, FieldValue<'_>), MalformedMessage>> {
    items(message, |cursor| {
        let key = varint(cursor)?;
        let value = match key & 7 {
            0 => FieldValue::Number(varint(cursor)?),
            1 => cursor.take(8).map(|_| FieldValue::Fixed)?,
            2 => {
                let length = usize::try_from(varint(cursor)?).ok()?;
                FieldValue::Bytes(cursor.take(length)?)
            }
            5 => cursor.take(4).map(|_| FieldValue::Fixed)?,
            _ => return None,
        };
        Some((key >> 3, value))
    })
}

/// Returns the last value of each of the fields `numbers`.
pub(super) fn last_values<const N: usize>(
    message: &[u8],
    numbers: [u64; N],
) -> Result<[FieldValue<'_>; N], MalformedMessage> {
    let mut values = [FieldValue::Absent; N];
    for field in fields(message) {
        let (number, value) = field?;
        if let Some(index) = numbers.iter().position(|&wanted| wanted == number) {
            values[index] = value;
        }
    }
    Ok(values)
}

/// Returns packed numbers. The first error ends them.
pub(super) fn varints(bytes: &[u8]) -> impl Iterator<Item = Result<u64, MalformedMessage>> {
    items(bytes, varint)
}

/// Returns the sums of packed signed differences. The first error ends them.
pub(super) fn delta_sums(bytes: &[u8]) -> impl Iterator<Item = Result<i64, MalformedMessage>> {
    let mut sum = 0i64;
    varints(bytes).map(move |step| {
        sum = sum.wrapping_add(zigzag(step?));
        Ok(sum)
    })
}

/// Returns the next of `items`.
///
/// # Errors
/// There is none, or it is malformed.
pub(super) fn next<T>(
    items: &mut impl Iterator<Item = Result<T, MalformedMessage>>,
) -> Result<T, MalformedMessage> {
    items.next().unwrap_or(Err(MalformedMessage))
}

fn items<'a, T>(
    bytes: &'a [u8],
    read: impl Fn(&mut ByteCursor<'a>) -> Option<T>,
) -> impl Iterator<Item = Result<T, MalformedMessage>> {
    let mut cursor = ByteCursor::new(bytes);
    std::iter::from_fn(move || {
        if cursor.is_empty() {
            return None;
        }
        let item = read(&mut cursor).ok_or(MalformedMessage);
        if item.is_err() {
            cursor = ByteCursor::new(&[]);
        }
        Some(item)
    })
}

fn varint(cursor: &mut ByteCursor<'_>) -> Option<u64> {
    let mut number = 0;
    for shift in (0..64).step_by(7) {
        let byte = cursor.u8()?;
        number |= u64::from(byte & 0x7f) << shift;
        if byte < 0x80 {
            return Some(number);
        }
    }
    None
}

/// Returns the signed number whose sign is the lowest bit of `number`.
pub(super) fn zigzag(number: u64) -> i64 {
    (number >> 1) as i64 ^ -((number & 1) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_with_their_sign() {
        let read: Vec<i64> =
            varints(&[0, 1, 2, 3, 0xac, 0x02]).map(|number| zigzag(number.expect("intact"))).collect();
        assert_eq!(read, [0, -1, 1, -2, 150]);
        assert_eq!(zigzag(u64::MAX), i64::MIN);
        let sums: Vec<i64> = delta_sums(&[2, 2, 3]).map(|sum| sum.expect("intact")).collect();
        assert_eq!(sums, [1, 2, 0]);
        assert!(varints(&[0x80]).all(|number| number.is_err()));
    }

    #[test]
    fn fields_have_their_numbers_and_a_message_cut_short_is_malformed() {
        let message = [0x08, 0x96, 0x01, 0x12, 0x02, b'o', b'k', 0x1d, 0, 0, 0, 0];
        let read: Vec<_> = fields(&message).map(|field| field.expect("intact").0).collect();
        assert_eq!(read, [1, 2, 3]);
        assert!(fields(&message[..6]).any(|field| field.is_err()));
        assert!(fields(&[0xff; 11]).any(|field| field.is_err()), "eleven bytes are no number");
    }
}
