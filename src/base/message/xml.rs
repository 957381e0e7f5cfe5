//! Text in XML.

/// `text` as XML 1.0 holds it, in elements and in attributes: what marks up is written as entities, control characters
/// become spaces, and the two characters that XML does not hold are left out.
pub fn escaped(text: &str) -> String {
    let mut xml = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => xml.push_str("&amp;"),
            '<' => xml.push_str("&lt;"),
            '>' => xml.push_str("&gt;"),
            '"' => xml.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => {}
            control if control.is_control() => xml.push(' '),
            character => xml.push(character),
        }
    }
    xml
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_marks_up_is_an_entity_and_what_xml_does_not_hold_is_gone() {
        assert_eq!(escaped("A <b> & \"c\"\u{1}d\u{ffff}é"), "A &lt;b&gt; &amp; &quot;c&quot; dé");
    }
}
