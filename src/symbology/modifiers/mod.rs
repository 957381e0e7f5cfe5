//! The modifiers that are drawn, set by set: sector 1 above the icon, sector 2 below it.
//!
//! Tables of MIL-STD-2525D, appendices B to G.

mod land_unit;

use crate::code::SymbolCode;
use crate::entities::entity::SymbolEntity;
use crate::fields::SymbolSet;

/// The modifiers of a set that are drawn, of sector 1 or 2.
pub fn modifiers(set: SymbolSet, sector: usize) -> &'static [SymbolEntity] {
    match (set, sector) {
        (SymbolSet::LandUnit, 1) => land_unit::SECTOR_1,
        (SymbolSet::LandUnit, 2) => land_unit::SECTOR_2,
        _ => &[],
    }
}

/// The modifiers that MIL-STD-2525E has under numbers that mean something else in MIL-STD-2525D.
fn changed(_set: SymbolSet, _sector: usize) -> &'static [SymbolEntity] {
    &[]
}

/// The modifier of a code in sector 1 or 2, if the code has one and it is drawn.
pub fn find(code: &SymbolCode, sector: usize) -> Option<&'static SymbolEntity> {
    let number = u32::from(code.modifiers[sector - 1]);
    let changed = if code.version.has_changes_of_e() { changed(code.set, sector) } else { &[] };
    changed.iter().chain(modifiers(code.set, sector)).find(|row| row.code == number)
}
