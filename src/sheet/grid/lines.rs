//! The lines of a grid in world X and Y.
//!
//! A line is straight in its own system and a curve in the scene's: it is sampled so finely that it is straight between two
//! points. Where a scene lies in several zones of UTM each zone has its own lines, which end where the zone ends.

use std::collections::BTreeSet;

use glam::DVec2;

use crate::grid::curve::parts_within;
use crate::grid::extent::{box_around, geographic_box, places, places_on_earth, wrapped_deg};
use crate::grid::system::{GridInterval, figures};
use sandtable_annotate::figure::CoordinateFigure;
use sandtable_annotate::grid::GridAxis;
use sandtable_description::words::GridName;
use sandtable_geom::crs::Crs;
use sandtable_geom::mgrs::{GridSquare, GridZone};
use sandtable_geom::rect::Rect;
use sandtable_scene::scene_model::SceneModel;

/// By how much a line may miss its place between two points, of the longer side of the scene: less than a tenth of a pixel
/// of any picture.
const MISS_SHARE: f64 = 2e-6;
/// The meters of a second of arc along a meridian.
const SECOND_M: f64 = 30.87;
/// The radius of the Earth, meters.
const EARTH_M: f64 = 6_371_000.0;

/// A grid over the ground of a scene.
pub struct GroundGrid {
    /// Its lines.
    pub lines: Vec<GroundLine>,
    /// The systems that its lines keep a coordinate of.
    pub systems: Vec<Crs>,
    /// Meters from line to line, of those that keep an easting and of those that keep a northing.
    pub apart_m: [f64; 2],
    /// One in this many lines is an index line.
    pub index_every: i64,
    /// What it is, such as `MGRS grid 1 km · 16S GF`.
    pub note: String,
    /// Whether the scene lies in several squares, which need their letters.
    pub has_squares: bool,
    /// Where meridians meet: world X and Y of the poles, for a geographic grid.
    poles: Vec<DVec2>,
}

/// One line of a grid.
pub struct GroundLine {
    /// The coordinate that it keeps.
    pub axis: GridAxis,
    /// What that coordinate is: meters, or degrees of a geographic grid.
    pub value: f64,
    /// Its system among [`GroundGrid::systems`].
    pub system: usize,
    /// Its parts on the model: world X and Y.
    pub parts: Vec<Vec<DVec2>>,
    /// Whether it is an index line.
    pub is_index: bool,
    /// Its number.
    pub figure: CoordinateFigure,
    /// Its number in full.
    pub full: CoordinateFigure,
}

impl GroundGrid {
    /// Meters from `line` to the next of its kind at a place in world X and Y.
    pub fn apart_m(&self, line: &GroundLine, at: DVec2) -> f64 {
        let apart_m = self.apart_m[line.axis as usize];
        if line.axis == GridAxis::North {
            return apart_m;
        }
        let turn = self.apart_m[GridAxis::North as usize] / EARTH_M;
        self.poles.iter().map(|pole| turn * pole.distance(at)).fold(apart_m, f64::min)
    }
}

/// The system of some of a grid's lines.
struct GridFrame {
    crs: Crs,
    /// The zone outside of which lines are not drawn.
    zone: Option<GridZone>,
    /// The unit of intervals in that of the system.
    unit: f64,
    /// The scene in it; empty where it has no place there.
    extent: Rect,
}

/// The scene's grid, its lines no nearer than `wanted_m` where no interval is stated; `None` where it has none, or its
/// system has no place on Earth.
pub fn ground_grid(scene: &SceneModel, wanted_m: f64) -> Option<GroundGrid> {
    let name = scene.grid;
    if name == GridName::None {
        return None;
    }
    let zones = zones(scene);
    let frames = frames(scene, &zones);
    let is_geographic = name == GridName::Geographic;
    let span = frames.iter().map(|frame| frame.extent.size().max_element() / frame.unit).reduce(f64::max)?;
    let wanted = if is_geographic { wanted_m / SECOND_M } else { wanted_m };
    let stated =
        scene.furniture.grid_interval.map(|stated| if is_geographic { stated * 60.0 } else { stated });
    let interval = GridInterval::choose(name, stated, wanted, span)?;
    let world = WorldPlaces::new(scene);
    let mut lines = Vec::new();
    for (system, frame) in frames.iter().enumerate() {
        for axis in [GridAxis::East, GridAxis::North] {
            add_lines(&mut lines, &world, name, (system, frame), axis, interval);
        }
    }
    let middle = frames[0].extent.center();
    let narrowing = if is_geographic { libm::cos(middle.y.to_radians()).max(0.01) } else { 1.0 };
    let meters = if is_geographic { SECOND_M } else { 1.0 };
    let squares = if name == GridName::Mgrs { squares(scene) } else { BTreeSet::new() };
    let poles = [-90.0, 90.0].into_iter().filter(|_| is_geographic);
    let poles = poles.filter_map(|latitude| world.of(&Crs::wgs84(), DVec2::new(middle.x, latitude)));
    Some(GroundGrid {
        lines,
        poles: poles.collect(),
        systems: frames.iter().map(|frame| frame.crs.clone()).collect(),
        apart_m: [interval.value * meters * narrowing, interval.value * meters],
        index_every: interval.index_every,
        note: note(name, interval, &zones, &squares, &scene.crs),
        has_squares: squares.len() > 1,
    })
}

/// The systems of the scene's grid in which it has a place.
fn frames(scene: &SceneModel, zones: &BTreeSet<GridZone>) -> Vec<GridFrame> {
    let zone_frame = |&zone: &GridZone| {
        let crs = zone.crs()?;
        let own = places_on_earth(scene).filter(|place| GridZone::at(*place) == Some(zone));
        let extent = box_around(own.filter_map(|place| Crs::wgs84().transform(&crs, place).ok()));
        Some(GridFrame { crs, zone: Some(zone).filter(|_| zones.len() > 1), unit: 1.0, extent })
    };
    let frames: Vec<GridFrame> = match scene.grid {
        GridName::None | GridName::Metric => {
            let crs = scene.crs.clone();
            vec![GridFrame { crs, zone: None, unit: 1.0, extent: scene.lattice.map_extent() }]
        }
        GridName::Geographic => {
            let extent = geographic_box(scene);
            vec![GridFrame { crs: Crs::wgs84(), zone: None, unit: 1.0 / 3600.0, extent }]
        }
        GridName::Utm | GridName::Mgrs => zones.iter().filter_map(zone_frame).collect(),
    };
    frames.into_iter().filter(|frame| !frame.extent.is_empty()).collect()
}

fn add_lines(
    lines: &mut Vec<GroundLine>,
    world: &WorldPlaces<'_>,
    name: GridName,
    (system, frame): (usize, &GridFrame),
    axis: GridAxis,
    interval: GridInterval,
) {
    let (along, across) = if axis == GridAxis::East { (1, 0) } else { (0, 1) };
    let step = interval.value * frame.unit;
    let (low, high) = (frame.extent.min[across], frame.extent.max[across]);
    let counts = match (name, axis) {
        (GridName::Geographic, GridAxis::East) => meridians(low, high, step),
        _ => (libm::ceil(low / step) as i64..=libm::floor(high / step) as i64).collect(),
    };
    let rect = world.scene.lattice.extent();
    let miss_m = rect.size().max_element() * MISS_SHARE;
    for count in counts {
        let value = count as f64 * step;
        let at = |share: f64| {
            let mut at = DVec2::splat(value);
            at[along] = frame.extent.min[along] + frame.extent.size()[along] * share;
            world.of_frame(frame, at)
        };
        let parts = parts_within(&rect, &at, miss_m);
        if parts.is_empty() {
            continue;
        }
        let [figure, full] = figures(name, axis, count as f64 * interval.value, interval);
        let is_index = count.rem_euclid(interval.index_every) == 0;
        lines.push(GroundLine { axis, value, system, parts, is_index, figure, full });
    }
}

/// The meridians between two longitudes, eastward from the western one, in steps from Greenwich: −180 exclusive to 180
/// inclusive.
fn meridians(west: f64, east: f64, step: f64) -> Vec<i64> {
    let mut counts = Vec::new();
    for turn in [-360.0, 0.0, 360.0] {
        let (low, high) = (west.max(turn - 180.0) - turn, east.min(turn + 180.0) - turn);
        let (first, last) = (libm::ceil(low / step) as i64, libm::floor(high / step) as i64);
        counts.extend((first..=last).filter(|&count| count as f64 * step > -180.0 + 1e-9 * step));
    }
    // All round the Earth the first is the last again.
    let is_round = counts.len() > 1 && counts.first() == counts.last();
    counts.truncate(counts.len() - usize::from(is_round));
    counts
}

/// Places of a grid's systems in the world space of a scene.
struct WorldPlaces<'a> {
    scene: &'a SceneModel,
    /// What eastings grow by once round the Earth, where the scene reaches beyond the border of its system.
    round_m: Option<f64>,
}

impl<'a> WorldPlaces<'a> {
    fn new(scene: &'a SceneModel) -> Self {
        let wgs84 = Crs::wgs84();
        let round_m = places(scene).find_map(|at| {
            let place = scene.crs.transform(&wgs84, at).ok()?;
            let off = (wgs84.transform(&scene.crs, place).ok()? - at).abs();
            // A system without such a border gives every place back.
            (off.x > EARTH_M && off.y < 1.0).then_some(off.x)
        });
        Self { scene, round_m }
    }

    /// World X and Y of a point of a system.
    fn of(&self, crs: &Crs, at: DVec2) -> Option<DVec2> {
        let mut map = crs.transform(&self.scene.crs, at).ok()?;
        if let Some(round_m) = self.round_m {
            let middle = self.scene.lattice.map_extent().center();
            map.x += libm::round((middle.x - map.x) / round_m) * round_m;
        }
        Some(map - self.scene.lattice.origin())
    }

    /// World X and Y of a point of a frame; `None` outside its zone.
    fn of_frame(&self, frame: &GridFrame, at: DVec2) -> Option<DVec2> {
        if let Some(zone) = frame.zone {
            let place = frame.crs.transform(&Crs::wgs84(), at).ok()?;
            GridZone::at(place).filter(|other| *other == zone)?;
        }
        let is_geographic = frame.crs.is_geographic();
        self.of(&frame.crs, if is_geographic { DVec2::new(wrapped_deg(at.x), at.y) } else { at })
    }
}

fn zones(scene: &SceneModel) -> BTreeSet<GridZone> {
    places_on_earth(scene).filter_map(GridZone::at).collect()
}

fn squares(scene: &SceneModel) -> BTreeSet<GridSquare> {
    places_on_earth(scene).filter_map(GridSquare::at).collect()
}

fn note(
    name: GridName,
    interval: GridInterval,
    zones: &BTreeSet<GridZone>,
    squares: &BTreeSet<GridSquare>,
    crs: &Crs,
) -> String {
    /// More names are not listed.
    const MOST: usize = 3;
    let every = interval.in_words(name);
    let listed = |names: Vec<String>| if names.len() > MOST { String::new() } else { names.join(", ") };
    let (kind, place) = match name {
        GridName::Mgrs => {
            let named = |square: &GridSquare| format!("{} {}", square.designation, square.letters);
            ("MGRS grid", listed(squares.iter().map(named).collect()))
        }
        GridName::Utm => ("UTM grid", listed(zones.iter().map(|zone| zone.name()).collect())),
        GridName::Geographic => ("Grid", "WGS 84".to_owned()),
        GridName::Metric | GridName::None => {
            ("Grid", if crs.proj_text().is_empty() { String::new() } else { crs.name().to_owned() })
        }
    };
    if place.is_empty() { format!("{kind} {every}") } else { format!("{kind} {every} · {place}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meridians_are_counted_from_greenwich_on_both_sides_of_180_degrees() {
        let minutes = |west: f64, east: f64, step: f64| -> Vec<f64> {
            meridians(west, east, step / 60.0).iter().map(|&count| count as f64 * step).collect()
        };
        assert_eq!(minutes(179.5, 180.5, 15.0), [10770.0, 10785.0, 10800.0, -10785.0, -10770.0]);
        assert_eq!(minutes(-0.3, 0.3, 15.0), [-15.0, 0.0, 15.0]);
        // 180° is no multiple of 7′: the next after 179° 54′ E is 179° 54′ W.
        assert_eq!(minutes(179.85, 180.15, 7.0), [10794.0, -10794.0]);
        let all = meridians(-180.0, 180.0, 30.0);
        assert_eq!((all.len(), all[0], all[11]), (12, 6, 5));
        assert_eq!(meridians(170.0, 170.0 + 359.0, 90.0), [2, -1, 0, 1]);
    }
}
