//! Spot heights: elevations at unnamed summits, saddles and lakes.

use glam::Vec2;

use crate::exact_ground::{ExactGround, ExactSpot};
use crate::label_course::LabelCourse;
use crate::scene_label::{SceneLabel, whole_meters};
use crate::water::lake_level::LakeSurface;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::words::LabelKind;
use sandtable_geom::polygon::inner_point;

/// Named labels come before all spot heights.
const FIRST_RANK: f64 = 1e9;
/// A saddle counts as much as a summit of this share of its prominence.
const SADDLE_SHARE: f32 = 0.5;
/// Spot heights keep this share of the ground's diagonal from labels and from each other.
const APART_SHARE: f32 = 0.02;
/// Hills and saddles lower than this share of the ground's relief have no spot height.
const LEAST_SHARE: f32 = 0.02;

/// Up to `most` labels of elevations off the places of `labels`, the most important first. On ground of means of samples these
/// find and rank the places; summits then are the highest samples there, and saddles and lakes without a stated level have the
/// height of all samples at their place.
///
/// # Errors
/// The samples cannot be read.
pub(super) fn spot_heights(
    most: usize,
    labels: &[SceneLabel],
    lakes: &[LakeSurface],
    exact: &ExactGround<'_>,
) -> Result<Vec<SceneLabel>, Diagnostic> {
    if most == 0 {
        return Ok(Vec::new());
    }
    let (frame, lattice) = (exact.frame, exact.lattice);
    let (low_m, high_m) = lattice.height_range();
    let extent = lattice.extent();
    let apart = extent.size().length() as f32 * APART_SHARE;
    let least = (high_m - low_m) * LEAST_SHARE;
    let mut spots: Vec<SpotHeight> = Vec::new();
    for summit in exact.summits().iter().filter(|summit| summit.prominence_m >= least) {
        spots.push(SpotHeight {
            at: summit.at,
            elevation_m: summit.height_m,
            weight: summit.prominence_m,
            origin: SpotOrigin::Summit,
        });
        spots.extend(summit.saddle.map(|saddle| SpotHeight {
            at: saddle.at,
            elevation_m: saddle.height_m,
            weight: summit.prominence_m * SADDLE_SHARE,
            origin: SpotOrigin::Saddle,
        }));
    }
    // A lake counts as a hill of the relief times its share of the ground's width.
    for lake in lakes {
        if let Some((at, width)) = inner_point([lake.outline.as_slice()], &extent) {
            let weight = (high_m - low_m) * (width / extent.size().max_element()).min(1.0) as f32;
            let (at, elevation_m) = (at.as_vec2(), lake.level_m as f32);
            let origin = SpotOrigin::Lake { is_stated: lake.is_stated };
            spots.push(SpotHeight { at, elevation_m, weight, origin });
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
        if !is_free {
            continue;
        }
        let Some(ground) = frame.ground_at(lattice, spot.at.as_dvec2()) else { continue };
        let found = spot.exact(exact, ground.z)?;
        let Some(ground) = frame.ground_at(lattice, found.at.as_dvec2()) else { continue };
        taken.push(found.at);
        chosen.push(SceneLabel {
            text: whole_meters(found.elevation_m),
            stated: 0..0,
            ground,
            anchor: ground,
            course: LabelCourse::Place,
            kind: match spot.origin {
                SpotOrigin::Summit | SpotOrigin::Saddle => LabelKind::Point,
                SpotOrigin::Lake { .. } => LabelKind::Water,
            },
            rank: FIRST_RANK + chosen.len() as f64,
            size: 1.0,
            shield: None,
        });
    }
    Ok(chosen)
}

struct SpotHeight {
    at: Vec2,
    elevation_m: f32,
    weight: f32,
    origin: SpotOrigin,
}

/// What a spot height is of.
#[derive(Clone, Copy)]
enum SpotOrigin {
    Summit,
    Saddle,
    Lake { is_stated: bool },
}

impl SpotHeight {
    /// Its place and its elevation by all samples; `drawn_z` is the ground of the picture there.
    fn exact(&self, exact: &ExactGround<'_>, drawn_z: f32) -> Result<ExactSpot, Diagnostic> {
        let Self { at, elevation_m, .. } = *self;
        let own = ExactSpot { at, elevation_m };
        match self.origin {
            SpotOrigin::Summit => exact.summit(own),
            SpotOrigin::Lake { is_stated: true } => Ok(own),
            SpotOrigin::Saddle | SpotOrigin::Lake { is_stated: false } if !exact.is_of_means() => Ok(own),
            SpotOrigin::Saddle | SpotOrigin::Lake { is_stated: false } => {
                Ok(ExactSpot { elevation_m: exact.elevation_m(at.as_dvec2(), drawn_z)?, ..own })
            }
        }
    }
}
