//! The names of files that stand in a folder while others are written: parts, and records of which belong together.

use std::ffi::OsStr;
use std::fmt::{self, Display, Formatter};

/// How such names begin.
const PREFIX: &str = "sandtable-";

/// `sandtable-PROCESS-NUMBER.part` or `.set`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PartName {
    /// The process that writes it.
    pub process: u32,
    /// Which of that process, from 1.
    pub number: u64,
    /// What it is.
    pub role: PartRole,
}

/// The role of such a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PartRole {
    /// A file that is being written, or an old one that is kept until all new ones are in place.
    Part,
    /// The record of a set.
    Record,
}

impl PartRole {
    fn suffix(self) -> &'static str {
        match self {
            Self::Part => ".part",
            Self::Record => ".set",
        }
    }
}

impl PartName {
    /// The name that a file has, where it is such a name as this program writes it.
    pub fn parse(name: &OsStr) -> Option<Self> {
        let name = name.to_str()?;
        let numbers = name.strip_prefix(PREFIX)?;
        let of_role = |role: PartRole| numbers.strip_suffix(role.suffix()).map(|numbers| (numbers, role));
        let (numbers, role) = [PartRole::Part, PartRole::Record].into_iter().find_map(of_role)?;
        let (process, number) = numbers.split_once('-')?;
        let parsed = Self { process: process.parse().ok()?, number: number.parse().ok()?, role };
        // Leading zeros and signs are not ours.
        (parsed.to_string() == name).then_some(parsed)
    }
}

impl Display for PartName {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        let Self { process, number, role } = self;
        write!(out, "{PREFIX}{process}-{number}{}", role.suffix())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_names_of_parts_and_records_are_taken_for_such() {
        for name in ["sandtable-1-1.part", "sandtable-4194304-77.part", "sandtable-7-2.set"] {
            let parsed = PartName::parse(OsStr::new(name)).map(|name| name.to_string());
            assert_eq!(parsed.as_deref(), Some(name));
        }
        for name in [
            "film.001.part",
            "sandtable-1.part",
            "sandtable--1.part",
            "sandtable-1-x.part",
            "sandtable-01-1.part",
            "sandtable-+1-1.set",
            "sandtable-1-1.set.part",
            "a.png",
        ] {
            assert_eq!(PartName::parse(OsStr::new(name)), None, "{name}");
        }
    }
}
