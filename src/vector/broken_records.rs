//! The records of a file that cannot be read: how many, where the first ones are, and why.

use std::fmt::Display;

use crate::error::VectorError;

/// As many as a message holds.
const MOST_TEXTS: usize = 3;

/// The records that cannot be read.
#[derive(Default)]
pub(crate) struct BrokenRecords {
    count: usize,
    first: Option<VectorError>,
    /// Place and reason of the first ones.
    texts: Vec<String>,
}

impl BrokenRecords {
    /// Adds the record at `place`, unless the error knows a place of its own.
    pub fn add(&mut self, place: impl Display, error: VectorError) {
        self.count += 1;
        if self.texts.len() < MOST_TEXTS {
            self.texts.push(error.of_record(&place.to_string()));
        }
        self.first.get_or_insert(error);
    }

    /// Adds those of a later part of the file.
    pub fn append(&mut self, later: Self) {
        self.count += later.count;
        self.texts.extend(later.texts);
        self.texts.truncate(MOST_TEXTS);
        self.first = self.first.take().or(later.first);
    }

    pub fn count(&self) -> usize {
        self.count
    }

    /// Returns a sentence with the places and reasons of the first records; `None` where there are none.
    pub fn text(&self) -> Option<String> {
        let what = match self.count {
            0 => return None,
            1 => "1 record that cannot be read".to_owned(),
            count => format!("{count} records that cannot be read"),
        };
        let more = if self.count > self.texts.len() { "; ..." } else { "" };
        Some(format!("left out: {what}: {}{more}", self.texts.join("; ")))
    }

    /// Returns the error of the first record as one of the file.
    ///
    /// # Errors
    /// There is such a record.
    pub fn first_error(self) -> Result<(), VectorError> {
        self.first.map_or(Ok(()), Err)
    }
}
