//! Numbers of grids stand at the ends of their lines: in many systems, and where the data do not fill the rectangle.

use std::collections::BTreeSet;
use std::fmt::Write;

use glam::DVec2;
use sandtable_annotate::figure::CoordinateFigure;
use sandtable_annotate::grid::GridAxis;
use sandtable_annotate::placed_figure::PlacedFigure;
use sandtable_geom::crs::Crs;
use sandtable_render::RenderBackend;
use sandtable_render::picture::Rendering;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;
use sandtable_sheet::grid::check::check_figures;
use sandtable_sheet::grid::grid_over;
use sandtable_sheet::grid::lines::GroundGrid;
use sandtable_sheet::picture::{PictureSize, annotate_view, draw_view};
use sandtable_view::camera::Camera;

use crate::common::scratch::Scratch;

/// Posts along each side.
const POSTS: u32 = 49;

/// Where the data are, of the rectangle: shares eastward and northward.
type DataShape = fn(DVec2) -> bool;

const SHAPES: [(&str, DataShape); 6] = [
    ("all", |_| true),
    ("strip", |at| (at.x + at.y - 1.0).abs() < 0.25),
    ("steep strip", |at| (at.x - 0.35 - 0.3 * at.y).abs() < 0.12),
    ("disk", |at| at.distance(DVec2::splat(0.5)) < 0.42),
    ("corner", |at| at.x < 0.3 || at.y < 0.25),
    ("island", |at| at.distance(DVec2::new(0.7, 0.35)) < 0.2),
];

/// Systems, each with a place on Earth and the side of the scene in meters.
const SYSTEMS: [(u32, (f64, f64), f64); 12] = [
    (32633, (15.0, 45.0), 40_000.0),
    (32616, (-84.2, 36.3), 12_000.0),
    (32601, (-180.0, 66.0), 40_000.0),
    (32733, (17.9, -33.9), 60_000.0),
    (32632, (12.0, 58.0), 30_000.0),
    (3413, (21.0, 84.5), 120_000.0),
    (3413, (-120.0, 89.8), 150_000.0),
    (3031, (170.0, -78.0), 90_000.0),
    (3035, (-8.0, 40.0), 80_000.0),
    (2154, (7.5, 48.0), 50_000.0),
    (3857, (9.0, 60.0), 70_000.0),
    (27700, (-5.7, 50.1), 20_000.0),
];

struct GridCase<'a> {
    crs: u32,
    place: (f64, f64),
    side_m: f64,
    shape: DataShape,
    grid: &'a str,
    interval: Option<f64>,
    layout: &'a str,
}

struct NumberedPicture {
    scene: SceneModel,
    camera: Camera,
    picture: Rendering,
    grid: GroundGrid,
    figures: Vec<PlacedFigure>,
}

impl GridCase<'_> {
    fn scene(&self) -> SceneModel {
        let crs = Crs::from_epsg(self.crs).expect("in the table");
        let middle = Crs::wgs84().transform(&crs, self.place.into()).expect("within the system");
        let cell = self.side_m / f64::from(POSTS - 1);
        let corner = middle - self.side_m / 2.0;
        let mut dem = format!(
            "ncols {POSTS}\nnrows {POSTS}\nxllcenter {:.3}\nyllcenter {:.3}\ncellsize {cell}\nNODATA_value -9999\n",
            corner.x, corner.y
        );
        for index in 0..POSTS * POSTS {
            let (column, row) = (f64::from(index % POSTS), f64::from(index / POSTS));
            let share = DVec2::new(column, f64::from(POSTS - 1) - row) / f64::from(POSTS - 1);
            let height = 200.25 + 60.0 * libm::sin(column * 0.2) * libm::cos(row * 0.15);
            let height = if (self.shape)(share) { height } else { -9999.0 };
            let _ = write!(dem, "{height:.2} ");
        }
        let Self { grid, layout, .. } = self;
        let interval = self.interval.map(|every| format!("grid_interval = {every}\n")).unwrap_or_default();
        let text = format!(
            "title = \"Grid\"\n[terrain]\ndem = \"dem.asc\"\ncrs = \"EPSG:{}\"\ninfer_water = false\n\
             [furniture]\nlayout = \"{layout}\"\ngrid = \"{grid}\"\n{interval}\
             [[camera]]\nname = \"plan\"\nprojection = \"plan\"\n\
             [[camera]]\nname = \"turned\"\nprojection = \"plan\"\nazimuth = 50\n\
             [[camera]]\nname = \"oblique\"\nprojection = \"oblique\"\nazimuth = 30\n\
             [[camera]]\nname = \"slanting\"\nprojection = \"orthographic\"\nazimuth = 200\npitch = 35\n",
            self.crs
        );
        let folder = Scratch::new();
        folder.write("dem.asc", dem);
        open_scene(&folder.write("scene.toml", text), &[], &|_| ()).expect("sound")
    }

    fn picture(&self, camera: &str) -> NumberedPicture {
        numbered(self.scene(), camera, PictureSize { width: 480, height: 400 })
    }
}

fn numbered(scene: SceneModel, camera: &str, size: PictureSize) -> NumberedPicture {
    let view = scene.view(Some(camera)).expect("a camera of the scene").clone();
    let drawn = draw_view(&scene, &view, size, RenderBackend::Cpu, &|_| ()).expect("sound");
    let (camera, picture) = (drawn.camera, drawn.picture.clone());
    let grid = grid_over(&scene, &camera, &picture).expect("the scene has a grid");
    let figures = annotate_view(&scene, drawn, &|_| ()).annotations.figures;
    NumberedPicture { scene, camera, picture, grid, figures }
}

impl NumberedPicture {
    /// How many numbers there are, all of them at their lines.
    fn checked(&self, what: &str) -> usize {
        check_figures(&self.figures, &self.grid, &self.scene, (&self.camera, &self.picture))
            .unwrap_or_else(|error| panic!("{what}: {error}"))
    }

    fn texts(&self) -> BTreeSet<String> {
        let text = |placed: &PlacedFigure| match &placed.figure {
            CoordinateFigure::Plain(text) => text.clone(),
            CoordinateFigure::Military { before, principal, after } => {
                [before.as_str(), principal, after].concat()
            }
        };
        self.figures.iter().map(text).collect()
    }
}

#[test]
fn numbers_stand_at_their_lines_in_all_systems_and_shapes() {
    let mut count = 0;
    for (index, (crs, place, side_m)) in SYSTEMS.into_iter().enumerate() {
        for (turn, grid) in ["geographic", "utm", "mgrs", "metric"].into_iter().enumerate() {
            let (shape_name, shape) = SHAPES[(index + turn) % SHAPES.len()];
            let layout = ["compact", "margin"][(index + turn) % 2];
            let case = GridCase { crs, place, side_m, shape, grid, interval: None, layout };
            let camera = ["plan", "turned", "oblique", "slanting"][(index / 2 + turn) % 4];
            for camera in ["plan", camera] {
                let what = format!("{crs} at {place:?}, {shape_name}, {grid}, {camera}");
                let own = case.picture(camera).checked(&what);
                assert!(own >= 2 || shape_name == "island", "{what}: {own} numbers");
                count += own;
            }
        }
    }
    assert!(count > 800, "{count} numbers");
}

#[test]
fn a_slanting_strip_has_both_coordinates_where_its_lines_end() {
    // Two degrees of longitude by one of latitude, as a strip of EPSG:3413.
    let shape: DataShape = |at| (at.x + at.y - 1.0).abs() < 0.25;
    let case = GridCase {
        crs: 3413,
        place: (21.0, 84.5),
        side_m: 120_000.0,
        shape,
        grid: "geographic",
        interval: Some(10.0),
        layout: "compact",
    };
    let numbered = case.picture("plan");
    numbered.checked("strip");
    let axes: BTreeSet<GridAxis> = numbered
        .figures
        .iter()
        .filter_map(|figure| numbered.grid.lines.get(figure.line?))
        .map(|line| line.axis)
        .collect();
    assert_eq!(axes.len(), 2, "{:?}", numbered.texts());
}

#[test]
fn the_check_finds_a_number_beside_its_line() {
    let case = GridCase {
        crs: 32633,
        place: (15.0, 45.0),
        side_m: 40_000.0,
        shape: SHAPES[1].1,
        grid: "utm",
        interval: None,
        layout: "compact",
    };
    let sound = case.picture("plan");
    sound.checked("as it is");
    let fails = |figures: &[PlacedFigure]| {
        check_figures(figures, &sound.grid, &sound.scene, (&sound.camera, &sound.picture)).is_err()
    };
    let changed = |change: &dyn Fn(&mut PlacedFigure)| {
        let mut figures = sound.figures.clone();
        change(&mut figures[0]);
        figures
    };
    let axis = sound.grid.lines[sound.figures[0].line.expect("of a line")].axis;
    let aside = if axis == GridAxis::East { glam::Vec2::X } else { glam::Vec2::Y } * 12.0;
    assert!(fails(&changed(&|figure| figure.at_px += aside)));
    assert!(fails(&changed(&|figure| (figure.min, figure.max) = (figure.min + 60.0, figure.max + 60.0))));
    let next = |figure: &mut PlacedFigure| figure.line = figure.line.map(|line| line + 1);
    assert!(fails(&changed(&next)));
    assert!(fails(&changed(&|figure| figure.figure = "9".to_owned().into())));
}

#[test]
fn a_geographic_grid_across_180_degrees_has_all_its_lines() {
    let case = GridCase {
        crs: 32601,
        place: (-180.0, 66.0),
        side_m: 60_000.0,
        shape: |_| true,
        grid: "geographic",
        interval: Some(15.0),
        layout: "compact",
    };
    let numbered = case.picture("plan");
    numbered.checked("across 180°");
    assert_eq!(numbered.grid.note, "Grid 15′ · WGS 84");
    let values = |axis: GridAxis| -> Vec<f64> {
        numbered.grid.lines.iter().filter(|line| line.axis == axis).map(|line| line.value).collect()
    };
    assert_eq!(values(GridAxis::East), [179.5, 179.75, 180.0, -179.75, -179.5]);
    assert_eq!(values(GridAxis::North), [65.75, 66.0, 66.25]);
    assert!(numbered.texts().contains("180°00′"), "{:?}", numbered.texts());
    // Every point between two of a line keeps its latitude, to a meter.
    let scene = &numbered.scene;
    for line in &numbered.grid.lines {
        let axis = if line.axis == GridAxis::East { 0 } else { 1 };
        for pair in line.parts.iter().flat_map(|part| part.windows(2)) {
            let middle = pair[0].midpoint(pair[1]) + scene.lattice.origin();
            let place = scene.crs.transform(&Crs::wgs84(), middle).expect("on Earth");
            let off = (place[axis] - line.value + 180.0).rem_euclid(360.0) - 180.0;
            assert!(off.abs() < 1e-5, "{:?}: {place}", line.figure);
        }
    }
}

#[test]
fn a_grid_round_a_pole_has_all_meridians_and_numbered_rings() {
    let case = GridCase {
        crs: 3413,
        place: (0.0, 90.0),
        side_m: 400_000.0,
        shape: |_| true,
        grid: "geographic",
        interval: Some(60.0),
        layout: "compact",
    };
    let numbered = case.picture("plan");
    numbered.checked("round the pole");
    let meridians = numbered.grid.lines.iter().filter(|line| line.axis == GridAxis::East).count();
    assert_eq!(meridians, 360);
    assert!(numbered.texts().contains("89°N"), "{:?}", numbered.texts());
}
