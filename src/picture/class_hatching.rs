//! Hatching of classes, by which they differ in black on white: lines on the ground, some pixels apart.
//!
//! Lines are as far apart as pixels are large where the ground is nearest; where it is farther, every second, fourth and so on
//! is left out, so that hatching is as dense all over the picture.

use std::f64::consts::FRAC_PI_4;

use glam::DVec2;
use rayon::prelude::*;

use crate::analysis_look::{hatch_color, is_print, printed};
use crate::graphic_lines::{GraphicPen, GraphicView, LineLook};
use sandtable_analysis::outcome::{Hatching, OutcomeRaster};
use sandtable_geom::rect::Rect;
use sandtable_scene::analyses::SceneAnalysis;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::Post;

/// The distance of lines in text heights, and the width of a line in pixels of a picture 1080 lines high.
const APART_EM: f64 = 0.8;
const WIDTH_PX: f64 = 1.1;
/// The same in black on white, which a copier keeps.
const PRINT_WIDTH_PX: f64 = 1.8;

/// How far inside the border of the land lines end, in text heights: as wide as they are, they lie on the ground.
const INSIDE_EM: f64 = 0.15;

/// The length of a dot in text heights: it is as long as wide.
const DOT_EM: f64 = 0.09;
const DOT_WIDTH_PX: f64 = 1.8;

/// More lines than a picture has rows of pixels are never seen apart.
const MOST_LINES: i64 = 4096;

/// Pieces of a line, in posts, along which its density is the same.
const PIECE_POSTS: usize = 16;

/// The directions of lines, counter-clockwise from rightward on the picture.
const DIRECTIONS: [f64; 3] = [FRAC_PI_4, -FRAC_PI_4, 0.0];

/// What is hatched: the posts of a raster by its classes.
pub(super) struct HatchedRaster<'a> {
    /// The values and their classes.
    pub raster: &'a OutcomeRaster,
    /// Whose they are.
    pub analysis: &'a SceneAnalysis,
    /// The scene that it is of.
    pub scene: &'a SceneModel,
}

impl HatchedRaster<'_> {
    /// Draws the hatching.
    pub fn draw(&self, view: &GraphicView<'_>, pen: &mut GraphicPen) {
        if self.raster.classes.iter().all(|class| class.look.hatching == Hatching::None) {
            return;
        }
        let extent = self.extent();
        let Some(em_m) = nearest_em_m(view, &extent) else { return };
        let middle = extent.center();
        let up = view.up(middle).normalize_or(DVec2::Y);
        for (number, turn) in DIRECTIONS.into_iter().enumerate() {
            let shows = |hatching: Hatching| match hatching {
                Hatching::None => false,
                Hatching::Single => number == 0,
                Hatching::Crossed => number < 2,
                Hatching::Dots | Hatching::Level => number == 2,
            };
            if !self.raster.classes.iter().any(|class| shows(class.look.hatching)) {
                continue;
            }
            let along = DVec2::from_angle(turn).rotate(up.perp() * -1.0);
            let lines = HatchLines { view, em_m, middle, along, radius_m: extent.size().length() / 2.0 };
            let count = lines.count();
            let drawn: Vec<Vec<Stretch>> =
                (-count..=count).into_par_iter().map(|line| self.stretches(line, &lines, shows)).collect();
            for Stretch { class, from, to } in drawn.into_iter().flatten() {
                self.draw_stretch(class, [from, to], view, pen);
            }
        }
    }

    /// The land in world X and Y.
    fn extent(&self) -> Rect {
        let (of_land, origin) = (self.analysis.ground.map_extent(), self.scene.lattice.origin());
        Rect { min: of_land.min - origin, max: of_land.max - origin }
    }

    fn draw_stretch(
        &self,
        class: usize,
        [from, to]: [DVec2; 2],
        view: &GraphicView<'_>,
        pen: &mut GraphicPen,
    ) {
        let look = self.raster.classes[class].look;
        let color = printed(self.scene, hatch_color(look.tint));
        let width_px = match look.hatching {
            Hatching::Dots => DOT_WIDTH_PX,
            _ if is_print(self.scene) => PRINT_WIDTH_PX,
            _ => WIDTH_PX,
        };
        view.draw_bare(
            pen,
            &[from, to],
            LineLook { color, is_dashed: false, width_px },
            self.analysis.feature,
        );
    }

    /// The stretches of a line that are hatched.
    fn stretches(&self, line: i64, lines: &HatchLines<'_>, shows: impl Fn(Hatching) -> bool) -> Vec<Stretch> {
        let start = lines.middle + lines.along.perp() * (line as f64 * lines.apart_m());
        let Some([from_m, to_m]) =
            within(&self.extent().grown(-INSIDE_EM * lines.em_m), start, lines.along, lines.radius_m)
        else {
            return Vec::new();
        };
        let step_m = self.analysis.ground.cell().min_element().max(lines.em_m * 0.25);
        let count = ((to_m - from_m) / step_m).floor() as usize;
        let at = |number: usize| start + lines.along * (from_m + number as f64 * step_m);
        let mut stretches: Vec<Stretch> = Vec::new();
        let mut open: Option<(usize, usize)> = None;
        let mut is_drawn = false;
        for number in 0..=count {
            if number % PIECE_POSTS == 0 {
                is_drawn = lines.is_drawn(line, at((number + PIECE_POSTS / 2).min(count)));
            }
            let class = self.class_at(at(number)).filter(|&class| {
                is_drawn && number < count && shows(self.raster.classes[class].look.hatching)
            });
            match (open, class) {
                (Some((own, _)), Some(class)) if own == class => {}
                (was, class) => {
                    if let Some((own, first)) = was.filter(|&(_, first)| number > first + 1) {
                        let ends = [at(first), at(number - 1)];
                        match self.raster.classes[own].look.hatching {
                            Hatching::Dots => stretches.extend(lines.dots(line, own, ends)),
                            _ => stretches.push(Stretch { class: own, from: ends[0], to: ends[1] }),
                        }
                    }
                    open = class.map(|class| (class, number));
                }
            }
        }
        stretches
    }

    /// The class of the nearest post; `None` off the land, and where it has none.
    fn class_at(&self, at: DVec2) -> Option<usize> {
        let ground = &*self.analysis.ground;
        let grid = ground.grid_from_map(at + self.scene.lattice.origin()).round();
        let last = ground.last_grid();
        if grid.cmplt(DVec2::ZERO).any() || grid.cmpgt(last).any() {
            return None;
        }
        let index = ground.index(Post::at_grid(grid));
        self.raster.class_of(self.raster.values.value(index))
    }
}

/// A hatched stretch of a line.
struct Stretch {
    class: usize,
    from: DVec2,
    to: DVec2,
}

/// Parallel lines over the land.
struct HatchLines<'a> {
    view: &'a GraphicView<'a>,
    /// The height of a text where the ground is nearest, meters.
    em_m: f64,
    /// A place on the middle line.
    middle: DVec2,
    /// Their direction, of length 1.
    along: DVec2,
    /// How far from the middle the land reaches.
    radius_m: f64,
}

impl HatchLines<'_> {
    fn apart_m(&self) -> f64 {
        self.em_m * APART_EM
    }

    /// The number of lines to each side of the middle one.
    fn count(&self) -> i64 {
        ((self.radius_m / self.apart_m()).ceil() as i64).min(MOST_LINES)
    }

    /// Whether a line is among those that are drawn at a place.
    fn is_drawn(&self, line: i64, at: DVec2) -> bool {
        let Some(em_m) = self.view.em_m(&[at]) else { return false };
        let doublings = libm::log2(em_m / self.em_m).round().clamp(0.0, 40.0);
        line.rem_euclid(1 << doublings as u32) == 0
    }

    /// Dots along a stretch; those of every second line stand between those of the others.
    fn dots(&self, line: i64, class: usize, [from, to]: [DVec2; 2]) -> Vec<Stretch> {
        let em_m = self.view.em_at(from.midpoint(to)).max(self.em_m);
        let doublings = libm::log2(em_m / self.em_m).round().clamp(0.0, 40.0);
        let apart_m = self.apart_m() * libm::pow(2.0, doublings);
        let shift = if (line >> doublings as u32).rem_euclid(2) == 0 { 0.0 } else { 0.5 };
        let station = |at: DVec2| (at - self.middle).dot(self.along) / apart_m - shift;
        let place = |number: f64| {
            from + self.along * ((number + shift) * apart_m - (from - self.middle).dot(self.along))
        };
        let half = self.along * (0.5 * DOT_EM * em_m);
        let (first, last) = (station(from).ceil(), station(to).floor());
        let count = if last >= first { (last - first) as usize + 1 } else { 0 };
        let dot = |number: usize| {
            let at = place(first + number as f64);
            Stretch { class, from: at - half, to: at + half }
        };
        (0..count.min(MOST_LINES as usize)).map(dot).collect()
    }
}

/// The stations of a line between which it is within `extent`; `None` where it passes by.
fn within(extent: &Rect, start: DVec2, along: DVec2, radius_m: f64) -> Option<[f64; 2]> {
    let (mut from, mut to) = (-2.0 * radius_m, 2.0 * radius_m);
    for axis in 0..2 {
        let (low, high) = (extent.min[axis] - start[axis], extent.max[axis] - start[axis]);
        if along[axis].abs() < 1e-12 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let ends = [low / along[axis], high / along[axis]];
        from = from.max(ends[0].min(ends[1]));
        to = to.min(ends[0].max(ends[1]));
    }
    (from < to).then_some([from, to])
}

/// The height of a text where the extent is nearest to the eye, meters; `None` where all is behind it.
fn nearest_em_m(view: &GraphicView<'_>, extent: &Rect) -> Option<f64> {
    /// Places along each side that are tried.
    const PLACES: u32 = 12;
    let share = |index: u32| f64::from(index) / f64::from(PLACES - 1);
    let places = (0..PLACES).flat_map(|y| (0..PLACES).map(move |x| DVec2::new(share(x), share(y))));
    let em_m = |share: DVec2| view.em_m(&[extent.min + extent.size() * share]);
    places.filter_map(em_m).min_by(f64::total_cmp).filter(|em_m| em_m.is_finite() && *em_m > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_cut_to_the_extent_that_it_crosses() {
        let extent = Rect { min: DVec2::ZERO, max: DVec2::new(10.0, 4.0) };
        let cut = |start: [f64; 2], along: [f64; 2]| within(&extent, start.into(), DVec2::from(along), 100.0);
        assert_eq!(cut([2.0, 2.0], [1.0, 0.0]), Some([-2.0, 8.0]));
        assert_eq!(cut([2.0, 2.0], [0.0, -1.0]), Some([-2.0, 2.0]));
        assert_eq!(cut([2.0, 5.0], [1.0, 0.0]), None);
        let slanted = cut([0.0, 0.0], [0.8, 0.6]).expect("crosses");
        assert!(slanted[0].abs() < 1e-9 && (slanted[1] - 4.0 / 0.6).abs() < 1e-9, "{slanted:?}");
    }
}
