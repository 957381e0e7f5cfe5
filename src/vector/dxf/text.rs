//! Texts of DXF without their codes.

/// A text of one line: `%%d`, `%%c`, `%%p` and `\U+XXXX` become their characters, marks of lines nothing.
pub(super) fn plain(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(['%', '\\']) {
        plain.push_str(&rest[..at]);
        rest = &rest[at..];
        let (character, length) = escaped(rest);
        plain.extend(character);
        rest = &rest[length..];
    }
    plain.push_str(rest);
    plain.trim().to_owned()
}

/// The character that an escape stands for, if any, and how long the escape is.
fn escaped(rest: &str) -> (Option<char>, usize) {
    let bytes = rest.as_bytes();
    if let Some(hex) = rest.strip_prefix("\\U+").and_then(|rest| rest.get(..4)) {
        let character = u32::from_str_radix(hex, 16).ok().and_then(char::from_u32);
        return (Some(character.unwrap_or('\u{fffd}')), 7);
    }
    match bytes {
        [b'%', b'%', b'd' | b'D', ..] => (Some('°'), 3),
        [b'%', b'%', b'c' | b'C', ..] => (Some('⌀'), 3),
        [b'%', b'%', b'p' | b'P', ..] => (Some('±'), 3),
        [b'%', b'%', b'u' | b'U' | b'o' | b'O' | b'k' | b'K', ..] => (None, 3),
        [b'%', b'%', b'%', ..] => (Some('%'), 3),
        [byte, ..] => (Some(char::from(*byte)), 1),
        [] => (None, 0),
    }
}

/// A text of several lines without its formats: fonts, heights, colors, stacked fractions, groups.
pub(super) fn without_formats(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(['\\', '{', '}', '%']) {
        plain.push_str(&rest[..at]);
        rest = &rest[at..];
        if rest.starts_with("\\U+") || rest.starts_with("%%") {
            let (character, length) = escaped(rest);
            plain.extend(character);
            rest = &rest[length..];
            continue;
        }
        let mut characters = rest.chars();
        let (first, second) = (characters.next(), characters.next());
        let length = first.map_or(0, char::len_utf8) + second.map_or(0, char::len_utf8);
        rest = match (first, second) {
            (Some('\\'), Some('P' | 'N' | 'X')) => {
                plain.push('\n');
                &rest[length..]
            }
            (Some('\\'), Some('~')) => {
                plain.push(' ');
                &rest[length..]
            }
            (Some('\\'), Some(mark @ ('\\' | '{' | '}'))) => {
                plain.push(mark);
                &rest[length..]
            }
            (Some('\\'), Some('L' | 'l' | 'O' | 'o' | 'K' | 'k')) => &rest[length..],
            (Some('\\'), Some('S')) => {
                let end = rest.find(';').unwrap_or(rest.len());
                plain.push_str(&rest[length.min(end)..end].replace(['^', '#'], "/"));
                rest.get(end + 1..).unwrap_or_default()
            }
            (Some('\\'), Some(_)) => match rest.find(';') {
                Some(end) => &rest[end + 1..],
                None => &rest[length..],
            },
            (Some('%'), _) => {
                plain.push('%');
                &rest[1..]
            }
            (Some('\\'), None) | (Some(_), _) | (None, _) => rest.get(1..).unwrap_or_default(),
        };
    }
    plain.push_str(rest);
    plain.trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_become_characters_and_formats_nothing() {
        assert_eq!(plain("%%uH%%u = 12%%d \\U+00C4 100% "), "H = 12° Ä 100%");
        assert_eq!(
            without_formats("{\\fArial|b0;\\H2.5;Well} 3\\Pdry\\~\\S1/2; \\{x\\} 50%"),
            "Well 3\ndry 1/2 {x} 50%"
        );
        for cut in ["\\", "\\S", "%", "\\U+00", "{\\f", "%%"] {
            let _ = (plain(cut), without_formats(cut));
        }
        assert_eq!(without_formats("é\\é;ü"), "éü");
    }
}
