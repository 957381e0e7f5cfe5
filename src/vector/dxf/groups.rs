//! Groups of a DXF file: a code and a value each, as text in two lines or in binary.
//!
//! The code says what a value is: 10 to 59 are coordinates and other reals, 60 to 79 whole numbers, 0 to 9 text. A group of
//! code 0 begins the next record.

use std::borrow::Cow;

use sandtable_base::bytes::ByteFields;

use crate::encoding::TextEncoding;

/// How binary files begin.
const SENTINEL: &[u8] = b"AutoCAD Binary DXF\r\n\x1a\0";

/// Bytes in which the version and the code page are searched.
const HEAD_BYTES: usize = 1 << 16;

/// A group: a code and a value.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct DxfGroup<'a> {
    pub code: i32,
    value: GroupValue<'a>,
}

#[derive(Clone, Debug, PartialEq)]
enum GroupValue<'a> {
    Text(Cow<'a, str>),
    Number(f64),
}

impl DxfGroup<'_> {
    /// The value as text; empty of a number.
    pub fn text(&self) -> &str {
        match &self.value {
            GroupValue::Text(text) => text,
            GroupValue::Number(_) => "",
        }
    }

    /// The value as a finite number.
    pub fn number(&self) -> Option<f64> {
        let number = match &self.value {
            GroupValue::Text(text) => text.trim().parse().ok()?,
            GroupValue::Number(number) => *number,
        };
        number.is_finite().then_some(number)
    }

    /// The value as a whole number; that of a real is cut off.
    pub fn integer(&self) -> Option<i64> {
        self.number().map(|number| number as i64)
    }
}

/// Whether bytes are those of a binary file.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    bytes.starts_with(SENTINEL)
}

/// Whether bytes begin as those of a file in text do: the code 0 or a comment, then a section or a comment's text.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(2000)];
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let mut lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    loop {
        match (lines.next(), lines.next()) {
            (Some(b"999"), Some(_)) => {}
            (Some(b"0"), Some(b"SECTION")) => return true,
            _ => return false,
        }
    }
}

/// Reads the groups of a file one after the other.
pub(super) enum GroupReader<'a> {
    Text { lines: std::str::Lines<'a>, line: usize },
    Binary { bytes: &'a [u8], at: usize, has_wide_codes: bool, encoding: TextEncoding },
}

/// The text of a file that is not binary.
pub(super) fn decode(bytes: &[u8]) -> Cow<'_, str> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let encoding = encoding(bytes);
    if encoding.is_utf_8() { String::from_utf8_lossy(bytes) } else { encoding.decode(bytes) }
}

/// The encoding of texts: UTF-8 from AutoCAD 2007 on, before it that of the code page.
fn encoding(bytes: &[u8]) -> TextEncoding {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD_BYTES)]);
    let after = |name: &str| {
        let (_, rest) = head.split_once(name)?;
        rest.split(|c: char| c.is_whitespace() || c == '\0').filter(|word| !word.is_empty()).nth(1)
    };
    // The version counts: AC1021 and later are UTF-8.
    let version = after("$ACADVER").and_then(|version| version.trim_start_matches("AC").parse::<u32>().ok());
    if version.is_some_and(|version| version >= 1021) {
        return TextEncoding::UTF_8;
    }
    let page = after("$DWGCODEPAGE").unwrap_or_default().to_ascii_uppercase();
    let name = match page.trim_start_matches("ANSI_") {
        "932" => "shift_jis".to_owned(),
        "936" => "gbk".to_owned(),
        "949" => "euc-kr".to_owned(),
        "950" => "big5".to_owned(),
        number if number.starts_with("125") || number == "874" => format!("windows-{number}"),
        // Without a code page most are of plain letters, and UTF-8 where they are not.
        _ if std::str::from_utf8(bytes).is_ok() => return TextEncoding::UTF_8,
        _ => "windows-1252".to_owned(),
    };
    TextEncoding::from_name(&name).unwrap_or(TextEncoding::UTF_8)
}

impl<'a> GroupReader<'a> {
    /// A reader of text.
    pub fn of_text(text: &'a str) -> Self {
        Self::Text { lines: text.lines(), line: 0 }
    }

    /// A reader of a binary file.
    pub fn of_binary(bytes: &'a [u8]) -> Self {
        let at = SENTINEL.len();
        // A code takes two bytes, in files before release 13 one.
        let has_wide_codes = bytes.get(at + 1) == Some(&0);
        Self::Binary { bytes, at, has_wide_codes, encoding: encoding(bytes) }
    }

    /// Where the reader is, for messages.
    pub fn place(&self) -> String {
        match self {
            Self::Text { line, .. } => format!("line {line}"),
            Self::Binary { at, .. } => format!("byte {at}"),
        }
    }

    /// The next group; `None` at the end.
    ///
    /// # Errors
    /// A sentence without the place.
    pub fn next(&mut self) -> Result<Option<DxfGroup<'a>>, String> {
        match self {
            Self::Text { lines, line } => {
                let Some(code) = lines.next() else { return Ok(None) };
                *line += 1;
                let Ok(number) = code.trim().parse::<i32>() else {
                    // What programs leave at the end.
                    if code.trim_matches(|c: char| c.is_whitespace() || c == '\u{1a}' || c == '\0').is_empty()
                    {
                        return Ok(None);
                    }
                    let code: String = code.trim().chars().take(30).collect();
                    return Err(format!("'{code}' is no code of a group"));
                };
                let Some(value) = lines.next() else {
                    return Err("it ends between a code and its value".to_owned());
                };
                *line += 1;
                // Spaces at the end of a text may be meant; those of numbers are not read.
                let value = if matches!(number, 1 | 3) { value } else { value.trim() };
                Ok(Some(DxfGroup { code: number, value: GroupValue::Text(Cow::Borrowed(value)) }))
            }
            Self::Binary { bytes, at, has_wide_codes, encoding } => {
                if *at >= bytes.len() {
                    return Ok(None);
                }
                let read = binary_group(bytes, *at, *has_wide_codes, encoding);
                let (group, next) = read.ok_or("it ends within a group, or a group is none")?;
                *at = next;
                Ok(Some(group))
            }
        }
    }
}

/// The group at a place, and the place of the next.
fn binary_group<'a>(
    bytes: &'a [u8],
    at: usize,
    has_wide_codes: bool,
    encoding: &TextEncoding,
) -> Option<(DxfGroup<'a>, usize)> {
    let fields = ByteFields::little_endian(bytes);
    let (code, at) = match (has_wide_codes, *bytes.get(at)?) {
        (true, _) => (i32::from(fields.i16(at)?), at + 2),
        (false, 255) => (i32::from(fields.i16(at + 1)?), at + 3),
        (false, code) => (i32::from(code), at + 1),
    };
    let number = |value: f64, size: usize| (GroupValue::Number(value), at + size);
    let (value, next) = match code {
        10..=59 | 110..=149 | 210..=239 | 460..=469 | 1010..=1059 => number(fields.f64(at)?, 8),
        60..=79 | 170..=179 | 270..=289 | 370..=389 | 400..=409 | 1060..=1070 => {
            number(f64::from(fields.i16(at)?), 2)
        }
        90..=99 | 420..=429 | 440..=459 | 1071 => number(f64::from(fields.u32(at)? as i32), 4),
        160..=169 => {
            let low = u64::from(fields.u32(at)?);
            let high = u64::from(fields.u32(at + 4)?);
            number((high << 32 | low) as i64 as f64, 8)
        }
        290..=299 => number(f64::from(*bytes.get(at)?), 1),
        310..=319 | 1004 => {
            let size = usize::from(*bytes.get(at)?);
            bytes.get(at + 1..at + 1 + size)?;
            (GroupValue::Text(Cow::Borrowed("")), at + 1 + size)
        }
        _ => {
            let rest = &bytes[at..];
            let size = rest.iter().position(|&byte| byte == 0)?;
            let text = match std::str::from_utf8(&rest[..size]) {
                Ok(text) if encoding.is_utf_8() || text.is_ascii() => Cow::Borrowed(text),
                _ => Cow::Owned(encoding.decode(&rest[..size]).into_owned()),
            };
            (GroupValue::Text(text), at + size + 1)
        }
    };
    Some((DxfGroup { code, value }, next))
}
