//! XML of the vector formats, over `quick-xml`: elements by their local names, attributes, text.
//!
//! A document is walked by [`XmlReader::next_child`], which keeps nothing; a small element is read as a tree.
//! Nothing is fetched. A document type that declares entities is refused, and with it the files that grow a
//! thousandfold by them. Elements lie at most [`XML_DEPTH`] deep.

use std::borrow::Cow;
use std::cell::Cell;
use std::error::Error;

use quick_xml::XmlVersion;
use quick_xml::escape::resolve_predefined_entity;
use quick_xml::events::attributes::Attribute;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;

use crate::encoding::TextEncoding;
use crate::error::{VectorError, shorten};
use sandtable_base::limits::XML_DEPTH;

/// Bytes of a document in which its declaration is searched.
const DECLARATION_BYTES: usize = 200;

pub(crate) struct XmlReader<'a> {
    reader: Reader<&'a [u8]>,
    text: &'a str,
    format: &'static str,
    depth: usize,
    /// Bytes of the text whose line breaks are counted, and how many there are: places are asked for in order.
    counted: Cell<(usize, usize)>,
}

/// An element: its name and attributes and, once [`XmlReader::read`], its content.
pub(crate) struct XmlElement<'a> {
    start: BytesStart<'a>,
    /// Bytes of the document up to the end of the start tag.
    offset: usize,
    content: Vec<XmlContent<'a>>,
}

enum XmlContent<'a> {
    Element(XmlElement<'a>),
    Text(Cow<'a, str>),
}

/// The text of a document.
#[derive(Debug)]
pub(crate) struct DecodedXml<'a> {
    pub text: Cow<'a, str>,
    /// A sentence about bytes that are not of the encoding.
    pub fault: Option<String>,
}

/// Decodes a document by its byte order mark, else by its declaration, else as UTF-8. Bytes that are not UTF-8 although
/// they should be, as of one name in another encoding, become replacement characters.
///
/// # Errors
/// The encoding is unknown.
pub(crate) fn decode<'a>(bytes: &'a [u8], format: &'static str) -> Result<DecodedXml<'a>, VectorError> {
    let (encoding, bytes) = match TextEncoding::from_mark(bytes) {
        Some(marked) => marked,
        None => (declared_encoding(bytes, format)?, bytes),
    };
    if !encoding.is_utf_8() {
        return Ok(DecodedXml { text: encoding.decode(bytes), fault: None });
    }
    let text = String::from_utf8_lossy(bytes);
    let fault = std::str::from_utf8(bytes).err().map(|error| {
        let at = error.valid_up_to();
        let line = 1 + bytes[..at].iter().filter(|&&byte| byte == b'\n').count();
        format!("the file is not all UTF-8: some letters are not read, the first in line {line}")
    });
    Ok(DecodedXml { text, fault })
}

fn declared_encoding(bytes: &[u8], format: &'static str) -> Result<TextEncoding, VectorError> {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(DECLARATION_BYTES)]);
    let declaration = head.split("?>").next().filter(|head| head.trim_start().starts_with("<?xml"));
    let Some((_, value)) = declaration.and_then(|declaration| declaration.split_once("encoding")) else {
        return Ok(TextEncoding::UTF_8);
    };
    let name = value.trim_start_matches([' ', '=']).split(['"', '\'']).nth(1).unwrap_or_default();
    TextEncoding::from_name(name).ok_or_else(|| VectorError::Unsupported {
        format,
        content: format!("text in the encoding '{}'", shorten(name)).into(),
        remedy: "save it as UTF-8",
    })
}

impl<'a> XmlReader<'a> {
    /// A reader at the start of `text`; messages call the document `format`.
    pub fn new(text: &'a str, format: &'static str) -> Self {
        let mut reader = Reader::from_str(text);
        reader.config_mut().expand_empty_elements = true;
        Self { reader, text, format, depth: 0, counted: Cell::new((0, 0)) }
    }

    /// Returns the error that the document is broken where the reader stands.
    pub fn broken(&self, source: impl Into<Box<dyn Error + Send + Sync>>) -> VectorError {
        VectorError::broken(self.format, self.line_at(self.offset()), source)
    }

    /// Returns the error that the document is broken at `element`.
    pub fn broken_at(
        &self,
        element: &XmlElement<'_>,
        source: impl Into<Box<dyn Error + Send + Sync>>,
    ) -> VectorError {
        VectorError::broken(self.format, self.line_at(element.offset), source)
    }

    /// Returns the line of `element` as text.
    pub fn line_of(&self, element: &XmlElement<'_>) -> String {
        self.line_at(element.offset)
    }

    /// Returns the line of the byte at `offset` as text.
    pub fn line_at(&self, offset: usize) -> String {
        let (from, before) = Some(self.counted.get()).filter(|(from, _)| *from <= offset).unwrap_or_default();
        let breaks =
            before + self.text.as_bytes()[from..offset].iter().filter(|&&byte| byte == b'\n').count();
        self.counted.set((offset, breaks));
        format!("line {}", breaks + 1)
    }

    /// Returns the bytes of the document up to where the reader is.
    pub fn offset(&self) -> usize {
        usize::try_from(self.reader.buffer_position()).unwrap_or(usize::MAX).min(self.text.len())
    }

    /// Opens the outermost element.
    ///
    /// # Errors
    /// There is none, or the document is not well-formed, as in all functions here.
    pub fn root(&mut self) -> Result<XmlElement<'a>, VectorError> {
        loop {
            match self.next()? {
                Some(XmlContent::Element(element)) => return Ok(element),
                Some(XmlContent::Text(text)) if text.trim().is_empty() => {}
                Some(_) => return Err(self.broken("text precedes the first element")),
                None => return Err(self.broken("there is no element")),
            }
        }
    }

    /// Opens the next child of the innermost open element, which the caller then reads, skips or walks; at the end of
    /// that element closes it and returns `None`.
    pub fn next_child(&mut self) -> Result<Option<XmlElement<'a>>, VectorError> {
        loop {
            match self.next()? {
                Some(XmlContent::Element(element)) => return Ok(Some(element)),
                Some(XmlContent::Text(_)) => {}
                None => return Ok(None),
            }
        }
    }

    /// Reads the content of the element just opened.
    pub fn read(&mut self, mut element: XmlElement<'a>) -> Result<XmlElement<'a>, VectorError> {
        while let Some(content) = self.next()? {
            element.content.push(match content {
                XmlContent::Element(child) => XmlContent::Element(self.read(child)?),
                text => text,
            });
        }
        Ok(element)
    }

    /// Skips the content of the element just opened.
    pub fn skip(&mut self) -> Result<(), VectorError> {
        let outside = self.depth - 1;
        while self.depth > outside {
            self.next()?;
        }
        Ok(())
    }

    /// Checks that only space and comments follow.
    pub fn finish(&mut self) -> Result<(), VectorError> {
        loop {
            match self.next()? {
                None => return Ok(()),
                Some(XmlContent::Text(text)) if text.trim().is_empty() => {}
                Some(_) => return Err(self.broken("something follows after the document's end")),
            }
        }
    }

    /// Returns the next content of the innermost open element; `None` at its end, and outside all at the document's.
    fn next(&mut self) -> Result<Option<XmlContent<'a>>, VectorError> {
        loop {
            let text = match self.reader.read_event().map_err(|error| self.broken(error))? {
                Event::Start(start) | Event::Empty(start) => return self.open(start).map(Some),
                Event::End(_) => {
                    self.depth = self.depth.saturating_sub(1);
                    return Ok(None);
                }
                Event::Eof if self.depth > 0 => return Err(self.broken("the file ends within an element")),
                Event::Eof => return Ok(None),
                Event::Text(text) => text.xml10_content(),
                Event::CData(text) => text.xml10_content(),
                Event::GeneralRef(name) => {
                    let character = name.resolve_char_ref().ok().flatten();
                    let name = name.into_inner();
                    match (character, resolve_predefined_entity(&name)) {
                        (Some(character), _) => character.to_string().into(),
                        (None, Some(text)) => text.into(),
                        (None, None) => {
                            return Err(self.broken(format!("the entity &{}; is unknown", shorten(&name))));
                        }
                    }
                }
                Event::DocType(text) if text.contains('[') => {
                    return Err(self.broken("its document type declares entities, which are not read"));
                }
                Event::DocType(_) | Event::Comment(_) | Event::Decl(_) | Event::PI(_) => continue,
            };
            return Ok(Some(XmlContent::Text(text)));
        }
    }

    fn open(&mut self, start: BytesStart<'a>) -> Result<XmlContent<'a>, VectorError> {
        self.depth += 1;
        if self.depth > XML_DEPTH.count() {
            return Err(self.broken(format!("elements lie more than {XML_DEPTH} deep; {XML_DEPTH:#}")));
        }
        Ok(XmlContent::Element(XmlElement { start, offset: self.offset(), content: Vec::new() }))
    }
}

impl<'a> XmlElement<'a> {
    /// Returns its name without prefix.
    pub fn name(&self) -> &str {
        self.start.local_name().into_inner()
    }

    pub fn children(&self) -> impl Iterator<Item = &XmlElement<'a>> {
        self.content.iter().filter_map(|content| match content {
            XmlContent::Element(element) => Some(element),
            XmlContent::Text(_) => None,
        })
    }

    pub fn children_named(&self, name: &str) -> impl Iterator<Item = &XmlElement<'a>> {
        self.children().filter(move |child| child.name() == name)
    }

    /// Returns its text and that of all elements in it, trimmed.
    pub fn text(&self) -> String {
        let mut text = String::new();
        self.append_text(&mut text);
        let trimmed = text.trim();
        if trimmed.len() == text.len() { text } else { trimmed.to_owned() }
    }

    fn append_text(&self, text: &mut String) {
        for content in &self.content {
            match content {
                XmlContent::Element(element) => element.append_text(text),
                XmlContent::Text(part) => text.push_str(part),
            }
        }
    }

    /// Returns the value of an attribute, `None` where it is absent or not well-formed.
    pub fn attribute(&self, name: &str) -> Option<Cow<'_, str>> {
        self.raw_attribute(name)?.normalized_value(XmlVersion::Implicit1_0).ok()
    }

    /// Returns the value of an attribute by its name without prefix.
    pub fn local_attribute(&self, name: &str) -> Option<Cow<'_, str>> {
        let mut attributes = self.start.attributes();
        attributes.with_checks(false);
        let found = attributes.flatten().find(|attribute| attribute.key.local_name().into_inner() == name);
        found?.normalized_value(XmlVersion::Implicit1_0).ok()
    }

    pub fn number<T: std::str::FromStr>(&self, name: &str) -> Option<T> {
        self.raw_attribute(name)?.value.trim().parse().ok()
    }

    fn raw_attribute(&self, name: &str) -> Option<Attribute<'_>> {
        let mut attributes = self.start.attributes();
        attributes.with_checks(false);
        attributes.flatten().find(|attribute| attribute.key.into_inner() == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_of(document: &str) -> Result<String, VectorError> {
        let mut xml = XmlReader::new(document, "XML");
        let root = xml.root()?;
        let text = xml.read(root)?.text();
        xml.finish()?;
        Ok(text)
    }

    #[test]
    fn text_has_its_references_resolved_and_its_cdata_unchanged() {
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
    fn elements_too_deep_or_left_open_are_refused() {
        assert!(text_of(&"<a>".repeat(100_000)).expect_err("deep").to_string().contains("64 deep"));
        assert!(text_of("<a><b></a>").is_err());
        assert!(text_of("<a>").is_err());
        assert!(text_of("<a/>more").expect_err("more").to_string().contains("follows"));
        assert!(text_of("").is_err());
    }

    #[test]
    fn encodings_are_known_by_the_declaration_or_the_mark() {
        let latin = b"<?xml version=\"1.0\" encoding='ISO-8859-1'?><a>\xe9</a>";
        assert!(decode(latin, "XML").expect("known").text.ends_with("<a>é</a>"));
        let wide: Vec<u8> = "\u{feff}<a>é</a>".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(decode(&wide, "XML").expect("known").text, "<a>é</a>");
        let mixed = decode(b"<a>\n\xe9 \xc3\xa9</a>", "XML").expect("known");
        assert_eq!(mixed.text, "<a>\n\u{fffd} é</a>");
        assert!(mixed.fault.is_some_and(|fault| fault.contains("line 2")));
        let other = b"<?xml version=\"1.0\" encoding=\"EBCDIC\"?><a/>";
        assert!(decode(other, "XML").expect_err("unknown").to_string().contains("EBCDIC"));
    }
}
