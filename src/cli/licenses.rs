//! `sandtable licenses`: the license notices of the program and its dependencies.

use crate::error::CliError;
use crate::output::print;

/// Made by `tests/tools/notices.py`.
const NOTICES: &str = include_str!("../../assets/NOTICES.txt");

pub fn run() -> Result<(), CliError> {
    print(NOTICES)
}
