//! Reads one value of the scene file; checks its type and range and reports errors.

use std::collections::BTreeMap;
use std::error::Error;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeArray, DeString, DeTable, DeValue};

use crate::bounds::{Bounds, ShortNumber};
use crate::color::{Color, RampChoice};
use crate::decode_context::DecodeContext;
use crate::expression::{Expression, ExpressionError};
use crate::feature_value::{FeatureValue, FeatureWord};
use crate::finding_code::FindingCode;
use crate::include::joined;
use crate::scalar::Scalar;
use crate::stated::Stated;
use crate::table_name::TableName;
use sandtable_base::limits::INLINE_POINTS;
use sandtable_base::limits::SCENE_LIST;
use sandtable_base::limits::SCENE_TEXT;
use sandtable_base::message::choice::Choice;
use sandtable_base::message::suggest::{quoted, remedy};
use sandtable_geom::crs::Crs;
use sandtable_geom::position::Position;

/// The largest coordinate, in any unit: beyond it centimeters are lost to rounding.
pub(super) const COORDINATES: Bounds = Bounds::Within(-1e9, 1e9);

/// A value on its way from TOML to a type.
pub(super) struct KeyValue<'k, 't> {
    pub context: &'k mut DecodeContext<'t>,
    pub table: &'k TableName,
    pub key: &'k str,
    pub key_span: Range<usize>,
    pub value: &'k Spanned<DeValue<'k>>,
}

/// An expression of a key that cannot be parsed.
#[derive(Debug, thiserror::Error)]
#[error("`{key}`")]
struct KeyExpressionError {
    key: String,
    source: ExpressionError,
}

/// The name of a TOML type in messages.
pub(super) fn type_name(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "true or false",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

/// The meters of a text that is a length with its unit, such as `6 m` or `20 ft`; `None` of any other text.
fn in_meters(text: &str) -> Option<f64> {
    if text.trim().parse::<f64>().is_ok() {
        return None;
    }
    Scalar::Text(text.to_owned()).number()
}

/// `value` as a number; `None` where it is of another type or too large for TOML.
fn number_of(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(whole) => {
            i64::from_str_radix(whole.as_str(), whole.radix()).ok().map(|whole| whole as f64)
        }
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    }
}

/// The file `name` in `folder`, relative to the scene file.
fn seen_from(folder: &str, name: String) -> String {
    if folder.is_empty() { name } else { joined(folder, &name) }
}

fn words<W: Choice>() -> Vec<&'static str> {
    W::CHOICES.iter().map(|choice| choice.word).collect()
}

/// The methods that read the types of [`key`](crate::key) have the names of these types.
impl<'t> KeyValue<'_, 't> {
    /// Reports an error about the value; always `None`.
    pub fn wrong<T>(
        &mut self,
        message: impl Into<Box<dyn Error + Send + Sync>>,
        help: impl Into<String>,
    ) -> Option<T> {
        self.wrong_as(FindingCode::WrongValue, message, help)
    }

    /// As [`Self::wrong`], with a code of its own.
    pub fn wrong_as<T>(
        &mut self,
        code: FindingCode,
        message: impl Into<Box<dyn Error + Send + Sync>>,
        help: impl Into<String>,
    ) -> Option<T> {
        self.context.report.coded(code, self.value.span(), message, help);
        None
    }

    /// Reports a value of another type than `wanted`; always `None`.
    pub fn wrong_type<T>(&mut self, wanted: &str, help: impl Into<String>) -> Option<T> {
        let found = type_name(self.value.get_ref());
        let message = format!("`{}` must be {wanted}, but this is {found}", self.key);
        self.wrong_as(FindingCode::WrongType, message, help)
    }

    pub fn element<'e>(&'e mut self, value: &'e Spanned<DeValue<'e>>) -> KeyValue<'e, 't> {
        let key_span = self.key_span.clone();
        KeyValue { context: self.context, table: self.table, key: self.key, key_span, value }
    }

    /// Reads every element of a list and reports all errors; `None` where one is wrong.
    pub fn each<T>(
        &mut self,
        list: &DeArray<'_>,
        read: impl Fn(KeyValue<'_, 't>) -> Option<T>,
    ) -> Option<Vec<T>> {
        let values: Vec<_> = list.iter().map(|value| read(self.element(value))).collect();
        values.into_iter().collect()
    }

    /// As [`Self::each`], for a table whose keys the user chooses.
    pub fn each_entry<T>(
        &mut self,
        table: &DeTable<'_>,
        read: impl Fn(KeyValue<'_, 't>) -> Option<T>,
    ) -> Option<BTreeMap<String, T>> {
        let entry = |(key, value): (&Spanned<DeString<'_>>, _)| {
            let key = key.get_ref().as_ref();
            Some((key.to_owned(), read(KeyValue { key, ..self.element(value) })?))
        };
        let entries: Vec<_> = table.iter().map(entry).collect();
        entries.into_iter().collect()
    }

    pub fn number(mut self, range: Bounds) -> Option<f64> {
        match number_of(self.value.get_ref()) {
            Some(number) if range.hold(number) => Some(number),
            Some(number) => {
                let message = format!("`{}` must be {range}, but this is {}", self.key, ShortNumber(number));
                self.wrong(message, "give a number in that range")
            }
            None => self.not_a_number(&range.to_string()),
        }
    }

    pub fn integer(mut self, least: u32, most: u32) -> Option<u32> {
        let range = Bounds::Within(f64::from(least), f64::from(most));
        let wanted = format!("from {least} to {most}");
        match number_of(self.value.get_ref()) {
            Some(number) if number == number.trunc() && range.hold(number) => Some(number as u32),
            Some(number) => {
                let (key, number) = (self.key, ShortNumber(number));
                let message = format!("`{key}` must be a whole number {wanted}, but this is {number}");
                self.wrong(message, "give a number in that range")
            }
            None => self.not_a_number(&wanted),
        }
    }

    fn not_a_number<T>(&mut self, wanted: &str) -> Option<T> {
        let help = match self.value.get_ref() {
            DeValue::String(text) if text.trim().parse::<f64>().is_ok() => {
                format!("write {} without quotes", text.trim())
            }
            DeValue::String(text) => match in_meters(text) {
                Some(meters) => format!("lengths are numbers in meters: write {}", ShortNumber(meters)),
                None => format!("give a number {wanted}"),
            },
            _ => format!("give a number {wanted}"),
        };
        self.wrong_type("a number", help)
    }

    pub fn number_range(mut self, range: Bounds) -> Option<[f64; 2]> {
        let help = "write [from, to]";
        let DeValue::Array(list) = self.value.get_ref() else { return self.wrong_type("two numbers", help) };
        if list.len() != 2 {
            return self.wrong(format!("`{}` holds {} numbers", self.key, list.len()), help);
        }
        match self.each(list, |number| number.number(range))?[..] {
            [from, to] if from <= to => Some([from, to]),
            _ => self.wrong(format!("`{}` ends below where it begins", self.key), help),
        }
    }

    pub fn directions(mut self, range: Bounds) -> Option<[f64; 2]> {
        let help = "write [first, second]";
        let DeValue::Array(list) = self.value.get_ref() else { return self.wrong_type("two numbers", help) };
        match self.each(list, |number| number.number(range))?[..] {
            [first, second] => Some([first, second]),
            _ => self.wrong(format!("`{}` holds {} numbers", self.key, list.len()), help),
        }
    }

    pub fn numbers(mut self, range: Bounds) -> Option<Vec<f64>> {
        match self.value.get_ref() {
            DeValue::Array(list) if list.len() <= INLINE_POINTS.count() => {
                self.each(list, |number| number.number(range))
            }
            _ => self.wrong_type(&format!("a list of up to {INLINE_POINTS} numbers"), "write [8, 8.5, ...]"),
        }
    }

    pub fn feature_number(mut self, range: Bounds) -> Option<FeatureValue<f64>> {
        match self.value.get_ref() {
            DeValue::String(text) if in_meters(text).is_some() => self.not_a_number(&range.to_string()),
            DeValue::String(text) if text.trim().parse::<f64>().is_err() => {
                let expression = self.expression_among(&[])?;
                Some(FeatureValue::Computed { expression, limits: range, key: self.key_in_table() })
            }
            _ => self.number(range).map(FeatureValue::Fixed),
        }
    }

    pub fn feature_word<W: FeatureWord>(mut self) -> Option<FeatureValue<W>> {
        match self.value.get_ref() {
            DeValue::String(text) if W::from_word(text).is_none() && Expression::computes(text) => {
                let expression = self.expression_among(&words::<W>())?;
                Some(FeatureValue::Computed { expression, limits: (), key: self.key_in_table() })
            }
            _ => self.word().map(FeatureValue::Fixed),
        }
    }

    fn key_in_table(&self) -> String {
        format!("{} {}", self.table.title(), self.key)
    }

    pub fn expression(mut self) -> Option<Expression> {
        self.expression_among(&[])
    }

    /// An expression whose result is one of `words`; any result where `words` is empty.
    fn expression_among(&mut self, words: &[&str]) -> Option<Expression> {
        let text = self.element(self.value).filled_text()?;
        match Expression::parse_among(&text, words) {
            Ok(expression) => Some(expression),
            Err(error) => {
                let (span, column) = match self.span_in_text(&text, &error) {
                    Some(span) => (span, None),
                    None => (self.value.span(), error.column),
                };
                let (key, help) = (self.key.to_owned(), error.help.clone());
                let source = ExpressionError { column, ..error };
                self.context.report.error(span, KeyExpressionError { key, source }, help);
                None
            }
        }
    }

    /// The bytes of the scene file that an error in `text` marks; `None` where the text contains escapes.
    fn span_in_text(&self, text: &str, error: &ExpressionError) -> Option<Range<usize>> {
        let span = self.value.span();
        let written = self.context.report.source().text().get(span.start + 1..span.end.checked_sub(1)?)?;
        let within = (error.at.start + span.start + 1)..(error.at.end + span.start + 1);
        (written == text).then_some(within)
    }

    pub fn switch(mut self) -> Option<bool> {
        match self.value.get_ref() {
            DeValue::Boolean(on) => Some(*on),
            _ => self.wrong_type("true or false", "write true or false, without quotes"),
        }
    }

    pub fn text(mut self) -> Option<String> {
        match self.value.get_ref() {
            DeValue::String(text) if text.chars().nth(SCENE_TEXT.count()).is_none() => Some(text.to_string()),
            DeValue::String(_) => {
                let message = format!("`{}` is longer than {SCENE_TEXT} characters", self.key);
                self.wrong(message, format!("shorten it, or {SCENE_TEXT:#}"))
            }
            _ => self.wrong_type("text", "write it in double quotes"),
        }
    }

    pub fn filled_text(mut self) -> Option<String> {
        let text = self.element(self.value).text()?;
        if text.trim().is_empty() {
            let message = format!("`{}` is empty", self.key);
            return self.wrong(message, "write something in it, or leave the key out");
        }
        Some(text)
    }

    pub fn text_list(self) -> Option<Vec<String>> {
        self.one_or_more("texts", |text| text.filled_text())
    }

    /// A value, or a list of values, which messages call `plural`.
    pub fn one_or_more<T>(
        mut self,
        plural: &str,
        read: impl Fn(KeyValue<'_, 't>) -> Option<T>,
    ) -> Option<Vec<T>> {
        match self.value.get_ref() {
            DeValue::Array(list) if (1..=SCENE_LIST.count()).contains(&list.len()) => self.each(list, read),
            DeValue::Array(list) => {
                let message = format!("`{}` lists {} {plural}", quoted(self.key), list.len());
                self.wrong(message, format!("list from 1 to {SCENE_LIST}, or {SCENE_LIST:#}"))
            }
            _ => read(self.element(self.value)).map(|value| vec![value]),
        }
    }

    pub fn file(self) -> Option<String> {
        let folder = self.folder();
        self.filled_text().map(|name| seen_from(&folder, name))
    }

    pub fn files(self, built_in: &[&str]) -> Option<Vec<String>> {
        let folder = self.folder();
        let seen =
            |name: String| if built_in.contains(&name.as_str()) { name } else { seen_from(&folder, name) };
        self.text_list().map(|names| names.into_iter().map(seen).collect())
    }

    pub fn named_files(self) -> Option<BTreeMap<String, String>> {
        self.text_table(|name| name.file())
    }

    pub fn named_texts(self) -> Option<BTreeMap<String, String>> {
        self.text_table(|text| text.filled_text())
    }

    fn text_table(
        mut self,
        read: impl Fn(KeyValue<'_, 't>) -> Option<String>,
    ) -> Option<BTreeMap<String, String>> {
        match self.value.get_ref() {
            DeValue::Table(table) if (1..=SCENE_LIST.count()).contains(&table.len()) => {
                self.each_entry(table, read)
            }
            _ => {
                let help = format!("write {{ name = \"text\", ... }} of so many, or {SCENE_LIST:#}");
                self.wrong_type(&format!("a table of 1 to {SCENE_LIST} texts"), help)
            }
        }
    }

    /// The folder of the file that states the value, relative to the scene file.
    fn folder(&self) -> String {
        self.context.report.source().folder_at(self.value.span().start).to_owned()
    }

    pub fn crs(mut self) -> Option<Crs> {
        let text = self.element(self.value).filled_text()?;
        Crs::parse(&text).map_or_else(|error| self.wrong_as(FindingCode::CrsUnknown, error, CRS_HELP), Some)
    }

    pub fn metric_crs(mut self) -> Option<Crs> {
        let crs = self.element(self.value).crs()?;
        let (name, unit) = (crs.name(), crs.meters_per_unit());
        let found = match crs.is_geographic() {
            true => format!("{name} is in degrees"),
            false if unit != 1.0 => format!("a unit of {name} is {unit} m"),
            false => return Some(crs),
        };
        let message = format!("the scene's coordinate system must be metric, but {found}");
        self.wrong_as(FindingCode::CrsInDegrees, message, CRS_HELP)
    }

    pub fn word<W: Choice>(mut self) -> Option<W> {
        let DeValue::String(text) = self.value.get_ref() else {
            return self.wrong_type("a word in quotes", remedy("", &words::<W>(), "it may be"));
        };
        W::from_word(text).or_else(|| self.none_of(text, &words::<W>()))
    }

    /// Reports a text that is none of `words`; always `None`.
    pub fn none_of<T>(&mut self, text: &str, words: &[&str]) -> Option<T> {
        let message = format!("`{}` cannot be \"{}\"", self.key, quoted(text));
        self.wrong(message, remedy(text, words, "it may be"))
    }

    pub fn color(mut self) -> Option<Color> {
        let help = "write \"#rgb\", \"#rrggbb\" or \"#rrggbbaa\" in hexadecimal digits";
        let DeValue::String(text) = self.value.get_ref() else {
            return self.wrong_type("a color in quotes", help);
        };
        Color::parse(text).or_else(|| self.wrong(format!("\"{}\" is not a color", quoted(text)), help))
    }

    pub fn ramp(mut self) -> Option<RampChoice> {
        match self.value.get_ref() {
            DeValue::Array(stops) => self.stops(stops).map(RampChoice::Stops),
            _ => self.word().map(RampChoice::Named),
        }
    }

    fn stops(&mut self, list: &DeArray<'_>) -> Option<Vec<(f64, Color)>> {
        let help = "write [[height, \"#rrggbb\"], ...] with heights in meters that grow";
        if !(2..=SCENE_LIST.count()).contains(&list.len()) {
            let message = format!("a ramp has from 2 to {SCENE_LIST} stops, but this has {}", list.len());
            return match list.len() {
                0 | 1 => self.wrong(message, help),
                _ => self.wrong(message, format!("leave some out, or {SCENE_LIST:#}")),
            };
        }
        let stops = self.each(list, |stop| stop.stop(help))?;
        match stops.windows(2).position(|pair| pair[0].0 >= pair[1].0) {
            Some(at) => {
                self.element(&list[at + 1]).wrong("this stop is not higher than the one before it", help)
            }
            None => Some(stops),
        }
    }

    fn stop(mut self, help: &str) -> Option<(f64, Color)> {
        match self.value.get_ref() {
            DeValue::Array(pair) if pair.len() == 2 => {
                let height = self.element(&pair[0]).number(Bounds::ELEVATION);
                let color = self.element(&pair[1]).color();
                Some((height?, color?))
            }
            _ => self.wrong("a stop is a height and a color", help),
        }
    }

    pub fn point(mut self) -> Option<Position> {
        let help = "write [easting, northing], or [longitude, latitude] in degrees, or a position in quotes, such as \
                    \"16S GF 50000 18000\" or \"36.277N 84.215W\"; heights come from the ground";
        match self.value.get_ref() {
            DeValue::Array(pair) if pair.len() == 2 => {
                let pair = self.each(pair, |number| number.number(COORDINATES))?;
                Some([pair[0], pair[1]].into())
            }
            DeValue::String(text) => match Position::parse(text) {
                Ok(position)
                    if position
                        .numbers()
                        .is_some_and(|at| !at.to_array().iter().all(|&number| COORDINATES.hold(number))) =>
                {
                    self.wrong(format!("`{}` must have numbers {COORDINATES}", self.key), help)
                }
                Ok(position) => Some(position),
                Err(error) => {
                    let message = format!("`{}`: {error}", self.key);
                    self.wrong(message, error.help().unwrap_or_default())
                }
            },
            DeValue::Array(other) => {
                self.wrong(format!("a point has two numbers, but this has {}", other.len()), help)
            }
            _ => self.wrong_type("a point", help),
        }
    }

    pub fn points(self, least: usize) -> Option<Vec<Position>> {
        Some(self.places(least)?.into_iter().map(Stated::into_value).collect())
    }

    pub fn places(mut self, least: usize) -> Option<Vec<Stated<Position>>> {
        let help = format!("write at least {least} points as [[x1, y1], [x2, y2], ...]");
        let DeValue::Array(list) = self.value.get_ref() else {
            return self.wrong_type("a list of points", help);
        };
        if list.len() > INLINE_POINTS.count() {
            let message = format!("{} points are more than the {INLINE_POINTS} allowed here", list.len());
            return self.wrong(
                message,
                format!("put them in a GeoJSON file and name it with `file`, or {INLINE_POINTS:#}"),
            );
        }
        let stated = |point: KeyValue<'_, '_>| {
            let span = point.value.span();
            Some(Stated::new(point.point()?, span))
        };
        let points = self.each(list, stated)?;
        let ends = points.first().zip(points.last()).filter(|_| points.len() > 1);
        let closed = least > 2 && ends.is_some_and(|(first, last)| **first == **last);
        let count = points.len() - usize::from(closed);
        if count < least {
            return self.wrong(format!("`{}` has {count} of the {least} points it needs", self.key), help);
        }
        Some(points)
    }

    /// As [`Self::places`]; where one is enough, also a point alone.
    pub fn place_or_places(mut self, least: usize) -> Option<Vec<Stated<Position>>> {
        let is_list =
            |list: &DeArray<'_>| list.first().is_none_or(|first| number_of(first.get_ref()).is_none());
        match self.value.get_ref() {
            DeValue::Array(list) if least > 1 || is_list(list) => self.places(least),
            _ => {
                let span = self.value.span();
                let place = self.element(self.value).point()?;
                Some(vec![Stated::new(place, span)])
            }
        }
    }

    /// The names of the styles; [`Styles::read`](crate::styles::Styles::read) checks them.
    pub fn styles(self) -> Option<Vec<String>> {
        let styles = self.value.get_ref().as_table()?;
        Some(styles.keys().map(|name| name.get_ref().to_string()).collect())
    }
}

const CRS_HELP: &str = "write \"EPSG:n\", for example \"EPSG:32616\", or a proj string in meters";
