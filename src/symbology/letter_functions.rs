//! The functions of MIL-STD-2525C and what each is in MIL-STD-2525D: MIL-STD-2525D, appendix A, table of conversions, as the
//! Joint Military Symbology Markup Language (Esri, Apache-2.0) lists it.
//!
//! A line of the table is coding scheme, battle dimension and the six letters of the function; symbol set, entity, sector 1 and
//! sector 2 modifier:
//!
//! ```text
//! SGUCIL-- 10 121100 00 19
//! ```

use std::sync::LazyLock;

const TABLE: &str = include_str!("letter_functions.txt");

/// A function of 2525C and what it is in 2525D.
pub(super) struct LetterFunction {
    /// Coding scheme, battle dimension and the six letters of the function.
    pub letters: [u8; 8],
    pub set: u8,
    pub entity: u32,
    pub modifiers: [u16; 2],
}

/// In the order of their letters.
pub(super) static FUNCTIONS: LazyLock<Vec<LetterFunction>> =
    LazyLock::new(|| TABLE.lines().filter_map(function).collect());

/// The function of these letters, if the standard has it.
pub(super) fn find(letters: &[u8]) -> Option<&'static LetterFunction> {
    let place = FUNCTIONS.binary_search_by(|row| row.letters.as_slice().cmp(letters)).ok()?;
    FUNCTIONS.get(place)
}

fn function(line: &str) -> Option<LetterFunction> {
    let mut words = line.split(' ');
    Some(LetterFunction {
        letters: words.next()?.as_bytes().try_into().ok()?,
        set: words.next()?.parse().ok()?,
        entity: words.next()?.parse().ok()?,
        modifiers: [words.next()?.parse().ok()?, words.next()?.parse().ok()?],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_is_a_function_and_they_ascend_so_that_they_are_found() {
        assert_eq!(FUNCTIONS.len(), TABLE.lines().count());
        assert!(FUNCTIONS.windows(2).all(|pair| pair[0].letters < pair[1].letters));
        assert!(find(b"SGUCIL--").is_some_and(|row| (row.entity, row.modifiers) == (121_100, [0, 19])));
        assert!(find(b"SGUCIL").is_none());
    }
}
