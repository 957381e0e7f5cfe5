//! The columns of tables that say where a place is: its grid reference, and the height of its ground.

use glam::DVec2;

use crate::land::Land;
use crate::outcome::{GRID_REFERENCE, PropertyValue, TableColumn};
use sandtable_geom::crs::Crs;
use sandtable_geom::mgrs::ZonePoint;
use sandtable_geom::position::notation::spaced;
use sandtable_terrain::query::{Interpolation, ground_height};

/// Digits of an easting and of a northing in a grid reference: ten meters, as a fire mission has them, and finer than the
/// posts of most models lie apart.
const DIGITS: u8 = 4;

/// Where places are, as cells of a table and as properties of features.
pub(crate) struct CenterColumns {
    places: Vec<DVec2>,
    heights_m: Vec<f64>,
    /// The grid reference of each; `None` where the land has no place on Earth.
    references: Option<Vec<String>>,
}

impl CenterColumns {
    /// Those of places on the land.
    pub fn new(land: &Land, places: Vec<DVec2>) -> Self {
        let height = |&at: &DVec2| ground_height(&land.ground, Interpolation::Planar, at).height_m();
        let heights_m = places.iter().map(|at| height(at).unwrap_or(f64::NAN)).collect();
        let references = places.iter().map(|&at| reference(&land.crs, at)).collect();
        Self { places, heights_m, references }
    }

    /// The columns: grid reference and height; easting, northing and height of land that has no place on Earth.
    pub fn columns(&self) -> Vec<TableColumn> {
        let place: &[TableColumn] = match self.references {
            Some(_) => &[TableColumn::new(GRID_REFERENCE, "", 0)],
            None => &[TableColumn::new("east", "m", 0), TableColumn::new("north", "m", 0)],
        };
        place.iter().cloned().chain([TableColumn::new("height", "m", 0)]).collect()
    }

    /// The cells of a place, by its index.
    pub fn cells(&self, index: usize) -> Vec<PropertyValue> {
        let place = match &self.references {
            Some(references) => vec![PropertyValue::Text(references[index].clone())],
            None => self.places[index].to_array().map(PropertyValue::Number).into(),
        };
        place.into_iter().chain([PropertyValue::Number(self.heights_m[index])]).collect()
    }

    /// The properties of a place, by its index: `grid_reference` where it has one, and `height_m`.
    pub fn properties(&self, index: usize) -> Vec<(&'static str, PropertyValue)> {
        let reference = self.references.as_ref().map(|references| references[index].clone());
        let reference = reference.map(|reference| ("grid_reference", PropertyValue::Text(reference)));
        reference.into_iter().chain([("height_m", PropertyValue::Number(self.heights_m[index]))]).collect()
    }
}

/// The grid reference of a place with spaces, such as `16S GF 5000 1800`.
fn reference(crs: &Crs, at: DVec2) -> Option<String> {
    let place = crs.transform(&Crs::wgs84(), at).ok()?;
    Some(spaced(&ZonePoint::of(place)?.reference(DIGITS)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_land::shaped;

    #[test]
    fn a_place_on_earth_has_a_grid_reference_and_local_land_coordinates() {
        let mut land = shaped(3, 3, 10.0, |column, _| column as f32);
        let names = |of: &CenterColumns| of.columns().iter().map(|column| column.name).collect::<Vec<_>>();
        let local = CenterColumns::new(&land, vec![DVec2::new(15.0, 5.0)]);
        assert_eq!(names(&local), ["east", "north", "height"]);
        assert_eq!(local.cells(0), [15.0, 5.0, 1.5].map(PropertyValue::Number));
        let name = |(name, _): &(&'static str, PropertyValue)| *name;
        assert_eq!(local.properties(0).iter().map(name).collect::<Vec<_>>(), ["height_m"]);
        land.crs = Crs::from_epsg(32616).expect("known");
        // Only the system counts: the place is far off the posts, and its height unknown.
        let placed = CenterColumns::new(&land, vec![DVec2::new(750_000.0, 4_018_000.0)]);
        assert_eq!(names(&placed), [GRID_REFERENCE, "height"]);
        assert_eq!(placed.cells(0)[0], PropertyValue::Text("16S GF 5000 1800".into()));
    }
}
