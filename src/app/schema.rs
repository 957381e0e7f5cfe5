//! `sandtable schema`: the JSON Schema of scene files, for editors.

use crate::app::failure::Failure;
use crate::app::output;
use crate::description::schema::schema;

/// Prints the schema.
///
/// # Errors
/// Standard output cannot be written.
pub fn run() -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(&schema()).map_err(Failure::input)?;
    output::print(&format!("{text}\n"))
}
