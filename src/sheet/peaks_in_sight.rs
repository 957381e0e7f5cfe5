//! The peaks that an eye sees: those that the scene names, and others by their prominence.
//!
//! A peak is in sight where a line of sight to a meter above its highest post is free, with the Earth's curvature and refraction, as `los`
//! says it. Names in data are often tens of meters beside the summit of the elevation model, which then hides its own name: so
//! a name belongs to the highest post near it.

use std::sync::Arc;

use glam::{DVec2, Vec2, Vec3};

use sandtable_description::words::LabelKind;
use sandtable_scene::label_course::LabelCourse;
use sandtable_scene::named_summits::summit_reach_m;
use sandtable_scene::scene_label::whole_meters;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::prominence::{ProminentSummit, summits};
use sandtable_terrain::query::{Interpolation, ground_height};
use sandtable_terrain::sight::Curvature;
use sandtable_terrain::sight::ground::SightGround;
use sandtable_terrain::sight::line::{Sight, SightEnd};

/// How far above its highest post a peak is looked for, meters: about a cairn. Without it, rounding hides the top of a cone.
pub const ABOVE_M: f64 = 1.0;

/// The least prominence of a peak without a name, as a share of the relief.
const LEAST_SHARE: f32 = 0.05;

/// Nearer peaks are under the eye's feet.
const NEAREST_M: f64 = 100.0;

/// A peak that an eye may see.
#[derive(Clone, Debug, PartialEq)]
pub struct Peak {
    /// Its name; `None` for one that the elevation model alone knows.
    pub name: Option<String>,
    /// Its highest post, world space, as it is drawn, without the lowering by curvature.
    pub world: Vec3,
    /// Elevation in meters.
    pub elevation_m: f32,
    /// From the eye, in plan.
    pub distance_m: f64,
    /// Above the saddle to higher ground; 0 where a name is on a slope.
    pub prominence_m: f32,
    /// Whether a line of sight from the eye to it is free.
    pub is_in_sight: bool,
}

impl Peak {
    /// The name, the elevation and the distance, on two lines.
    pub fn text(&self) -> String {
        let distance_km = self.distance_m / 1000.0;
        let decimals = usize::from(distance_km < 99.95);
        let (height, distance) = (whole_meters(self.elevation_m), format!("{distance_km:.decimals$} km"));
        match &self.name {
            Some(name) => format!("{name}\n{height} m, {distance}"),
            None => format!("{height} m\n{distance}"),
        }
    }
}

/// The peaks around an eye in world space: named ones in the order of their rank, then others, the more prominent first.
pub fn peaks(scene: &SceneModel, eye: Vec3) -> Vec<Peak> {
    let lattice = &scene.lattice;
    let eye_map = lattice.map_point(eye);
    let Some(ground_m) = ground_height(lattice, Interpolation::Planar, eye_map).height_m() else {
        return Vec::new();
    };
    let observer = SightEnd { at: eye_map, above_m: f64::from(scene.scale.elevation_m(eye.z)) - ground_m };
    let sight = SightGround::new(Arc::clone(lattice));
    let all = summits(lattice);
    let (low_m, high_m) = lattice.height_range();
    let least_m = (high_m - low_m) * LEAST_SHARE;
    let reach_m = summit_reach_m(lattice);
    let mut labels: Vec<_> = scene
        .labels
        .iter()
        .filter(|label| label.kind == LabelKind::Summit && label.course == LabelCourse::Place)
        .filter_map(|label| Some((label, peak_name(&label.text)?)))
        .collect();
    labels.sort_by(|(a, _), (b, _)| a.rank.total_cmp(&b.rank));
    let mut found: Vec<(Option<String>, Vec2, f32)> = Vec::new();
    for (label, name) in labels {
        let Some(at) = highest_near(lattice, label.ground.truncate().as_dvec2(), reach_m) else { continue };
        let prominence_m =
            all.iter().find(|summit| summit.at == at).map_or(0.0, |summit| summit.prominence_m);
        if !found.iter().any(|(_, other, _)| *other == at) {
            found.push((Some(name.to_owned()), at, prominence_m));
        }
    }
    let named: Vec<Vec2> = found.iter().map(|(_, at, _)| *at).collect();
    let is_unnamed = |summit: &&ProminentSummit| {
        let is_apart = |at: &Vec2| f64::from(at.distance(summit.at)) > reach_m;
        summit.prominence_m >= least_m && named.iter().all(is_apart)
    };
    found.extend(all.iter().filter(is_unnamed).map(|summit| (None, summit.at, summit.prominence_m)));
    let peak = |(name, at, prominence_m): (Option<String>, Vec2, f32)| {
        let map = lattice.map_point(at.extend(0.0));
        let elevation_m = ground_height(lattice, Interpolation::Planar, map).height_m()? as f32;
        let target = SightEnd { at: map, above_m: ABOVE_M };
        Some(Peak {
            name,
            world: at.extend(scene.scale.world_z(elevation_m)),
            elevation_m,
            distance_m: map.distance(eye_map),
            prominence_m,
            is_in_sight: sight.line_of_sight(observer, target, Curvature::default()) == Sight::Clear,
        })
    };
    found.into_iter().filter_map(peak).filter(|peak| peak.distance_m > NEAREST_M).collect()
}

/// The name in a label's text: its first line, where that is more than a height.
fn peak_name(text: &str) -> Option<&str> {
    let first = text.lines().next()?.trim();
    let letters = first.chars().filter(|letter| letter.is_alphabetic()).count();
    (letters > 1).then_some(first)
}

/// The highest post within `reach_m` of a place in world space; the southernmost and westernmost of several.
fn highest_near(lattice: &Lattice, world: DVec2, reach_m: f64) -> Option<Vec2> {
    let clamp = |at: DVec2| at.clamp(DVec2::ZERO, lattice.last_grid());
    let [low, high] = [world - reach_m, world + reach_m].map(|at| lattice.grid_at(at));
    let (low, high) = (clamp(low.ceil()).as_uvec2(), clamp(high.floor()).as_uvec2());
    let mut highest: Option<(f32, Vec2)> = None;
    for row in low.y..=high.y {
        for column in low.x..=high.x {
            let post = Post { column, row };
            let (height, at) = (lattice.height(post), lattice.position(post));
            let is_near = at.as_dvec2().distance(world) <= reach_m;
            if is_near && highest.map_or(height.is_finite(), |(other, _)| height > other) {
                highest = Some((height, at));
            }
        }
    }
    highest.map(|(_, at)| at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_height_is_no_name() {
        assert_eq!(peak_name("Cross Mountain\n1076 m"), Some("Cross Mountain"));
        assert_eq!((peak_name("1076 m"), peak_name("  \n"), peak_name("")), (None, None, None));
        assert_eq!(peak_name("K2\n8611 m"), None, "a letter alone is a unit");
        assert_eq!(peak_name("Piz\n"), Some("Piz"));
    }

    #[test]
    fn a_name_belongs_to_the_highest_post_near_it() {
        let mut heights = vec![10.0; 25];
        (heights[7], heights[13]) = (30.0, 40.0);
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(100.0), 5, heights).expect("a lattice");
        let near = |x: f64, y: f64, reach_m: f64| highest_near(&lattice, DVec2::new(x, y), reach_m);
        assert_eq!(near(210.0, 110.0, 90.0), Some(Vec2::new(200.0, 100.0)));
        assert_eq!(near(210.0, 110.0, 150.0), Some(Vec2::new(300.0, 200.0)));
        assert_eq!(near(-900.0, 110.0, 50.0), None);
    }

    #[test]
    fn texts_have_elevation_and_distance() {
        let peak = Peak {
            name: Some("Signal".into()),
            world: Vec3::ZERO,
            elevation_m: 812.4,
            distance_m: 12_340.0,
            prominence_m: 90.0,
            is_in_sight: true,
        };
        assert_eq!(peak.text(), "Signal\n812 m, 12.3 km");
        assert_eq!(Peak { name: None, distance_m: 120_400.0, ..peak }.text(), "812 m\n120 km");
    }
}
