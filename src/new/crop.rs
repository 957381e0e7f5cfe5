//! The part of an elevation model that a new scene is made of.

use glam::DVec2;

use crate::stated;
use crate::survey::SurveyedLayer;
use crate::text::VectorDraft;
use sandtable_geom::rect::Rect;
use sandtable_raster::largest_rectangle::largest_rectangle;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::Lattice;

/// A part of the elevation model, in the scene's system, or in that of its inline points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ExtentDraft {
    pub rect: Rect,
    /// What it holds, as the beginning of a sentence.
    pub holds: &'static str,
}

impl ExtentDraft {
    /// The extent in the system of inline points.
    pub fn stated_in(self, scene: &SceneModel) -> Self {
        Self { rect: stated(self.rect, scene), ..self }
    }
}

/// The box of the features on the ground without strays, in the scene's system: along each axis it leaves out as much of
/// their length on either side as little as a stray way has. Empty where there are none. Features that cannot be transformed to the
/// system are left out.
pub(super) fn main_extent(vectors: &[VectorDraft], scene: &SceneModel) -> Rect {
    /// The share of the length on each side: in all, 98 % of it are kept. Less keeps single long ways that lead out of the
    /// place, more cuts off its outskirts.
    const TRIMMED: f64 = 0.005;
    let ground = scene.lattice.map_extent();
    let layers = vectors.iter().flat_map(|vector| &vector.layers);
    let segments = layers.flat_map(|layer| {
        layer.segments.iter().filter_map(|ends| {
            let [from, to] = ends.map(|at| layer.crs.transform(&scene.crs, at).ok());
            ground.clip_line(from?, to?)
        })
    });
    let mut ends: Vec<WeighedPoint> = segments
        .flat_map(|(from, to)| {
            let length_m = from.distance(to);
            [from, to].map(|at| WeighedPoint { at, weight: length_m })
        })
        .collect();
    if ends.iter().all(|end| end.weight == 0.0) {
        ends.iter_mut().for_each(|end| end.weight = 1.0);
    }
    ends.retain(|end| end.weight > 0.0);
    let least = ends.iter().map(|end| end.weight).sum::<f64>() * TRIMMED;
    let mut side = |axis: fn(DVec2) -> f64| {
        ends.sort_by(|a, b| axis(a.at).total_cmp(&axis(b.at)));
        Some((axis(beyond(ends.iter(), least)?), axis(beyond(ends.iter().rev(), least)?)))
    };
    match (side(|at| at.x), side(|at| at.y)) {
        (Some((west, east)), Some((south, north))) => {
            Rect { min: DVec2::new(west, south), max: DVec2::new(east, north) }
        }
        _ => Rect::EMPTY,
    }
}

/// Whether a layer has a segment on the ground.
pub(super) fn is_on_ground(layer: &SurveyedLayer, scene: &SceneModel) -> bool {
    let ground = scene.lattice.map_extent();
    layer.segments.iter().any(|ends| {
        let [from, to] = ends.map(|at| layer.crs.transform(&scene.crs, at));
        from.is_ok_and(|from| to.is_ok_and(|to| ground.clip_line(from, to).is_some()))
    })
}

/// The first of `ends` with more than `least` weight up to it.
fn beyond<'a>(mut ends: impl Iterator<Item = &'a WeighedPoint>, least: f64) -> Option<DVec2> {
    let mut passed = 0.0;
    let found = ends.find(|end| {
        passed += end.weight;
        passed > least
    });
    found.map(|end| end.at)
}

/// An end of a segment and the length that it stands for.
struct WeighedPoint {
    at: DVec2,
    weight: f64,
}

/// The extent of a scene whose vectors cover little of the `ground`: theirs and a margin; `None` where they cover more, or
/// where there are none.
pub(super) fn around_vectors(vectors: Rect, ground: Rect) -> Option<ExtentDraft> {
    /// The share of the ground below which it is cropped.
    const LITTLE: f64 = 0.3;
    /// The margin on each side, as a share of the longer side.
    const MARGIN: f64 = 0.12;
    /// The width from west to east as a share of the height from south to north, at least and at most: in a view toward
    /// the north, a narrower or lower block leaves most of a picture empty.
    const SHAPES: [f64; 2] = [1.3, 1.7];
    /// A smaller share of the ground along a side is a point on it, not a place to crop to.
    const LEAST: f64 = 0.01;
    let covered = vectors.intersection(&ground);
    let share = covered.size() / ground.size();
    let is_little = !covered.is_empty() && share.element_product() < LITTLE && share.min_element() > LEAST;
    is_little.then(|| {
        let half = covered.size() / 2.0 + covered.size().max_element() * MARGIN;
        let [narrowest, widest] = SHAPES;
        let half = half.max(DVec2::new(half.y * narrowest, half.x / widest)).min(ground.size() / 2.0);
        // Beside the border of the ground, the block is moved rather than made narrower.
        let center = covered.center().clamp(ground.min + half, (ground.max - half).max(ground.min + half));
        let rect = Rect { min: center - half, max: center + half }.intersection(&ground);
        ExtentDraft { rect, holds: "The features and a margin" }
    })
}

/// The largest rectangle that holds data all through, for a ground that has none along its border; `None` where there is
/// data everywhere, or too little of it in any rectangle.
pub(super) fn with_straight_edges(ground: &Lattice) -> Option<ExtentDraft> {
    /// Where less of the data is kept it is better seen whole, with the border that it has.
    const LEAST_KEPT: f64 = 0.5;
    let has_no_data: Vec<bool> = ground.heights().iter().map(|height| height.is_nan()).collect();
    let held = has_no_data.iter().filter(|&&without| !without).count();
    // Rows of a lattice run from the south: "top" is the southernmost row.
    let kept = largest_rectangle(&has_no_data, ground.columns());
    let is_part = held < has_no_data.len() && kept.width.min(kept.height) > 1;
    (is_part && kept.area() as f64 >= held as f64 * LEAST_KEPT).then(|| {
        let at = |column: u32, row: u32| {
            ground.origin() + DVec2::new(f64::from(column), f64::from(row)) * ground.cell()
        };
        let rect = Rect {
            min: at(kept.left, kept.top),
            max: at(kept.left + kept.width - 1, kept.top + kept.height - 1),
        };
        ExtentDraft { rect, holds: "The largest rectangle without missing data" }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ground_with_a_slanting_border_is_cropped_to_straight_edges() {
        let height = |index: u32| if index % 20 < index / 20 / 4 { f32::NAN } else { 5.0 };
        let heights = (0..400).map(height).collect();
        let ground = Lattice::new(DVec2::splat(1000.0), DVec2::splat(10.0), 20, heights).expect("sound");
        let found = with_straight_edges(&ground).expect("a part");
        assert_eq!(found.rect, Rect { min: DVec2::new(1040.0, 1000.0), max: DVec2::splat(1190.0) });
        let whole = Lattice::new(DVec2::ZERO, DVec2::ONE, 20, vec![5.0; 400]).expect("sound");
        assert_eq!(with_straight_edges(&whole), None);
    }

    #[test]
    fn little_data_is_seen_whole() {
        let diagonal = (0..400u32).map(|index| if index % 21 < 2 { 5.0 } else { f32::NAN }).collect();
        let ground = Lattice::new(DVec2::ZERO, DVec2::ONE, 20, diagonal).expect("sound");
        assert_eq!(with_straight_edges(&ground), None);
    }
}
