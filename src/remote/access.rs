//! What a run may read by address, and where it keeps what it has read: set once, before anything is read.

use std::path::PathBuf;
use std::sync::OnceLock;

use crate::remote::address::AllowedHost;

/// The hosts that may be read from, and the folder of the blocks that are kept on disk.
#[derive(Clone, Debug, Default)]
pub struct RemoteAccess {
    /// The hosts. Default none: every address is refused.
    pub hosts: Vec<AllowedHost>,
    /// The folder of blocks on disk; `None`, the default, where none are kept.
    pub blocks: Option<PathBuf>,
}

static ACCESS: OnceLock<RemoteAccess> = OnceLock::new();

impl RemoteAccess {
    /// The access of this run: none, unless it was set.
    pub fn of_run() -> &'static Self {
        ACCESS.get_or_init(Self::default)
    }

    /// Sets the access of this run, before anything is read by its address. Returns `false` where it is set or in use already:
    /// then nothing changes.
    pub fn set_for_run(self) -> bool {
        ACCESS.set(self).is_ok()
    }

    /// Whether a host may be read from; it names its port where that is not the default.
    pub fn allows(&self, host: &str) -> bool {
        self.hosts.iter().any(|allowed| allowed.is(host))
    }
}
