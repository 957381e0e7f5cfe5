//! Text of XML: escaped, and elements written line by line.

use sandtable_base::message::xml::escaped;

/// A document as it is written, indented by depth.
#[derive(Default)]
pub(super) struct XmlText {
    text: String,
    open: Vec<String>,
}

impl XmlText {
    /// A document with its declaration.
    pub fn new() -> Self {
        Self { text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned(), open: Vec::new() }
    }

    /// Opens an element; attributes are names with values.
    pub fn open(&mut self, name: &str, attributes: &[(&str, &str)]) -> &mut Self {
        self.start(name, attributes);
        self.text.push_str(">\n");
        self.open.push(name.to_owned());
        self
    }

    /// Closes the element opened last.
    pub fn close(&mut self) -> &mut Self {
        if let Some(name) = self.open.pop() {
            self.indent();
            self.text.push_str(&format!("</{name}>\n"));
        }
        self
    }

    /// An element with a text alone.
    pub fn element(&mut self, name: &str, text: &str) -> &mut Self {
        self.element_with(name, &[], text)
    }

    /// An element with attributes and a text; without one it is empty.
    pub fn element_with(&mut self, name: &str, attributes: &[(&str, &str)], text: &str) -> &mut Self {
        self.start(name, attributes);
        match text {
            "" => self.text.push_str("/>\n"),
            text => self.text.push_str(&format!(">{}</{name}>\n", escaped(text))),
        }
        self
    }

    /// The document, with what is open closed.
    pub fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text
    }

    fn start(&mut self, name: &str, attributes: &[(&str, &str)]) {
        self.indent();
        self.text.push('<');
        self.text.push_str(name);
        for (key, value) in attributes {
            self.text.push_str(&format!(" {key}=\"{}\"", escaped(value)));
        }
    }

    fn indent(&mut self) {
        self.text.extend(std::iter::repeat_n("  ", self.open.len()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_closed_and_texts_escaped() {
        let mut xml = XmlText::new();
        xml.open("a", &[("b", "<&\"")]).element("c", "x & y").element("d", "");
        let text = xml.finish();
        assert_eq!(
            text,
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<a b=\"&lt;&amp;&quot;\">\n  <c>x &amp; y</c>\n  <d/>\n</a>\n"
        );
    }
}
