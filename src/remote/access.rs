//! The hosts that a run may read from, and the folder where it keeps blocks.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::{PoisonError, RwLock};

use crate::address::AllowedHost;

/// The hosts that may be read from, and the folder of the blocks that are kept on disk.
#[derive(Clone, Debug, Default)]
pub struct RemoteAccess {
    /// The hosts. Default none: every address is refused.
    pub hosts: Vec<AllowedHost>,
    /// The folder of blocks on disk; `None`, the default, where none are kept.
    pub blocks: Option<PathBuf>,
}

static ACCESS: RwLock<RemoteAccess> = RwLock::new(RemoteAccess { hosts: Vec::new(), blocks: None });

impl RemoteAccess {
    /// The access of this run: none, until some is added.
    pub fn of_run() -> Self {
        ACCESS.read().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Adds the hosts to the access of this run, for all that is opened from now on, and the folder where it has none yet.
    pub fn add_to_run(self) {
        let mut access = ACCESS.write().unwrap_or_else(PoisonError::into_inner);
        for host in self.hosts {
            if !access.hosts.contains(&host) {
                access.hosts.push(host);
            }
        }
        access.blocks = access.blocks.take().or(self.blocks);
    }

    /// The folder for blocks by the standard variables of the system, which `variable` looks up; `None` where they name none.
    pub fn blocks_folder(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
        let absolute = |name: &str| variable(name).map(PathBuf::from).filter(|path| path.is_absolute());
        let system = if cfg!(windows) { "LOCALAPPDATA" } else { "XDG_CACHE_HOME" };
        let cache = absolute(system).or_else(|| Some(absolute("HOME")?.join(".cache")));
        Some(cache?.join("sandtable").join("remote"))
    }

    /// Whether a host may be read from; it names its port where that is not the default.
    pub fn allows(&self, host: &str) -> bool {
        self.hosts.iter().any(|allowed| allowed.is(host))
    }
}
