//! The part of an elevation model that a new scene is made of.

use glam::DVec2;

use crate::stated;
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

/// The extent of a scene whose vectors cover little of the `ground`: theirs and a margin; `None` where they cover more, or
/// where there are none.
pub(super) fn around_vectors(vectors: Rect, ground: Rect) -> Option<ExtentDraft> {
    /// The share of the ground below which it is cropped.
    const LITTLE: f64 = 0.3;
    /// The margin on each side, as a share of the longer side.
    const MARGIN: f64 = 0.15;
    /// The shorter side as a share of the longer: a narrow block leaves most of a picture empty.
    const NARROWEST: f64 = 0.8;
    /// A smaller share of the ground along a side is a point on it, not a place to crop to.
    const LEAST: f64 = 0.01;
    let covered = vectors.intersection(&ground);
    let share = covered.size() / ground.size();
    let is_little = !covered.is_empty() && share.element_product() < LITTLE && share.min_element() > LEAST;
    is_little.then(|| {
        let longer = covered.size().max_element();
        let half = covered.size().max(DVec2::splat(longer * NARROWEST)) / 2.0 + longer * MARGIN;
        let rect = Rect { min: covered.center() - half, max: covered.center() + half }.intersection(&ground);
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
