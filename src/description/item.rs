//! One value of the scene file on its way from TOML to a type: what it may be, and what to say if it is not.

use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};

use toml::Spanned;
use toml::de::{DeArray, DeValue};

use crate::description::bounds::{Bounds, ELEVATION, Short};
use crate::description::diagnostic::DiagnosticSink;
use crate::description::document::{Color, RampChoice};
use crate::description::expression::{ComputedWord, Expression, ExpressionError, Quantity};
use crate::description::include::joined;
use crate::description::sketch::KeyShape;
use crate::description::suggest::{quoted, remedy};
use crate::description::words::{RampName, Word};
use crate::geom::crs::Crs;

/// The largest coordinate, in any unit: beyond it centimeters are lost to rounding.
pub(super) const MAX_COORDINATE: f64 = 1e9;
/// The most inline points of one feature; longer lines belong in a file.
const MAX_POINTS: usize = 100_000;
/// The longest text, in characters.
pub(super) const MAX_TEXT: usize = 4096;
/// The most stops of a ramp, values of a filter's list, and files of a mosaic.
pub(super) const MAX_LIST: usize = 256;

/// A value, the key it was given for, and where to say what is wrong with it.
pub(super) struct KeyValue<'a, 'i> {
    pub report: &'a mut DiagnosticSink,
    pub key: &'a str,
    pub value: &'a Spanned<DeValue<'i>>,
    /// Where to write down what is asked for, in place of reading it.
    pub asked: Option<&'a mut Option<KeyShape>>,
}

/// `name`, which is relative to `folder`, as seen from the scene file.
fn seen_from(folder: &str, name: String) -> String {
    if folder.is_empty() { name } else { joined(folder, &name) }
}

/// What a value is, in the words of messages.
pub(super) fn kind_of(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

/// The number that `value` is; `None` where it is none or is too large for what TOML can hold.
fn as_number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(whole) => {
            i64::from_str_radix(whole.as_str(), whole.radix()).ok().map(|whole| whole as f64)
        }
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    }
}

/// The words that may be written for a `W`.
fn words<W: Word>() -> Vec<&'static str> {
    W::ALL.iter().map(|(word, _)| *word).collect()
}

impl<'i> KeyValue<'_, 'i> {
    /// Writes down what is asked for; whether that is all that is wanted.
    pub(super) fn sketched(&mut self, shape: impl FnOnce() -> KeyShape) -> bool {
        match &mut self.asked {
            Some(asked) => {
                **asked = Some(shape());
                true
            }
            None => false,
        }
    }

    pub(super) fn wrong(&mut self, message: impl Into<String>, help: impl Into<String>) {
        self.report.error(self.value.span(), message, Some(help.into()));
    }

    pub(super) fn wrong_kind(&mut self, wanted: &str, help: impl Into<String>) {
        let found = kind_of(self.value.get_ref());
        self.wrong(format!("`{}` must be {wanted}, but this is {found}", self.key), help);
    }

    pub(super) fn element<'b>(&'b mut self, value: &'b Spanned<DeValue<'i>>) -> KeyValue<'b, 'i> {
        KeyValue { report: self.report, key: self.key, value, asked: None }
    }

    /// A finite number within `bounds`.
    pub fn number(mut self, bounds: Bounds) -> Option<f64> {
        if self.sketched(|| KeyShape::Number(bounds)) {
            return None;
        }
        match as_number(self.value.get_ref()) {
            Some(number) if bounds.hold(number) => Some(number),
            Some(number) => {
                let message = format!("`{}` must be {bounds}, but this is {}", self.key, Short(number));
                self.wrong(message, "give a number in that range");
                None
            }
            None => {
                self.not_a_number(&bounds.to_string());
                None
            }
        }
    }

    /// A whole number within `bounds`.
    pub fn whole(mut self, bounds: RangeInclusive<u32>) -> Option<u32> {
        if self.sketched(|| KeyShape::Whole(bounds.clone())) {
            return None;
        }
        let wanted = format!("from {} to {}", bounds.start(), bounds.end());
        match as_number(self.value.get_ref()) {
            Some(number)
                if number == number.trunc() && bounds.contains(&(number as u32)) && number >= 0.0 =>
            {
                Some(number as u32)
            }
            Some(number) => {
                let message =
                    format!("`{}` must be a whole number {wanted}, but this is {}", self.key, Short(number));
                self.wrong(message, "give a number in that range");
                None
            }
            None => {
                self.not_a_number(&wanted);
                None
            }
        }
    }

    fn not_a_number(&mut self, wanted: &str) {
        let help = match self.value.get_ref() {
            DeValue::String(text) if text.trim().parse::<f64>().is_ok() => {
                format!("write {} without quotes", text.trim())
            }
            _ => format!("give a number {wanted}"),
        };
        self.wrong_kind("a number", help);
    }

    /// A number within `bounds`, or an expression that gives one.
    pub fn quantity(mut self, bounds: Bounds) -> Option<Quantity> {
        if self.sketched(|| KeyShape::Quantity(bounds)) {
            return None;
        }
        match self.value.get_ref() {
            DeValue::String(text) if text.trim().parse::<f64>().is_err() => {
                self.expression().map(|expression| Quantity::of_features(expression, bounds))
            }
            _ => self.number(bounds).map(Quantity::fixed),
        }
    }

    /// One of `W`'s words, or an expression that gives one.
    pub fn choice<W: Word>(mut self) -> Option<ComputedWord<W>> {
        if self.sketched(|| KeyShape::Choice(words::<W>())) {
            return None;
        }
        match self.value.get_ref() {
            DeValue::String(text)
                if W::ALL.iter().all(|(word, _)| word != text) && Expression::computes(text) =>
            {
                self.expression_among(&words::<W>()).map(ComputedWord::of_features)
            }
            _ => self.word().map(ComputedWord::Fixed),
        }
    }

    /// An expression over a feature's properties.
    pub fn expression(&mut self) -> Option<Expression> {
        if self.sketched(|| KeyShape::Expression) {
            return None;
        }
        self.expression_among(&[])
    }

    /// An expression that gives one of `words`, or anything where they are none.
    fn expression_among(&mut self, words: &[&str]) -> Option<Expression> {
        let text = self.element(self.value).filled_text()?;
        match Expression::parse_among(&text, words) {
            Ok(expression) => Some(expression),
            Err(error) => {
                let (place, message) = match self.place_in_text(&text, &error) {
                    Some(place) => (place, error.message),
                    None => (self.value.span(), error.to_string()),
                };
                self.report.error(place, format!("`{}`: {message}", self.key), Some(error.help));
                None
            }
        }
    }

    /// Where in the file the error stands, where the text stands there letter by letter.
    fn place_in_text(&self, text: &str, error: &ExpressionError) -> Option<Range<usize>> {
        let span = self.value.span();
        let written = self.report.source().text().get(span.start + 1..span.end.checked_sub(1)?)?;
        let within = (error.at.start + span.start + 1)..(error.at.end + span.start + 1);
        (written == text).then_some(within)
    }

    /// The name of a file, as seen from the scene file.
    pub fn file(self) -> Option<String> {
        let folder = self.folder();
        self.filled_text().map(|name| seen_from(&folder, name))
    }

    /// The names of one or more files, as seen from the scene file; what is one of `built_in` is none.
    pub fn files(self, built_in: &[&str]) -> Option<Vec<String>> {
        let folder = self.folder();
        let seen =
            |name: String| if built_in.contains(&name.as_str()) { name } else { seen_from(&folder, name) };
        self.one_or_more_texts().map(|names| names.into_iter().map(seen).collect())
    }

    /// The names of files by words of the user's, as seen from the scene file.
    pub fn files_by_word(self) -> Option<BTreeMap<String, String>> {
        let folder = self.folder();
        let names = self.texts()?.into_iter();
        Some(names.map(|(word, name)| (word, seen_from(&folder, name))).collect())
    }

    /// The folder of the file that the value stands in, as seen from the scene file.
    fn folder(&self) -> String {
        self.report.source().folder_at(self.value.span().start).to_owned()
    }

    /// Two numbers within `bounds`, the second not less than the first.
    pub fn range(mut self, bounds: Bounds) -> Option<[f64; 2]> {
        if self.sketched(|| KeyShape::Range(bounds)) {
            return None;
        }
        let help = "write [from, to]";
        let DeValue::Array(list) = self.value.get_ref() else {
            self.wrong_kind("two numbers", help);
            return None;
        };
        let numbers: Vec<_> = list.iter().map(|number| self.element(number).number(bounds)).collect();
        match numbers[..] {
            [Some(from), Some(to)] if from <= to => Some([from, to]),
            [Some(_), Some(_)] => {
                self.wrong(format!("`{}` ends below where it begins", self.key), help);
                None
            }
            [_, _] => None,
            _ => {
                self.wrong(format!("`{}` holds {} numbers", self.key, numbers.len()), help);
                None
            }
        }
    }

    /// As many numbers as points may be, each within `bounds`.
    pub fn numbers(mut self, bounds: Bounds) -> Option<Vec<f64>> {
        if self.sketched(|| KeyShape::Numbers(bounds, MAX_POINTS)) {
            return None;
        }
        match self.value.get_ref() {
            DeValue::Array(list) if list.len() <= MAX_POINTS => {
                let numbers: Vec<_> = list.iter().map(|number| self.element(number).number(bounds)).collect();
                numbers.into_iter().collect()
            }
            _ => {
                self.wrong_kind(&format!("a list of up to {MAX_POINTS} numbers"), "write [8, 8.5, ...]");
                None
            }
        }
    }

    /// A table of texts.
    fn texts(mut self) -> Option<BTreeMap<String, String>> {
        if self.sketched(|| KeyShape::Texts(MAX_LIST)) {
            return None;
        }
        match self.value.get_ref() {
            DeValue::Table(table) if (1..=MAX_LIST).contains(&table.len()) => {
                let texts: Vec<_> = table
                    .iter()
                    .map(|(key, text)| {
                        let item =
                            KeyValue { report: self.report, key: key.get_ref(), value: text, asked: None };
                        Some((key.get_ref().to_string(), item.filled_text()?))
                    })
                    .collect();
                texts.into_iter().collect()
            }
            _ => {
                self.wrong_kind(
                    &format!("a table of 1 to {MAX_LIST} texts"),
                    "write { name = \"text\", ... }",
                );
                None
            }
        }
    }

    /// True or false.
    pub fn switch(mut self) -> Option<bool> {
        if self.sketched(|| KeyShape::Switch) {
            return None;
        }
        match self.value.get_ref() {
            DeValue::Boolean(on) => Some(*on),
            _ => {
                self.wrong_kind("true or false", "write true or false, without quotes");
                None
            }
        }
    }

    /// Text of bounded length; may be empty.
    pub fn text(mut self) -> Option<String> {
        if self.sketched(|| KeyShape::Text) {
            return None;
        }
        match self.value.get_ref() {
            DeValue::String(text) if text.chars().nth(MAX_TEXT).is_none() => Some(text.to_string()),
            DeValue::String(_) => {
                self.wrong(format!("`{}` is longer than {MAX_TEXT} characters", self.key), "shorten it");
                None
            }
            _ => {
                self.wrong_kind("text", "write it in double quotes");
                None
            }
        }
    }

    /// Text with something in it.
    pub fn filled_text(mut self) -> Option<String> {
        if self.sketched(|| KeyShape::FilledText) {
            return None;
        }
        let text = self.element(self.value).text()?;
        if text.trim().is_empty() {
            self.wrong(format!("`{}` is empty", self.key), "write something in it, or leave the key out");
            return None;
        }
        Some(text)
    }

    /// Text with something in it, or a list of such texts.
    pub fn one_or_more_texts(mut self) -> Option<Vec<String>> {
        if self.sketched(|| KeyShape::OneOrMoreTexts(MAX_LIST)) {
            return None;
        }
        match self.value.get_ref() {
            DeValue::Array(list) if (1..=MAX_LIST).contains(&list.len()) => {
                let texts: Vec<_> = list.iter().map(|text| self.element(text).filled_text()).collect();
                texts.into_iter().collect()
            }
            DeValue::Array(list) => {
                let message = format!("`{}` lists {} texts", self.key, list.len());
                self.wrong(message, format!("list from 1 to {MAX_LIST}"));
                None
            }
            _ => self.filled_text().map(|text| vec![text]),
        }
    }

    /// Text that names a coordinate reference system; `check` may refuse what it names.
    pub fn crs(mut self, check: impl FnOnce(&Crs) -> Result<(), String>) -> Option<String> {
        if self.sketched(|| KeyShape::FilledText) {
            return None;
        }
        let text = self.element(self.value).filled_text()?;
        let refused = match Crs::parse(&text).map_err(|error| error.to_string()) {
            Ok(crs) => check(&crs).err(),
            Err(error) => Some(error),
        };
        match refused {
            None => Some(text),
            Some(reason) => {
                let help = "write \"EPSG:n\", for example \"EPSG:32616\", or a proj string in meters";
                self.wrong(reason, help);
                None
            }
        }
    }

    /// One of `W`'s words.
    pub fn word<W: Word>(mut self) -> Option<W> {
        if self.sketched(|| KeyShape::Word(words::<W>())) {
            return None;
        }
        let words = words::<W>();
        let DeValue::String(text) = self.value.get_ref() else {
            self.wrong_kind("a word in quotes", remedy("", &words, "it may be"));
            return None;
        };
        let found = W::ALL.iter().find(|(word, _)| word == text);
        if found.is_none() {
            let message = format!("`{}` cannot be \"{}\"", self.key, quoted(text));
            self.wrong(message, remedy(text, &words, "it may be"));
        }
        found.map(|(_, value)| *value)
    }

    /// `#rgb`, `#rrggbb` or `#rrggbbaa`.
    pub fn color(mut self) -> Option<Color> {
        if self.sketched(|| KeyShape::Color) {
            return None;
        }
        let help = "write \"#rgb\", \"#rrggbb\" or \"#rrggbbaa\" in hexadecimal digits";
        let DeValue::String(text) = self.value.get_ref() else {
            self.wrong_kind("a color in quotes", help);
            return None;
        };
        let color = Color::parse(text);
        if color.is_none() {
            self.wrong(format!("\"{}\" is not a color", quoted(text)), help);
        }
        color
    }

    /// A coordinate pair.
    pub fn point(mut self) -> Option<[f64; 2]> {
        if self.sketched(|| KeyShape::Point) {
            return None;
        }
        let help =
            "write [easting, northing], or [longitude, latitude] in degrees; heights come from the ground";
        match self.value.get_ref() {
            DeValue::Array(pair) if pair.len() == 2 => {
                let bounds = Bounds::Within(-MAX_COORDINATE, MAX_COORDINATE);
                let east = self.element(&pair[0]).number(bounds);
                let north = self.element(&pair[1]).number(bounds);
                Some([east?, north?])
            }
            DeValue::Array(other) => {
                let message = format!("a point has two numbers, but this has {}", other.len());
                self.wrong(message, help);
                None
            }
            _ => {
                self.wrong_kind("a point", help);
                None
            }
        }
    }

    /// At least `least` coordinate pairs; a closing point that repeats the first one is not counted where
    /// `least` asks for a ring of three.
    pub fn points(mut self, least: usize) -> Option<Vec<[f64; 2]>> {
        if self.sketched(|| KeyShape::Points(least, MAX_POINTS)) {
            return None;
        }
        let help = format!("write at least {least} points as [[x1, y1], [x2, y2], ...]");
        let DeValue::Array(list) = self.value.get_ref() else {
            self.wrong_kind("a list of points", help);
            return None;
        };
        if list.len() > MAX_POINTS {
            let message = format!("{} points are more than the {MAX_POINTS} allowed here", list.len());
            self.wrong(message, "put them in a GeoJSON file and name it with `file`");
            return None;
        }
        let points: Vec<_> = list.iter().map(|point| self.element(point).point()).collect();
        let points: Vec<[f64; 2]> = points.into_iter().collect::<Option<_>>()?;
        let closed = least > 2 && points.len() > 1 && points.first() == points.last();
        let count = points.len() - usize::from(closed);
        if count < least {
            self.wrong(format!("`{}` has {count} of the {least} points it needs", self.key), help);
            return None;
        }
        Some(points)
    }

    /// A ramp's name, or its stops from low to high.
    pub fn ramp(mut self) -> Option<RampChoice> {
        if self.sketched(|| KeyShape::Ramp(words::<RampName>(), MAX_LIST)) {
            return None;
        }
        match self.value.get_ref() {
            DeValue::Array(stops) => self.stops(stops).map(RampChoice::Stops),
            _ => self.word().map(RampChoice::Named),
        }
    }

    fn stops(&mut self, list: &DeArray<'i>) -> Option<Vec<(f64, Color)>> {
        let help = "write [[height, \"#rrggbb\"], ...] with heights in meters that grow";
        if !(2..=MAX_LIST).contains(&list.len()) {
            self.wrong(format!("a ramp has from 2 to {MAX_LIST} stops, but this has {}", list.len()), help);
            return None;
        }
        let stops: Vec<_> = list.iter().map(|stop| self.element(stop).stop(help)).collect();
        let stops: Vec<(f64, Color)> = stops.into_iter().collect::<Option<_>>()?;
        if let Some(at) = stops.windows(2).position(|pair| pair[0].0 >= pair[1].0) {
            self.element(&list[at + 1]).wrong("this stop is not higher than the one before it", help);
            return None;
        }
        Some(stops)
    }

    fn stop(mut self, help: &str) -> Option<(f64, Color)> {
        match self.value.get_ref() {
            DeValue::Array(pair) if pair.len() == 2 => {
                let height = self.element(&pair[0]).number(ELEVATION);
                let color = self.element(&pair[1]).color();
                Some((height?, color?))
            }
            _ => {
                self.wrong("a stop is a height and a color", help);
                None
            }
        }
    }
}
