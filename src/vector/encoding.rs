//! Text encodings of attribute tables and XML: Unicode and code pages by `encoding_rs`, those of DOS by `oem_cp`.

use std::borrow::Cow;

use encoding_rs::{Encoding, UTF_8, WINDOWS_1252};
use oem_cp::code_table::DECODING_TABLE_CP_MAP;
use oem_cp::code_table_type::TableType;

/// An encoding of text. Undefined bytes decode to U+FFFD or a control character.
#[derive(Clone, Copy)]
pub(crate) enum TextEncoding {
    /// UTF-8 where the bytes are valid, else Windows-1252: for files that state nothing.
    Guess,
    /// An encoding of the WHATWG standard.
    Standard(&'static Encoding),
    /// A code page of DOS.
    Dos(&'static TableType),
}

impl TextEncoding {
    pub const UTF_8: Self = Self::Standard(UTF_8);

    /// Returns the Unicode encoding that the byte order mark at the start of `bytes` states, and the bytes behind it.
    pub fn from_mark(bytes: &[u8]) -> Option<(Self, &[u8])> {
        let (encoding, mark_bytes) = Encoding::for_bom(bytes)?;
        Some((Self::Standard(encoding), &bytes[mark_bytes..]))
    }

    pub fn is_utf_8(self) -> bool {
        matches!(self, Self::Standard(encoding) if encoding == UTF_8)
    }

    /// Returns the encoding that a `.cpg` file or an XML declaration names, or `None` where it is unknown.
    ///
    /// Names are labels of the WHATWG standard, and names that end in the number of a code page or of a part of ISO
    /// 8859: `ANSI 1251`, `OEM 850`, `88591`.
    pub fn from_name(name: &str) -> Option<Self> {
        let name = name.trim();
        if name.eq_ignore_ascii_case("ascii") || name.eq_ignore_ascii_case("us-ascii") {
            return Some(Self::Guess);
        }
        if let Some(encoding) = Encoding::for_label(name.as_bytes()) {
            // A name that is not itself in UTF-16 cannot truly state UTF-16; this makes it UTF-8.
            return Some(Self::Standard(encoding.output_encoding()));
        }
        let digits: String = name.chars().filter(char::is_ascii_digit).collect();
        match digits.strip_prefix("8859") {
            Some(part) => Encoding::for_label(format!("iso-8859-{part}").as_bytes()).map(Self::Standard),
            None => digits.parse().ok().and_then(Self::from_code_page),
        }
    }

    /// Returns the encoding that the language driver of a dBASE table means, or `None` where it is unknown.
    pub fn from_language_driver(driver: u8) -> Option<Self> {
        let page = match driver {
            0x00 => return Some(Self::Guess),
            0x01 | 0x09 | 0x0b | 0x0d | 0x0f | 0x11 | 0x15 | 0x18 | 0x19 | 0x1b => 437,
            0x02 | 0x08 | 0x0a | 0x0e | 0x10 | 0x12 | 0x14 | 0x16 | 0x1a | 0x1d | 0x25 | 0x37 => 850,
            0x03 | 0x57 | 0x58 | 0x59 => 1252,
            0x13 | 0x7b => 932,
            0x1c | 0x6c => 863,
            0x1f | 0x22 | 0x23 | 0x40 | 0x64 | 0x87 => 852,
            0x17 | 0x66 => 865,
            0x24 => 860,
            0x26 | 0x65 => 866,
            0x4d | 0x7a => 936,
            0x4e | 0x79 => 949,
            0x4f | 0x78 => 950,
            0x50 | 0x7c => 874,
            0x67 => 861,
            0x6a | 0x86 => 737,
            0x6b | 0x88 => 857,
            0xc8 => 1250,
            0xc9 => 1251,
            0xca => 1254,
            0xcb => 1253,
            0xcc => 1257,
            _ => return None,
        };
        Self::from_code_page(page)
    }

    fn from_code_page(page: u16) -> Option<Self> {
        if let Some(table) = DECODING_TABLE_CP_MAP.get(&page) {
            return Some(Self::Dos(table));
        }
        let label = match page {
            932 => "shift_jis".to_owned(),
            936 => "gbk".to_owned(),
            950 => "big5".to_owned(),
            65001 => "utf-8".to_owned(),
            page => format!("windows-{page}"),
        };
        Encoding::for_label(label.as_bytes()).map(Self::Standard)
    }

    pub fn decode(self, bytes: &[u8]) -> Cow<'_, str> {
        match (self, std::str::from_utf8(bytes)) {
            (Self::Guess, Ok(text)) => Cow::Borrowed(text),
            (Self::Dos(_), Ok(text)) if text.is_ascii() => Cow::Borrowed(text),
            (Self::Guess, Err(_)) => WINDOWS_1252.decode_without_bom_handling(bytes).0,
            (Self::Standard(encoding), _) => encoding.decode_without_bom_handling(bytes).0,
            (Self::Dos(table), _) => Cow::Owned(table.decode_string_lossy(bytes)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_come_out_as_they_were_written() {
        let decode =
            |name: &str, bytes: &[u8]| TextEncoding::from_name(name).expect(name).decode(bytes).into_owned();
        assert_eq!(decode("ISO-8859-1", b"Stra\xdfe"), "Straße");
        assert_eq!(decode("88591", b"Stra\xdfe"), "Straße");
        assert_eq!(decode("ANSI 1251", b"\xcc\xee\xf1\xea\xe2\xe0"), "Москва");
        assert_eq!(decode("windows-1252", b"\x80 5"), "€ 5");
        assert_eq!(decode("CP850", b"\x9c"), "£");
        assert_eq!(decode("UTF-8", "Æ".as_bytes()), "Æ");
        assert_eq!(decode("65001", "Æ".as_bytes()), "Æ");
        assert_eq!(decode("iso-8859-15", b"\xa4"), "€");
        assert_eq!(decode("936", b"\xb1\xb1\xbe\xa9"), "北京");
        assert!(TextEncoding::from_name("EBCDIC").is_none());
    }

    #[test]
    fn every_code_page_that_files_name_is_known() {
        for page in ["437", "850", "852", "866", "1250", "1251", "1252", "1253", "1254", "1257", "8859-2"] {
            for prefix in ["", "cp", "OEM ", "ANSI "] {
                assert!(TextEncoding::from_name(&format!("{prefix}{page}")).is_some(), "{prefix}{page}");
            }
        }
        let drivers = (0..=u8::MAX).filter(|&driver| TextEncoding::from_language_driver(driver).is_some());
        assert_eq!(drivers.count(), 60);
    }

    #[test]
    fn utf_8_is_recognized_where_nothing_is_stated() {
        assert_eq!(TextEncoding::Guess.decode("Straße".as_bytes()), "Straße");
        assert_eq!(TextEncoding::Guess.decode(b"Stra\xdfe"), "Straße");
        assert_eq!(TextEncoding::from_language_driver(0x57).expect("ANSI").decode(b"\xe9"), "é");
    }
}
