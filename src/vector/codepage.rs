//! Texts of one byte a character, as attribute tables of shapefiles and old XML files hold them.
//!
//! The tables are those that Unicode publishes for each code page (unicode.org/Public/MAPPINGS); a character that a
//! page leaves undefined is U+FFFD. East Asian code pages of two bytes are not read.

use std::borrow::Cow;

/// How bytes become text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    /// UTF-8; what is none becomes U+FFFD.
    Utf8,
    /// UTF-8 where the bytes are that, else Windows-1252: what files that say nothing hold.
    Guessed,
    /// A code page: its characters from 128 on.
    Page(&'static str),
}

impl Encoding {
    /// The encoding that a `.cpg` file or an XML declaration names; `None` for one that is not read.
    pub fn named(name: &str) -> Option<Self> {
        let plain: String =
            name.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_lowercase();
        let short = ["ansi", "windows", "cp", "oem", "ibm", "iso"];
        let short =
            short.iter().fold(plain.as_str(), |name, prefix| name.strip_prefix(prefix).unwrap_or(name));
        Some(match short {
            "utf8" | "65001" | "usascii" | "ascii" => Self::Utf8,
            "1252" | "88591" | "latin1" | "l1" => Self::Page(WINDOWS_1252),
            "437" => Self::Page(DOS_437),
            "850" => Self::Page(DOS_850),
            "852" => Self::Page(DOS_852),
            "866" => Self::Page(DOS_866),
            "1250" => Self::Page(WINDOWS_1250),
            "1251" => Self::Page(WINDOWS_1251),
            "1253" => Self::Page(WINDOWS_1253),
            "1254" | "88599" => Self::Page(WINDOWS_1254),
            "1257" => Self::Page(WINDOWS_1257),
            "88592" => Self::Page(ISO_8859_2),
            "885915" => Self::Page(ISO_8859_15),
            _ => return None,
        })
    }

    /// The encoding that a dBASE file's language driver means; `None` for one that is not read.
    pub fn of_language_driver(driver: u8) -> Option<Self> {
        Some(match driver {
            0 => Self::Guessed,
            0x03 | 0x57 | 0x58 | 0x59 => Self::Page(WINDOWS_1252),
            0x01 | 0x09 | 0x0b | 0x0d | 0x0f | 0x11 | 0x15 | 0x18 | 0x19 | 0x1b => Self::Page(DOS_437),
            0x02 | 0x08 | 0x0a | 0x0e | 0x10 | 0x12 | 0x14 | 0x16 | 0x1a | 0x1d | 0x25 | 0x37 => {
                Self::Page(DOS_850)
            }
            0x1f | 0x22 | 0x23 | 0x40 | 0x64 | 0x87 => Self::Page(DOS_852),
            0x26 | 0x65 => Self::Page(DOS_866),
            0xc8 => Self::Page(WINDOWS_1250),
            0xc9 => Self::Page(WINDOWS_1251),
            0xcb => Self::Page(WINDOWS_1253),
            0xca => Self::Page(WINDOWS_1254),
            0xcc => Self::Page(WINDOWS_1257),
            _ => return None,
        })
    }

    /// The text that `bytes` are.
    pub fn decode(self, bytes: &[u8]) -> Cow<'_, str> {
        match self {
            _ if bytes.is_ascii() => String::from_utf8_lossy(bytes),
            Self::Utf8 => String::from_utf8_lossy(bytes),
            Self::Guessed => match std::str::from_utf8(bytes) {
                Ok(text) => Cow::Borrowed(text),
                Err(_) => Self::Page(WINDOWS_1252).decode(bytes),
            },
            Self::Page(page) => {
                let high: Vec<char> = page.chars().collect();
                let character = |&byte: &u8| match byte.checked_sub(128) {
                    None => char::from(byte),
                    Some(at) => high[usize::from(at)],
                };
                Cow::Owned(bytes.iter().map(character).collect())
            }
        }
    }
}

const WINDOWS_1252: &str = "\
    €\u{fffd}‚ƒ„…†‡ˆ‰Š‹Œ\u{fffd}Ž\u{fffd}\
    \u{fffd}‘’“”•–—˜™š›œ\u{fffd}žŸ\
    \u{a0}¡¢£¤¥¦§¨©ª«¬\u{ad}®¯\
    °±²³´µ¶·¸¹º»¼½¾¿\
    ÀÁÂÃÄÅÆÇÈÉÊËÌÍÎÏ\
    ÐÑÒÓÔÕÖ×ØÙÚÛÜÝÞß\
    àáâãäåæçèéêëìíîï\
    ðñòóôõö÷øùúûüýþÿ";
const WINDOWS_1250: &str = "\
    €\u{fffd}‚\u{fffd}„…†‡\u{fffd}‰Š‹ŚŤŽŹ\
    \u{fffd}‘’“”•–—\u{fffd}™š›śťžź\
    \u{a0}ˇ˘Ł¤Ą¦§¨©Ş«¬\u{ad}®Ż\
    °±˛ł´µ¶·¸ąş»Ľ˝ľż\
    ŔÁÂĂÄĹĆÇČÉĘËĚÍÎĎ\
    ĐŃŇÓÔŐÖ×ŘŮÚŰÜÝŢß\
    ŕáâăäĺćçčéęëěíîď\
    đńňóôőö÷řůúűüýţ˙";
const WINDOWS_1251: &str = "\
    ЂЃ‚ѓ„…†‡€‰Љ‹ЊЌЋЏ\
    ђ‘’“”•–—\u{fffd}™љ›њќћџ\
    \u{a0}ЎўЈ¤Ґ¦§Ё©Є«¬\u{ad}®Ї\
    °±Ііґµ¶·ё№є»јЅѕї\
    АБВГДЕЖЗИЙКЛМНОП\
    РСТУФХЦЧШЩЪЫЬЭЮЯ\
    абвгдежзийклмноп\
    рстуфхцчшщъыьэюя";
const WINDOWS_1253: &str = "\
    €\u{fffd}‚ƒ„…†‡\u{fffd}‰\u{fffd}‹\u{fffd}\u{fffd}\u{fffd}\u{fffd}\
    \u{fffd}‘’“”•–—\u{fffd}™\u{fffd}›\u{fffd}\u{fffd}\u{fffd}\u{fffd}\
    \u{a0}΅Ά£¤¥¦§¨©\u{fffd}«¬\u{ad}®―\
    °±²³΄µ¶·ΈΉΊ»Ό½ΎΏ\
    ΐΑΒΓΔΕΖΗΘΙΚΛΜΝΞΟ\
    ΠΡ\u{fffd}ΣΤΥΦΧΨΩΪΫάέήί\
    ΰαβγδεζηθικλμνξο\
    πρςστυφχψωϊϋόύώ\u{fffd}";
const WINDOWS_1254: &str = "\
    €\u{fffd}‚ƒ„…†‡ˆ‰Š‹Œ\u{fffd}\u{fffd}\u{fffd}\
    \u{fffd}‘’“”•–—˜™š›œ\u{fffd}\u{fffd}Ÿ\
    \u{a0}¡¢£¤¥¦§¨©ª«¬\u{ad}®¯\
    °±²³´µ¶·¸¹º»¼½¾¿\
    ÀÁÂÃÄÅÆÇÈÉÊËÌÍÎÏ\
    ĞÑÒÓÔÕÖ×ØÙÚÛÜİŞß\
    àáâãäåæçèéêëìíîï\
    ğñòóôõö÷øùúûüışÿ";
const WINDOWS_1257: &str = "\
    €\u{fffd}‚\u{fffd}„…†‡\u{fffd}‰\u{fffd}‹\u{fffd}¨ˇ¸\
    \u{fffd}‘’“”•–—\u{fffd}™\u{fffd}›\u{fffd}¯˛\u{fffd}\
    \u{a0}\u{fffd}¢£¤\u{fffd}¦§Ø©Ŗ«¬\u{ad}®Æ\
    °±²³´µ¶·ø¹ŗ»¼½¾æ\
    ĄĮĀĆÄÅĘĒČÉŹĖĢĶĪĻ\
    ŠŃŅÓŌÕÖ×ŲŁŚŪÜŻŽß\
    ąįāćäåęēčéźėģķīļ\
    šńņóōõö÷ųłśūüżž˙";
const DOS_437: &str = "\
    ÇüéâäàåçêëèïîìÄÅ\
    ÉæÆôöòûùÿÖÜ¢£¥₧ƒ\
    áíóúñÑªº¿⌐¬½¼¡«»\
    ░▒▓│┤╡╢╖╕╣║╗╝╜╛┐\
    └┴┬├─┼╞╟╚╔╩╦╠═╬╧\
    ╨╤╥╙╘╒╓╫╪┘┌█▄▌▐▀\
    αßΓπΣσµτΦΘΩδ∞φε∩\
    ≡±≥≤⌠⌡÷≈°∙·√ⁿ²■\u{a0}";
const DOS_850: &str = "\
    ÇüéâäàåçêëèïîìÄÅ\
    ÉæÆôöòûùÿÖÜø£Ø×ƒ\
    áíóúñÑªº¿®¬½¼¡«»\
    ░▒▓│┤ÁÂÀ©╣║╗╝¢¥┐\
    └┴┬├─┼ãÃ╚╔╩╦╠═╬¤\
    ðÐÊËÈıÍÎÏ┘┌█▄¦Ì▀\
    ÓßÔÒõÕµþÞÚÛÙýÝ¯´\
    \u{ad}±‗¾¶§÷¸°¨·¹³²■\u{a0}";
const DOS_852: &str = "\
    ÇüéâäůćçłëŐőîŹÄĆ\
    ÉĹĺôöĽľŚśÖÜŤťŁ×č\
    áíóúĄąŽžĘę¬źČş«»\
    ░▒▓│┤ÁÂĚŞ╣║╗╝Żż┐\
    └┴┬├─┼Ăă╚╔╩╦╠═╬¤\
    đĐĎËďŇÍÎě┘┌█▄ŢŮ▀\
    ÓßÔŃńňŠšŔÚŕŰýÝţ´\
    \u{ad}˝˛ˇ˘§÷¸°¨˙űŘř■\u{a0}";
const DOS_866: &str = "\
    АБВГДЕЖЗИЙКЛМНОП\
    РСТУФХЦЧШЩЪЫЬЭЮЯ\
    абвгдежзийклмноп\
    ░▒▓│┤╡╢╖╕╣║╗╝╜╛┐\
    └┴┬├─┼╞╟╚╔╩╦╠═╬╧\
    ╨╤╥╙╘╒╓╫╪┘┌█▄▌▐▀\
    рстуфхцчшщъыьэюя\
    ЁёЄєЇїЎў°∙·√№¤■\u{a0}";
const ISO_8859_2: &str = "\
    \u{80}\u{81}\u{82}\u{83}\u{84}\u{85}\u{86}\u{87}\u{88}\u{89}\u{8a}\u{8b}\u{8c}\u{8d}\u{8e}\u{8f}\
    \u{90}\u{91}\u{92}\u{93}\u{94}\u{95}\u{96}\u{97}\u{98}\u{99}\u{9a}\u{9b}\u{9c}\u{9d}\u{9e}\u{9f}\
    \u{a0}Ą˘Ł¤ĽŚ§¨ŠŞŤŹ\u{ad}ŽŻ\
    °ą˛ł´ľśˇ¸šşťź˝žż\
    ŔÁÂĂÄĹĆÇČÉĘËĚÍÎĎ\
    ĐŃŇÓÔŐÖ×ŘŮÚŰÜÝŢß\
    ŕáâăäĺćçčéęëěíîď\
    đńňóôőö÷řůúűüýţ˙";
const ISO_8859_15: &str = "\
    \u{80}\u{81}\u{82}\u{83}\u{84}\u{85}\u{86}\u{87}\u{88}\u{89}\u{8a}\u{8b}\u{8c}\u{8d}\u{8e}\u{8f}\
    \u{90}\u{91}\u{92}\u{93}\u{94}\u{95}\u{96}\u{97}\u{98}\u{99}\u{9a}\u{9b}\u{9c}\u{9d}\u{9e}\u{9f}\
    \u{a0}¡¢£€¥Š§š©ª«¬\u{ad}®¯\
    °±²³Žµ¶·ž¹º»ŒœŸ¿\
    ÀÁÂÃÄÅÆÇÈÉÊËÌÍÎÏ\
    ÐÑÒÓÔÕÖ×ØÙÚÛÜÝÞß\
    àáâãäåæçèéêëìíîï\
    ðñòóôõö÷øùúûüýþÿ";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_page_has_its_128_characters() {
        for name in
            ["1250", "1251", "1252", "1253", "1254", "1257", "437", "850", "852", "866", "8859-2", "8859-15"]
        {
            let Some(Encoding::Page(page)) = Encoding::named(name) else { panic!("{name}") };
            assert_eq!(page.chars().count(), 128, "{name}");
        }
    }

    #[test]
    fn texts_come_out_as_they_were_written() {
        let decode = |name: &str, bytes: &[u8]| Encoding::named(name).expect(name).decode(bytes).into_owned();
        assert_eq!(decode("ISO-8859-1", b"Stra\xdfe"), "Straße");
        assert_eq!(decode("ANSI 1251", b"\xcc\xee\xf1\xea\xe2\xe0"), "Москва");
        assert_eq!(decode("windows-1252", b"\x80 5"), "€ 5");
        assert_eq!(decode("CP850", b"\x9c"), "£");
        assert_eq!(decode("UTF-8", "Æ".as_bytes()), "Æ");
        assert_eq!(decode("iso-8859-15", b"\xa4"), "€");
        assert_eq!(Encoding::named("Shift_JIS"), None);
    }

    #[test]
    fn where_nothing_is_said_utf_8_is_recognized() {
        assert_eq!(Encoding::Guessed.decode("Straße".as_bytes()), "Straße");
        assert_eq!(Encoding::Guessed.decode(b"Stra\xdfe"), "Straße");
        assert_eq!(Encoding::of_language_driver(0x57).expect("ANSI").decode(b"\xe9"), "é");
    }
}
