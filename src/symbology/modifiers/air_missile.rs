//! Sector 1 and sector 2 modifiers of missiles in the air.

use crate::entities::entity::{SymbolEntity, entity};

/// Above the icon.
pub(super) const SECTOR_1: &[SymbolEntity] = &[
    entity(1, "air", "text 30 68,97.5 A"),
    entity(2, "surface", "text 30 68,97.5 S"),
    entity(3, "subsurface", "text 30 68,82.5 S; text 30 68,112.5 U"),
    entity(4, "space", "text 30 68,82.5 S; text 30 68,112.5 P"),
    entity(5, "anti-ballistic", "text 30 68,82.5 A; text 30 68,112.5 B"),
    entity(6, "ballistic", "text 30 68,97.5 B"),
    entity(7, "cruise", "text 30 68,97.5 C"),
    entity(8, "interceptor", "text 30 68,97.5 I"),
    entity(9, "hypersonic", "text 30 68,82.5 H; text 30 68,112.5 V"),
];

/// Below it.
pub(super) const SECTOR_2: &[SymbolEntity] = &[
    entity(1, "air", "text 30 132,97.5 A"),
    entity(2, "surface", "text 30 132,97.5 S"),
    entity(3, "subsurface", "text 30 132,82.5 S; text 30 132,112.5 U"),
    entity(4, "space", "text 30 132,82.5 S; text 30 132,112.5 P"),
    entity(5, "launched", "text 30 132,97.5 L"),
    entity(6, "missile", "text 30 132,97.5 M"),
    entity(7, "patriot", "text 30 132,97.5 P"),
    entity(8, "standard missile-2 (SM-2)", "text 30 132,82.5 S; text 30 132,112.5 2"),
    entity(9, "standard missile-6 (SM-6)", "text 30 132,82.5 S; text 30 132,112.5 6"),
    entity(10, "evolved sea sparrow missile (ESSM)", "text 30 132,82.5 S; text 30 132,112.5 S"),
    entity(11, "rolling airframe missile (RAM)", "text 30 132,97.5 R"),
    entity(12, "short range", "text 30 132,82.5 S; text 30 132,112.5 R"),
    entity(13, "medium range", "text 30 132,82.5 M; text 30 132,112.5 R"),
    entity(14, "intermediate range", "text 30 132,82.5 I; text 30 132,112.5 R"),
    entity(15, "long range", "text 30 132,82.5 L; text 30 132,112.5 R"),
    entity(16, "intercontinental", "text 30 132,82.5 I; text 30 132,112.5 C"),
];
