//! One limit: its value, and how far it may be raised.

use std::fmt::{self, Display, Formatter};
use std::sync::OnceLock;

/// A limit on input or work. Its value is read with [`WorkLimit::get`]; from then on it stays, so that one run of a program
/// knows one value.
///
/// Messages write the value by `{}`, and what to do about it by `{:#}`: ``raise it with `--limit raster-samples=…` ``, or
/// `this limit is fixed`.
#[derive(Debug)]
pub struct WorkLimit {
    constant: &'static str,
    default: u64,
    highest: Highest,
    /// What is counted.
    pub unit: &'static str,
    /// What the limit applies to, and why it is not higher.
    pub what: &'static str,
    /// The remedy for input that exceeds the limit.
    pub remedy: &'static str,
    value: OnceLock<u64>,
}

/// The extent to which a limit may be raised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Highest {
    /// Not at all: it protects the stack, or is part of a format.
    Fixed,
    /// To a value that the program's numbering and arithmetic hold.
    To(u64),
}

/// Why a limit cannot be set.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LimitError {
    /// No limit has this name.
    #[error("there is no limit `{0}`")]
    Unknown(String),
    /// It may not be set to any value.
    #[error("the limit `{0}` is fixed: it protects the stack, or is part of a format")]
    Fixed(String),
    /// It may not be set to this value.
    #[error("{value} is out of range for the limit `{name}`: it may be 1 to {highest}")]
    OutOfRange {
        /// The limit.
        name: String,
        /// What it was to be.
        value: u64,
        /// The most it may be.
        highest: u64,
    },
    /// It has another value already.
    #[error("the limit `{0}` is in use or set already: set it once, before anything is read")]
    InUse(String),
}

impl WorkLimit {
    /// The limit of a constant's name, with the unit, what is limited and the remedy.
    pub(in crate::limits) const fn new(
        constant: &'static str,
        default: u64,
        highest: Highest,
        [unit, what, remedy]: [&'static str; 3],
    ) -> Self {
        Self { constant, default, highest, unit, what, remedy, value: OnceLock::new() }
    }

    /// Its name, such as `raster-samples`.
    pub fn name(&self) -> String {
        self.constant.to_lowercase().replace('_', "-")
    }

    /// Its value where none is set.
    pub fn default_value(&self) -> u64 {
        self.default
    }

    /// Whether it cannot be set.
    pub fn is_fixed(&self) -> bool {
        self.highest == Highest::Fixed
    }

    /// The most that is allowed.
    pub fn get(&self) -> u64 {
        *self.value.get_or_init(|| self.default)
    }

    /// The most that is allowed, as the length of a list.
    pub fn count(&self) -> usize {
        usize::try_from(self.get()).unwrap_or(usize::MAX)
    }

    /// Sets the most that is allowed, once and before it is read.
    ///
    /// # Errors
    /// [`LimitError`], but for an unknown name.
    pub fn set(&self, value: u64) -> Result<(), LimitError> {
        let highest = match self.highest {
            Highest::Fixed => return Err(LimitError::Fixed(self.name())),
            Highest::To(highest) => highest,
        };
        if !(1..=highest).contains(&value) {
            return Err(LimitError::OutOfRange { name: self.name(), value, highest });
        }
        let held = *self.value.get_or_init(|| value);
        if held == value { Ok(()) } else { Err(LimitError::InUse(self.name())) }
    }
}

impl Display for WorkLimit {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        match (out.alternate(), self.highest) {
            (false, _) => self.get().fmt(out),
            (true, Highest::Fixed) => out.write_str("this limit is fixed"),
            (true, Highest::To(_)) => write!(out, "raise it with `--limit {}=…`", self.name()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limit(highest: Highest) -> WorkLimit {
        WorkLimit::new("TABLE_ROWS", 12, highest, ["rows", "of a table", "part it"])
    }

    #[test]
    fn a_limit_is_set_once_before_it_is_read() {
        let (unread, read) = (limit(Highest::To(100)), limit(Highest::To(100)));
        assert_eq!((unread.set(5), unread.get(), unread.count()), (Ok(()), 5, 5));
        assert_eq!((unread.set(5), unread.set(6)), (Ok(()), Err(LimitError::InUse("table-rows".into()))));
        assert_eq!((read.get(), read.set(5)), (12, Err(LimitError::InUse("table-rows".into()))));
    }

    #[test]
    fn a_limit_lies_in_its_range_and_a_fixed_one_stays() {
        for value in [0, 101] {
            let wrong = limit(Highest::To(100)).set(value).map_err(|error| error.to_string());
            assert_eq!(
                wrong,
                Err(format!("{value} is out of range for the limit `table-rows`: it may be 1 to 100"))
            );
        }
        assert_eq!(limit(Highest::Fixed).set(12), Err(LimitError::Fixed("table-rows".into())));
    }

    #[test]
    fn messages_have_the_value_and_how_to_raise_it() {
        assert_eq!(
            format!("{0} rows; {0:#}", limit(Highest::To(100))),
            "12 rows; raise it with `--limit table-rows=…`"
        );
        assert_eq!(format!("{:#}", limit(Highest::Fixed)), "this limit is fixed");
    }
}
