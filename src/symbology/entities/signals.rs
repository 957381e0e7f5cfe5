//! Signals intelligence of all five sets: MIL-STD-2525D.

use crate::entities::entity::{SymbolEntity, entity};

pub(super) const SIGNALS: &[SymbolEntity] = &[
    entity(110000, "signal intercept", ""),
    entity(110100, "communications", "@communications"),
    entity(110200, "jammer", "text 45 J"),
    entity(110300, "radar", "@radar"),
];
