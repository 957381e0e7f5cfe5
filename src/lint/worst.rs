//! The worst finding of each table: otherwise a file of ten thousand roads would repeat one message as often.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::context::LintContext;
use crate::sink::FindingSink;
use sandtable_description::finding_code::FindingCode;

/// Findings of one kind: the worst of each table is reported, and the others are counted.
#[derive(Debug, Default)]
pub struct WorstOfTables {
    tables: BTreeMap<(usize, usize), WorstOfTable>,
}

/// The worst finding of a table.
#[derive(Debug)]
struct WorstOfTable {
    /// The higher, the worse.
    badness: f64,
    message: String,
    count: usize,
}

impl WorstOfTables {
    /// Adds one about the table at `span`. `badness` is the higher, the worse; of equal ones the first stays.
    pub fn add(&mut self, span: Range<usize>, badness: f64, message: impl FnOnce() -> String) {
        let known = self.tables.get_mut(&(span.start, span.end));
        match known {
            Some(worst) => {
                worst.count += 1;
                if badness > worst.badness {
                    (worst.badness, worst.message) = (badness, message());
                }
            }
            None => {
                let worst = WorstOfTable { badness, message: message(), count: 1 };
                self.tables.insert((span.start, span.end), worst);
            }
        }
    }

    /// Adds the finding of each table, in the order of the file, with the remedy `help`; a message ends with how many others
    /// there are.
    pub fn report(self, context: &LintContext<'_>, code: FindingCode, help: &str, sink: &mut FindingSink) {
        for (span, message, others) in self.into_messages() {
            sink.add(context.finding(code, span, message).with_help(help).and_more(others));
        }
    }

    /// The span and the message of each table, in the order of the file, and how many others it has.
    fn into_messages(self) -> impl Iterator<Item = (Range<usize>, String, usize)> {
        self.tables.into_iter().map(|((start, end), WorstOfTable { message, count, .. })| {
            let others =
                if count > 1 { format!("; {} more in this table", count - 1) } else { String::new() };
            (start..end, message + &others, count - 1)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_of_each_table_is_told_and_the_others_are_counted() {
        let mut worst = WorstOfTables::default();
        for (start, badness) in [(40, 1.0), (7, 3.0), (40, 5.0), (40, 2.0)] {
            worst.add(start..start + 2, badness, || format!("{badness} m"));
        }
        let told: Vec<_> = worst.into_messages().collect();
        assert_eq!(told, [(7..9, "3 m".to_owned(), 0), (40..42, "5 m; 2 more in this table".to_owned(), 2)]);
    }
}
