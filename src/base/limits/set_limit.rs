//! Setting a limit by its name.

use crate::limits::all;
use crate::limits::work_limit::LimitError;

/// Sets one of [the limits](crate::limits#limits-on-input-and-work), such as `raster-samples`, for the whole process, from 1
/// to what 32-bit numbers hold: once, and before any file is read. What a limit allows takes the memory and the time that
/// the page says.
///
/// # Errors
/// [`LimitError`]: the name is unknown, the limit is fixed, the value is out of range, or the limit is in use or was set to
/// another value before.
pub fn set_limit(name: &str, value: u64) -> Result<(), LimitError> {
    match all().find(|limit| limit.name() == name) {
        Some(limit) => limit.set(value),
        None => Err(LimitError::Unknown(name.to_owned())),
    }
}
