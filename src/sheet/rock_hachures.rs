//! Rock drawn by hachures on views from above, after Geisthövel and Hurni 2018, "Automated Swiss-style relief shading and rock
//! hachuring": what Swiss maps have drawn by hand for two centuries.
//!
//! ```text
//!    ────╮ edge line: where rock begins below gentler ground, and where a ridge parts light from shade
//!   │ │││╰─── fill strokes down the slope, thick above and thin below,
//!   │  │ ││   wider apart and thinner on the side of the light
//! ```
//!
//! The ground that the picture shows is read at every few pixels and smoothed; strokes follow its fall, each off those before
//! it. Seeds are jittered by their place alone, so that the same picture has the same strokes.

use glam::Vec2;

use crate::shown_elevation::shown_elevation_m;
use sandtable_annotate::annotation::TaperedStroke;
use sandtable_draw::list::DrawList;
use sandtable_draw::lowbias::lowbias32;
use sandtable_geom::isolines::{Isoline, ValueGrid, isolines};
use sandtable_render::picture::Rendering;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

/// Rows of a picture at which elevations are read; more show posts as steps.
const ROWS: usize = 400;
/// How much a camera may look aside of straight down.
const STRAIGHT_DOWN: f32 = -0.999;
/// The distance of strokes in full shade and in full light, in thousandths of the picture's height.
const APART: [f32; 2] = [3.4, 6.0];
/// The width of strokes at their upper end, and of edges, in full shade and in full light, in the same unit.
const FILL_WIDTH: [f32; 2] = [2.0, 0.8];
const EDGE_WIDTH: [f32; 2] = [1.9, 0.8];
/// The share of their width that strokes have at their lower end.
const TAPER: f32 = 0.35;
/// The length of strokes, shortest and longest, in the same unit; shorter ones are left out.
const LENGTH: [f32; 2] = [10.0, 28.0];
const SHORTEST: f32 = 3.5;
/// The same of edges: shorter ones look like hooks.
const SHORTEST_EDGE: f32 = 16.0;
/// How near a stroke comes to another, of their distance.
const STOP: f32 = 0.6;
/// How much the fall diverges along a ridge, per grid cell.
const RIDGE: f32 = 0.12;
/// Edges are drawn where the fall leads into the rock by this share at least.
const INWARD: f32 = 0.35;
/// Strokes in a picture: more are gray.
const MOST_STROKES: usize = 60_000;

/// The strokes of rock on a picture; none where the scene wants none or the camera looks aside.
pub fn rock_strokes(
    scene: &SceneModel,
    list: &DrawList,
    camera: &Camera,
    picture: &Rendering,
) -> Vec<TaperedStroke> {
    let is_plan = camera.parallel_frame().is_some() && camera.forward().z < STRAIGHT_DOWN;
    let Some(rock) = scene.rock.filter(|_| is_plan) else { return Vec::new() };
    let to_sun = list.lighting.to_sun;
    let toward_light = Vec2::new(to_sun.dot(camera.right()), -to_sun.dot(camera.up())).normalize_or_zero();
    let ground = SteepGround::new(&ReadPlan::new(list, camera, picture), toward_light, rock.least_rise);
    let unit = picture.pixels.height() as f32 / 1000.0;
    let mut strokes: Vec<TaperedStroke> = Vec::new();
    let mut taken = TakenPlaces::new(picture, unit * APART[0]);
    for edge in ground.edges() {
        let path_px: Vec<Vec2> = edge.iter().map(|at| *at * ground.step).collect();
        if length(&path_px) > SHORTEST_EDGE * unit {
            path_px.iter().for_each(|at| taken.add(*at));
            let lit = ground.facing(edge[edge.len() / 2]);
            strokes.push(TaperedStroke { path_px, width_px: [between(EDGE_WIDTH, lit) * unit; 2] });
        }
    }
    strokes.extend(ground.fill(unit, &mut taken));
    strokes.truncate(MOST_STROKES);
    strokes
}

/// The elevations that a plan shows, at every few pixels.
struct ReadPlan {
    columns: usize,
    rows: usize,
    /// Pixels.
    step: f32,
    /// Meters on the ground.
    step_m: f32,
    /// NaN where the picture shows something else than bare ground.
    elevations_m: Vec<f32>,
}

impl ReadPlan {
    fn new(list: &DrawList, camera: &Camera, picture: &Rendering) -> Self {
        let (width, height) = (picture.pixels.width() as usize, picture.pixels.height() as usize);
        let step = (height / ROWS).max(2);
        let (columns, rows) = (width.div_ceil(step), height.div_ceil(step));
        let elevation = |index: usize| {
            let pixel = Vec2::new((index % columns * step) as f32, (index / columns * step) as f32);
            shown_elevation_m(list, camera, picture, pixel).unwrap_or(f32::NAN)
        };
        let elevations_m = (0..columns * rows).map(elevation).collect();
        let across_m = camera.point_at(Vec2::new(step as f32, 0.0), 1.0) - camera.point_at(Vec2::ZERO, 1.0);
        Self { columns, rows, step: step as f32, step_m: across_m.length(), elevations_m }
    }
}

/// The fall of the ground on a grid over the picture, in its pixels.
struct SteepGround {
    columns: usize,
    rows: usize,
    step: f32,
    /// Down the slope, X right and Y down, as long as the rise per meter; zero where there is no ground.
    falls: Vec<Vec2>,
    /// The rise, of the least that is rock; NaN where there is no ground.
    steepness: Vec<f32>,
    toward_light: Vec2,
}

impl SteepGround {
    fn new(read: &ReadPlan, toward_light: Vec2, least_rise: f32) -> Self {
        let (columns, rows) = (read.columns, read.rows);
        let smooth = smoothed(&smoothed(&read.elevations_m, columns), columns);
        let at = |column: usize, row: usize| smooth[row * columns + column];
        let fall = |index: usize| {
            let (column, row) = (index % columns, index / columns);
            let (left, right) = (column.saturating_sub(1), (column + 1).min(columns - 1));
            let (above, below) = (row.saturating_sub(1), (row + 1).min(rows - 1));
            let rise = Vec2::new(
                (at(right, row) - at(left, row)) / (right - left).max(1) as f32,
                (at(column, below) - at(column, above)) / (below - above).max(1) as f32,
            );
            let fall = -rise / read.step_m;
            if fall.is_finite() { fall } else { Vec2::ZERO }
        };
        let falls: Vec<Vec2> = (0..columns * rows).map(fall).collect();
        let steepness: Vec<f32> = falls.iter().map(|fall| fall.length() / least_rise).collect();
        let steepness = smoothed(&steepness, columns);
        Self { columns, rows, step: read.step, falls, steepness, toward_light }
    }

    fn index(&self, at: Vec2) -> Option<usize> {
        let (column, row) = (at.x.round(), at.y.round());
        let inside = column >= 0.0 && row >= 0.0 && column < self.columns as f32 && row < self.rows as f32;
        inside.then(|| row as usize * self.columns + column as usize)
    }

    fn is_rock(&self, at: Vec2) -> bool {
        self.index(at).is_some_and(|index| self.steepness[index] >= 1.0 && self.falls[index] != Vec2::ZERO)
    }

    fn down(&self, at: Vec2) -> Vec2 {
        self.index(at).map_or(Vec2::ZERO, |index| self.falls[index].normalize_or_zero())
    }

    /// How much the slope at a place of the grid faces the light, -1 to 1.
    fn facing(&self, at: Vec2) -> f32 {
        self.down(at).dot(self.toward_light)
    }

    /// The lines along the upper edges of rock and along its ridges, in the grid.
    fn edges(&self) -> Vec<Vec<Vec2>> {
        let grid = |values| ValueGrid { columns: self.columns, values };
        let borders = isolines(&grid(&self.steepness), 1.0, 4, |_, _| true);
        let mut edges: Vec<Vec<Vec2>> = Vec::new();
        for border in borders.iter().filter(|border| border.level == 1) {
            // Rock is on the left of its border, looking along it, X right and Y down.
            edges.extend(runs(
                border,
                |leg| {
                    let inward = Vec2::new(leg.y, -leg.x);
                    move |fall: Vec2| inward.dot(fall) > INWARD
                },
                |at| self.down(at),
            ));
        }
        let facing = |index: usize| {
            let at = Vec2::new((index % self.columns) as f32, (index / self.columns) as f32);
            if self.is_rock(at) { self.facing(at) } else { f32::NAN }
        };
        let facings: Vec<f32> = (0..self.falls.len()).map(facing).collect();
        for ridge in isolines(&grid(&facings), 4.0, 1, |_, _| true) {
            edges.extend(runs(&ridge, |_| |divergence: f32| divergence > RIDGE, |at| self.divergence(at)));
        }
        edges
    }

    /// How much the fall diverges at a place, per cell.
    fn divergence(&self, at: Vec2) -> f32 {
        let across = self.down(at + Vec2::X) - self.down(at - Vec2::X);
        let along = self.down(at + Vec2::Y) - self.down(at - Vec2::Y);
        (across.x + along.y) * 0.5
    }

    /// The strokes down the slope.
    fn fill(&self, unit: f32, taken: &mut TakenPlaces) -> Vec<TaperedStroke> {
        let pitch = APART[0] * unit * 0.8;
        let size = Vec2::new(self.columns as f32, self.rows as f32) * self.step;
        let (across, down) = ((size.x / pitch) as u32, (size.y / pitch) as u32);
        let mut strokes = Vec::new();
        for (row, column) in (0..down).flat_map(|row| (0..across).map(move |column| (row, column))) {
            let [aside, along, long] = [0, 1, 2].map(|salt| chance(column, row, salt));
            let seed = (Vec2::new(column as f32, row as f32) + Vec2::new(aside, along)) * pitch;
            let at = seed / self.step;
            if !self.is_rock(at) {
                continue;
            }
            let lit = self.facing(at);
            let apart = between(APART, lit) * unit;
            if taken.is_near(seed, apart) {
                continue;
            }
            let steep = self.index(at).map_or(1.0, |index| self.steepness[index].clamp(1.0, 2.0));
            let longest = (LENGTH[0] + (LENGTH[1] - LENGTH[0]) * long) * unit * steep.sqrt();
            let path_px = self.stroke(seed, longest, apart * STOP, taken);
            if length(&path_px) < SHORTEST * unit {
                continue;
            }
            path_px.iter().for_each(|at| taken.add(*at));
            let width = between(FILL_WIDTH, lit) * unit;
            strokes.push(TaperedStroke { path_px, width_px: [width, width * TAPER] });
        }
        strokes
    }

    /// A stroke through `seed`, from above down.
    fn stroke(&self, seed: Vec2, longest: f32, apart: f32, taken: &TakenPlaces) -> Vec<Vec2> {
        let pace = self.step * 0.75;
        let half = |sign: f32| {
            let (mut at, mut path) = (seed, Vec::new());
            for _ in 0..(longest * 0.5 / pace) as usize {
                let down = self.down(at / self.step);
                at += down * (pace * sign);
                if down == Vec2::ZERO || !self.is_rock(at / self.step) || taken.is_near(at, apart) {
                    break;
                }
                path.push(at);
            }
            path
        };
        let mut path = half(-1.0);
        path.reverse();
        path.push(seed);
        path.extend(half(1.0));
        path
    }
}

/// The parts of a line along which `keeps`, made for the direction of each leg, holds for the value in its middle.
fn runs<T, K: Fn(T) -> bool>(
    line: &Isoline,
    keeps: impl Fn(Vec2) -> K,
    value: impl Fn(Vec2) -> T,
) -> Vec<Vec<Vec2>> {
    let points: Vec<Vec2> = line.points.iter().map(|at| at.as_vec2()).collect();
    let mut runs: Vec<Vec<Vec2>> = vec![Vec::new()];
    for leg in points.windows(2) {
        let along = (leg[1] - leg[0]).normalize_or_zero();
        let run = runs.last_mut().expect("there is always one");
        if keeps(along)(value((leg[0] + leg[1]) * 0.5)) {
            if run.is_empty() {
                run.push(leg[0]);
            }
            run.push(leg[1]);
        } else if !run.is_empty() {
            runs.push(Vec::new());
        }
    }
    runs.retain(|run| run.len() > 2);
    runs
}

/// Values with each the weighted mean of the nine around it; voids stay voids and count for nothing.
fn smoothed(values: &[f32], columns: usize) -> Vec<f32> {
    let rows = values.len() / columns.max(1);
    let mean = |index: usize| {
        if values[index].is_nan() {
            return f32::NAN;
        }
        let (column, row) = (index % columns, index / columns);
        let (mut sum, mut weights) = (0.0, 0.0);
        for y in row.saturating_sub(1)..=(row + 1).min(rows - 1) {
            for x in column.saturating_sub(1)..=(column + 1).min(columns - 1) {
                let value = values[y * columns + x];
                let near = |is_own: bool| if is_own { 2.0 } else { 1.0 };
                let weight = near(x == column) * near(y == row);
                if value.is_finite() {
                    sum += value * weight;
                    weights += weight;
                }
            }
        }
        sum / weights
    };
    (0..values.len()).map(mean).collect()
}

/// The value between those in full shade and in full light, for a slope that faces the light by `lit`.
fn between([shade, light]: [f32; 2], lit: f32) -> f32 {
    shade + (light - shade) * (lit * 0.5 + 0.5).clamp(0.0, 1.0)
}

fn length(path: &[Vec2]) -> f32 {
    path.windows(2).map(|leg| leg[0].distance(leg[1])).sum()
}

/// A number in 0..1 by a place.
fn chance(column: u32, row: u32, salt: u32) -> f32 {
    let place =
        column.wrapping_mul(0x9e37_79b1) ^ row.wrapping_mul(0x85eb_ca77) ^ salt.wrapping_mul(0xc2b2_ae3d);
    (lowbias32(place) >> 8) as f32 / (1u32 << 24) as f32
}

/// The vertices of strokes so far, by square cells.
struct TakenPlaces {
    cell: f32,
    columns: usize,
    cells: Vec<Vec<Vec2>>,
}

impl TakenPlaces {
    fn new(picture: &Rendering, cell: f32) -> Self {
        let cell = cell.max(1.0);
        let count = |pixels: u32| (pixels as f32 / cell) as usize + 1;
        let (columns, rows) = (count(picture.pixels.width()), count(picture.pixels.height()));
        Self { cell, columns, cells: vec![Vec::new(); columns * rows] }
    }

    fn add(&mut self, at: Vec2) {
        let (column, row) = ((at.x / self.cell).max(0.0) as usize, (at.y / self.cell).max(0.0) as usize);
        if column < self.columns
            && let Some(cell) = self.cells.get_mut(row * self.columns + column)
        {
            cell.push(at);
        }
    }

    fn is_near(&self, at: Vec2, apart: f32) -> bool {
        let reach = (apart / self.cell).ceil() as usize;
        let (column, row) = ((at.x / self.cell).max(0.0) as usize, (at.y / self.cell).max(0.0) as usize);
        let rows = self.cells.len() / self.columns;
        (row.saturating_sub(reach)..=(row + reach).min(rows - 1)).any(|row| {
            (column.saturating_sub(reach)..=(column + reach).min(self.columns - 1)).any(|column| {
                self.cells[row * self.columns + column].iter().any(|other| other.distance(at) < apart)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pyramid with a flat top at the middle of a grid of 120 × 120 cells of 3 pixels and 10 m.
    fn pyramid() -> SteepGround {
        let elevation = |index: usize| {
            let at = Vec2::new((index % 120) as f32, (index / 120) as f32) - 60.0;
            (600.0 - 12.0 * at.abs().max_element().max(10.0)).max(100.0)
        };
        let elevations_m = (0..120 * 120).map(elevation).collect();
        let read = ReadPlan { columns: 120, rows: 120, step: 3.0, step_m: 10.0, elevations_m };
        // Light from the upper left.
        SteepGround::new(&read, Vec2::new(-1.0, -1.0).normalize(), 1.0)
    }

    fn filled(ground: &SteepGround) -> Vec<TaperedStroke> {
        let mut taken = TakenPlaces { cell: 3.0, columns: 121, cells: vec![Vec::new(); 121 * 121] };
        ground.fill(1.0, &mut taken)
    }

    #[test]
    fn strokes_run_down_the_slope_and_are_thinner_and_fewer_toward_the_light() {
        let ground = pyramid();
        let strokes = filled(&ground);
        let middle = Vec2::splat(180.0);
        let (mut lit, mut shaded) = ((0, 0.0f32), (0, 0.0f32));
        for stroke in &strokes {
            let (from, to) = (stroke.path_px[0], stroke.path_px[stroke.path_px.len() - 1]);
            let away = |at: Vec2| (at - middle).abs().max_element();
            assert!(away(to) > away(from) + 2.0, "{from} to {to}");
            assert!(stroke.width_px[1] < stroke.width_px[0]);
            let side = if (from - middle).x + (from - middle).y < 0.0 { &mut lit } else { &mut shaded };
            *side = (side.0 + 1, side.1.max(stroke.width_px[0]));
        }
        assert!(lit.0 > 40 && shaded.0 > lit.0 * 5 / 4, "{lit:?} {shaded:?}");
        assert!(shaded.1 > lit.1 * 1.4, "{lit:?} {shaded:?}");
        assert_eq!(strokes, filled(&ground), "the same ground has the same strokes");
    }

    #[test]
    fn rock_has_an_edge_above_and_none_below_and_level_ground_has_no_stroke() {
        let ground = pyramid();
        let middle = Vec2::splat(60.0);
        let edges = ground.edges();
        assert!(!edges.is_empty());
        let is_upper = |at: &Vec2| (*at - middle).abs().max_element() < 14.0;
        let is_ridge = |at: &Vec2| ((at.x - middle.x).abs() - (at.y - middle.y).abs()).abs() < 4.0;
        for at in edges.iter().flatten() {
            assert!(is_upper(at) || is_ridge(at), "{at}");
        }
        assert!(edges.iter().flatten().any(is_upper));
        let outside = |at: &Vec2| (*at / 3.0 - middle).abs().max_element() > 44.0;
        assert!(!filled(&ground).iter().flat_map(|stroke| &stroke.path_px).any(outside));
    }
}
