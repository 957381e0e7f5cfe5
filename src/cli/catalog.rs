//! `sandtable catalog`: the kinds of terrain analysis and their parameters, for programs that make forms of them.

use crate::error::CliError;
use crate::output::print;
use sandtable_export::features::analysis_json::catalog_json;

pub fn run() -> Result<(), CliError> {
    print(&format!("{:#}\n", catalog_json()))
}
