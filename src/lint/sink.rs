//! Collects findings, within a limit for each code.

use std::collections::BTreeMap;

use sandtable_description::finding::Finding;
use sandtable_description::finding_code::FindingCode;

/// The most findings of one code that are kept: more say nothing new, and a file may have a million features. The last one
/// that is kept states how many there are, and counts them as more of it.
const MOST_OF_A_CODE: usize = 20;

/// Findings so far.
#[derive(Debug, Default)]
pub struct FindingSink {
    list: Vec<Finding>,
    counts: BTreeMap<FindingCode, usize>,
    /// What the findings count for that are not kept.
    dropped: BTreeMap<FindingCode, usize>,
}

impl FindingSink {
    /// Adds a finding, unless its code has enough of them, which counts it, or it repeats one that is kept.
    pub fn add(&mut self, finding: Finding) {
        if self.list.contains(&finding) {
            return;
        }
        let count = self.counts.entry(finding.code).or_default();
        *count += 1;
        if *count <= MOST_OF_A_CODE {
            self.list.push(finding);
        } else {
            *self.dropped.entry(finding.code).or_default() += 1 + finding.more;
        }
    }

    /// Adds findings.
    pub fn add_all(&mut self, findings: impl IntoIterator<Item = Finding>) {
        findings.into_iter().for_each(|finding| self.add(finding));
    }

    /// Whether more findings of a code are only counted: a check may stop looking.
    pub fn is_full(&self, code: FindingCode) -> bool {
        self.counts.get(&code).is_some_and(|&count| count > MOST_OF_A_CODE)
    }

    /// The findings in the order of output.
    pub fn into_findings(mut self) -> Vec<Finding> {
        for (code, count) in self.counts {
            let last = self.list.iter_mut().rev().find(|finding| finding.code == code);
            if let (Some(last), Some(more @ 1..)) = (last, count.checked_sub(MOST_OF_A_CODE)) {
                last.message += &format!(" (and {more} more findings of this code)");
                last.more += self.dropped.get(&code).copied().unwrap_or_default();
            }
        }
        self.list.sort_by(Finding::order);
        self.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repetitions_are_dropped_and_more_than_enough_are_counted() {
        let mut sink = FindingSink::default();
        let finding = |number: usize| Finding::new(FindingCode::UnusedStyle, format!("m{number:03}"));
        for number in 0..MOST_OF_A_CODE {
            sink.add(finding(number));
            sink.add(finding(number));
        }
        assert!(!sink.is_full(FindingCode::UnusedStyle));
        (0..3).for_each(|more| sink.add(finding(MOST_OF_A_CODE + more)));
        assert!(sink.is_full(FindingCode::UnusedStyle) && !sink.is_full(FindingCode::UnknownKey));
        let found = sink.into_findings();
        assert_eq!(found.len(), MOST_OF_A_CODE);
        let last = found.last().expect("twenty");
        assert!(last.message.ends_with("(and 3 more findings of this code)"));
        assert_eq!(found.iter().map(|finding| 1 + finding.more).sum::<usize>(), MOST_OF_A_CODE + 3);
    }
}
