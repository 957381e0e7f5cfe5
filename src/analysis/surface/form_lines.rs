//! Ridge and valley lines from passes: of the lines of steepest slope through a pass, those that climb run along ridges to
//! summits, and those that fall run down valleys to depressions (Maxwell 1870, "On hills and dales").
//!
//! ```text
//!   +  +  −      The neighbors of a pass form arcs of higher (+) and lower (−) posts, two or more of each. A line goes
//!   −  o  −      out over the steepest post of each arc and on from post to post by the steepest slope, until it ends
//!   −  +  +      or meets a line of its kind.
//! ```
//!
//! Of posts of equal height the one with the smaller index counts as higher, so that every line ends.

use super::divide_tree::{divide_passes, divide_summits, posts_around};
use super::peaks::{is_inside, left_out};
use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::outcome::{FeatureRole, Outcome, OutcomeFeature, OutcomeShape, PropertyValue};
use glam::DVec2;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::neighbors::STEPS;
use sandtable_terrain::stop_flag::StopFlag;

/// Ridge and valley lines from passes that are at least so deep, with `form` and `length_m`. Ridges begin at the pass and
/// climb, valleys fall.
///
/// # Errors
/// [`AnalysisError::Memory`] and [`AnalysisError::Stopped`].
pub(crate) fn form_lines(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let ground = &*land.ground;
    let summits = divide_summits(ground, arguments.number("depth") as f32, stop)?;
    let passes = divide_passes(&summits).into_iter().map(|(pass, _)| pass);
    let (inner, outer): (Vec<usize>, Vec<usize>) = passes.partition(|&pass| is_inside(ground, pass));
    let forms: &[LineForm] = match &*arguments.word("form") {
        "ridges" => &[LineForm::Ridge],
        "valleys" => &[LineForm::Valley],
        _ => &[LineForm::Ridge, LineForm::Valley],
    };
    let mut features = Vec::new();
    for &form in forms {
        let mut tracer = FormTracer { ground, form, next: vec![NO_LINE; ground.heights().len()] };
        for &pass in &inner {
            if stop.is_stopped() {
                return Err(AnalysisError::Stopped);
            }
            for start in tracer.starts(pass).into_iter().flatten() {
                let line = tracer.trace(pass, start);
                features.extend((line.len() > 1).then(|| feature(ground, form, &line)));
            }
        }
    }
    Ok(Outcome { features, notes: left_out(outer.len(), "pass"), ..Outcome::default() })
}

/// What a line runs along.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LineForm {
    Ridge,
    Valley,
}

/// Traces the lines of a form.
struct FormTracer<'a> {
    ground: &'a Lattice,
    form: LineForm,
    /// Where the line over a post goes on; the post itself where it ends.
    next: Vec<u32>,
}

/// A post without a line.
const NO_LINE: u32 = u32::MAX;

impl FormTracer<'_> {
    /// The steepest post of each arc of the ring around a pass on the line's side of it; a ring has four arcs at most.
    fn starts(&self, pass: usize) -> [Option<usize>; 4] {
        let columns = i64::from(self.ground.columns());
        let ring = STEPS.map(|(east, north)| pass.wrapping_add_signed((north * columns + east) as isize));
        let is_ahead = ring.map(|post| self.is_ahead(post, pass));
        let mut starts = [None; 4];
        // Around from a post that is not ahead, so that no arc is cut.
        let Some(first) = is_ahead.iter().position(|&is_ahead| !is_ahead) else { return starts };
        let mut arcs = 0;
        let mut is_in_arc = false;
        for index in (first..first + 8).map(|index| index % 8) {
            if is_ahead[index] && !is_in_arc {
                arcs += 1;
            }
            is_in_arc = is_ahead[index];
            if is_in_arc {
                let best = &mut starts[arcs - 1];
                *best = best.filter(|&best| !self.is_steeper(pass, ring[index], best)).or(Some(ring[index]));
            }
        }
        starts
    }

    /// The posts of a line from a pass over its next post; ends with the first post of another line where it meets one.
    /// The pass alone where another line already runs that way.
    fn trace(&mut self, pass: usize, start: usize) -> Vec<usize> {
        if self.next[pass] == start as u32 {
            return vec![pass];
        }
        if self.next[pass] == NO_LINE {
            self.next[pass] = start as u32;
        }
        let mut line = vec![pass, start];
        let mut at = start;
        while self.next[at] == NO_LINE {
            let ahead = posts_around(self.ground, at).filter(|&post| self.is_ahead(post, at));
            // Of equally steep ones the first.
            let is_better = |post: usize, best: usize| {
                self.is_steeper(at, post, best) || post < best && !self.is_steeper(at, best, post)
            };
            let next = ahead.reduce(|best, post| if is_better(post, best) { post } else { best });
            self.next[at] = next.unwrap_or(at) as u32;
            line.extend(next);
            at = next.unwrap_or(at);
        }
        line
    }

    /// Whether a line that has come to `from` may go on to `post`: upward on ridges, downward in valleys.
    fn is_ahead(&self, post: usize, from: usize) -> bool {
        let heights = self.ground.heights();
        let (height, own) = (heights[post], heights[from]);
        let is_higher = height > own || height == own && post < from;
        !height.is_nan() && is_higher == (self.form == LineForm::Ridge)
    }

    /// Whether it is steeper from a post to `post` than to `best`.
    fn is_steeper(&self, from: usize, post: usize, best: usize) -> bool {
        let slope = |to: usize| {
            let rise = f64::from(self.ground.heights()[to]) - f64::from(self.ground.heights()[from]);
            rise.abs() / distance_m(self.ground, from, to)
        };
        slope(post) > slope(best)
    }
}

/// Meters between two posts.
fn distance_m(ground: &Lattice, a: usize, b: usize) -> f64 {
    let place = |post: usize| ground.post_at(post).grid();
    ((place(a) - place(b)) * ground.cell()).length()
}

fn feature(ground: &Lattice, form: LineForm, line: &[usize]) -> OutcomeFeature {
    let length_m: f64 = line.windows(2).map(|pair| distance_m(ground, pair[0], pair[1])).sum();
    let places: Vec<DVec2> = line.iter().map(|&post| ground.map_position(ground.post_at(post))).collect();
    let form = if form == LineForm::Ridge { "ridge" } else { "valley" };
    OutcomeFeature {
        shape: OutcomeShape::Line(places),
        name: String::new(),
        role: FeatureRole::FormLine,
        properties: vec![
            ("form", PropertyValue::Text(form.to_owned())),
            ("length_m", PropertyValue::Number(length_m)),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::super::window::tests::{land, outcome};
    use super::*;

    /// A saddle between summits at columns 2 and 12 of 15 × 9 posts, 2 m apart; its middle is at column 7, row 4.
    fn saddle() -> Land {
        let height = |index: i16| {
            let (x, y) = (f32::from((index % 15 - 7).abs()), f32::from(index / 15 - 4));
            10.0 - (x - 5.0).abs() - 2.0 * y.abs()
        };
        land(DVec2::splat(2.0), 15, (0..135).map(height).collect())
    }

    fn lines(land: &Land, form: &str) -> Vec<Vec<DVec2>> {
        let outcome = outcome(land, "form-lines", &[("form", form)], &[("depth", 1.0)]).expect("lines");
        let points = |feature: OutcomeFeature| match feature.shape {
            OutcomeShape::Line(points) => points,
            _ => Vec::new(),
        };
        outcome.features.into_iter().map(points).collect()
    }

    #[test]
    fn a_saddle_has_a_ridge_to_each_summit_and_a_valley_to_each_side() {
        let land = saddle();
        let at = |column: f64, row: f64| DVec2::new(1000.0 + 2.0 * column, 2000.0 + 2.0 * row);
        let ridges = lines(&land, "ridges");
        assert_eq!(ridges.len(), 2);
        for (summit, step) in [(2.0, -1.0), (12.0, 1.0)] {
            let along: Vec<DVec2> = (0..6).map(|index| at(7.0 + step * f64::from(index), 4.0)).collect();
            assert!(ridges.contains(&along), "to column {summit}: {ridges:?}");
        }
        let valleys = lines(&land, "valleys");
        assert_eq!(valleys.len(), 2);
        for row in [0.0, 8.0] {
            let ends =
                valleys.iter().filter(|line| line[0] == at(7.0, 4.0) && line[line.len() - 1] == at(7.0, row));
            assert_eq!(ends.count(), 1, "{valleys:?}");
        }
        assert_eq!(lines(&land, "both").len(), 4);
    }

    #[test]
    fn lines_climb_or_fall_from_post_to_post_and_no_part_is_there_twice() {
        let heights: Vec<f32> = (0..40 * 30u32).map(|index| (index * 7919 % 433 / 8) as f32).collect();
        let land = land(DVec2::ONE, 40, heights);
        for (form, sign) in [("ridges", 1.0), ("valleys", -1.0)] {
            let mut parts = std::collections::BTreeSet::new();
            let lines = lines(&land, form);
            assert!(lines.len() > 20);
            for pair in lines.iter().flat_map(|line| line.windows(2)) {
                let [a, b] = [pair[0], pair[1]].map(|at| (at - DVec2::new(1000.0, 2000.0)).as_uvec2());
                let [from, to] = [a, b].map(|at| land.ground.heights()[(at.y * 40 + at.x) as usize]);
                assert!((to - from) * sign >= 0.0, "{form}");
                assert!(parts.insert((a.to_array(), b.to_array())), "{form} {a} {b}");
            }
        }
    }

    #[test]
    fn level_ground_and_ground_without_data_have_no_lines() {
        for heights in [vec![3.0; 81], vec![f32::NAN; 81]] {
            assert!(lines(&land(DVec2::ONE, 9, heights), "both").is_empty());
        }
    }
}
