//! Points as text, a point a line, with or without a first line of column names.
//!
//! Semicolons separate fields, else commas, else blanks or tabs. Commas between blanks are decimal, or end a field:
//! `1,5 2,5 3` and `1, 2, 3` both hold three numbers. Empty lines and lines that start with `#` or `//` are skipped.

use glam::DVec3;

use crate::formats::text::{is_missing, number, quote};

/// Column names of x, y and z, in lower case.
const NAMES: [&[&str]; 3] = [
    &["x", "lon", "long", "longitude", "lng", "easting", "east", "e", "rechtswert"],
    &["y", "lat", "latitude", "lati", "northing", "north", "n", "hochwert"],
    &["z", "elevation", "elev", "height", "h", "alt", "altitude", "ele", "hoehe"],
];

pub(crate) struct PointText<'a> {
    text: &'a str,
    /// The first line, where it holds column names.
    pub header: Option<PointLine<'a>>,
    /// The columns of x, y and z; 0, 1 and 2 without a header, `None` where the header does not name one.
    pub columns: [Option<usize>; 3],
}

#[derive(Clone, Copy)]
pub(crate) struct PointLine<'a> {
    /// Its number, from 1.
    pub number: usize,
    text: &'a str,
}

impl<'a> PointText<'a> {
    /// Reads the header of a text. A first line with a number in it is a point, or meant to be one.
    pub fn new(text: &'a str) -> Self {
        let text = text.trim_start_matches('\u{feff}');
        let header =
            lines(text).next().filter(|line| line.fields().all(|field| number(field.as_bytes()).is_none()));
        let columns = header.map_or([Some(0), Some(1), Some(2)], |header| {
            let names: Vec<String> = header.fields().map(str::to_lowercase).collect();
            NAMES.map(|known| names.iter().position(|name| known.contains(&name.as_str())))
        });
        Self { text, header, columns }
    }

    pub fn lines(&self) -> impl Iterator<Item = PointLine<'a>> {
        let header = self.header.map_or(0, |header| header.number);
        lines(self.text).filter(move |line| line.number > header)
    }
}

fn lines(text: &str) -> impl Iterator<Item = PointLine<'_>> {
    let lines = text.lines().zip(1..).map(|(line, number)| PointLine { number, text: line.trim() });
    lines.filter(|line| !(line.text.is_empty() || line.text.starts_with('#') || line.text.starts_with("//")))
}

impl<'a> PointLine<'a> {
    /// The point in three columns, with a height of NaN where the field is empty or a word for that; `None` where a field is not a number
    /// or x or y is not finite.
    pub fn point(&self, columns: [usize; 3]) -> Option<DVec3> {
        let mut found = [None; 3];
        for (index, field) in self.fields().enumerate() {
            for (column, found) in columns.iter().zip(&mut found) {
                if *column == index {
                    *found = Some(field);
                }
            }
        }
        let [x, y, z] = found;
        let z = match z? {
            field if field.is_empty() || is_missing(field.as_bytes()) => f64::NAN,
            field => number(field.as_bytes())?,
        };
        let point = DVec3::new(number(x?.as_bytes())?, number(y?.as_bytes())?, z);
        (point.x.is_finite() && point.y.is_finite()).then_some(point)
    }

    /// The line as messages repeat it.
    pub fn quote(&self) -> String {
        quote(self.text.as_bytes())
    }

    fn fields(&self) -> impl Iterator<Item = &'a str> {
        let separator = self.separator();
        self.text
            .split(move |letter: char| {
                separator.map_or(letter.is_whitespace(), |separator| letter == separator)
            })
            .map(move |field| if separator.is_none() { field.trim_end_matches(',') } else { field })
            .map(|field| field.trim().trim_matches('"'))
            .filter(move |field| separator.is_some() || !field.is_empty())
    }

    /// The separator of fields; `None` for blanks.
    fn separator(&self) -> Option<char> {
        if self.text.contains(';') {
            return Some(';');
        }
        let is_number = |word: &str| number(word.trim_end_matches(',').as_bytes()).is_some();
        let words = self.text.split_whitespace();
        let is_blank =
            !self.text.contains(',') || words.clone().nth(2).is_some() && words.take(3).all(is_number);
        if is_blank { None } else { Some(',') }
    }
}
