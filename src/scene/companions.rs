//! The files beside a file that a scene names, which its format looks for: a world file, a table of attributes, a coordinate
//! system.

use std::cell::RefCell;

use crate::scene::assets::{AssetError, Assets};

/// Companions of files. One that is not there is none; a server that does not answer is an error.
pub struct CompanionAssets<'a> {
    assets: &'a Assets,
    most_bytes: u64,
    fault: RefCell<Option<AssetError>>,
}

impl<'a> CompanionAssets<'a> {
    /// Those that a scene may read, each of at most `most_bytes` where it has an address.
    pub fn of(assets: &'a Assets, most_bytes: u64) -> Self {
        Self { assets, most_bytes, fault: RefCell::default() }
    }

    /// The bytes of the companion called `name`; `None` where there is none.
    pub fn get(&self, name: &str) -> Option<Vec<u8>> {
        // A server that is waited for in vain is not waited for again.
        if self.fault.borrow().is_some() {
            return None;
        }
        self.assets.read_companion(name, self.most_bytes).unwrap_or_else(|error| {
            self.fault.borrow_mut().get_or_insert(error);
            None
        })
    }

    /// Whether all that were asked for could be looked for.
    ///
    /// # Errors
    /// The first error since the last check.
    pub fn check(&self) -> Result<(), AssetError> {
        self.fault.take().map_or(Ok(()), Err)
    }
}
