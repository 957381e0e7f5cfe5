//! Type, color and symbols of labels by kind.

use glam::Vec2;

use crate::annotation::{LineLabel, PictureLabel};
use crate::composer::Composer;
use crate::drawing::{Drawing, polygon};
use crate::fonts::FontCut;
use crate::halo::{Halo, worst_contrast};
use crate::sheet::{INK, PAPER, SOFT_INK, Sheet, WATER_INK};
use crate::shield;
use crate::text::TextStyle;
use sandtable_description::words::LabelKind;
use sandtable_draw::color::Srgba;

/// The look of a label at a place.
pub struct LabelStyle {
    pub name: TextStyle,
    pub note: TextStyle,
    pub ink: Srgba,
    pub note_ink: Srgba,
    pub halo: f32,
    /// Half the size of the symbol.
    pub symbol: f32,
    pub leader: f32,
}

/// The look of a name along a line.
#[derive(Clone, Copy, Debug)]
pub struct LineStyle {
    pub text: TextStyle,
    pub ink: Srgba,
    pub halo: f32,
}

/// The sizes of names, in design pixels: each 15 % above the one before, which the eye tells apart without a direct
/// comparison, so that no picture mixes sizes that look like mistakes.
const TYPE_SCALE: [f32; 9] = [12.5, 14.4, 16.5, 19.0, 21.9, 25.1, 28.9, 33.2, 38.2];

/// The size of numbers in shields.
const SHIELD_TYPE: f32 = 14.4;

/// The type of names of a kind: the one table of sizes, cuts, spaces and colors of labels.
struct NameType {
    /// Design pixels: sizes of [`TYPE_SCALE`].
    at_place: f32,
    along_line: f32,
    cut: FontCut,
    note_cut: FontCut,
    /// Ems between letters, at a place and along a line.
    tracking: [f32; 2],
    ink: Srgba,
    note_ink: Srgba,
    /// Half the size of the symbol, and the length of a leader line, design pixels.
    symbol: f32,
    leader: f32,
}

impl NameType {
    const fn of(kind: LabelKind) -> Self {
        let plain = Self {
            at_place: 16.5,
            along_line: 16.5,
            cut: FontCut::Medium,
            note_cut: FontCut::Medium,
            tracking: [0.0, 0.04],
            ink: INK,
            note_ink: SOFT_INK,
            symbol: 3.2,
            leader: 26.0,
        };
        let large = Self { at_place: 19.0, along_line: 19.0, cut: FontCut::Bold, leader: 34.0, ..plain };
        match kind {
            LabelKind::Summit => Self { symbol: 6.0, leader: 44.0, ..large },
            LabelKind::Place => Self { symbol: 4.5, ..large },
            LabelKind::Water => Self {
                along_line: 16.5,
                cut: FontCut::Italic,
                note_cut: FontCut::Italic,
                tracking: [0.06, 0.08],
                ink: WATER_INK,
                note_ink: WATER_INK,
                symbol: 3.0,
                ..large
            },
            LabelKind::Area => {
                Self { cut: FontCut::Medium, tracking: [0.1, 0.12], ink: SOFT_INK, symbol: 3.0, ..large }
            }
            LabelKind::Road => Self { cut: FontCut::Condensed, tracking: [0.0, 0.05], ..plain },
            LabelKind::Point => plain,
        }
    }
}

/// The size of [`TYPE_SCALE`] that is nearest to `times` the size `usual`; the smallest where `times` is no positive number.
fn on_scale(usual: f32, times: f32) -> f32 {
    let wished = usual * times;
    let steps = TYPE_SCALE.windows(2);
    let [smallest, ..] = TYPE_SCALE;
    // From the geometric mean of two sizes on, the larger is nearer.
    steps.filter(|pair| wished * wished >= pair[0] * pair[1]).fold(smallest, |_, pair| pair[1])
}

/// How far halos reach around letters.
fn halo_px(sheet: &Sheet) -> f32 {
    sheet.px(2.2).max(1.5)
}

impl LabelStyle {
    pub fn new(label: &PictureLabel, composer: &Composer) -> Self {
        let sheet = composer.sheet;
        let named = NameType::of(label.kind);
        let size = on_scale(named.at_place, label.size);
        let tracked = |style: TextStyle| TextStyle { tracking: named.tracking[0], ..style };
        Self {
            name: tracked(composer.style(size, named.cut)),
            note: tracked(composer.style(size * 0.8, named.note_cut)),
            ink: named.ink,
            note_ink: named.note_ink,
            halo: halo_px(&sheet),
            symbol: sheet.px(named.symbol).max(2.6),
            leader: sheet.px(named.leader),
        }
    }

    pub fn draw_symbol(
        &self,
        label: &PictureLabel,
        at: Vec2,
        halo: Halo,
        sheet: &Sheet,
        drawing: &mut Drawing,
    ) {
        let size = self.symbol;
        let halo = Halo { reach_px: halo.reach_px * 0.8, ..halo };
        if label.kind == LabelKind::Summit {
            let corners = [(0.0, -1.0), (0.95, 0.72), (-0.95, 0.72)];
            if let Some(triangle) = polygon(&corners.map(|(x, y)| at + Vec2::new(x, y) * size)) {
                drawing.fill_haloed(triangle, self.ink, halo);
            }
            return;
        }
        drawing.disc(at, size + halo.reach_px, halo.color);
        drawing.disc(at, size, self.ink);
        if label.kind == LabelKind::Place {
            drawing.disc(at, size - sheet.px(1.6).max(1.0), PAPER);
        }
    }
}

impl LineStyle {
    /// Numbers on contour lines of a color.
    pub fn contour(color: Srgba, composer: &Composer) -> Self {
        let text = composer.style(13.5, FontCut::Condensed);
        Self { text, ink: legible(color), halo: composer.sheet.px(2.6).max(1.6) }
    }

    pub fn new(label: &LineLabel, composer: &Composer) -> Self {
        if let Some(shield) = label.shield {
            let [_, ink] = shield::colors(shield);
            let text = composer.style(on_scale(SHIELD_TYPE, label.size), FontCut::Bold);
            return Self { text, ink, halo: 0.0 };
        }
        let named = NameType::of(label.kind);
        let size = on_scale(named.along_line, label.size);
        let text = TextStyle { tracking: named.tracking[1], ..composer.style(size, named.cut) };
        Self { text, ink: label.ink.unwrap_or(named.ink), halo: halo_px(&composer.sheet) }
    }
}

/// `color` without transparency, darkened until it can be read on paper.
fn legible(color: Srgba) -> Srgba {
    /// Darker than the least contrast needs: halos are tinted.
    const CONTRAST: f32 = 6.0;
    let [red, green, blue, _] = color.0;
    let darkened = |percent: u32| {
        let dark = |channel: u8| (u32::from(channel) * percent / 100) as u8;
        Srgba::opaque(dark(red), dark(green), dark(blue))
    };
    (0..=100)
        .rev()
        .step_by(5)
        .map(darkened)
        .find(|ink| worst_contrast(PAPER, *ink) >= CONTRAST)
        .unwrap_or(INK)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_base::message::choice::Choice;

    #[test]
    fn sizes_of_names_are_of_one_scale_whatever_is_asked_for() {
        for kind in LabelKind::CHOICES.iter().map(|choice| choice.value) {
            let named = NameType::of(kind);
            for usual in [named.at_place, named.along_line] {
                assert_eq!(on_scale(usual, 1.0), usual, "{kind:?}");
                for times in [0.5, 0.87, 1.3, 3.0, f32::NAN, f32::INFINITY, -1.0] {
                    assert!(TYPE_SCALE.contains(&on_scale(usual, times)), "{kind:?} {times}");
                }
            }
        }
        assert!(TYPE_SCALE.windows(2).all(|pair| (pair[1] / pair[0] - 1.15).abs() < 0.01));
        assert_eq!([on_scale(19.0, 1.5), on_scale(19.0, 0.87)], [28.9, 16.5]);
    }
}
