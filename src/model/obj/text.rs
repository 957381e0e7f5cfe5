//! Bytes to logical lines: encodings and continued lines.

/// The text in `bytes`: UTF-8 with or without a mark, UTF-16 with one, otherwise Latin-1.
pub(super) fn decode(bytes: &[u8]) -> String {
    let utf16 = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
        String::from_utf16_lossy(&units)
    };
    match bytes {
        [0xFE, 0xFF, rest @ ..] => utf16(rest, u16::from_be_bytes),
        [0xFF, 0xFE, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xEF, 0xBB, 0xBF, rest @ ..] => String::from_utf8_lossy(rest).into_owned(),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => text.into(),
            Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
        },
    }
}

/// The lines of `text` with their numbers from 1; a line that ends in a backslash goes on in the next one.
/// Lines end with LF, CR LF or CR.
pub(super) fn logical_lines(text: &str) -> impl Iterator<Item = (usize, std::borrow::Cow<'_, str>)> {
    let mut physical = text.split('\n').flat_map(|line| line.strip_suffix('\r').unwrap_or(line).split('\r'));
    let mut read = 0;
    std::iter::from_fn(move || {
        let mut line = std::borrow::Cow::Borrowed(physical.next()?);
        read += 1;
        let number = read;
        while let Some(start) = line.trim_end().strip_suffix('\\') {
            let start = start.to_owned();
            let rest = physical.next();
            read += usize::from(rest.is_some());
            line = format!("{start} {}", rest.unwrap_or_default()).into();
            if rest.is_none() {
                break;
            }
        }
        Some((number, line))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodings_are_told_by_their_marks() {
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
}
