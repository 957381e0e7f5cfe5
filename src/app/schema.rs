//! `sandtable schema`: the JSON Schema of scene files, for editors.

use crate::app::failure::CliError;
use crate::app::output;
use crate::description::schema::schema;

/// Prints the schema.
///
/// # Errors
/// Standard output cannot be written.
pub fn run() -> Result<(), CliError> {
    let text = serde_json::to_string_pretty(&schema()).map_err(CliError::input)?;
    output::print(&format!("{text}\n"))
}
