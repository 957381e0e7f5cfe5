//! `sandtable schema`: the JSON Schema of scene files, for editors.

use crate::cli::error::CliError;
use crate::cli::output::print;
use crate::description::schema::schema;

pub fn run() -> Result<(), CliError> {
    print(&format!("{:#}\n", schema()))
}
