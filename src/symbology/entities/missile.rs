//! Missiles in the air and in space: MIL-STD-2525D, appendices B and C.

use crate::entities::entity::{SymbolEntity, entity};

/// In the air.
pub(super) const AIR_MISSILES: &[SymbolEntity] = &[entity(
    110000,
    "missile",
    "cream M87,135 L87,124 L93,119 L93,65 L100,55 L107,65 L107,119 L113,124 L113,135 L100,125 Z",
)];

/// In space.
pub(super) const SPACE_MISSILES: &[SymbolEntity] = &[entity(
    110000,
    "missile",
    "cream M87,135 L87,124 L93,119 L93,65 L100,55 L107,65 L107,119 L113,124 L113,135 L100,125 Z",
)];
