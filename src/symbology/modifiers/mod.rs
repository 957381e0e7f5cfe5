//! The modifiers that are drawn, set by set: sector 1 above the icon, sector 2 below it.
//!
//! Tables of MIL-STD-2525D, appendices B to G.

mod dismounted;
mod land_civilian;
mod land_equipment;
mod land_installation;
mod land_unit;

use glam::Vec2;

use crate::code::SymbolCode;
use crate::entities::entity::SymbolEntity;
use crate::fields::SymbolSet;

/// The modifiers of a set that are drawn, of sector 1 or 2.
pub fn modifiers(set: SymbolSet, sector: usize) -> &'static [SymbolEntity] {
    match (set, sector) {
        (SymbolSet::LandUnit, 1) => land_unit::SECTOR_1,
        (SymbolSet::LandUnit, 2) => land_unit::SECTOR_2,
        (SymbolSet::LandCivilian, 1) => land_civilian::SECTOR_1,
        (SymbolSet::LandCivilian, 2) => land_civilian::SECTOR_2,
        (SymbolSet::LandEquipment, 1) => land_equipment::SECTOR_1,
        (SymbolSet::LandEquipment, 2) => land_equipment::SECTOR_2,
        (SymbolSet::LandInstallation, 1) => land_installation::SECTOR_1,
        (SymbolSet::LandInstallation, 2) => land_installation::SECTOR_2,
        (SymbolSet::Dismounted, 1) => dismounted::SECTOR_1,
        (SymbolSet::Dismounted, 2) => dismounted::SECTOR_2,
        _ => &[],
    }
}

/// The modifiers that MIL-STD-2525E has under numbers that mean something else in MIL-STD-2525D.
pub fn changed(set: SymbolSet, sector: usize) -> &'static [SymbolEntity] {
    match (set, sector) {
        (SymbolSet::LandUnit, 1) => land_unit::CHANGED_1,
        (SymbolSet::LandUnit, 2) => land_unit::CHANGED_2,
        _ => &[],
    }
}

/// The modifier of a code in sector 1 or 2, if the code has one and it is drawn.
pub fn find(code: &SymbolCode, sector: usize) -> Option<&'static SymbolEntity> {
    let number = u32::from(code.modifiers[sector - 1]);
    let changed = if code.version.has_changes_of_e() { changed(code.set, sector) } else { &[] };
    changed.iter().chain(modifiers(code.set, sector)).find(|row| row.code == number)
}

/// Equipment whose icon stays as it is beside modifiers.
const FIXED_EQUIPMENT: [u32; 25] = [
    130_100, 170_000, 170_400, 170_600, 170_700, 170_800, 170_900, 171_100, 200_200, 200_300, 200_600,
    200_700, 200_800, 200_900, 201_100, 201_301, 201_302, 201_400, 210_100, 210_200, 210_300, 210_400,
    210_500, 230_200, 250_000,
];

/// Where the icon stands, by offset and factor: equipment, and the weapons of individuals, make way for modifiers.
pub(super) fn place_of_icon(code: &SymbolCode) -> (Vec2, f32) {
    let makes_way = match code.set {
        SymbolSet::LandEquipment => !FIXED_EQUIPMENT.contains(&code.entity),
        SymbolSet::Dismounted => (110_301..=110_403).contains(&code.entity),
        _ => false,
    };
    match code.modifiers.map(|number| number > 0) {
        [true, true] if makes_way => (Vec2::ZERO, 0.45),
        [false, true] if makes_way => (Vec2::new(0.0, -10.0), 0.7),
        [true, false] if makes_way => (Vec2::new(0.0, 10.0), 0.7),
        _ => (Vec2::ZERO, 1.0),
    }
}
