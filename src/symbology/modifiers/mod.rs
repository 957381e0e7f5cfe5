//! The modifiers that are drawn, set by set: sector 1 above the icon, sector 2 below it.
//!
//! Tables of MIL-STD-2525D, appendices B to G.

mod activity;
mod air;
mod air_missile;
mod common;
mod cyberspace;
mod dismounted;
mod land_civilian;
mod land_equipment;
mod land_installation;
mod land_unit;
mod sea_surface;
mod signals;
mod space;
mod space_missile;
mod subsurface;

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
        (SymbolSet::Activity, 1) => activity::SECTOR_1,
        (SymbolSet::Activity, 2) => activity::SECTOR_2,
        (SymbolSet::Air, 1) => air::SECTOR_1,
        (SymbolSet::Air, 2) => air::SECTOR_2,
        (SymbolSet::AirMissile, 1) => air_missile::SECTOR_1,
        (SymbolSet::AirMissile, 2) => air_missile::SECTOR_2,
        (SymbolSet::Space, 1) => space::SECTOR_1,
        (SymbolSet::Space, 2) => space::SECTOR_2,
        (SymbolSet::SpaceMissile, 1) => space_missile::SECTOR_1,
        (SymbolSet::SpaceMissile, 2) => space_missile::SECTOR_2,
        (SymbolSet::SeaSurface, 1) => sea_surface::SECTOR_1,
        (SymbolSet::SeaSurface, 2) => sea_surface::SECTOR_2,
        (SymbolSet::Subsurface, 1) => subsurface::SECTOR_1,
        (SymbolSet::Subsurface, 2) => subsurface::SECTOR_2,
        (SymbolSet::Cyberspace, 1) => cyberspace::SECTOR_1,
        (SymbolSet::Cyberspace, 2) => cyberspace::SECTOR_2,
        (
            SymbolSet::SignalsSpace
            | SymbolSet::SignalsAir
            | SymbolSet::SignalsLand
            | SymbolSet::SignalsSurface
            | SymbolSet::SignalsSubsurface,
            sector,
        ) => {
            if sector == 1 {
                signals::SECTOR_1
            } else {
                signals::SECTOR_2
            }
        }
        _ => &[],
    }
}

/// The modifiers of sector 1 or 2 that MIL-STD-2525E has for all sets, by numbers of three digits.
pub fn common(sector: usize) -> &'static [SymbolEntity] {
    if sector == 1 { common::SECTOR_1 } else { common::SECTOR_2 }
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
    changed.iter().chain(modifiers(code.set, sector)).chain(common(sector)).find(|row| row.code == number)
}

/// Equipment whose icon stays as it is beside modifiers.
const FIXED_EQUIPMENT: [u32; 25] = [
    130_100, 170_000, 170_400, 170_600, 170_700, 170_800, 170_900, 171_100, 200_200, 200_300, 200_600,
    200_700, 200_800, 200_900, 201_100, 201_301, 201_302, 201_400, 210_100, 210_200, 210_300, 210_400,
    210_500, 230_200, 250_000,
];

/// Where the icon stands, by offset and factor, if not in the middle: equipment, and the weapons of individuals, make way for
/// modifiers.
pub(super) fn place_of_icon(code: &SymbolCode) -> Option<(Vec2, f32)> {
    let makes_way = match code.set {
        SymbolSet::LandEquipment => !FIXED_EQUIPMENT.contains(&code.entity),
        SymbolSet::Dismounted => (110_301..=110_403).contains(&code.entity),
        _ => false,
    };
    match code.modifiers.map(|number| number > 0) {
        [true, true] if makes_way => Some((Vec2::ZERO, 0.45)),
        [false, true] if makes_way => Some((Vec2::new(0.0, -10.0), 0.7)),
        [true, false] if makes_way => Some((Vec2::new(0.0, 10.0), 0.7)),
        _ => None,
    }
}
