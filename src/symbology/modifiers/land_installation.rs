//! Sector 1 and sector 2 modifiers of land installations.

use crate::entities::entity::{SymbolEntity, entity};

/// Above the icon.
pub(super) const SECTOR_1: &[SymbolEntity] = &[
    entity(1, "biological", "text 28 100,68.5 B"),
    entity(2, "chemical", "text 28 100,68.5 C"),
    entity(3, "nuclear", "text 28 100,68.5 N"),
    entity(4, "radiological", "text 28 100,68.5 R"),
    entity(5, "decontamination", "text 28 100,68.5 D"),
    entity(6, "coal", "text 28 100,68.5 CO"),
    entity(7, "geothermal", "text 28 100,68.5 GT"),
    entity(8, "hydroelectric", "text 28 100,68.5 HY"),
    entity(9, "natural gas", "text 28 100,68.5 NG"),
    entity(10, "petroleum", "@m1-petroleum"),
    entity(11, "civilian", "text 25 100,69 CIV"),
    entity(12, "civilian telephone", "text 28 100,68.5 T"),
    entity(13, "civilian television", "text 28 100,68.5 TV"),
    entity(14, "cyberspace", "text 25 100,69 CYB"),
    entity(15, "joint network node", "text 25 100,69 JNN"),
    entity(16, "command post node", "text 25 100,69 CPN"),
];

/// Below it.
pub(super) const SECTOR_2: &[SymbolEntity] = &[
    entity(1, "biological warfare production", "text 28 100,131.5 B"),
    entity(2, "chemical warfare production", "text 28 100,131.5 C"),
    entity(3, "nuclear warfare production", "text 28 100,131.5 N"),
    entity(4, "radiological warfare production", "text 28 100,131.5 R"),
    entity(5, "atomic energy reactor", "text 28 100,131.5 A"),
    entity(6, "nuclear material production", "text 28 100,131.5 P"),
    entity(7, "nuclear material storage", "text 28 100,131.5 S"),
    entity(8, "weapons grade production", "text 25 100,132 WPN"),
    entity(9, "cyberspace", "text 25 100,132 CYB"),
    entity(
        10,
        "transportation",
        "M100,122 L100,146 M88.7,128 L111,139 M88.7,139 L111,128; circle 99.8,134 12.1",
    ),
];
