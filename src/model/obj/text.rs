//! Splits bytes into logical lines: decodes text and joins continued lines.

use std::borrow::Cow;

use encoding_rs::Encoding;
use encoding_rs::mem::decode_latin1;

/// The text in `bytes`: UTF-8 with or without a byte order mark, UTF-16 with one, otherwise Latin-1.
pub(super) fn decode(bytes: &[u8]) -> Cow<'_, str> {
    match Encoding::for_bom(bytes) {
        Some((encoding, _)) => encoding.decode(bytes).0,
        None => std::str::from_utf8(bytes).map_or_else(|_| decode_latin1(bytes), Cow::Borrowed),
    }
}

/// The lines of `text` with their numbers from 1. A line that ends in a backslash continues in the next one. Lines end
/// with LF, CR LF or CR.
pub(super) fn logical_lines(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    let lines = text.split('\n').flat_map(|line| line.strip_suffix('\r').unwrap_or(line).split('\r'));
    let mut lines = (1..).zip(lines);
    std::iter::from_fn(move || {
        let (number, line) = lines.next()?;
        let mut line = Cow::Borrowed(line);
        while let Some(start) = line.trim_end().strip_suffix('\\') {
            let next = lines.next();
            line = format!("{start} {}", next.map_or("", |(_, next)| next)).into();
            if next.is_none() {
                break;
            }
        }
        Some((number, line))
    })
}

pub(super) fn split_keyword(line: &str) -> (&str, &str) {
    let line = line.trim();
    let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
    (keyword, rest.trim())
}

/// The number that a word begins with: exporters write `1.#IND` and worse. NaN where there is none.
pub(super) fn number(word: &str) -> f32 {
    if let Ok(value) = word.parse() {
        return value;
    }
    let bytes = word.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let mut end = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    end += digits(end);
    if bytes.get(end) == Some(&b'.') {
        end += 1 + digits(end + 1);
    }
    word.get(..end).and_then(|start| start.parse().ok()).unwrap_or(f32::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodings_are_known_by_their_byte_order_marks() {
        assert_eq!(decode(b"\xFE\xFF\0v\0 \x000"), "v 0");
        assert_eq!(decode(b"\xFF\xFEv\0 \x000\0"), "v 0");
        assert_eq!(decode(b"\xEF\xBB\xBFv 0"), "v 0");
        assert_eq!(decode(b"usemtl f\xFCr"), "usemtl für");
    }

    #[test]
    fn continued_lines_become_one() {
        let lines: Vec<_> =
            logical_lines("a \\\r\nb\\\nc\nd\\").map(|(at, line)| (at, line.into_owned())).collect();
        assert_eq!(lines, [(1, "a  b c".into()), (4, "d ".into())]);
    }

    #[test]
    fn odd_numbers_are_read_as_far_as_possible() {
        let numbers = "+2. -.5 1e2 3.1+e2 -1.#IND 1E-2".split(' ').map(number);
        assert!(numbers.eq([2.0, -0.5, 100.0, 3.1, -1.0, 0.01]));
        assert!(number("x").is_nan() && number("").is_nan() && number("é").is_nan());
    }
}
