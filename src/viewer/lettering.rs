//! The fonts of names over the scene: those of pictures, so that a view and its picture look alike.

use std::sync::Arc;

use egui::{Context, FontData, FontDefinitions, FontFamily, FontId};

use sandtable_annotate::fonts::FontCut;
use sandtable_description::words::LabelKind;
use sandtable_draw::font::FontFile;

/// The cuts, with the names of their families.
const CUTS: [(FontCut, &str); 4] = [
    (FontCut::Medium, "lettering medium"),
    (FontCut::Bold, "lettering bold"),
    (FontCut::Italic, "lettering italic"),
    (FontCut::Condensed, "lettering condensed"),
];
/// The font that a scene names, for characters that the cuts lack.
const GIVEN: &str = "lettering given";

/// Makes the fonts known from the next frame on; `given` has the characters that they lack.
pub fn set_fonts(context: &Context, given: Option<&FontFile>) {
    let mut fonts = FontDefinitions::default();
    let given = given.map(|file| FontData::from_owned(file.bytes().to_vec()));
    let fallback: Vec<String> = given.iter().map(|_| GIVEN.to_owned()).collect();
    fonts.font_data.extend(given.map(|data| (GIVEN.to_owned(), Arc::new(data))));
    let panels = fonts.families.get(&FontFamily::Proportional).cloned().unwrap_or_default();
    for (cut, name) in CUTS {
        fonts.font_data.insert(name.to_owned(), Arc::new(FontData::from_static(cut.bytes())));
        let own = std::iter::once(name.to_owned());
        let all = own.chain(fallback.iter().cloned()).chain(panels.iter().cloned()).collect();
        fonts.families.insert(FontFamily::Name(name.into()), all);
    }
    // Names of features stand on panels, too.
    if let Some(panels) = fonts.families.get_mut(&FontFamily::Proportional) {
        panels.extend(fallback);
    }
    context.set_fonts(fonts);
}

/// The font of a name, its size in points.
pub fn font(kind: LabelKind) -> FontId {
    let (size, cut) = match kind {
        LabelKind::Summit | LabelKind::Place => (15.0, FontCut::Bold),
        LabelKind::Water => (14.0, FontCut::Italic),
        LabelKind::Area => (14.0, FontCut::Medium),
        LabelKind::Road => (12.5, FontCut::Condensed),
        LabelKind::Point => (12.5, FontCut::Medium),
    };
    let name = CUTS.iter().find(|(other, _)| *other == cut).map_or(CUTS[0].1, |(_, name)| name);
    FontId::new(size, FontFamily::Name(name.into()))
}
