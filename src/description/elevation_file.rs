//! One of the elevation files of a scene: its name, and what is stated of it alone.

use toml::de::DeValue;

use crate::bounds::Bounds;
use crate::declaration::{KeyDeclaration, KeyKind, Presence};
use crate::key::{self, Key};
use crate::reader::TableReader;
use crate::table::Table;
use crate::value::KeyValue;

table! {
    /// An elevation file of `dem` under `[terrain]`.
    struct ElevationFile {
        /// The file, folder, virtual raster or address.
        file: String = key::file(), required;
        /// What is added to its heights, where it is counted from another zero than the others.
        offset: f64 = key::number(Bounds::ELEVATION, "m"), default 0;
    }
}

impl ElevationFile {
    /// A file of which nothing else is stated.
    pub fn named(file: String) -> Self {
        Self { file, offset: 0.0 }
    }
}

/// The name of an elevation file, a table of one, or a list of them.
pub(super) const fn elevation_files() -> Key<Vec<ElevationFile>> {
    let kind = KeyKind::FilesOrTables(<ElevationFile as Table>::KEYS);
    Key { kind, unit: "", arguments: (), read: |value, ()| value.elevation_files() }
}

impl KeyValue<'_, '_> {
    fn elevation_files(self) -> Option<Vec<ElevationFile>> {
        self.one_or_more("elevation files", |value| match value.value.get_ref() {
            DeValue::Table(_) => value.table::<ElevationFile, 0>(),
            _ => value.file().map(ElevationFile::named),
        })
    }
}
