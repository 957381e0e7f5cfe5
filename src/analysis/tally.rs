//! What the figures of an analysis are made of, so that those of parts add up to those of the whole.
//!
//! Counts and sums are whole numbers, so that their sum is the same in any order: the whole is the sum of its only part, and
//! both have the same bits.

/// Whole numbers in an order that the kind knows, such as posts of each class; empty for a kind without figures.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FigureTally(Vec<u64>);

impl FigureTally {
    /// A tally of these numbers.
    pub fn new(counts: Vec<u64>) -> Self {
        Self(counts)
    }

    /// The numbers.
    pub fn counts(&self) -> &[u64] {
        &self.0
    }

    /// The sum of both; `None` where they are of different kinds.
    pub fn plus(mut self, other: &Self) -> Option<Self> {
        if self.0.len() != other.0.len() {
            return None;
        }
        self.0.iter_mut().zip(&other.0).for_each(|(sum, count)| *sum = sum.saturating_add(*count));
        Some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tallies_of_parts_add_up_and_those_of_different_kinds_do_not() {
        let part = |counts: &[u64]| FigureTally::new(counts.to_vec());
        assert_eq!(part(&[1, 2]).plus(&part(&[10, 20])), Some(part(&[11, 22])));
        assert_eq!(part(&[u64::MAX, 0]).plus(&part(&[1, 2])), Some(part(&[u64::MAX, 2])));
        assert_eq!(part(&[1]).plus(&part(&[1, 2])), None);
    }
}
