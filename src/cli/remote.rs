//! The option `--allow-remote` of all commands, and the note of what was fetched.

use std::env;
use std::ffi::OsString;

use crate::error::CliError;
use crate::limit::check_side;
use crate::output::warn;
use sandtable_remote::access::RemoteAccess;
use sandtable_remote::address::AllowedHost;
use sandtable_remote::traffic::Traffic;

/// Sets which hosts may be read from, before anything is read. `stated` are all arguments of the program.
///
/// # Errors
/// Hosts are stated both before and after the command.
pub fn set(hosts: &[AllowedHost], stated: &[OsString]) -> Result<(), CliError> {
    check_side("--allow-remote", hosts.len(), stated)?;
    if !hosts.is_empty() {
        let blocks = RemoteAccess::blocks_folder(|name| env::var_os(name));
        RemoteAccess { hosts: hosts.to_vec(), blocks }.add_to_run();
    }
    Ok(())
}

/// Prints what was fetched, if anything was.
pub fn note_traffic() {
    let Traffic { requests, bytes } = Traffic::of_run();
    if requests > 0 {
        warn(&format!("note: {requests} requests fetched {bytes} bytes"));
    }
}
