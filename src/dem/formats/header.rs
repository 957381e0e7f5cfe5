//! Text headers of keys and values, as in ESRI ASCII grids, ESRI binary grids and ENVI rasters.

use glam::DVec2;

use crate::formats::text::{number, quote, unknown_nodata};
use sandtable_raster::error::DemErrorKind;

/// The keys of a header in lower case, and their values.
pub(crate) struct HeaderFields {
    format: &'static str,
    fields: Vec<(String, String)>,
}

/// What a header states of missing data.
pub(crate) struct StatedNoData {
    /// The value; `None` where none is stated, or no number.
    pub value: Option<f64>,
    /// A note for the user where it is no number.
    pub note: Option<String>,
}

impl HeaderFields {
    pub fn new(format: &'static str) -> Self {
        Self { format, fields: Vec::new() }
    }

    /// A header of `format` with a key and its value a line.
    pub fn from_lines(format: &'static str, lines: &[u8], most: usize) -> Self {
        let text = String::from_utf8_lossy(lines);
        let mut header = Self::new(format);
        for line in text.lines().take(most) {
            let mut words = line.split_ascii_whitespace();
            if let (Some(key), Some(value)) = (words.next(), words.next()) {
                header.push(key, value);
            }
        }
        header
    }

    pub fn push(&mut self, key: &str, value: &str) {
        self.fields.push((key.trim().to_ascii_lowercase(), value.trim().to_owned()));
    }

    /// The value of `key`, which is in lower case.
    pub fn get(&self, key: &str) -> Option<&str> {
        self.fields.iter().find(|(known, _)| known == key).map(|(_, value)| value.as_str())
    }

    pub fn number(&self, key: &str) -> Result<Option<f64>, DemErrorKind> {
        self.get(key).map(|text| self.parse(key, text)).transpose()
    }

    /// The number that `text`, which belongs to `key`, states.
    pub fn parse(&self, key: &str, text: &str) -> Result<f64, DemErrorKind> {
        let shown = quote(text.as_bytes());
        number(text.as_bytes())
            .ok_or_else(|| self.broken(format!("{key} in its header is '{shown}', not a number")))
    }

    /// The no-data value that the first of these keys states.
    pub fn nodata(&self, keys: &[&str]) -> StatedNoData {
        let stated = keys.iter().find_map(|key| self.get(key));
        let value = stated.and_then(|text| number(text.as_bytes()));
        let note = stated.filter(|text| value.is_none() && !text.is_empty()).map(unknown_nodata);
        StatedNoData { value, note }
    }

    pub fn first_number(&self, keys: [&str; 2]) -> Result<Option<f64>, DemErrorKind> {
        Ok(self.number(keys[0])?.or(self.number(keys[1])?))
    }

    /// The whole number from 0 on that `key` states.
    pub fn whole(&self, key: &str) -> Result<Option<u64>, DemErrorKind> {
        let Some(value) = self.number(key)? else { return Ok(None) };
        if value >= 0.0 && value.fract() == 0.0 && value <= u64::MAX as f64 {
            return Ok(Some(value as u64));
        }
        let text = quote(self.get(key).unwrap_or_default().as_bytes());
        Err(self.broken(format!("{key} in its header is '{text}', not a whole number from 0 on")))
    }

    /// The whole number that `key` must state.
    pub fn required(&self, key: &str) -> Result<u64, DemErrorKind> {
        self.whole(key)?.ok_or_else(|| self.broken(format!("its header does not state {key}")))
    }

    /// The outer south-west corner of a grid of `cell`, by Esri's keys; `None` where either axis is not stated.
    pub fn south_west(&self, cell: DVec2) -> Result<Option<DVec2>, DemErrorKind> {
        let edge = |corner: &str, center: &str, cell: f64| -> Result<Option<f64>, DemErrorKind> {
            Ok(self.number(corner)?.or(self.number(center)?.map(|center| center - cell * 0.5)))
        };
        let x = edge("xllcorner", "xllcenter", cell.x)?;
        Ok(x.zip(edge("yllcorner", "yllcenter", cell.y)?).map(DVec2::from))
    }

    pub fn broken(&self, reason: impl Into<String>) -> DemErrorKind {
        DemErrorKind::Broken { format: self.format, reason: reason.into() }
    }
}
