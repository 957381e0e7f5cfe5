//! The lines of a grid in world X and Y.
//!
//! A line is straight in its own system and nearly so in the scene's: it is transformed at some points, and straight
//! between. Where a scene lies in several zones of UTM each zone has its own lines, which end where the zone ends.

use std::collections::BTreeSet;

use glam::DVec2;

use crate::grid::system::{GridInterval, figures};
use sandtable_annotate::figure::CoordinateFigure;
use sandtable_annotate::grid::GridAxis;
use sandtable_description::words::GridName;
use sandtable_geom::crs::Crs;
use sandtable_geom::mgrs::{GridSquare, GridZone};
use sandtable_geom::rect::Rect;
use sandtable_scene::scene_model::SceneModel;

/// Points at which a line is transformed: a line of 100 km is off by less than a meter between them.
const POINTS: u32 = 65;
/// The same where lines end at a zone's edge, which is found to this share of a line.
const ZONE_POINTS: u32 = 1025;
/// Points along each side of the scene that tell what coordinates it has.
const SIDE_POINTS: u32 = 33;
/// The meters of a second of arc along a meridian.
const SECOND_M: f64 = 30.87;

/// A grid over the ground of a scene.
pub struct GroundGrid {
    /// Its lines.
    pub lines: Vec<GroundLine>,
    /// Meters from line to line, of those that keep an easting and of those that keep a northing.
    pub apart_m: [f64; 2],
    /// One in this many lines is an index line.
    pub index_every: i64,
    /// What it is, such as `MGRS grid 1 km · 16S GF`.
    pub note: String,
    /// Whether the scene lies in several squares, which need their letters.
    pub has_squares: bool,
}

/// One line of a grid.
pub struct GroundLine {
    /// The coordinate that it keeps.
    pub axis: GridAxis,
    /// Its parts on the model: world X and Y.
    pub parts: Vec<Vec<DVec2>>,
    /// Whether it is an index line.
    pub is_index: bool,
    /// Its number.
    pub figure: CoordinateFigure,
    /// Its number in full.
    pub full: CoordinateFigure,
}

/// The system of some of a grid's lines.
struct GridFrame {
    crs: Crs,
    /// The zone outside of which lines are not drawn.
    zone: Option<GridZone>,
    /// The unit of intervals in that of the system.
    unit: f64,
}

/// The scene's grid, its lines no nearer than `wanted_m` where no interval is stated; `None` where it has none, or its
/// system has no place on Earth.
pub fn ground_grid(scene: &SceneModel, wanted_m: f64) -> Option<GroundGrid> {
    let name = scene.grid;
    if name == GridName::None {
        return None;
    }
    let zones = zones(scene);
    let frames: Vec<GridFrame> = match name {
        GridName::None | GridName::Metric => {
            vec![GridFrame { crs: scene.crs.clone(), zone: None, unit: 1.0 }]
        }
        GridName::Geographic => vec![GridFrame { crs: Crs::wgs84(), zone: None, unit: 1.0 / 3600.0 }],
        GridName::Utm | GridName::Mgrs => {
            let frame = |&zone: &GridZone| {
                let is_one = zones.len() == 1;
                Some(GridFrame { crs: zone.crs()?, zone: Some(zone).filter(|_| !is_one), unit: 1.0 })
            };
            zones.iter().filter_map(frame).collect()
        }
    };
    let extents: Vec<Rect> = frames.iter().map(|frame| extent_in(&frame.crs, scene)).collect();
    let is_geographic = name == GridName::Geographic;
    let span = frames
        .iter()
        .zip(&extents)
        .filter(|(_, extent)| !extent.is_empty())
        .map(|(frame, extent)| extent.size().max_element() / frame.unit)
        .reduce(f64::max)?;
    let wanted = if is_geographic { wanted_m / SECOND_M } else { wanted_m };
    let stated =
        scene.furniture.grid_interval.map(|stated| if is_geographic { stated * 60.0 } else { stated });
    let interval = GridInterval::choose(name, stated, wanted, span)?;
    let mut lines = Vec::new();
    for (frame, extent) in frames.iter().zip(&extents).filter(|(_, extent)| !extent.is_empty()) {
        for axis in [GridAxis::East, GridAxis::North] {
            add_lines(&mut lines, scene, name, (frame, extent), axis, interval);
        }
    }
    let narrowing = if is_geographic { libm::cos(extents[0].center().y.to_radians()).max(0.01) } else { 1.0 };
    let meters = if is_geographic { SECOND_M } else { 1.0 };
    let squares = if name == GridName::Mgrs { squares(scene) } else { BTreeSet::new() };
    Some(GroundGrid {
        lines,
        apart_m: [interval.value * meters * narrowing, interval.value * meters],
        index_every: interval.index_every,
        note: note(name, interval, &zones, &squares, &scene.crs),
        has_squares: squares.len() > 1,
    })
}

fn add_lines(
    lines: &mut Vec<GroundLine>,
    scene: &SceneModel,
    name: GridName,
    (frame, extent): (&GridFrame, &Rect),
    axis: GridAxis,
    interval: GridInterval,
) {
    let (along, across) = if axis == GridAxis::East { (1, 0) } else { (0, 1) };
    let step = interval.value * frame.unit;
    let first = libm::ceil(extent.min[across] / step) as i64;
    let last = libm::floor(extent.max[across] / step) as i64;
    let points = if frame.zone.is_some() { ZONE_POINTS } else { POINTS };
    for count in first..=last {
        let at = |index: u32| {
            let share = f64::from(index) / f64::from(points - 1);
            let mut at = DVec2::splat(count as f64 * step);
            at[along] = extent.min[along] + extent.size()[along] * share;
            world(frame, scene, at)
        };
        let parts = parts_on(&scene.lattice.extent(), (0..points).map(at));
        if parts.is_empty() {
            continue;
        }
        let [figure, full] = figures(name, axis, count as f64 * interval.value, interval);
        let is_index = count.rem_euclid(interval.index_every) == 0;
        lines.push(GroundLine { axis, parts, is_index, figure, full });
    }
}

/// World X and Y of a point of a frame; `None` outside its zone.
fn world(frame: &GridFrame, scene: &SceneModel, at: DVec2) -> Option<DVec2> {
    if let Some(zone) = frame.zone {
        let place = frame.crs.transform(&Crs::wgs84(), at).ok()?;
        GridZone::at(place).filter(|other| *other == zone)?;
    }
    Some(frame.crs.transform(&scene.crs, at).ok()? - scene.lattice.origin())
}

/// The parts of a line that lie within `rect`.
fn parts_on(rect: &Rect, points: impl Iterator<Item = Option<DVec2>>) -> Vec<Vec<DVec2>> {
    let (mut parts, mut before): (Vec<Vec<DVec2>>, Option<DVec2>) = (Vec::new(), None);
    for point in points {
        let piece = before.zip(point).and_then(|(from, to)| rect.clip_line(from, to));
        if let Some((from, to)) = piece.filter(|(from, to)| from != to) {
            match parts.last_mut().filter(|part| part.last() == Some(&from)) {
                Some(part) => part.push(to),
                None => parts.push(vec![from, to]),
            }
        }
        before = point;
    }
    parts
}

/// Map coordinates spread over the scene: along its border, and inside.
fn places(scene: &SceneModel) -> impl Iterator<Item = DVec2> + use<> {
    let extent = scene.lattice.map_extent();
    (0..SIDE_POINTS * SIDE_POINTS).map(move |index| {
        let share = DVec2::new(f64::from(index % SIDE_POINTS), f64::from(index / SIDE_POINTS));
        extent.min + extent.size() * share / f64::from(SIDE_POINTS - 1)
    })
}

/// The box of the scene in another system; empty where it has no place there.
fn extent_in(crs: &Crs, scene: &SceneModel) -> Rect {
    Rect::around(places(scene).filter_map(|at| scene.crs.transform(crs, at).ok()))
}

fn zones(scene: &SceneModel) -> BTreeSet<GridZone> {
    on_earth(scene).filter_map(GridZone::at).collect()
}

fn squares(scene: &SceneModel) -> BTreeSet<GridSquare> {
    on_earth(scene).filter_map(GridSquare::at).collect()
}

fn on_earth(scene: &SceneModel) -> impl Iterator<Item = DVec2> {
    places(scene).filter_map(|at| scene.crs.transform(&Crs::wgs84(), at).ok())
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
    fn a_line_is_cut_to_the_model_and_broken_where_it_has_no_place() {
        let rect = Rect { min: DVec2::ZERO, max: DVec2::splat(10.0) };
        let at = |x: f64| Some(DVec2::new(x, 5.0));
        let line = [at(-5.0), at(2.0), at(4.0), None, at(6.0), at(20.0)];
        let parts = parts_on(&rect, line.into_iter());
        let ends: Vec<[f64; 2]> = parts.iter().map(|part| [part[0].x, part[part.len() - 1].x]).collect();
        assert_eq!(ends, [[0.0, 4.0], [6.0, 10.0]]);
        assert!(parts_on(&rect, [Some(DVec2::splat(20.0)), Some(DVec2::splat(30.0))].into_iter()).is_empty());
    }
}
