//! The parameters of a request: from the query, a form, or a JSON object.
//!
//! A query and a form are `name=value` pairs (WHATWG URL, `application/x-www-form-urlencoded`); most values hold no
//! escape and are borrowed as they stand. A JSON object holds the same names; its values may be strings, numbers, and a
//! list of strings, which means the same as those strings with `|` between them. Later values replace earlier ones.

use std::borrow::Cow;
use std::fmt;

use serde::Deserializer;
use serde::de::{self, MapAccess, SeqAccess, Visitor};

use crate::app::serve::reply::{HttpError, quoted};

/// No request needs as many parameters; a list of millions must not be searched again and again.
const MOST: usize = 32;

/// Named values, in the order they were first given.
#[derive(Debug, Default)]
pub struct Params<'a> {
    pairs: Vec<(Cow<'a, str>, Cow<'a, str>)>,
}

impl<'a> Params<'a> {
    /// Adds the pairs of a query or a form.
    ///
    /// # Errors
    /// A value is not UTF-8, or there are too many.
    pub fn add_form(&mut self, text: &'a str) -> Result<(), HttpError> {
        for pair in text.split('&').filter(|pair| !pair.is_empty()) {
            let (name, value) = pair.split_once('=').unwrap_or((pair, ""));
            self.put(unescaped(name)?, unescaped(value)?)?;
        }
        Ok(())
    }

    /// Adds the members of a JSON object.
    ///
    /// # Errors
    /// The bytes are no JSON object, or a value is neither a string, a number, nor a list of strings.
    pub fn add_json(&mut self, bytes: &'a [u8]) -> Result<(), HttpError> {
        let mut reader = serde_json::Deserializer::from_slice(bytes);
        let read = reader.deserialize_map(JsonMembers(self)).and_then(|()| reader.end());
        read.map_err(|error| {
            HttpError::wrong(format!("the body is not the JSON object that was expected: {error}"))
        })
    }

    /// The value of a parameter.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.pairs.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_ref())
    }

    /// The value of a parameter that may not be left out.
    ///
    /// # Errors
    /// It was; `example` shows how it is written.
    pub fn required(&self, name: &str, example: &str) -> Result<&str, HttpError> {
        self.get(name)
            .filter(|value| !value.is_empty())
            .ok_or_else(|| HttpError::wrong(format!("'{name}' is missing; write it as in {name}={example}")))
    }

    /// A finite number within `range`, or `default` where it is not given.
    ///
    /// # Errors
    /// It is something else.
    pub fn number(
        &self,
        name: &str,
        range: std::ops::RangeInclusive<f64>,
        default: f64,
    ) -> Result<f64, HttpError> {
        let Some(text) = self.get(name) else {
            return Ok(default);
        };
        let value = text.trim().parse::<f64>().ok().filter(|value| range.contains(value));
        value.ok_or_else(|| {
            let found = quoted(text);
            let (least, most) = range.into_inner();
            HttpError::wrong(format!("{name} is {found}; write a number from {least} to {most}"))
        })
    }

    /// The choice that a word names; `None` where the parameter is not given.
    ///
    /// # Errors
    /// The word is none of them; the message lists all.
    pub fn choice<T: Copy>(&self, name: &str, choices: &[(&str, T)]) -> Result<Option<T>, HttpError> {
        let Some(text) = self.get(name) else {
            return Ok(None);
        };
        let found = choices.iter().find(|(word, _)| *word == text).map(|&(_, choice)| choice);
        found.map(Some).ok_or_else(|| {
            let words: Vec<&str> = choices.iter().map(|&(word, _)| word).collect();
            HttpError::wrong(format!("{name} is {}; there are {}", quoted(text), words.join(", ")))
        })
    }

    /// Refuses parameters that are not in `known`: a misspelled one would be answered as if it were not there.
    ///
    /// # Errors
    /// There is one.
    pub fn only(&self, known: &[&str]) -> Result<(), HttpError> {
        match self.pairs.iter().find(|(name, _)| !known.contains(&name.as_ref())) {
            None => Ok(()),
            Some((name, _)) => {
                let known = known.join(", ");
                Err(HttpError::wrong(format!("there is no parameter {}; there are {known}", quoted(name))))
            }
        }
    }

    fn put(&mut self, name: Cow<'a, str>, value: Cow<'a, str>) -> Result<(), HttpError> {
        if let Some(pair) = self.pairs.iter_mut().find(|(known, _)| *known == name) {
            pair.1 = value;
            return Ok(());
        }
        if self.pairs.len() == MOST {
            return Err(HttpError::wrong(format!("more than {MOST} parameters")));
        }
        self.pairs.push((name, value));
        Ok(())
    }
}

/// `text` with `+` read as a space and `%xx` as a byte; borrowed where there is neither.
fn unescaped(text: &str) -> Result<Cow<'_, str>, HttpError> {
    let bytes = text.as_bytes();
    if !bytes.iter().any(|byte| matches!(byte, b'%' | b'+')) {
        return Ok(Cow::Borrowed(text));
    }
    let mut out = Vec::with_capacity(bytes.len());
    let mut rest = bytes;
    while let Some((&byte, after)) = rest.split_first() {
        rest = after;
        match (byte, after) {
            (b'+', _) => out.push(b' '),
            (b'%', [high, low, after @ ..]) if high.is_ascii_hexdigit() && low.is_ascii_hexdigit() => {
                out.push(hex(*high) << 4 | hex(*low));
                rest = after;
            }
            // As browsers do: an escape that is none stands for itself.
            _ => out.push(byte),
        }
    }
    String::from_utf8(out).map(Cow::Owned).map_err(|_| {
        HttpError::wrong(format!("{} is not UTF-8 text after its escapes are read", quoted(text)))
    })
}

fn hex(digit: u8) -> u8 {
    (digit as char).to_digit(16).map_or(0, |value| value as u8)
}

/// Reads the members of a JSON object into parameters.
struct JsonMembers<'p, 'a>(&'p mut Params<'a>);

impl<'a> Visitor<'a> for JsonMembers<'_, 'a> {
    type Value = ();

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("an object of parameters")
    }

    fn visit_map<A: MapAccess<'a>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(TextValue(name)) = map.next_key()? {
            if let TextValue(Some(value)) = map.next_value::<TextValue<Option<Cow<'a, str>>>>()? {
                let name = name.unwrap_or_default();
                self.0.put(name, value).map_err(|refusal| de::Error::custom(refusal.reason()))?;
            }
        }
        Ok(())
    }
}

/// The text of a value; `None` for null.
struct TextValue<T>(T);

impl<'de> de::Deserialize<'de> for TextValue<Option<Cow<'de, str>>> {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        reader.deserialize_any(TextVisitor).map(Self)
    }
}

struct TextVisitor;

impl<'de> Visitor<'de> for TextVisitor {
    type Value = Option<Cow<'de, str>>;

    fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("a string, a number, or a list of strings such as [\"56,123\", \"57,124\"]")
    }

    fn visit_borrowed_str<E: de::Error>(self, text: &'de str) -> Result<Self::Value, E> {
        Ok(Some(Cow::Borrowed(text)))
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<Self::Value, E> {
        Ok(Some(Cow::Owned(text.to_owned())))
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<Self::Value, E> {
        Ok(Some(Cow::Owned(value.to_string())))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Self::Value, E> {
        Ok(Some(Cow::Owned(value.to_string())))
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Self::Value, E> {
        Ok(Some(Cow::Owned(value.to_string())))
    }

    fn visit_unit<E: de::Error>(self) -> Result<Self::Value, E> {
        Ok(None)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
        let mut joined = String::new();
        while let Some(item) = list.next_element::<Cow<'de, str>>()? {
            if !joined.is_empty() {
                joined.push('|');
            }
            joined.push_str(&item);
        }
        Ok(Some(Cow::Owned(joined)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn form(text: &str) -> Params<'_> {
        let mut params = Params::default();
        params.add_form(text).expect("sound");
        params
    }

    #[test]
    fn escapes_are_read_and_what_has_none_is_borrowed() {
        let params = form("locations=1%2C2%7C3,4&&a+b=c%20d&broken=100%&empty");
        assert_eq!(params.get("locations"), Some("1,2|3,4"));
        assert_eq!(params.get("a b"), Some("c d"));
        assert_eq!((params.get("broken"), params.get("empty")), (Some("100%"), Some("")));
        assert_eq!(form("a=1&a=2").get("a"), Some("2"), "later values replace earlier ones");
        assert!(Params::default().add_form("a=%ff").is_err());
    }

    #[test]
    fn json_holds_the_same_as_a_form() {
        let mut params = Params::default();
        let body = br#"{"locations": ["1,2", "3,4"], "samples": 7, "nodata_value": -9999.5, "format": null}"#;
        params.add_json(body).expect("sound");
        assert_eq!(params.get("locations"), Some("1,2|3,4"));
        assert_eq!((params.get("samples"), params.get("nodata_value")), (Some("7"), Some("-9999.5")));
        assert_eq!(params.get("format"), None);
        for wrong in ["", "[]", "{", "{\"a\":true}", "{\"a\":{}}", "{\"a\":[1]}", "{\"a\":[[]]}", "{} {}"] {
            let refused = Params::default().add_json(wrong.as_bytes());
            assert!(refused.is_err_and(|refusal| refusal.status() == 400), "{wrong}");
        }
    }

    #[test]
    fn there_is_an_end_to_parameters() {
        let many: String = (0..100).map(|index| format!("p{index}=1&")).collect();
        assert!(Params::default().add_form(&many).is_err());
    }

    proptest! {
        #[test]
        fn no_text_breaks_the_readers(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            if let Ok(text) = std::str::from_utf8(&bytes) {
                let _ = Params::default().add_form(text);
            }
            let _ = Params::default().add_json(&bytes);
        }

        #[test]
        fn whatever_is_escaped_comes_back(text in "\\PC{0,40}") {
            let escaped: String = text.bytes().map(|byte| format!("%{byte:02x}")).collect();
            let query = format!("a={escaped}");
            let params = form(&query);
            prop_assert_eq!(params.get("a"), Some(text.as_str()));
        }
    }
}
