//! Spot heights: elevations at summits, saddles and lakes that nobody has named.

use glam::{DVec2, Vec2};

use crate::description::words::LabelKind;
use crate::geom::polygon::inner_point;
use crate::scene::SceneLabel;
use crate::scene::label_course::LabelCourse;
use crate::scene::views::whole_meters;
use crate::scene::world_frame::WorldFrame;
use crate::terrain::lattice::Lattice;
use crate::terrain::prominence::summits;

/// Named labels come before all spot heights.
const FIRST_RANK: f64 = 1e9;
/// A saddle counts as much as a summit of this share of its prominence.
const SADDLE_SHARE: f32 = 0.5;
/// Spot heights keep this share of the ground's diagonal from labels and from each other.
const APART_SHARE: f32 = 0.02;
/// Hills and saddles lower than this share of the ground's relief have no spot height.
const LEAST_SHARE: f32 = 0.02;

/// A lake's outline in world coordinates with its level in meters.
#[derive(Clone, Debug, PartialEq)]
pub struct LakeSurface {
    /// Its outer shore.
    pub outline: Vec<DVec2>,
    /// Of the water.
    pub level_m: f64,
}

/// Up to `most` labels of elevations off the places of `labels`, the most important first.
pub fn spot_heights(
    most: usize,
    labels: &[SceneLabel],
    lakes: &[LakeSurface],
    frame: &WorldFrame<'_>,
    lattice: &Lattice,
) -> Vec<SceneLabel> {
    if most == 0 {
        return Vec::new();
    }
    let (low_m, high_m) = lattice.height_range();
    let extent = lattice.extent();
    let apart = extent.size().length() as f32 * APART_SHARE;
    let least = (high_m - low_m) * LEAST_SHARE;
    let mut spots: Vec<SpotHeight> = Vec::new();
    for summit in summits(lattice).into_iter().filter(|summit| summit.prominence_m >= least) {
        spots.push(SpotHeight::new(summit.at, summit.height_m, summit.prominence_m, LabelKind::Point));
        spots.extend(summit.saddle.map(|saddle| {
            SpotHeight::new(saddle.at, saddle.height_m, summit.prominence_m * SADDLE_SHARE, LabelKind::Point)
        }));
    }
    // A lake counts as a hill of the relief times its share of the ground's width.
    for lake in lakes {
        if let Some((at, width)) = inner_point([lake.outline.as_slice()], &extent) {
            let weight = (high_m - low_m) * (width / extent.size().max_element()).min(1.0) as f32;
            spots.push(SpotHeight::new(at.as_vec2(), lake.level_m as f32, weight, LabelKind::Water));
        }
    }
    spots.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let mut taken: Vec<Vec2> = labels.iter().map(|label| label.ground.truncate()).collect();
    let mut chosen = Vec::new();
    for spot in spots {
        if chosen.len() == most {
            break;
        }
        let is_free = taken.iter().all(|other| other.distance(spot.at) > apart);
        let Some(ground) = frame.ground_at(lattice, spot.at.as_dvec2()).filter(|_| is_free) else { continue };
        taken.push(spot.at);
        chosen.push(SceneLabel {
            text: whole_meters(spot.elevation_m),
            stated: 0..0,
            ground,
            anchor: ground,
            course: LabelCourse::Place,
            kind: spot.kind,
            rank: FIRST_RANK + chosen.len() as f64,
        });
    }
    chosen
}

struct SpotHeight {
    at: Vec2,
    elevation_m: f32,
    weight: f32,
    kind: LabelKind,
}

impl SpotHeight {
    fn new(at: Vec2, elevation_m: f32, weight: f32, kind: LabelKind) -> Self {
        Self { at, elevation_m, weight, kind }
    }
}
