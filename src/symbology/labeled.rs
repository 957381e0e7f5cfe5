//! A symbol with the text round it, from its code and its fields by their keys.

use thiserror::Error;

use crate::code::{SymbolCode, SymbolCodeError};
use crate::engagement::EngagementBar;
use crate::entities;
use crate::fields::SymbolSet;
use crate::symbol::MilitarySymbol;
use crate::texts::{SymbolNote, SymbolText, TEXT_FIELDS, placed_for};
use sandtable_base::message::suggest::{quoted, remedy};

/// A symbol with the lines of text round it.
#[derive(Clone, Debug, PartialEq)]
pub struct LabeledSymbol {
    /// Its code.
    pub code: SymbolCode,
    /// The drawing, with its engagement bar.
    pub symbol: MilitarySymbol,
    /// The lines of text.
    pub texts: Vec<SymbolNote>,
}

/// A code or fields that make no symbol.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LabeledSymbolError {
    /// The code is none.
    #[error(transparent)]
    Code(#[from] SymbolCodeError),
    /// The symbols of the set have no frames.
    #[error("the set {:02} of the symbol code, {}, has no symbols with frames: it is drawn as `[[graphic]]` of a scene", .0.number(), .0.name())]
    Frameless(SymbolSet),
    /// A field that no symbol has.
    #[error("`{}` is no field of a symbol: {}", quoted(key), remedy(key, &keys(), "use"))]
    NoField {
        /// The key.
        key: String,
    },
    /// A field that is there twice.
    #[error("the field `{key}` is there twice: leave one of them out")]
    Twice {
        /// The key.
        key: &'static str,
    },
}

fn keys() -> Vec<&'static str> {
    TEXT_FIELDS.iter().map(|row| row.key).collect()
}

impl LabeledSymbol {
    /// The symbol of a code, with fields of text by the keys of `[[symbol]]`, such as `unique_designation`, or by the letters of
    /// the standard, such as `T`.
    ///
    /// # Errors
    /// The code is none, its set has no frames, or no symbol has such a field.
    pub fn new(code: &str, fields: &[(&str, &str)]) -> Result<Self, LabeledSymbolError> {
        let code = SymbolCode::parse(code)?;
        let mut texts: Vec<(SymbolText, &str)> = Vec::new();
        for &(key, text) in fields {
            let row = TEXT_FIELDS.iter().find(|row| row.key == key || row.letter == key);
            let row = row.ok_or_else(|| LabeledSymbolError::NoField { key: key.to_owned() })?;
            if texts.iter().any(|found| found.0 == row.field) {
                return Err(LabeledSymbolError::Twice { key: row.key });
            }
            texts.push((row.field, text));
        }
        let text = |field| texts.iter().find(|row| row.0 == field).map(|row| row.1);
        let symbol = MilitarySymbol::new(&code).ok_or(LabeledSymbolError::Frameless(code.set))?;
        let lines = placed_for(&code, text);
        let symbol = match EngagementBar::of(text) {
            Some(bar) => symbol.with_engagement_bar(&code, bar, &lines),
            None => symbol,
        };
        Ok(Self { code, symbol, texts: lines })
    }

    /// What the symbol is: its identity, its set, and its entity where one is stated and drawn.
    pub fn description(&self) -> String {
        // Jokers and fakers are what follows a comma.
        let identity = self.code.identity.name().split(',').next();
        let words = [identity, Some(self.code.set.name()), self.entity()];
        words.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }

    fn entity(&self) -> Option<&'static str> {
        entities::of(&self.code).map(|entity| entity.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texts::TextPlace;

    #[test]
    fn fields_are_named_by_keys_and_by_letters() {
        let fields = [("unique_designation", "1-12"), ("M", "3 BDE"), ("engagement_bar", "A:PTRIOT")];
        let labeled = LabeledSymbol::new("10031000161211000000", &fields).expect("a symbol");
        let lines: Vec<_> = labeled.texts.iter().map(|line| (line.text.as_str(), line.place)).collect();
        assert_eq!(lines, [("1-12", TextPlace::Left(3)), ("3 BDE", TextPlace::Right(3))]);
        assert_eq!(labeled.description(), "friend, land unit, infantry");
        let bare = LabeledSymbol::new("10031000161211000000", &[]).expect("a symbol");
        assert_eq!(bare.symbol.bounds.min.y - labeled.symbol.bounds.min.y, 31.0);
    }

    #[test]
    fn wrong_fields_and_sets_are_named_with_what_to_use() {
        let error = |code, fields: &[(&str, &str)]| {
            LabeledSymbol::new(code, fields).expect_err("no symbol").to_string()
        };
        let unit = "10031000161211000000";
        let near = error(unit, &[("unique_designaton", "1")]);
        assert!(
            near.contains("`unique_designaton` is no field") && near.contains("`unique_designation`"),
            "{near}"
        );
        assert!(error(unit, &[("T", "1"), ("unique_designation", "2")]).contains("twice"));
        let frameless = error("10032500001403000000", &[]);
        assert!(frameless.starts_with("the set 25 of the symbol code, control measure"), "{frameless}");
        assert!(error("1003", &[]).contains("4 characters"));
    }
}
