//! Coasts: the sea ends where their lines run.

use glam::DVec2;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::query::{Interpolation, ground_height};

use crate::common::data::data;
use crate::common::scratch::Scratch;
use crate::water::over_grid_in;

/// A scene over 31 × 31 posts 90 m apart that rise northward from a sea of zeros, from `text` after its `dem` and `crs`.
fn shore(text: &str) -> Result<SceneModel, String> {
    shore_in(&Scratch::new(), text)
}

/// The same, beside the files of a folder.
fn shore_in(folder: &Scratch, text: &str) -> Result<SceneModel, String> {
    let height = |index: u32| ((20 - (index / 31) as i32).max(0) * 6).to_string();
    let heights: Vec<String> = (0..31 * 31).map(height).collect();
    over_grid_in(folder, "xllcorner -45\nyllcorner -45\ncellsize 90", &heights, text)
}

/// A coast from east to west, land in the north, with a mole 30 m wide that reaches 400 m out to sea.
const MOLE: &str = "[[coast]]\npoints = [[-100, 1000], [1000, 1000], [1000, 600], [1030, 600], [1030, 1000], [2900, 1000]]\n";

fn is_sea(scene: &SceneModel, x: f64, y: f64) -> bool {
    scene.water().is_under(&scene.lattice, DVec2::new(x, y) - scene.lattice.origin())
}

#[test]
fn a_mole_narrower_than_a_cell_stands_in_the_sea() {
    let scene = shore(MOLE).expect("sound");
    assert!(scene.has_sea() && scene.lattice.cell().max_element() <= 10.0);
    for (x, y, expected) in [
        (1015.0, 700.0, false),
        (1015.0, 560.0, true),
        (970.0, 700.0, true),
        (1060.0, 700.0, true),
        // The model has the sea up to 900 m, and 6 m of land at 990 m.
        (500.0, 980.0, true),
        (500.0, 1020.0, false),
        (2000.0, 2500.0, false),
    ] {
        assert_eq!(is_sea(&scene, x, y), expected, "at {x}, {y}");
    }
    let told =
        scene.notes().into_iter().find(|note| note.contains("the sea ends at 1 coastline")).expect("a note");
    assert!(told.contains("of land are raised to 0.5 m"), "{told}");
}

#[test]
fn land_of_a_coast_that_the_model_has_as_sea_is_raised_by_the_least() {
    let scene = shore("[[coast]]\npoints = [[-100, 400], [2900, 400]]\n").expect("sound");
    let at = |y: f64| {
        let place = DVec2::new(1000.0, y);
        ground_height(&scene.lattice, Interpolation::Bilinear, place).height_m().expect("on the ground")
    };
    assert_eq!((at(200.0), at(600.0)), (0.0, 0.5));
    assert!(!is_sea(&scene, 1000.0, 600.0) && is_sea(&scene, 1000.0, 300.0));
}

#[test]
fn a_coast_the_wrong_way_round_is_an_error_at_its_table() {
    let refused =
        shore("[[coast]]\npoints = [[2900, 1600], [-100, 1600]]\n").err().expect("land on the right");
    assert!(refused.contains("scene.toml:5:"), "{refused}");
    assert!(refused.contains("a coastline has the land on its left"), "{refused}");
    assert!(refused.contains("reverse the lines"), "{refused}");
}

/// The heights of the ground of [`shore`] with the coast of a GeoJSON geometry and these keys, or the error, and the notes.
fn along_file(geometry: &str, keys: &str) -> Result<(Vec<f32>, Vec<String>), String> {
    let folder = Scratch::new();
    let feature = format!(r#"{{"type": "Feature", "properties": {{}}, "geometry": {geometry}}}"#);
    folder.write("coast.geojson", &feature);
    let text = format!("[[coast]]\nfile = \"coast.geojson\"\ncrs = \"EPSG:32633\"\n{keys}");
    let scene = shore_in(&folder, &text)?;
    Ok((scene.lattice.heights().to_vec(), scene.notes().into_iter().map(str::to_owned).collect()))
}

#[test]
fn a_coast_is_the_same_as_a_line_as_polygons_of_the_sea_and_as_one_of_land() {
    const COURSE: &str = "[-300, 1003], [997, 1001], [1001, 604], [1033, 601], [1029, 1002], [3300, 1004]";
    let line = format!(r#"{{"type": "LineString", "coordinates": [{COURSE}]}}"#);
    let (by_line, _) = along_file(&line, "").expect("sound");
    // Two tiles that share an edge, as those of osmdata do.
    let sea = r#"{"type": "MultiPolygon", "coordinates": [
        [[[-300, 1003], [-300, -500], [500, -500], [500, 1001.766384], [-300, 1003]]],
        [[[500, 1001.766384], [500, -500], [3300, -500], [3300, 1004], [1029, 1002], [1033, 601], [1001, 604],
        [997, 1001], [500, 1001.766384]]]]}"#;
    let (by_sea, notes) = along_file(sea, "").expect("sound");
    assert!(by_sea == by_line);
    let told = notes.iter().find(|note| note.contains("the sea ends at 2 polygons of the sea: "));
    assert!(told.is_some_and(|note| note.contains("of land are raised to 0.5 m")), "{notes:?}");
    let land = format!(
        r#"{{"type": "Polygon", "coordinates": [[{COURSE}, [3300, 4000], [-300, 4000], [-300, 1003]]]}}"#
    );
    assert!(along_file(&land, "inside = \"land\"\n").expect("sound").0 == by_line);
    let refused = along_file(&land, "").expect_err("the sea would lie on the hills");
    assert!(refused.contains("the ground of the sea that the polygons tell lies"), "{refused}");
    assert!(refused.contains("state `inside = \"land\"`"), "{refused}");
}

#[test]
fn what_lies_inside_a_line_is_refused() {
    let refused = shore(&format!("{MOLE}inside = \"land\"\n")).err().expect("there is no inside");
    assert!(refused.contains("`inside` has no effect on a line"), "{refused}");
}

#[test]
fn buildings_and_streets_of_a_town_at_the_sea_stand_on_land() {
    let Some(osm) = data("scenes/monaco/monaco.osm.gz") else { return };
    let dem = data("scenes/monaco/N43E007.hgt.zip").expect("beside it");
    let folder = Scratch::new();
    let text = format!(
        "[terrain]\ndem = {dem:?}\nextent = [[371500, 4842100], [374600, 4845500]]\n\
         [[coast]]\nfile = {osm:?}\nlayer = \"lines\"\nwhere = \"natural = 'coastline'\"\n\
         [[building]]\nfile = {osm:?}\nlayer = \"multipolygons\"\nwhere = \"building\"\n"
    );
    let path = folder.write("scene.toml", &text);
    let scene = sandtable_scene::scene_file::open_scene(
        &path,
        &[osm.parent().expect("a folder").to_owned()],
        &|_| {},
    )
    .unwrap_or_else(|failure| panic!("{failure:?}"));
    let map = |longitude: f64, latitude: f64| {
        let wgs84 = sandtable_geom::crs::Crs::wgs84();
        let at = wgs84.transform(&scene.crs, DVec2::new(longitude, latitude)).expect("on Earth");
        at - scene.lattice.origin()
    };
    let is_sea = |at: DVec2| scene.water().is_under(&scene.lattice, at);
    // Port Hercule, the harbor of Fontvieille, and the open sea; the palace on its rock, the stadium, the casino.
    for (longitude, latitude) in [(7.4255, 43.7353), (7.4205, 43.7290), (7.44, 43.73)] {
        assert!(is_sea(map(longitude, latitude)), "{longitude}, {latitude}");
    }
    for (longitude, latitude) in [(7.4235, 43.7297), (7.4203, 43.7314), (7.4155, 43.7276), (7.4282, 43.7396)]
    {
        assert!(!is_sea(map(longitude, latitude)), "{longitude}, {latitude}");
    }
    assert!(scene.features.len() > 900, "{}", scene.features.len());
}
