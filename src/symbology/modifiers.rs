//! Sector 1 and sector 2 modifiers of land units: MIL-STD-2525D, tables D-V and D-VI.

use crate::entities::entity::SymbolEntity;
use crate::fields::SymbolSet;

/// Above the icon.
const SECTOR_1: [SymbolEntity; 5] = [
    modifier(3, "attack", "text 28 100,67 A"),
    modifier(6, "bridging", "M80,60.5 L86,67 L114,67 L120,60.5 M80,81 L86,75 L114,75 L120,81"),
    modifier(41, "multiple rocket launcher", "M85,68 L100,53 L115,68 M85,76 L100,61 L115,76"),
    modifier(54, "security", "text 25 100,67 SEC"),
    modifier(98, "headquarters element", "@staff-line"),
];

/// Below it.
const SECTOR_2: [SymbolEntity; 8] = [
    modifier(1, "airborne", "M75,140 A87.5,140 12.5,11 180 360 A112.5,140 12.5,11 180 360"),
    modifier(15, "heavy", "text 28 100,131 H"),
    modifier(19, "light", "text 28 100,131 L"),
    modifier(24, "medium", "text 28 100,131 M"),
    modifier(27, "mountain", "fill M87,142.5 L98,122 L103,131 L106,129.5 L114,142.5 Z"),
    modifier(
        42,
        "ski",
        "M90,122 L111,143 M110,122 L89,143 M85.5,136.5 L94.5,145.5 M105.5,145.5 L114.5,136.5",
    ),
    modifier(51, "wheeled", "circle 75,131 7; circle 100,131 7; circle 125,131 7"),
    modifier(77, "tracked", "M84,125 L116,125 A116,133 8,8 -90 90 L84,141 A84,133 8,8 90 270 Z"),
];

const fn modifier(code: u32, name: &'static str, drawing: &'static str) -> SymbolEntity {
    SymbolEntity { code, name, drawing }
}

/// The modifiers of a set that are drawn, of sector 1 or 2.
pub fn modifiers(set: SymbolSet, sector: usize) -> &'static [SymbolEntity] {
    match (set, sector) {
        (SymbolSet::LandUnit, 1) => &SECTOR_1,
        (SymbolSet::LandUnit, 2) => &SECTOR_2,
        _ => &[],
    }
}
