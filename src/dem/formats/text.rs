//! Words and numbers of text formats.

pub(crate) struct TextWords<'a> {
    rest: &'a [u8],
}

impl<'a> TextWords<'a> {
    /// The words of `bytes`; white space and NULs separate them.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes }
    }

    /// The bytes that have not been read yet.
    pub fn rest(&self) -> &'a [u8] {
        self.rest
    }

    /// The next word, unless `is_wanted` refuses it.
    pub fn next_if(&mut self, is_wanted: impl Fn(&[u8]) -> bool) -> Option<&'a [u8]> {
        let mut after = Self { rest: self.rest };
        let word = after.next().filter(|word| is_wanted(word))?;
        *self = after;
        Some(word)
    }
}

impl<'a> Iterator for TextWords<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let is_blank = |byte: &u8| byte.is_ascii_whitespace() || *byte == 0;
        let word = &self.rest[self.rest.iter().position(|byte| !is_blank(byte))?..];
        let (word, rest) = word.split_at(word.iter().position(is_blank).unwrap_or(word.len()));
        self.rest = rest;
        Some(word)
    }
}

/// Words that programs write in place of a number that is missing, in lower case.
const MISSING: [&str; 12] =
    ["null", "none", "na", "n/a", "#n/a", "nodata", "no_data", "no-data", "void", "missing", "*", "-"];

/// Whether a word is one of those that are written in place of a number that is missing.
pub(crate) fn is_missing(word: &[u8]) -> bool {
    MISSING.iter().any(|missing| missing.as_bytes().eq_ignore_ascii_case(word))
}

/// A number, with a decimal point or a single decimal comma; `nan` in any case, the same with what C adds in parentheses,
/// and Microsoft's `-1.#IND` are NaN.
pub(crate) fn number(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    if let Ok(value) = text.parse() {
        return Some(value);
    }
    let unsigned = text.trim_start_matches(['+', '-']);
    let is_nan = unsigned.get(..4).is_some_and(|start| start.eq_ignore_ascii_case("nan("));
    if is_nan || unsigned.starts_with("1.#") {
        return Some(f64::NAN);
    }
    if text.matches(',').count() == 1 && !text.contains('.') {
        return text.replace(',', ".").parse().ok();
    }
    None
}

/// The note on a no-data value that is no number.
pub(crate) fn unknown_nodata(stated: &str) -> String {
    format!("its no-data value '{}' is no number, so that none is taken", quote(stated.trim().as_bytes()))
}

/// A word as messages repeat it: cut where it is long.
pub(crate) fn quote(word: &[u8]) -> String {
    String::from_utf8_lossy(word).chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_to_write_nan_is_one_and_words_are_missing_numbers() {
        for nan in ["nan", "NaN", "-nan", "nan(ind)", "-nan(ind)", "1.#QNAN", "-1.#IND", "1.#IND00"] {
            assert!(number(nan.as_bytes()).is_some_and(f64::is_nan), "{nan}");
        }
        for word in ["null", "NULL", "NoData", "N/A", "#N/A", "*", "-"] {
            assert!(number(word.as_bytes()).is_none() && is_missing(word.as_bytes()), "{word}");
        }
        assert!(!is_missing(b"12") && !is_missing(b"") && number(b"x#").is_none());
        assert_eq!((number(b"1,5"), number(b"+2"), number(b"1,5.0")), (Some(1.5), Some(2.0), None));
    }
}
