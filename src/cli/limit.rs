//! The option `--limit` of all commands.

use std::ffi::OsString;

use crate::error::CliError;
use sandtable_base::limits::all;
use sandtable_base::limits::set_limit::set_limit;
use sandtable_base::limits::work_limit::LimitError;
use sandtable_base::message::suggest::{nearest, quoted};

/// The name of a limit and its new value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StatedLimit {
    pub name: String,
    pub value: u64,
}

/// Parses `NAME=VALUE`; the value is a whole number, which may end in k, M or G.
pub fn stated_limit(text: &str) -> Result<StatedLimit, String> {
    let (name, value) =
        text.split_once('=').ok_or("write the name of a limit and its value, as in raster-samples=1G")?;
    let value = count(value).ok_or("write a whole number, which may end in k, M or G, as in 20M")?;
    Ok(StatedLimit { name: name.to_owned(), value })
}

/// A whole number, or thousands (k), millions (M) or billions (G).
fn count(text: &str) -> Option<u64> {
    let scales = [('k', 1_000), ('M', 1_000_000), ('G', 1_000_000_000)];
    let scaled = scales.iter().find_map(|&(suffix, scale)| Some((text.strip_suffix(suffix)?, scale)));
    let (digits, scale) = scaled.unwrap_or((text, 1));
    let is_count = !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit());
    is_count.then(|| digits.parse::<u64>().ok()?.checked_mul(scale)).flatten()
}

/// Checks that every option called `name` among the `stated` arguments was parsed: options of all commands are parsed only on
/// one side of the command.
///
/// # Errors
/// They are stated both before and after the command.
pub fn check_side(name: &str, parsed: usize, stated: &[OsString]) -> Result<(), CliError> {
    let with_value = format!("{name}=");
    let is_option = |argument: &&OsString| {
        *argument == name || argument.as_encoded_bytes().starts_with(with_value.as_bytes())
    };
    match stated.iter().filter(is_option).count() > parsed {
        true => Err(CliError::usage(format!("state every {name} after the command"))),
        false => Ok(()),
    }
}

/// Sets the limits, before anything is read. `stated` are all arguments of the program.
///
/// # Errors
/// A name is unknown, a limit is fixed or stated twice, a value is out of range, or limits are stated both before and after
/// the command.
pub fn set(limits: &[StatedLimit], stated: &[OsString]) -> Result<(), CliError> {
    check_side("--limit", limits.len(), stated)?;
    for (index, StatedLimit { name, value }) in limits.iter().enumerate() {
        if limits[..index].iter().any(|before| before.name == *name) {
            return Err(CliError::usage(format!("--limit {} is stated twice", quoted(name))));
        }
        set_limit(name, *value).map_err(|error| CliError::usage(format!("--limit: {}", explained(error))))?;
    }
    Ok(())
}

/// The message of an error; of an unknown name with the nearest one, or all.
fn explained(error: LimitError) -> String {
    let LimitError::Unknown(name) = &error else { return error.to_string() };
    let names: Vec<String> = all().map(|limit| limit.name()).collect();
    let known = || names.iter().map(String::as_str);
    let name = quoted(name);
    match nearest(&name, known()) {
        Some(near) => format!("there is no limit `{name}`; did you mean `{near}`?"),
        None => format!("there is no limit `{name}`; there are {}", known().collect::<Vec<_>>().join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_a_whole_number_of_ones_thousands_millions_or_billions() {
        for (text, value) in [("0", 0), ("12", 12), ("20k", 20_000), ("3M", 3_000_000), ("1G", 1_000_000_000)]
        {
            let stated = stated_limit(&format!("road-pairs={text}"));
            assert_eq!(stated, Ok(StatedLimit { name: "road-pairs".into(), value }));
        }
        for text in ["", "k", "-1", "+1", "1.5", "1K", "1e6", "1 k", "99999999999G", "road=", "a=b=1"] {
            assert!(stated_limit(&format!("road-pairs={text}")).is_err(), "{text}");
        }
        assert!(stated_limit("road-pairs").is_err());
    }
}
