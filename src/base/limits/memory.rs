//! Checks that memory is available before it is used, so that a lack of it is an error and not the program's end.
//!
//! An allocation that fails ends a program. So what a file or an option makes large, a raster or a picture, is asked for
//! once as a whole and given back: where the system refuses that, as under `ulimit -v`, the error says how much is needed.
//! A system that promises more than it has, as Linux does by default, refuses nothing here.

/// Memory in bytes that is left beside what is asked for: what is made of it takes small lists too, and nobody asks for those.
const BESIDE: u64 = 16 << 20;

/// Memory that is not to be had.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{what} needs about {megabytes} MB of memory, which this process cannot have; {remedy}, or let it have more"
)]
pub struct MemoryRefused {
    what: &'static str,
    megabytes: u64,
    remedy: &'static str,
}

/// Checks that `bytes` of memory and a reserve are available for `what`.
///
/// # Errors
/// They cannot; the message has `remedy`.
pub fn check_memory(bytes: u64, what: &'static str, remedy: &'static str) -> Result<(), MemoryRefused> {
    let asked = usize::try_from(bytes.saturating_add(BESIDE))
        .ok()
        .and_then(|bytes| Vec::<u8>::new().try_reserve_exact(bytes).ok());
    asked.ok_or(MemoryRefused { what, megabytes: bytes.div_ceil(1_000_000), remedy })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_machine_has_is_refused_with_its_size() {
        assert_eq!(check_memory(1 << 20, "the raster", "cut it"), Ok(()));
        let refused = check_memory(u64::MAX / 2, "the raster", "cut it").map_err(|error| error.to_string());
        let said = "the raster needs about 9223372036855 MB of memory, which this process cannot have; cut it, or let it have more";
        assert_eq!(refused, Err(said.to_owned()));
    }
}
