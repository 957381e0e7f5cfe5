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

/// A number, with a decimal point or a single decimal comma; `nan` in any case and GDAL's `-1.#IND` are NaN.
pub(crate) fn number(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    if let Ok(value) = text.parse() {
        return Some(value);
    }
    if text.contains('#') {
        return Some(f64::NAN);
    }
    if text.matches(',').count() == 1 && !text.contains('.') {
        return text.replace(',', ".").parse().ok();
    }
    None
}

/// A word as messages repeat it: cut where it is long.
pub(crate) fn quote(word: &[u8]) -> String {
    String::from_utf8_lossy(word).chars().take(40).collect()
}
