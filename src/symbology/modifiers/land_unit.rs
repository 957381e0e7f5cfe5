//! Sector 1 and sector 2 modifiers of land units: MIL-STD-2525D, tables D-V and D-VI.

use crate::entities::entity::{SymbolEntity, entity};

/// Above the icon.
pub(super) const SECTOR_1: &[SymbolEntity] = &[
    entity(3, "attack", "text 28 100,67 A"),
    entity(6, "bridging", "M80,60.5 L86,67 L114,67 L120,60.5 M80,81 L86,75 L114,75 L120,81"),
    entity(41, "multiple rocket launcher", "M85,68 L100,53 L115,68 M85,76 L100,61 L115,76"),
    entity(54, "security", "text 25 100,67 SEC"),
    entity(98, "headquarters element", "@staff-line"),
];

/// Below it.
pub(super) const SECTOR_2: &[SymbolEntity] = &[
    entity(1, "airborne", "M75,140 A87.5,140 12.5,11 180 360 A112.5,140 12.5,11 180 360"),
    entity(15, "heavy", "text 28 100,131 H"),
    entity(19, "light", "text 28 100,131 L"),
    entity(24, "medium", "text 28 100,131 M"),
    entity(27, "mountain", "fill M87,142.5 L98,122 L103,131 L106,129.5 L114,142.5 Z"),
    entity(42, "ski", "M90,122 L111,143 M110,122 L89,143 M85.5,136.5 L94.5,145.5 M105.5,145.5 L114.5,136.5"),
    entity(51, "wheeled", "circle 75,131 7; circle 100,131 7; circle 125,131 7"),
    entity(77, "tracked", "M84,125 L116,125 A116,133 8,8 -90 90 L84,141 A84,133 8,8 90 270 Z"),
];
