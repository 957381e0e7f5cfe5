//! Sector 1 and sector 2 modifiers of missiles in space.

use crate::entities::entity::{SymbolEntity, entity};

/// Above the icon.
pub(super) const SECTOR_1: &[SymbolEntity] = &[
    entity(1, "ballistic", "text 30 68,97.5 B"),
    entity(2, "space", "text 30 68,82.5 S; text 30 68,112.5 P"),
    entity(3, "interceptor", "text 30 68,97.5 I"),
    entity(4, "hypersonic", "text 30 68,82.5 H; text 30 68,112.5 V"),
];

/// Below it.
pub(super) const SECTOR_2: &[SymbolEntity] = &[
    entity(1, "short range", "text 30 132,82.5 S; text 30 132,112.5 R"),
    entity(2, "medium range", "text 30 132,82.5 M; text 30 132,112.5 R"),
    entity(3, "intermediate range", "text 30 132,82.5 I; text 30 132,112.5 R"),
    entity(4, "long range", "text 30 132,82.5 L; text 30 132,112.5 R"),
    entity(5, "intercontinental", "text 30 132,82.5 I; text 30 132,112.5 C"),
    entity(6, "arrow", "text 30 132,82.5 A; text 30 132,112.5 R"),
    entity(7, "ground-based interceptor (GBI)", "text 30 132,97.5 G"),
    entity(8, "patriot", "text 30 132,97.5 P"),
    entity(9, "standard missile terminal phase (SM-T)", "text 30 132,82.5 S; text 30 132,112.5 T"),
    entity(10, "standard missile - 3 (SM-3)", "text 30 132,82.5 S; text 30 132,112.5 3"),
    entity(11, "terminal high altitude area defense (THAAD)", "text 30 132,97.5 T"),
    entity(12, "space", "text 30 132,82.5 S; text 30 132,112.5 P"),
    entity(13, "close range (CRBM)", "text 30 132,82.5 C; text 30 132,112.5 R"),
    entity(14, "debris", "text 30 132,82.5 D; text 30 132,112.5 B"),
    entity(15, "unknown", "text 30 132,97.5 U"),
];
