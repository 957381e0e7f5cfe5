//! Properties that no key names and a table reads by itself, as OpenStreetMap writes them: what they mean, and a count of
//! those that were guessed at or not understood.

use std::collections::BTreeMap;

use crate::attributes::Attributes;
use crate::meant_number::{Meaning, MeantNumber, meant};
use crate::scene_findings::SceneFindings;
use sandtable_base::message::suggest::quoted;
use sandtable_description::finding_code::FindingCode;
use sandtable_description::scalar::Scalar;

/// As many texts as a sentence holds.
const MOST_TEXTS: usize = 3;

/// What became of a property's text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TagOutcome {
    /// It holds several numbers, and the greatest was taken.
    GreatestTaken,
    /// It is not understood, and the feature is as if it had none.
    NotUnderstood,
    /// It is a number that no such thing has, and the feature is as if it had none.
    OutOfRange,
    /// It names something that is not drawn; this is drawn in its place.
    Replaced(&'static str),
}

/// The features whose text came to one outcome.
#[derive(Clone, Debug, Default)]
struct TaggedFeatures {
    count: usize,
    /// The first different texts.
    texts: Vec<String>,
}

impl TaggedFeatures {
    /// Keeps a text where it is one of the first, and one more than is told of, which says that there are more.
    fn add_text(&mut self, text: String) {
        if self.texts.len() <= MOST_TEXTS && !self.texts.contains(&text) {
            self.texts.push(text);
        }
    }
}

/// Counts of properties that were guessed at or not understood.
#[derive(Clone, Debug, Default)]
pub struct TagNotes {
    counts: BTreeMap<(&'static str, TagOutcome), TaggedFeatures>,
}

impl TagNotes {
    /// Counts a feature whose property came to an outcome.
    pub fn add(&mut self, property: &'static str, outcome: TagOutcome, value: &Scalar) {
        let features = self.counts.entry((property, outcome)).or_default();
        features.count += 1;
        let text = match value {
            Scalar::Text(text) => quoted(text.trim()),
            Scalar::Number(number) => number.to_string(),
            Scalar::Bool(value) => value.to_string(),
        };
        features.add_text(text);
    }

    /// Counts what was counted of later features as well.
    pub fn append(&mut self, later: Self) {
        for (key, TaggedFeatures { count, texts }) in later.counts {
            let features = self.counts.entry(key).or_default();
            features.count += count;
            texts.into_iter().for_each(|text| features.add_text(text));
        }
    }

    /// The number within `limits` that the first of some properties means that means one; counts what is guessed at, and
    /// what is passed over.
    pub fn number(
        &mut self,
        attributes: &Attributes,
        properties: &[&'static str],
        meaning: Meaning,
        limits: NumberLimits,
    ) -> Option<f64> {
        properties.iter().find_map(|property| {
            let value = attributes.get(property).filter(is_stated)?;
            match meant(&value, meaning) {
                Some(MeantNumber { number, is_greatest }) if limits.hold(number) => {
                    if is_greatest {
                        self.add(property, TagOutcome::GreatestTaken, &value);
                    }
                    return Some(number);
                }
                Some(_) => self.add(property, TagOutcome::OutOfRange, &value),
                None => self.add(property, TagOutcome::NotUnderstood, &value),
            }
            None
        })
    }

    /// Adds a finding for each property and outcome.
    pub fn report(&self, findings: &mut SceneFindings) {
        for ((property, outcome), TaggedFeatures { count, texts }) in &self.counts {
            let features = if *count == 1 { "1 feature has" } else { &format!("{count} features have") };
            let shown: Vec<String> = texts.iter().take(MOST_TEXTS).map(|text| format!("'{text}'")).collect();
            let more = if texts.len() > MOST_TEXTS { ", ..." } else { "" };
            let shown = format!("{}{more}", shown.join(", "));
            let (code, message) = match outcome {
                TagOutcome::GreatestTaken => (
                    FindingCode::DefaultTaken,
                    format!("{property}: {features} several numbers, {shown}; the greatest was taken"),
                ),
                TagOutcome::NotUnderstood => (
                    FindingCode::DefaultTaken,
                    format!("{property}: {features} what is not understood, {shown}; the default was taken"),
                ),
                TagOutcome::OutOfRange => (
                    FindingCode::DefaultTaken,
                    format!(
                        "{property}: {features} a number out of its range, {shown}; the default was taken"
                    ),
                ),
                TagOutcome::Replaced(word) => (
                    FindingCode::RoofReplaced,
                    format!("{property}: {features} what is not drawn, {shown}; drawn as {word}"),
                ),
            };
            findings.add(code, 0..0, message);
        }
    }
}

/// The numbers that a property may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NumberLimits {
    /// The lowest.
    pub low: f64,
    /// Whether the lowest is one of them.
    pub includes_low: bool,
    /// The greatest, which is one of them.
    pub high: f64,
}

impl NumberLimits {
    /// Above 0 and up to `high`.
    pub fn above_zero(high: f64) -> Self {
        Self { low: 0.0, includes_low: false, high }
    }

    /// From 0 to `high`.
    pub fn from_zero(high: f64) -> Self {
        Self { low: 0.0, includes_low: true, high }
    }

    fn hold(&self, number: f64) -> bool {
        (number > self.low || (self.includes_low && number == self.low)) && number <= self.high
    }
}

/// Whether a property says anything.
fn is_stated(value: &Scalar) -> bool {
    !matches!(value, Scalar::Text(text) if text.trim().is_empty())
}
