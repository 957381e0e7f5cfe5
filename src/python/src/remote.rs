//! Hosts that elevation is read from by its address.

use std::env;

use pyo3::prelude::*;
use sandtable::{AllowedHost, RemoteAccess};

use crate::error::wrong_value;

/// Allows hosts for all that this process opens from now on. Blocks are kept in the folder of the command line's.
///
/// # Errors
/// `ValueError`: one is no host.
pub fn allow(hosts: &[String]) -> PyResult<()> {
    if hosts.is_empty() {
        return Ok(());
    }
    let hosts = hosts.iter().map(|host| AllowedHost::parse(host)).collect::<Result<_, _>>();
    let blocks = RemoteAccess::blocks_folder(|name| env::var_os(name));
    RemoteAccess { hosts: hosts.map_err(wrong_value)?, blocks }.add_to_run();
    Ok(())
}
