//! `sandtable schema`: the JSON Schema of scene files, for editors.

use crate::error::CliError;
use crate::output::print;
use sandtable_description::schema::schema;

pub fn run() -> Result<(), CliError> {
    print(&format!("{:#}\n", schema()))
}
