//! The longitudinal profiles of roads that the ground follows, with ground and design along them, and of bridges.

use std::fmt::Write;

use sandtable_base::message::numbers::fixed;
use sandtable_draw::list::FeatureId;
use sandtable_earthworks::alignment::Support;
use sandtable_geom::polyline::Polyline;
use sandtable_geom::profile::Profile;
use sandtable_ribbon::texture::RibbonSurface;

/// A road's longitudinal profile.
#[derive(Clone, Debug, PartialEq)]
pub struct RoadProfile {
    /// The road.
    pub feature: FeatureId,
    /// Its name; may be empty.
    pub name: String,
    /// Its centerline in world coordinates.
    pub line: Polyline,
    /// The ground on the centerline before the road was built, in meters; NaN where there is none.
    pub ground: Profile,
    /// The road's level on the centerline in meters, at the same stations.
    pub design: Profile,
    /// What carries the road at each station; where that changes, what carries it from there.
    pub supports: Vec<Support>,
}

/// The longitudinal profile of a bridge.
#[derive(Clone, Debug, PartialEq)]
pub struct BridgeProfile {
    /// The bridge.
    pub feature: FeatureId,
    /// Its centerline in world coordinates.
    pub line: Polyline,
    /// The level of its deck on the centerline in meters.
    pub level: Profile,
    /// What it carries.
    pub surface: RibbonSurface,
    /// The steepest rise that its road states, meters per meter; `None` where it states none.
    pub max_grade: Option<f64>,
}

impl RoadProfile {
    /// The profile as a table of comma-separated values, one line a station in meters to the millimeter, under a line
    /// of names. Nothing stands where there is no ground.
    pub fn csv(&self) -> String {
        let mut text = String::from("station_m,ground_m,design_m,carried\n");
        for (index, station_m) in self.design.stations().iter().enumerate() {
            let ground = Some(self.ground.values()[index]).filter(|ground| !ground.is_nan());
            let ground = ground.map(|ground| fixed(ground, 3)).unwrap_or_default();
            let (design_m, support) = (fixed(self.design.values()[index], 3), self.supports[index].word());
            writeln!(text, "{station_m:.3},{ground},{design_m},{support}")
                .expect("text takes all that is written");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    #[test]
    fn a_profile_s_table_has_a_line_a_station() {
        let profile = RoadProfile {
            feature: FeatureId(2),
            name: "pass road".into(),
            line: Polyline::new([DVec2::ZERO, DVec2::X * 12.5], 0.0).expect("a line"),
            ground: Profile::straight(12.5, [101.25, f64::NAN]),
            design: Profile::straight(12.5, [101.25, 102.0]),
            supports: vec![Support::Ground, Support::Bridge],
        };
        let table =
            "station_m,ground_m,design_m,carried\n0.000,101.250,101.250,ground\n12.500,,102.000,bridge\n";
        assert_eq!(profile.csv(), table);
    }
}
