//! What a new scene says of buildings: how they stand on coarse ground, and how tall they are where no data tell.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::rules::{CITY_JSON, TableRule};
use sandtable_geom::crs::Crs;
use sandtable_geom::polygon;
use sandtable_structure::building::STORY_M;
use sandtable_vector::feature::{Feature, Polygon};

/// The buildings of a layer.
pub(super) struct SurveyedBuildings {
    /// Evenly chosen outlines without courtyards, up to [`MOST_OUTLINES`], in the system of the layer.
    outlines: Vec<Vec<DVec2>>,
    /// How many buildings each outline stands for.
    step: usize,
    /// Whether a property of any of them tells a height.
    tell_heights: bool,
}

/// As many buildings tell how close they stand.
const MOST_OUTLINES: usize = 1 << 15;

/// The properties that tell a height, by Simple 3D Buildings.
const HEIGHTS: [&str; 4] = ["height", "building:levels", "levels", "roof:levels"];

/// The posts of elevation that are called coarse lie as far apart as buildings are wide, or farther, meters.
const COARSE_M: f64 = 20.0;

/// The side of the squares in which the share of built ground is taken, meters: a block of streets or two.
const SQUARE_M: f64 = 200.0;

/// The least share of built ground in a town whose houses stand wall to wall; suburbs of single houses have 0.1 to 0.2.
const TOWN_SHARE: f64 = 0.25;

/// The stories of a house in such a town.
const TOWN_STORIES: f64 = 5.0;

impl SurveyedBuildings {
    /// Of the features that a table of buildings takes.
    pub fn new<'a>(features: impl Iterator<Item = &'a Feature> + Clone) -> Self {
        let tells = |feature: &Feature| HEIGHTS.iter().any(|key| feature.properties.contains_key(*key));
        let tell_heights = features.clone().any(tells);
        let outlines = || features.clone().flat_map(Feature::polygons);
        let step = outlines().count().div_ceil(MOST_OUTLINES).max(1);
        let outline = |polygon: &Polygon| polygon.exterior.clone();
        Self { outlines: outlines().step_by(step).map(outline).collect(), step, tell_heights }
    }

    /// The share of built ground around a building, from 0 to 1, in `scene`, a metric system; 0 where no outline has a
    /// place in it.
    fn built_share(&self, layer: &Crs, scene: &Crs) -> f64 {
        let mut squares = BTreeMap::<[i64; 2], f64>::new();
        for outline in &self.outlines {
            let ring: Result<Vec<DVec2>, _> = outline.iter().map(|at| layer.transform(scene, *at)).collect();
            let Some((ring, first)) = ring.ok().and_then(|ring| ring.first().copied().map(|at| (ring, at)))
            else {
                continue;
            };
            let square = (first / SQUARE_M).floor().to_array().map(|index| index as i64);
            *squares.entry(square).or_default() +=
                polygon::doubled_area(&ring).abs() / 2.0 * self.step as f64;
        }
        let built_m2: f64 = squares.values().sum();
        let squared: f64 = squares.values().map(|built_m2| built_m2 * built_m2).sum();
        if built_m2 > 0.0 { (squared / built_m2 / (SQUARE_M * SQUARE_M)).min(1.0) } else { 0.0 }
    }

    /// The likely height of buildings of which none tells its own, meters; `None` where some do, and where they do not stand
    /// as close as in a town.
    pub fn likely_height_m(&self, layer: &Crs, scene: &Crs) -> Option<f64> {
        let is_town = || self.built_share(layer, scene) >= TOWN_SHARE;
        (!self.tell_heights && is_town()).then_some(TOWN_STORIES * STORY_M)
    }
}

/// The keys of a table of buildings over elevation with a post every `post_m`; `height_m` is the
/// [likely height](SurveyedBuildings::likely_height_m).
pub(super) fn keys(rule: &TableRule, post_m: f64, height_m: Option<f64>) -> String {
    let mut keys = String::new();
    if rule.what == CITY_JSON {
        return keys;
    }
    if post_m >= COARSE_M {
        keys += &format!(
            "# Heights are known every {post_m:.0} m: at the mean of the ground under it a building does not sink into a slope.\n\
             base = \"mean\"\n"
        );
    }
    let states_height = rule.keys.iter().any(|key| key.starts_with("height"));
    if let Some(height_m) = height_m.filter(|_| !states_height) {
        keys += &format!(
            "# None tells its height. They stand as close as in a town, where {TOWN_STORIES} stories are likely.\n\
             height = {height_m}\n"
        );
    }
    keys
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_vector::feature::Geometry;

    /// Houses of 20 m by 20 m, `step_m` apart, 40 by 40 of them.
    fn houses(step_m: f64, properties: &str) -> Vec<Feature> {
        let house = |index: usize| {
            let low = DVec2::new(500_000.0, 4_000_000.0)
                + DVec2::new((index % 40) as f64, (index / 40) as f64) * step_m;
            let exterior =
                [[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [0.0, 20.0]].map(|at| low + DVec2::from(at)).to_vec();
            Feature {
                geometry: Geometry::Polygons(vec![Polygon { exterior, holes: Vec::new() }]),
                elevations: None,
                properties: serde_json::from_str(properties).expect("an object"),
            }
        };
        (0..1600).map(house).collect()
    }

    fn likely_m(step_m: f64, properties: &str) -> Option<f64> {
        let utm = Crs::from_epsg(32632).expect("known");
        SurveyedBuildings::new(houses(step_m, properties).iter()).likely_height_m(&utm, &utm)
    }

    #[test]
    fn houses_of_a_town_are_likely_taller_unless_one_tells_its_height() {
        assert_eq!(likely_m(25.0, "{}"), Some(15.0), "0.64 of the ground is built");
        assert_eq!(likely_m(60.0, "{}"), None, "0.11 of the ground is built");
        assert_eq!(likely_m(25.0, r#"{"building:levels": "2"}"#), None, "they tell it");
    }

    #[test]
    fn the_share_of_built_ground_is_that_of_the_squares() {
        let utm = Crs::from_epsg(32632).expect("known");
        let share = SurveyedBuildings::new(houses(40.0, "{}").iter()).built_share(&utm, &utm);
        assert!((share - 0.25).abs() < 1e-9, "{share}");
        let nowhere = SurveyedBuildings::new([].iter());
        assert_eq!(nowhere.built_share(&utm, &utm), 0.0);
    }
}
