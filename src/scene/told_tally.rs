//! What cannot be drawn as it is meant, by the reason, for messages.

use std::collections::BTreeMap;

/// As many reasons as messages name; further ones are counted.
const MOST_REASONS: usize = 8;

/// How often each reason was given.
#[derive(Clone, Debug, Default)]
pub(crate) struct ToldTally {
    reasons: BTreeMap<String, usize>,
    others: usize,
}

impl ToldTally {
    /// Counts a reason.
    pub fn add(&mut self, reason: String) {
        if let Some(count) = self.reasons.get_mut(&reason) {
            *count += 1;
        } else if self.reasons.len() < MOST_REASONS {
            self.reasons.insert(reason, 1);
        } else {
            self.others += 1;
        }
    }

    /// A sentence for each reason, and one for the others.
    pub fn sentences(&self) -> Vec<String> {
        let sentence = |(reason, count): (&String, &usize)| match count {
            1 => format!("1 thing is drawn plain: {reason}"),
            count => format!("{count} things are drawn plain: {reason}"),
        };
        let others = (self.others > 0)
            .then(|| format!("{} more things are drawn plain, for other reasons", self.others));
        self.reasons.iter().map(sentence).chain(others).collect()
    }
}
