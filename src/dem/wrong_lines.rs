//! Lines of a text of points that are no points: how many they are, and the first of them.
//!
//! A file in which a few are wrong is read without them, and they are told; where they are as many as the points, the file is
//! no text of points.

use crate::point_text::PointLine;
use sandtable_base::message::numbers::counted;

/// As many as a message quotes.
const MOST_QUOTED: usize = 3;

/// Lines that are no points.
#[derive(Default)]
pub(crate) struct WrongLines {
    count: usize,
    /// The numbers and the texts of the first ones.
    first: Vec<(usize, String)>,
}

impl WrongLines {
    pub fn add(&mut self, line: &PointLine<'_>) {
        self.count += 1;
        if self.first.len() < MOST_QUOTED {
            self.first.push((line.number, line.quote()));
        }
    }

    /// The number and the text of the first wrong line of a file of `points` points, where that is no text of points.
    pub fn refused(&self, points: usize) -> Option<(usize, String)> {
        self.first.first().filter(|_| self.count >= points).cloned()
    }

    /// A sentence that says how many were left out, and quotes the first ones; `None` where there are none.
    pub fn note(&self) -> Option<String> {
        let quoted: Vec<String> =
            self.first.iter().map(|(number, text)| format!("line {number} is '{text}'")).collect();
        let more = if self.count > self.first.len() { ", ..." } else { "" };
        let lines = counted(self.count, "line that is no point", "lines that are no points");
        (self.count > 0).then(|| format!("left out: {lines}: {}{more}", quoted.join(", ")))
    }
}
