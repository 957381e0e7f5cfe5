//! The option `--allow-remote` of all commands, and the note of what was fetched.

use std::env;
use std::path::PathBuf;

use crate::cli::error::CliError;
use crate::cli::limit::check_side;
use crate::cli::output::warn;
use crate::remote::access::RemoteAccess;
use crate::remote::address::AllowedHost;
use crate::remote::traffic::Traffic;

/// Sets which hosts may be read from, before anything is read.
///
/// # Errors
/// Hosts are stated both before and after the command.
pub fn set(hosts: &[AllowedHost]) -> Result<(), CliError> {
    check_side("--allow-remote", hosts.len())?;
    if !hosts.is_empty() {
        let access = RemoteAccess { hosts: hosts.to_vec(), blocks: cache_folder() };
        access.set_for_run();
    }
    Ok(())
}

/// The folder for blocks of remote files: by the standard variables of the system, `None` where there are none.
fn cache_folder() -> Option<PathBuf> {
    let absolute = |name: &str| env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let system = if cfg!(windows) { "LOCALAPPDATA" } else { "XDG_CACHE_HOME" };
    let cache = absolute(system).or_else(|| Some(absolute("HOME")?.join(".cache")));
    Some(cache?.join("sandtable").join("remote"))
}

/// Prints what was fetched, if anything was.
pub fn note_traffic() {
    let Traffic { requests, bytes } = Traffic::of_run();
    if requests > 0 {
        warn(&format!("note: {requests} requests fetched {bytes} bytes"));
    }
}
