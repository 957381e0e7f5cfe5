//! Counts records of a file, with the places of the first ones, for messages.

use std::fmt::{Display, Write};

/// As many places as a reader looks up by hand.
const MOST_PLACES: usize = 3;

/// How often a place is computed, however many records have the same.
const MOST_ASKED: usize = 16;

/// A count of records and the places of the first of them, such as `feature 7` or `line 12`.
#[derive(Default)]
pub(crate) struct RecordTally {
    count: usize,
    places: Vec<String>,
    /// How often a place was computed.
    asked: usize,
}

impl RecordTally {
    /// A tally of nothing.
    pub const fn new() -> Self {
        Self { count: 0, places: Vec::new(), asked: 0 }
    }

    /// Counts `count` things in one record. The place is computed for the first records only: that of a line in a
    /// large document is slow to find.
    pub fn add_many(&mut self, count: usize, place: impl Fn() -> String) {
        self.count += count;
        if count > 0 && self.places.len() <= MOST_PLACES && self.asked < MOST_ASKED {
            let place = place();
            self.asked += 1;
            if self.places.last() != Some(&place) {
                self.places.push(place);
            }
        }
    }

    /// Counts one record.
    pub fn add(&mut self, place: impl Fn() -> String) {
        self.add_many(1, place);
    }

    /// Returns `1 line of one vertex (feature 7)`: the count, `one` or `many` by it, and the first places; `None`
    /// where nothing was counted.
    pub fn text(&self, one: impl Display, many: impl Display) -> Option<String> {
        let mut text = match self.count {
            0 => return None,
            1 => format!("1 {one}"),
            count => format!("{count} {many}"),
        };
        let shown = self.places.iter().take(MOST_PLACES).map(String::as_str).collect::<Vec<_>>().join(", ");
        let more = if self.places.len() > MOST_PLACES { ", ..." } else { "" };
        if !shown.is_empty() {
            let _ = write!(text, " ({shown}{more})");
        }
        Some(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tally_names_the_first_records_and_agrees_with_its_number() {
        let mut tally = RecordTally::default();
        assert_eq!(tally.text("line", "lines"), None);
        tally.add(|| "feature 2".into());
        assert_eq!(tally.text("line", "lines").as_deref(), Some("1 line (feature 2)"));
        tally.add_many(2, || "feature 2".into());
        assert_eq!(tally.text("line", "lines").as_deref(), Some("3 lines (feature 2)"));
        for number in 3..9 {
            tally.add(|| format!("feature {number}"));
        }
        let text = tally.text("line", "lines").expect("counted");
        assert_eq!(text, "9 lines (feature 2, feature 3, feature 4, ...)");
    }
}
