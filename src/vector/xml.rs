//! XML as the vector formats need it, over `quick-xml`: elements by their names without prefix, attributes, text.
//!
//! Nothing is fetched and no entity of the document's own is known: a document type that declares some is refused,
//! and with it the files that grow a thousandfold by them. Elements lie at most [`MOST_DEPTH`] deep.

use std::borrow::Cow;

use quick_xml::XmlVersion;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;

use crate::vector::codepage::Encoding;
use crate::vector::error::VectorError;

/// Deeper than folders in folders are ever nested, and no danger to the stack.
const MOST_DEPTH: usize = 64;

/// As much of a document as its declaration is looked for in.
const DECLARATION_BYTES: usize = 200;

/// A document while it is read.
pub(crate) struct Xml<'a> {
    reader: Reader<&'a [u8]>,
    text: &'a str,
    format: &'static str,
    depth: usize,
}

/// An element's name and attributes.
pub(crate) struct Element<'a>(BytesStart<'a>);

/// What comes next.
enum XmlToken<'a> {
    Open(Element<'a>),
    Text(Cow<'a, str>),
    Close,
    End,
}

/// The text of a document, by its byte order mark or its declaration, else as UTF-8.
///
/// # Errors
/// The encoding is none that is read, or the bytes are not in it.
pub(crate) fn decode<'a>(bytes: &'a [u8], format: &'static str) -> Result<Cow<'a, str>, VectorError> {
    let utf16 = |rest: &[u8], unit: fn([u8; 2]) -> u16| {
        let units = rest.as_chunks::<2>().0.iter().map(|&pair| unit(pair));
        Cow::Owned(char::decode_utf16(units).map(|unit| unit.unwrap_or('\u{fffd}')).collect())
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => return Ok(utf16(rest, u16::from_le_bytes)),
        [0xfe, 0xff, rest @ ..] => return Ok(utf16(rest, u16::from_be_bytes)),
        _ => {}
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(DECLARATION_BYTES)]);
    let declaration = head.split("?>").next().filter(|head| head.trim_start().starts_with("<?xml"));
    let stated = declaration.and_then(|text| text.split_once("encoding")).map(|(_, rest)| {
        let rest = rest.trim_start_matches([' ', '=']);
        rest.split(['"', '\'']).nth(1).unwrap_or_default().to_owned()
    });
    let encoding = stated.as_deref().map_or(Some(Encoding::Utf8), Encoding::named);
    match encoding {
        Some(Encoding::Utf8) => std::str::from_utf8(bytes).map(Cow::Borrowed).map_err(|error| {
            let place = format!("byte {}", error.valid_up_to() + 1);
            VectorError::broken(format, place, "this is not UTF-8, which it says it is")
        }),
        Some(page) => Ok(page.decode(bytes)),
        None => Err(VectorError::Unsupported {
            format,
            what: format!("text in the encoding '{}'", stated.unwrap_or_default()),
            remedy: "save it as UTF-8".into(),
        }),
    }
}

impl<'a> Xml<'a> {
    /// The document `text`, called `format` in messages.
    pub fn new(text: &'a str, format: &'static str) -> Self {
        let mut reader = Reader::from_str(text);
        reader.config_mut().expand_empty_elements = true;
        Self { reader, text, format, depth: 0 }
    }

    /// The error that something is wrong here.
    pub fn broken(&self, reason: impl Into<String>) -> VectorError {
        let at = usize::try_from(self.reader.buffer_position()).unwrap_or(usize::MAX).min(self.text.len());
        let line = self.text.as_bytes()[..at].iter().filter(|&&byte| byte == b'\n').count() + 1;
        VectorError::broken(self.format, format!("line {line}"), reason)
    }

    /// The document's outermost element.
    ///
    /// # Errors
    /// There is none.
    pub fn root(&mut self) -> Result<Element<'a>, VectorError> {
        loop {
            match self.next()? {
                XmlToken::Open(element) => return Ok(element),
                XmlToken::Text(text) if text.trim().is_empty() => {}
                XmlToken::Text(_) => return Err(self.broken("text stands before the first element")),
                XmlToken::Close | XmlToken::End => return Err(self.broken("there is no element")),
            }
        }
    }

    /// Gives `each` every element that lies directly in the one just opened, which it must read to its end, and
    /// reads on behind the end of this one.
    ///
    /// # Errors
    /// Those of `each`; what is not well-formed.
    pub fn children(
        &mut self,
        mut each: impl FnMut(&mut Self, &Element<'a>) -> Result<(), VectorError>,
    ) -> Result<(), VectorError> {
        loop {
            match self.next()? {
                XmlToken::Open(element) => each(self, &element)?,
                XmlToken::Text(_) => {}
                XmlToken::Close => return Ok(()),
                XmlToken::End => return Err(self.broken("the file ends within an element")),
            }
        }
    }

    /// Reads to the end of the element just opened.
    ///
    /// # Errors
    /// What is not well-formed.
    pub fn skip(&mut self) -> Result<(), VectorError> {
        let outside = self.depth - 1;
        while self.depth > outside {
            if matches!(self.next()?, XmlToken::End) {
                return Err(self.broken("the file ends within an element"));
            }
        }
        Ok(())
    }

    /// The text in the element just opened and in those within it, trimmed.
    ///
    /// # Errors
    /// What is not well-formed.
    pub fn text(&mut self) -> Result<String, VectorError> {
        let outside = self.depth - 1;
        let mut all = String::new();
        while self.depth > outside {
            match self.next()? {
                XmlToken::Text(text) => all.push_str(&text),
                XmlToken::Open(_) | XmlToken::Close => {}
                XmlToken::End => return Err(self.broken("the file ends within an element")),
            }
        }
        let trimmed = all.trim();
        Ok(if trimmed.len() == all.len() { all } else { trimmed.to_owned() })
    }

    /// Holds that nothing but space and comments follow.
    ///
    /// # Errors
    /// Something does.
    pub fn end(&mut self) -> Result<(), VectorError> {
        loop {
            match self.next()? {
                XmlToken::End => return Ok(()),
                XmlToken::Text(text) if text.trim().is_empty() => {}
                _ => return Err(self.broken("something follows after the document's end")),
            }
        }
    }

    fn next(&mut self) -> Result<XmlToken<'a>, VectorError> {
        loop {
            let event = self.reader.read_event().map_err(|error| self.broken(error.to_string()))?;
            match event {
                Event::Start(start) | Event::Empty(start) => {
                    self.depth += 1;
                    if self.depth > MOST_DEPTH {
                        return Err(self.broken(format!("elements lie more than {MOST_DEPTH} deep")));
                    }
                    return Ok(XmlToken::Open(Element(start)));
                }
                Event::End(_) => {
                    self.depth = self.depth.saturating_sub(1);
                    return Ok(XmlToken::Close);
                }
                Event::Text(text) => return Ok(XmlToken::Text(text.xml10_content())),
                Event::CData(text) => return Ok(XmlToken::Text(text.xml10_content())),
                Event::GeneralRef(name) => {
                    let character = name.resolve_char_ref().ok().flatten().map(|c| Cow::Owned(c.to_string()));
                    let name = name.into_inner();
                    let known = character.or_else(|| resolve_predefined_entity(&name).map(Cow::Borrowed));
                    return match known {
                        Some(text) => Ok(XmlToken::Text(text)),
                        None => {
                            let name: String = name.chars().take(40).collect();
                            Err(self.broken(format!("the entity &{name}; is not known")))
                        }
                    };
                }
                Event::DocType(text) if text.contains('[') => {
                    return Err(self.broken(
                        "its document type declares something, entities perhaps, which is not read",
                    ));
                }
                Event::DocType(_) | Event::Comment(_) | Event::Decl(_) | Event::PI(_) => {}
                Event::Eof => return Ok(XmlToken::End),
            }
        }
    }
}

impl Element<'_> {
    /// Its name without prefix.
    pub fn name(&self) -> &str {
        self.0.local_name().into_inner()
    }

    /// Its attributes, as they are written; references to characters are not resolved, which numbers need not.
    pub fn raw_attributes(&self) -> impl Iterator<Item = (&str, Cow<'_, str>)> {
        let mut attributes = self.0.attributes();
        attributes.with_checks(false);
        attributes.flatten().map(|attribute| (attribute.key.into_inner(), attribute.value))
    }

    /// The value of an attribute; `None` where it is absent or not well-formed.
    pub fn attribute(&self, name: &str) -> Option<Cow<'_, str>> {
        let mut attributes = self.0.attributes();
        attributes.with_checks(false);
        let found = attributes.flatten().find(|attribute| attribute.key.into_inner() == name)?;
        found.normalized_value(XmlVersion::Implicit1_0).ok()
    }

    /// The value of an attribute as a number.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.attribute(name)?.trim().parse().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_of(document: &str) -> Result<String, VectorError> {
        let mut xml = Xml::new(document, "XML");
        xml.root()?;
        let text = xml.text()?;
        xml.end()?;
        Ok(text)
    }

    #[test]
    fn text_has_its_references_resolved_and_its_cdata_as_it_is() {
        let text = text_of("<?xml version='1.0'?><!DOCTYPE a><a> x &amp; &#228;<b/><![CDATA[<y>]]> </a>");
        assert_eq!(text.expect("well-formed"), "x & ä<y>");
    }

    #[test]
    fn entities_of_the_document_are_refused() {
        let bomb = "<!DOCTYPE a [<!ENTITY l \"lol\">]><a>&l;</a>";
        assert!(text_of(bomb).expect_err("declares").to_string().contains("document type"));
        let error = text_of("<a>\n&file;</a>").expect_err("unknown").to_string();
        assert!(error.contains("line 2") && error.contains("&file;"), "{error}");
    }

    #[test]
    fn depth_has_an_end_and_so_has_the_document() {
        assert!(text_of(&"<a>".repeat(100_000)).expect_err("deep").to_string().contains("64 deep"));
        assert!(text_of("<a><b></a>").is_err());
        assert!(text_of("<a>").is_err());
        assert!(text_of("<a/>more").expect_err("more").to_string().contains("follows"));
        assert!(text_of("").is_err());
    }

    #[test]
    fn other_encodings_are_read_by_the_declaration_or_the_mark() {
        let latin = b"<?xml version=\"1.0\" encoding='ISO-8859-1'?><a>\xe9</a>";
        assert!(decode(latin, "XML").expect("known").ends_with("<a>é</a>"));
        let wide: Vec<u8> = "\u{feff}<a>é</a>".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(decode(&wide, "XML").expect("known"), "<a>é</a>");
        assert!(decode(b"<a>\xe9</a>", "XML").expect_err("not UTF-8").to_string().contains("byte 4"));
        let other = b"<?xml version=\"1.0\" encoding=\"Big5\"?><a/>";
        assert!(decode(other, "XML").expect_err("unknown").to_string().contains("Big5"));
    }
}
