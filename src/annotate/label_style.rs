//! Type, color and symbols of labels by kind.

use glam::Vec2;

use crate::annotation::PictureLabel;
use crate::composer::Composer;
use crate::drawing::{Drawing, polygon};
use crate::fonts::FontCut;
use crate::halo::{Halo, worst_contrast};
use crate::sheet::{INK, PAPER, SOFT_INK, Sheet, WATER_INK};
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

/// How far halos reach around letters.
fn halo_px(sheet: &Sheet) -> f32 {
    sheet.px(2.2).max(1.5)
}

impl LabelStyle {
    pub fn new(kind: LabelKind, composer: &Composer) -> Self {
        let sheet = composer.sheet;
        let (size, cut, symbol, leader) = match kind {
            LabelKind::Summit => (20.0, FontCut::Bold, 6.0, 44.0),
            LabelKind::Place => (19.0, FontCut::Bold, 4.5, 34.0),
            LabelKind::Water => (19.0, FontCut::Italic, 3.0, 34.0),
            LabelKind::Area => (18.0, FontCut::Medium, 3.0, 34.0),
            LabelKind::Road => (16.5, FontCut::Condensed, 3.2, 26.0),
            LabelKind::Point => (16.5, FontCut::Medium, 3.2, 26.0),
        };
        let (note_cut, tracking, ink, note_ink) = match kind {
            LabelKind::Water => (FontCut::Italic, 0.06, WATER_INK, WATER_INK),
            LabelKind::Area => (FontCut::Medium, 0.1, SOFT_INK, SOFT_INK),
            _ => (FontCut::Medium, 0.0, INK, SOFT_INK),
        };
        let tracked = |style: TextStyle| TextStyle { tracking, ..style };
        Self {
            name: tracked(composer.style(size, cut)),
            note: tracked(composer.style(size * 0.8, note_cut)),
            ink,
            note_ink,
            halo: halo_px(&sheet),
            symbol: sheet.px(symbol).max(2.6),
            leader: sheet.px(leader),
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

    pub fn new(kind: LabelKind, ink: Option<Srgba>, composer: &Composer) -> Self {
        let (size, cut, tracking, usual) = match kind {
            LabelKind::Water => (17.0, FontCut::Italic, 0.08, WATER_INK),
            LabelKind::Road => (16.0, FontCut::Condensed, 0.05, INK),
            LabelKind::Area => (20.0, FontCut::Medium, 0.12, SOFT_INK),
            LabelKind::Summit | LabelKind::Place => (18.0, FontCut::Bold, 0.04, INK),
            LabelKind::Point => (16.5, FontCut::Medium, 0.04, INK),
        };
        let text = TextStyle { tracking, ..composer.style(size, cut) };
        Self { text, ink: ink.unwrap_or(usual), halo: halo_px(&composer.sheet) }
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
