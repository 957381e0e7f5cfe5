//! The files beside a file that its format looks for, such as a world file, a table of attributes or a coordinate system.

use std::cell::RefCell;

/// The bytes of a companion; `None` where there is none.
pub type FoundCompanion<E> = Result<Option<Vec<u8>>, E>;

/// Companions of a file, as `F` finds them by their names. One that is not there is none; a server that does not answer is an
/// error of all.
pub struct CompanionFiles<F, E> {
    find: F,
    fault: RefCell<Option<E>>,
}

impl<E, F: Fn(&str) -> FoundCompanion<E>> CompanionFiles<F, E> {
    /// The companions that `find` finds.
    pub fn found_by(find: F) -> Self {
        Self { find, fault: RefCell::new(None) }
    }

    /// The bytes of the companion called `name`; `None` where there is none.
    pub fn get(&self, name: &str) -> Option<Vec<u8>> {
        // A server that is waited for in vain is not waited for again.
        if self.fault.borrow().is_some() {
            return None;
        }
        (self.find)(name).unwrap_or_else(|error| {
            self.fault.replace(Some(error));
            None
        })
    }

    /// Whether all companions could be looked for.
    ///
    /// # Errors
    /// The first error since the last check.
    pub fn check(&self) -> Result<(), E> {
        self.fault.take().map_or(Ok(()), Err)
    }
}
