//! Names in the sky of a panorama, in rows over the skyline, with a line down to what each names.
//!
//! ```text
//!            Cross Mountain            Rows are as far apart as a name is high, and the same all along the picture. A name
//!  Frozen     1076 m, 9 km             takes the lowest free row over its peak that has nothing but sky, so that lines are
//!   Head            │                  short. No line passes another name.
//!     │       ╱╲____│____╱╲
//! ```

use glam::Vec2;

use crate::annotation::SkylineName;
use crate::composer::Composer;
use crate::cover::SceneCover;
use crate::drawing::Drawing;
use crate::halo::Halo;
use crate::paragraph::written_lines;
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::place::{LabelCandidate, LabelField, LabelPlacer, LabelRequest, TextAlignment};
use crate::report::{AnnotationReport, LabelOutcome, SheetBox};
use crate::sheet::{INK, SOFT_INK};
use crate::text::{TextStyle, TypesetLine};
use sandtable_draw::pixels::Pixels;

/// Lines of a name that are drawn.
const MOST_LINES: usize = 2;
/// The greatest width of a line, as a share of the picture's.
const WIDEST_SHARE: f32 = 0.25;
/// From the peak to the name at the least, and from the peak to its line, design pixels.
const LEADER_PX: f32 = 16.0;
const ABOVE_PX: f32 = 3.0;
/// From baseline to baseline, in ems of the lower line.
const LEADING: f32 = 1.14;
/// Where the line meets the name, as a share of the name's width: its middle before its ends.
const FEET: [f32; 5] = [0.5, 0.25, 0.75, 0.08, 0.92];
/// Sky around a name, pixels: as far as the squares of the cover leave open.
const SKY_PX: f32 = 7.0;
/// More names are not tried.
const MOST_NAMES: usize = 2048;

/// A name, set.
struct PreparedSkylineName<'a> {
    name: &'a SkylineName,
    /// With the starts of their baselines, from the left end of the block's first baseline.
    lines: Vec<(TypesetLine, Vec2)>,
    /// Around the lines, halo and all.
    area: PixelBox,
}

/// Draws the names that find a place in the sky of `ground`, beside `taken`, which their boxes are added to.
pub fn draw(
    names: &[SkylineName],
    (ground, cover): (&Pixels, Option<&SceneCover>),
    taken: &mut Vec<PixelBox>,
    composer: &mut Composer,
    report: &mut AnnotationReport,
) -> Drawing {
    let (sheet, mut drawing) = (composer.sheet, Drawing::default());
    let halo_px = sheet.px(2.2).max(1.5);
    let names = names.iter().take(MOST_NAMES).filter(|name| sheet.bounds().contains(name.at_px));
    let prepared: Vec<PreparedSkylineName<'_>> =
        names.filter_map(|name| PreparedSkylineName::new(name, halo_px, composer)).collect();
    let row_px = prepared.iter().map(|name| name.area.size().y).fold(0.0, f32::max) + sheet.px(4.0);
    let field = LabelField {
        bounds: sheet.bounds().grown(-(sheet.margin() * 0.4).round()),
        taken: taken.iter().map(|taken| taken.grown(sheet.px(6.0))).collect(),
        leader_gap: sheet.px(3.0),
    };
    let is_sky = |area: &PixelBox| cover.is_none_or(|cover| cover.share(&area.grown(SKY_PX)) == 0.0);
    let request = |name: &PreparedSkylineName<'_>| LabelRequest {
        candidates: name.candidates(&field, row_px, sheet.px(LEADER_PX), sheet.px(ABOVE_PX), &is_sky),
        reserved: None,
    };
    let requests: Vec<LabelRequest> = prepared.iter().map(request).collect();
    let chosen = LabelPlacer::new(&field).place(&requests);
    let placed = || {
        prepared
            .iter()
            .zip(&requests)
            .zip(&chosen)
            .filter_map(|((name, request), chosen)| Some((name, request.candidates.get((*chosen)?)?)))
    };
    let width = sheet.px(1.1).max(1.0);
    for (_, candidate) in placed() {
        if let Some(leader) = candidate.leader {
            let halo = Halo::over(ground, &candidate.text, INK, halo_px);
            drawing.line(leader, width + sheet.px(2.0).max(1.6), halo.color);
            drawing.line(leader, width, INK);
        }
    }
    for (name, candidate) in placed() {
        let faintest = if name.lines.len() > 1 { SOFT_INK } else { INK };
        name.write(candidate, Halo::over(ground, &candidate.text, faintest, halo_px), &mut drawing);
        taken.push(candidate.text);
        report.boxes.extend(SheetBox::of(&name.name.text, candidate));
    }
    for (name, chosen) in prepared.iter().zip(&chosen) {
        match chosen {
            Some(_) => LabelOutcome::Placed(None).report(&name.name.text, report),
            None if name.name.is_wanted => LabelOutcome::CrowdedOut.report(&name.name.text, report),
            None => {}
        }
    }
    report.add_texts(&drawing.texts);
    drawing
}

impl<'a> PreparedSkylineName<'a> {
    /// `None` for a name without letters.
    fn new(name: &'a SkylineName, halo_px: f32, composer: &mut Composer) -> Option<Self> {
        let widest = composer.sheet.size.x * WIDEST_SHARE;
        let styles = [(18.0, TextStyle::BOLD), (14.5, TextStyle::MEDIUM)];
        let styles = styles.map(|(size, cut)| composer.style(size, cut));
        let (written, _) = written_lines(&name.text, MOST_LINES);
        let set: Vec<TypesetLine> = written
            .iter()
            .zip(styles)
            .filter_map(|(line, style)| composer.fitted(line, style, widest))
            .collect();
        let width = set.iter().map(|line| line.advance).fold(0.0, f32::max);
        let (mut lines, mut y) = (Vec::new(), 0.0);
        for (number, line) in set.into_iter().enumerate() {
            if number > 0 {
                y += (line.style.size_px * LEADING).round();
            }
            let x = ((width - line.advance) * 0.5).round();
            lines.push((line, Vec2::new(x, y)));
        }
        let boxes = lines.iter().map(|(line, at)| line.bounds(halo_px).moved(*at));
        let area = boxes.fold(PixelBox::EMPTY, PixelBox::union);
        let is_sound = area.size().is_finite() && area.size().cmpgt(Vec2::ZERO).all();
        is_sound.then_some(Self { name, lines, area })
    }

    /// The places over its peak, from the lowest row up.
    fn candidates(
        &self,
        field: &LabelField,
        row_px: f32,
        leader_px: f32,
        above_px: f32,
        is_sky: &dyn Fn(&PixelBox) -> bool,
    ) -> Vec<LabelCandidate> {
        let peak = self.name.at_px.floor() + 0.5;
        let (size, top) = (self.area.size(), field.bounds.min.y);
        let lowest = ((peak.y - leader_px - top) / row_px).floor().max(0.0) as u32;
        let rows = (0..lowest).rev().map(|row| top + (row + 1) as f32 * row_px);
        let places = rows.flat_map(|bottom| {
            FEET.map(|foot| PixelBox::at(Vec2::new(peak.x - size.x * foot, bottom - size.y).round(), size))
        });
        let candidate = |text: PixelBox| LabelCandidate {
            text,
            letters: Vec::new(),
            symbol: None,
            leader: Some(PixelSegment { from: peak - Vec2::Y * above_px, to: Vec2::new(peak.x, text.max.y) }),
            alignment: TextAlignment::Center,
        };
        places.filter(is_sky).map(candidate).collect()
    }

    fn write(&self, candidate: &LabelCandidate, halo: Halo, drawing: &mut Drawing) {
        let by = (candidate.text.min - self.area.min).round();
        let lines: Vec<(&TypesetLine, Vec2)> = self.lines.iter().map(|(line, at)| (line, *at + by)).collect();
        drawing.draw_halo(&lines, halo);
        let inks = std::iter::once(INK).chain(std::iter::repeat(SOFT_INK));
        lines.iter().zip(inks).for_each(|((line, at), ink)| drawing.write(line, *at, ink));
        let (missing, shortened) = self.lines.iter().fold((0, false), |(missing, shortened), (line, _)| {
            (missing + line.missing, shortened || line.shortened)
        });
        drawing.record_text(&self.name.text, missing, shortened);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::color::Srgba;

    fn drawn(names: &[SkylineName], ground_below: u32) -> AnnotationReport {
        let (mut composer, mut report) = (Composer::new(1600, 400), AnnotationReport::default());
        let ground = Pixels::filled(1600, 400, Srgba::opaque(170, 200, 230));
        let cover = SceneCover::new(1600, 400, |_, y| y >= ground_below);
        draw(names, (&ground, Some(&cover)), &mut Vec::new(), &mut composer, &mut report);
        report
    }

    fn name(text: &str, x: f32, y: f32) -> SkylineName {
        SkylineName { text: text.into(), at_px: Vec2::new(x, y), is_wanted: true }
    }

    #[test]
    fn names_stand_in_the_sky_and_not_on_each_other() {
        let names: Vec<SkylineName> = (0..60)
            .map(|number| name(&format!("Peak {number}\n1234 m, 9 km"), 20.0 + 26.0 * number as f32, 210.0))
            .collect();
        let report = drawn(&names, 205);
        assert!(report.placed.len() > 12, "{:?}", report.placed.len());
        assert_eq!(report.placed.len() + report.crowded_out.len(), 60);
        for (number, area) in report.boxes.iter().enumerate() {
            assert!(area.max.y <= 205.0 && area.min.y >= 0.0, "{area:?}");
            for other in &report.boxes[number + 1..] {
                let apart = area.max.cmple(other.min).any() || other.max.cmple(area.min).any();
                assert!(apart, "{area:?} on {other:?}");
            }
        }
    }

    #[test]
    fn the_more_important_name_comes_first_and_a_peak_under_the_upper_border_has_none() {
        let report = drawn(&[name("Great", 800.0, 60.0), name("Small", 804.0, 60.0)], 50);
        assert_eq!(report.placed, ["Great"]);
        assert!(drawn(&[name("Border", 800.0, 5.0)], 2).placed.is_empty());
    }
}
