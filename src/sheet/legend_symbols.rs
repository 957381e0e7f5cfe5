//! Military symbols in the legend: the frames of the sides, and each kind of unit or thing, as the picture draws them.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use sandtable_annotate::class_legend::{LegendEntry, LegendSwatch};
use sandtable_base::message::capitalized::capitalized;
use sandtable_description::words::StylePreset;
use sandtable_render::picture::Rendering;
use sandtable_scene::scene_model::SceneModel;
use sandtable_symbology::code::SymbolCode;
use sandtable_symbology::entities;
use sandtable_symbology::fields::SymbolIdentity;
use sandtable_symbology::symbol::MilitarySymbol;
use sandtable_view::camera::Camera;

/// Kinds at most, the most frequent: who reads the standard's symbols needs no table of them.
const MOST_KINDS: usize = 8;

/// The sides in the order of the legend.
const SIDES: [SymbolIdentity; 7] = [
    SymbolIdentity::Friend,
    SymbolIdentity::AssumedFriend,
    SymbolIdentity::Hostile,
    SymbolIdentity::Suspect,
    SymbolIdentity::Neutral,
    SymbolIdentity::Unknown,
    SymbolIdentity::Pending,
];

/// Numbers of the set and of the entity of a symbol.
type KindNumbers = (u8, u32);

/// The sides and kinds of the symbols whose places `picture` shows, in front of relief or hidden behind it.
pub fn symbol_entries(scene: &SceneModel, camera: &Camera, picture: &Rendering) -> Vec<LegendEntry> {
    let is_shown = |at| {
        let pixel = camera.project(at).map(|projected| projected.pixel);
        let (width, height) = (picture.pixels.width() as f32, picture.pixels.height() as f32);
        pixel.is_some_and(|at| (0.0..width).contains(&at.x) && (0.0..height).contains(&at.y))
    };
    let shown = scene.military.iter().filter(|symbol| is_shown(symbol.ground));
    entries(shown.map(|symbol| symbol.code), scene.preset == Some(StylePreset::Print))
}

fn entries(codes: impl Iterator<Item = SymbolCode>, is_print: bool) -> Vec<LegendEntry> {
    let mut sides: BTreeMap<usize, SymbolCode> = BTreeMap::new();
    let mut kinds: BTreeMap<KindNumbers, (usize, SymbolCode)> = BTreeMap::new();
    for code in codes {
        let kind = code.kind();
        let side = SIDES.iter().position(|&side| side == code.identity).unwrap_or(SIDES.len());
        sides.entry(side).or_insert(SymbolCode { entity: 0, ..kind });
        if entities::of(&kind).is_some() {
            kinds.entry((kind.set.number(), kind.entity)).or_insert((0, kind)).0 += 1;
        }
    }
    let mut kinds: Vec<(usize, SymbolCode)> = kinds.into_values().collect();
    kinds.sort_by_key(|(count, _)| Reverse(*count));
    kinds.truncate(MOST_KINDS);
    // One side needs no telling apart.
    let is_told = sides.len() > 1;
    let sides = sides.into_values().filter(|_| is_told);
    let side = |code: SymbolCode| (code.identity.name().split(',').next().unwrap_or_default(), code);
    let kind = |(_, code): (usize, SymbolCode)| entities::of(&code).map(|entity| (entity.name, code));
    let entry = |(name, code): (&str, SymbolCode)| {
        let symbol = MilitarySymbol::new(&code)?;
        let symbol = if is_print { symbol.in_black_and_white() } else { symbol };
        Some(LegendEntry { name: capitalized(name), swatch: LegendSwatch::Symbol(Box::new(symbol)) })
    };
    sides.map(side).chain(kinds.into_iter().filter_map(kind)).filter_map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(codes: &[&str]) -> Vec<String> {
        let codes = codes.iter().map(|code| SymbolCode::parse(code).expect("a code"));
        entries(codes, false).into_iter().map(|entry| entry.name).collect()
    }

    #[test]
    fn kinds_are_listed_once_and_the_most_frequent_first() {
        let (tanks, foot) = ("10031000161205000000", "10031000151211000000");
        assert_eq!(names(&[tanks, foot, foot]), ["Infantry", "Armor or mechanized"]);
        // Echelon, role and modifiers make no other kind.
        assert_eq!(names(&[foot, "10031002181211000100"]), ["Infantry"]);
        assert_eq!(names(&[]), [""; 0]);
    }

    #[test]
    fn sides_are_told_apart_where_there_are_several() {
        let said = names(&["10031000151211000000", "10061000151211000000", "10041000151211000000"]);
        assert_eq!(said, ["Friend", "Hostile", "Neutral", "Infantry"]);
    }

    #[test]
    fn no_more_kinds_are_listed_than_are_read() {
        let all = entities::entities(sandtable_symbology::fields::SymbolSet::LandUnit).iter();
        let codes: Vec<String> = all.map(|entity| format!("1003100000{:06}0000", entity.code)).collect();
        let codes: Vec<&str> = codes.iter().map(String::as_str).collect();
        assert!(codes.len() > MOST_KINDS && names(&codes).len() == MOST_KINDS);
    }
}
