//! The text of a scene file and of the files that it includes; maps a byte offset to file, line and column.
//!
//! The texts are concatenated with a line feed after each that belongs to no file, so that a byte range identifies both
//! the file and the place in it:
//!
//! ```text
//!  0            start of the second    start of the third
//!  ▼            ▼                      ▼
//!  scene.toml ␊ common/roads.toml    ␊ common/trees.toml ␊
//! ```

use std::ops::Range;
use std::sync::Arc;

/// The concatenated text files. Diagnostics share it and point into it.
#[derive(Debug, PartialEq, Eq)]
pub struct SourceText {
    /// In the order of their texts; never empty, the first starts at 0.
    files: Vec<SourceFile>,
    text: String,
}

#[derive(Debug, PartialEq, Eq)]
struct SourceFile {
    name: String,
    /// The folder relative to that of the first file; empty, or with a `/` at its end.
    folder: String,
    start: usize,
}

/// A place in a file. The first character is line 1, column 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct LineColumn {
    /// Counts line feeds.
    pub line: usize,
    /// Counts characters, whatever their width or number of bytes; a tab is one.
    pub column: usize,
}

impl SourceText {
    /// The text of one file; messages call it `name`.
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Arc<Self> {
        Arc::new(Self::alone(name, text))
    }

    /// As [`Self::new`], before other files are appended.
    pub(super) fn alone(name: impl Into<String>, text: impl Into<String>) -> Self {
        let file = SourceFile { name: name.into(), folder: String::new(), start: 0 };
        Self { files: vec![file], text: text.into() }
    }

    /// Appends a file and returns the first byte of its text. `folder` is relative to that of the first file; empty, or
    /// with a `/` at its end.
    pub(super) fn append(&mut self, name: String, folder: String, text: &str) -> usize {
        self.text.push('\n');
        let start = self.text.len();
        self.files.push(SourceFile { name, folder, start });
        self.text.push_str(text);
        start
    }

    /// The name of the first file in messages; usually its path as the user gave it.
    pub fn name(&self) -> &str {
        &self.files[0].name
    }

    /// The name in messages of the file that contains byte `offset`.
    pub fn name_at(&self, offset: usize) -> &str {
        &self.file_at(offset).name
    }

    /// The folder of the file that contains byte `offset`, relative to that of the first file; empty, or with a `/` at
    /// its end.
    pub fn folder_at(&self, offset: usize) -> &str {
        &self.file_at(offset).folder
    }

    /// The concatenated text.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The first byte and the text of each file.
    pub(super) fn texts(&self) -> impl Iterator<Item = (usize, &str)> {
        let ends = self.files.iter().skip(1).map(|next| next.start - 1).chain([self.text.len()]);
        self.files.iter().zip(ends).map(|(file, end)| (file.start, &self.text[file.start..end]))
    }

    /// Line and column of byte `offset` in its file. An offset past the end counts as the end, one inside a character
    /// as its first byte.
    pub fn line_column(&self, offset: usize) -> LineColumn {
        let offset = self.text.floor_char_boundary(offset);
        let file = self.file_at(offset).start;
        let line = self.text[file..offset].bytes().filter(|&byte| byte == b'\n').count() + 1;
        let start = self.line_at(offset).start;
        LineColumn { line, column: self.text[start..offset].chars().count() + 1 }
    }

    /// The bytes of the line that holds `offset`, without its line ending and without a byte order mark.
    pub fn line_at(&self, offset: usize) -> Range<usize> {
        let offset = self.text.floor_char_boundary(offset);
        let file = self.file_at(offset).start;
        let start = match self.text[file..offset].rfind('\n') {
            Some(feed) => file + feed + 1,
            None if offset > file && self.text[file..].starts_with('\u{feff}') => {
                file + '\u{feff}'.len_utf8()
            }
            None => file,
        };
        let end = self.text[offset..].find('\n').map_or(self.text.len(), |feed| offset + feed);
        let line = self.text[start..end].trim_end_matches('\r');
        start..start + line.len()
    }

    fn file_at(&self, offset: usize) -> &SourceFile {
        let after = self.files.partition_point(|file| file.start <= offset);
        &self.files[after.saturating_sub(1)]
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

    #[test]
    fn files_laid_end_to_end_keep_their_names_and_lines() {
        let mut text = SourceText::alone("a", "x = 1\ny = 2");
        let second = text.append("b".into(), "more/".into(), "\u{feff}z = 3\nw = 4\n");
        let third = text.append("c".into(), String::new(), "");
        assert_eq!((text.name_at(0), text.name_at(second - 1), text.name_at(second)), ("a", "a", "b"));
        assert_eq!(
            (text.name_at(third), text.name_at(usize::MAX), text.folder_at(second)),
            ("c", "c", "more/")
        );
        let at = |needle: &str| text.line_column(text.text().find(needle).expect("it is there"));
        assert_eq!(at("z"), LineColumn { line: 1, column: 1 });
        assert_eq!(at("w"), LineColumn { line: 2, column: 1 });
        assert_eq!(text.line_column(second - 1), LineColumn { line: 2, column: 6 }, "the end of the first");
        assert_eq!(&text.text()[text.line_at(second - 1)], "y = 2");
        let texts: Vec<&str> = text.texts().map(|(_, text)| text).collect();
        assert_eq!(texts, ["x = 1\ny = 2", "\u{feff}z = 3\nw = 4\n", ""]);
    }
}
