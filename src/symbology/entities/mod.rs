//! The entities that are drawn, set by set, each with its drawing ([`crate::drawing`]).
//!
//! The drawings follow the descriptions and figures of MIL-STD-2525D, appendices B to G; parts, places and sizes of many were
//! measured from milsymbol 3.0.4 (Måns Beckman, MIT), against which `tests/pictures/symbols.rs` holds them. An entity whose
//! symbol is the frame alone has an empty drawing.

mod activity;
mod air;
mod cyberspace;
mod dismounted;
pub mod entity;
mod land_civilian;
mod land_equipment;
mod land_installation;
mod land_unit;
mod mine_warfare;
mod missile;
mod sea_surface;
mod signals;
mod space;
mod subsurface;

use crate::code::SymbolCode;
use crate::entities::entity::SymbolEntity;
use crate::fields::SymbolSet;

/// The sets that have entities.
pub const SETS: [SymbolSet; 19] = [
    SymbolSet::LandUnit,
    SymbolSet::LandCivilian,
    SymbolSet::LandEquipment,
    SymbolSet::LandInstallation,
    SymbolSet::Dismounted,
    SymbolSet::Activity,
    SymbolSet::Air,
    SymbolSet::AirMissile,
    SymbolSet::Space,
    SymbolSet::SpaceMissile,
    SymbolSet::SeaSurface,
    SymbolSet::Subsurface,
    SymbolSet::MineWarfare,
    SymbolSet::SignalsSpace,
    SymbolSet::SignalsAir,
    SymbolSet::SignalsLand,
    SymbolSet::SignalsSurface,
    SymbolSet::SignalsSubsurface,
    SymbolSet::Cyberspace,
];

/// The entities of a set that are drawn; none of a set outside [`SETS`].
pub fn entities(set: SymbolSet) -> &'static [SymbolEntity] {
    match set {
        SymbolSet::LandUnit => land_unit::LAND_UNITS,
        SymbolSet::LandEquipment => land_equipment::LAND_EQUIPMENT,
        SymbolSet::LandCivilian => land_civilian::LAND_CIVILIANS,
        SymbolSet::Dismounted => dismounted::DISMOUNTED,
        SymbolSet::LandInstallation => land_installation::LAND_INSTALLATIONS,
        SymbolSet::Activity => activity::ACTIVITIES,
        SymbolSet::Air => air::AIRCRAFT,
        SymbolSet::AirMissile => missile::AIR_MISSILES,
        SymbolSet::Space => space::SPACECRAFT,
        SymbolSet::SpaceMissile => missile::SPACE_MISSILES,
        SymbolSet::SeaSurface => sea_surface::SHIPS,
        SymbolSet::Subsurface => subsurface::SUBMARINES,
        SymbolSet::MineWarfare => mine_warfare::SEA_MINES,
        SymbolSet::SignalsSpace
        | SymbolSet::SignalsAir
        | SymbolSet::SignalsLand
        | SymbolSet::SignalsSurface
        | SymbolSet::SignalsSubsurface => signals::SIGNALS,
        SymbolSet::Cyberspace => cyberspace::CYBERSPACE,
        _ => &[],
    }
}

/// The entities that MIL-STD-2525E has under codes that mean something else in MIL-STD-2525D.
pub fn changed(set: SymbolSet) -> &'static [SymbolEntity] {
    if set == SymbolSet::Cyberspace { cyberspace::CHANGED } else { &[] }
}

/// The entity of a code, as the code's edition has it, if it is drawn.
pub fn of(code: &SymbolCode) -> Option<&'static SymbolEntity> {
    let changed = if code.version.has_changes_of_e() { changed(code.set) } else { &[] };
    changed.iter().chain(entities(code.set)).find(|entity| entity.code == code.entity)
}

/// An entity of a set, if it is drawn.
pub fn find(set: SymbolSet, code: u32) -> Option<&'static SymbolEntity> {
    entities(set).iter().find(|entity| entity.code == code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_ascend_and_have_six_digits() {
        for set in SETS {
            let codes: Vec<u32> = entities(set).iter().map(|entity| entity.code).collect();
            assert!(codes.windows(2).all(|pair| pair[0] < pair[1]), "{set:?}");
            assert!(codes.iter().all(|code| (110_000..1_000_000).contains(code)), "{set:?}");
        }
    }
}
