//! A file's name and text, and where in it a byte stands.

use std::ops::Range;
use std::sync::Arc;

/// A text file as it was read, shared by everything that points into it.
#[derive(Debug, PartialEq, Eq)]
pub struct SourceText {
    name: String,
    text: String,
}

/// A place in a text as people count: the first character of a file is line 1, column 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct LineColumn {
    /// Counts line feeds.
    pub line: usize,
    /// Counts characters, whatever their width or number of bytes; a tab is one.
    pub column: usize,
}

impl SourceText {
    /// `text` under the `name` that messages call it by.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Arc<Self> {
        Arc::new(Self { name: name.into(), text: text.into() })
    }

    /// What messages call it; usually its path as the user gave it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The whole text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Line and column of byte `offset`; past the end gives the end, inside a character its start.
    pub fn line_column(&self, offset: usize) -> LineColumn {
        let offset = self.text.floor_char_boundary(offset);
        let line = self.text[..offset].bytes().filter(|&byte| byte == b'\n').count() + 1;
        let start = self.line_at(offset).start;
        LineColumn { line, column: self.text[start..offset].chars().count() + 1 }
    }

    /// The bytes of the line that holds `offset`, without its line ending and without a byte order mark.
    pub fn line_at(&self, offset: usize) -> Range<usize> {
        let offset = self.text.floor_char_boundary(offset);
        let start = match self.text[..offset].rfind('\n') {
            Some(feed) => feed + 1,
            None if offset > 0 && self.text.starts_with('\u{feff}') => '\u{feff}'.len_utf8(),
            None => 0,
        };
        let end = self.text[offset..].find('\n').map_or(self.text.len(), |feed| offset + feed);
        let line = self.text[start..end].trim_end_matches('\r');
        start..start + line.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_not_bytes() {
        let text = SourceText::new("a", "x\n名前 = 3\r\nz");
        assert_eq!(text.line_column(text.text().find('3').expect("a 3")), LineColumn { line: 2, column: 6 });
        assert_eq!(text.line_column(usize::MAX), LineColumn { line: 3, column: 2 });
        assert_eq!(&text.text()[text.line_at(4)], "名前 = 3");
    }

    #[test]
    fn a_byte_order_mark_is_no_column() {
        let text = SourceText::new("a", "\u{feff}key = 3");
        assert_eq!(text.line_column(3), LineColumn { line: 1, column: 1 });
    }
}
