//! A bridge: a deck with parapets drawn out along its course, abutments at its ends, piers under it.
//!
//! The cross-section at each section of the course, looking along it; the carriageway is a mesh of its own, since it
//! carries the road's texture, and closes the rest:
//!
//! ```text
//!    0─1                 4─5     parapets, outside the carriageway
//!    │ │                 │ │
//!   11 2─────────────────3 6     carriageway: the profile's elevation
//!   10 ╲                 ╱ 7     edge beams
//!        ╲9───────────8╱         soffit
//! ```
//!
//! A deck is planned true to scale: [`sections`], [`deck()`], [`end_parapets`]. [`build`] takes its sections with elevations
//! as they are drawn, on which all that is built keeps its own height. A road may be drawn much wider than any is, to be
//! seen on a small picture; then what is built for it is magnified as well.

use glam::{DVec2, FloatExt, Vec2, Vec3};

use crate::deck::{self, DeckSection};
use crate::deck_check::{self, OpenSurfaceError};
use crate::faces::Faces;
use crate::pier;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::DrawMesh;
use sandtable_earthworks::alignment::Alignment;
use sandtable_geom::offset::Continuations;
use sandtable_geom::profile::Profile;
use sandtable_terrain::query::deck::Deck;
use sandtable_terrain::triangle_surface::SurfaceTriangle;

/// The elevation of the ground at a world position in meters; `None` where there is none.
pub type GroundHeight<'a> = dyn Fn(DVec2) -> Option<f64> + 'a;

/// The depth below the ground to which walls and piers are founded, in meters: the ground is drawn coarser when it is
/// far away, by about a pixel, and nothing may show its foot then.
pub const FOUNDED_M: f64 = 3.0;

/// The width of the widest bridges that are built, about, in meters: a wider one is a symbol, drawn larger than life.
const WIDEST_REAL_M: f64 = 20.0;

/// Over how many widths a deck turns from how the ground lies across its end to level.
const TILT_WIDTHS: f64 = 2.0;

/// Sections where bridges meet, an eighth of the width apart, so that parapets end where they should.
const MEETING_BREAKS: u32 = 24;

/// How far above or below a parapet's foot a carriageway lies that it would stand in the way of, in meters.
const SAME_DECK_M: f64 = 1.5;

/// The steepest fall across that a deck takes over from the ground at its end: between a steep road and a warped deck.
const MOST_TILT: f64 = 0.25;

const CONCRETE: Srgba = Srgba::opaque(236, 231, 219);

/// The cross slope at a deck's end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Across {
    /// As the ground lies, on which the road continues.
    AsGround,
    /// Level, as in a tunnel or on the next bridge.
    Level,
}

/// The options of a bridge.
#[derive(Clone, Debug, PartialEq)]
pub struct BridgeOptions {
    /// Meters from the carriageway to the soffit, above 0; see [`depth_m`].
    pub depth_m: f64,
    /// Stations of the piers, in meters.
    pub piers_m: Vec<f64>,
    /// The depth to which the abutments at its start and end reach below it, in meters; `None` where another bridge
    /// continues it.
    pub abutments_m: [Option<f64>; 2],
    /// How its start and end lie across.
    pub across: [Across; 2],
    /// The lines that continue it at its ends.
    pub beyond: Continuations,
    /// How long a miter may be, in half widths, at least 1.
    pub miter_limit: f64,
    /// Meters along the carriageway in one repeat of its texture, above 0.
    pub texture_length_m: f64,
}

/// The solids of a bridge, in world space.
#[derive(Clone, Debug, Default)]
pub struct BridgeSolids {
    /// The carriageway, with a road's texture coordinates.
    pub carriageway: DrawMesh,
    /// All the rest.
    pub body: DrawMesh,
    /// How many piers stand.
    pub piers: usize,
}

/// The depth of a deck by its longest span: an eighteenth of it, as for girders of concrete, from 0.6 to 4 meters.
pub fn depth_m(longest_span_m: f64) -> f64 {
    (longest_span_m / 18.0).clamp(0.6, 4.0)
}

/// The factor by which a structure on a road of this width is drawn larger than it is, at least 1.
pub fn magnified(width_m: f64) -> f64 {
    (width_m / WIDEST_REAL_M).max(1.0)
}

/// How high parapets stand over a carriageway of this width, in meters.
pub fn parapet_m(width_m: f64) -> f64 {
    PARAPET_M * magnified(width_m)
}

/// The carriageway over the sections of a course.
pub fn deck(sections: &[DeckSection]) -> Vec<SurfaceTriangle> {
    carriageway(sections).map(|corners| corners.map(|(section, side)| section.edges()[side])).collect()
}

/// Ends the parapets where one of the other carriageways of `decks` continues beside their own, `width_m` wide.
pub fn end_parapets(sections: &mut [DeckSection], width_m: f64, decks: &Deck) {
    let middle = 1.0 + PARAPET_THICK_M * magnified(width_m) / width_m;
    for section in sections {
        let goes_on = |side: usize| {
            let other_m = decks.height_m(section.at + section.aside[side] * middle);
            other_m.is_some_and(|other_m| (other_m - section.edges_m[side]).abs() <= SAME_DECK_M)
        };
        section.parapets = [!goes_on(0), !goes_on(1)];
    }
}

/// Builds the bridge over the sections of an alignment of one width on `ground`, the elevations of both as they are drawn.
pub fn build(
    alignment: &Alignment,
    sections: &[DeckSection],
    options: &BridgeOptions,
    ground: &GroundHeight<'_>,
) -> BridgeSolids {
    let (length_m, width_m) = (alignment.line.length(), alignment.width.widest_m());
    let mut body = Faces::default();
    let mut bridge = BridgeSolids { carriageway: textured(sections, options), ..BridgeSolids::default() };
    draw_out(sections, &cross_section(width_m, options), &mut body);
    for (end, reach_m) in options.abutments_m.iter().enumerate() {
        let Some(reach_m) = *reach_m else { continue };
        let reach = |section: &&DeckSection| {
            let from_end = if end == 0 { section.station_m } else { length_m - section.station_m };
            from_end <= reach_m + 1e-6
        };
        let under: Vec<DeckSection> = sections.iter().filter(reach).copied().collect();
        pier::abutment(&under, width_m, options, ground, &mut body);
        let last = if end == 0 { sections.first() } else { sections.last() };
        if let Some(section) = last {
            pier::end_posts(section, width_m, options, &mut body);
        }
    }
    for &station in &options.piers_m {
        let section = nearest(sections, station);
        bridge.piers += usize::from(pier::pier(section, width_m, options, ground, &mut body));
    }
    bridge.body = body.into_mesh();
    bridge
}

/// The section that stands nearest to a station; there is one at every pier unless it stands on a miter.
fn nearest(sections: &[DeckSection], station_m: f64) -> &DeckSection {
    let after =
        sections.partition_point(|section| section.station_m < station_m).clamp(1, sections.len() - 1);
    let (before, after) = (&sections[after - 1], &sections[after]);
    if station_m - before.station_m < after.station_m - station_m { before } else { after }
}

/// The sections of an alignment at its levels, turned at its ends as the ground lies across.
pub fn sections(
    alignment: &Alignment,
    options: &BridgeOptions,
    ground: &GroundHeight<'_>,
) -> Vec<DeckSection> {
    let (length_m, width_m) = (alignment.line.length(), alignment.width.widest_m());
    let fade_m = (width_m * TILT_WIDTHS).min(length_m / 2.0);
    let abutments = options.abutments_m.map(|length| length.unwrap_or(0.0));
    let mut breaks: Vec<f64> = alignment.level.iter().flat_map(Profile::stations).copied().collect();
    breaks.extend([abutments[0], length_m - abutments[1]]);
    breaks.extend([0.25, 0.5, 0.75, 1.0].map(|part| part * fade_m));
    breaks.extend([0.25, 0.5, 0.75, 1.0].map(|part| length_m - part * fade_m));
    breaks.extend(&options.piers_m);
    for (end, abutment) in options.abutments_m.iter().enumerate() {
        if abutment.is_none() {
            let from_end = (1..=MEETING_BREAKS).map(|step| f64::from(step) * width_m / 8.0);
            breaks.extend(from_end.map(|from_end| if end == 0 { from_end } else { length_m - from_end }));
        }
    }
    let mut sections = deck::sections(alignment, options.beyond, options.miter_limit, &breaks);
    let last = sections.len() - 1;
    for (index, end) in [0, last].into_iter().enumerate() {
        if options.across[index] == Across::Level {
            continue;
        }
        let tilt = tilt(&sections[end], width_m, ground);
        for section in &mut sections {
            let from_end = (section.station_m - if index == 0 { 0.0 } else { length_m }).abs();
            // Smooth at both ends.
            let share = (1.0 - from_end / fade_m).smoothstep(0.0, 1.0);
            for (edge_m, tilt_m) in section.edges_m.iter_mut().zip(tilt) {
                *edge_m += tilt_m * share;
            }
        }
    }
    sections
}

/// How far the ground lies above either edge of a section, within what a deck takes over.
fn tilt(section: &DeckSection, width_m: f64, ground: &GroundHeight<'_>) -> [f64; 2] {
    let most = MOST_TILT * width_m / 2.0;
    [0, 1].map(|side| {
        let above = ground(section.at + section.aside[side]).map(|height| height - section.edges_m[side]);
        above.unwrap_or(0.0).clamp(-most, most)
    })
}

/// How a quad of plan positions, counter-clockwise, is cut into two triangles that both face up wherever that can be.
pub(crate) fn quad_corners(quad: [DVec2; 4]) -> [[usize; 3]; 2] {
    let area = |[a, b, c]: [usize; 3]| (quad[b] - quad[a]).perp_dot(quad[c] - quad[a]);
    let cuts = [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]];
    let worst = |cut: [[usize; 3]; 2]| cut.map(area).into_iter().fold(f64::INFINITY, f64::min);
    if worst(cuts[0]) >= worst(cuts[1]).min(1e-9) { cuts[0] } else { cuts[1] }
}

/// The triangles of the carriageway, their corners as a section and its side.
fn carriageway(sections: &[DeckSection]) -> impl Iterator<Item = [(&DeckSection, usize); 3]> {
    sections.windows(2).flat_map(|pair| {
        let quad = [(&pair[0], 0), (&pair[0], 1), (&pair[1], 1), (&pair[1], 0)];
        let cut = quad_corners(quad.map(|(section, side)| section.at + section.aside[side]));
        cut.map(|corners| corners.map(|corner| quad[corner]))
    })
}

/// The carriageway with a road's texture coordinates.
fn textured(sections: &[DeckSection], options: &BridgeOptions) -> DrawMesh {
    let mut faces = Faces::default();
    for corners in carriageway(sections) {
        let vertex = |(section, side): (&DeckSection, usize)| {
            let along = (section.station_m / options.texture_length_m) as f32;
            (section.point(side, 1.0, 0.0), Vec2::new(side as f32, along))
        };
        faces.textured(corners.map(vertex), Srgba::WHITE);
    }
    faces.into_mesh()
}

/// A corner of the cross-section.
#[derive(Clone, Copy)]
struct RingPoint {
    side: usize,
    /// The part of the way to the carriageway's edge.
    part: f64,
    /// Meters above that edge.
    above_m: f64,
}

fn cross_section(width_m: f64, options: &BridgeOptions) -> [RingPoint; 12] {
    let by = magnified(width_m);
    let (parapet, thick) = (parapet_m(width_m), PARAPET_THICK_M * by);
    let outer = 1.0 + thick / (width_m / 2.0);
    let (edge, depth) = (-0.4 * options.depth_m, -options.depth_m);
    [
        (0, outer, parapet),
        (0, 1.0, parapet),
        (0, 1.0, 0.0),
        (1, 1.0, 0.0),
        (1, 1.0, parapet),
        (1, outer, parapet),
        (1, outer, 0.0),
        (1, outer, edge),
        (1, GIRDER, depth),
        (0, GIRDER, depth),
        (0, outer, edge),
        (0, outer, 0.0),
    ]
    .map(|(side, part, above_m)| RingPoint { side, part, above_m })
}

/// The cross-section at a section, flat where no parapet stands.
fn ring(points: &[RingPoint; 12], section: &DeckSection) -> [Vec3; 12] {
    points.map(|RingPoint { side, part, above_m }| {
        let above_m = if section.parapets[side] { above_m } else { above_m.min(0.0) };
        section.point(side, part, above_m)
    })
}

/// [`parapet_m`] of bridges of usual widths.
const PARAPET_M: f64 = 1.1;
/// How thick they are, in meters.
pub(crate) const PARAPET_THICK_M: f64 = 0.4;
/// How wide the soffit is, as a part of the carriageway.
pub(crate) const GIRDER: f64 = 0.62;

/// Draws the cross-section out along the sections and closes its ends.
fn draw_out(sections: &[DeckSection], points: &[RingPoint; 12], faces: &mut Faces) {
    /// The side between points 2 and 3 is the carriageway.
    const CARRIAGEWAY: usize = 2;
    for pair in sections.windows(2) {
        let (from, to) = (ring(points, &pair[0]), ring(points, &pair[1]));
        for side in (0..12).filter(|&side| side != CARRIAGEWAY) {
            let next = (side + 1) % 12;
            faces.polygon(&[from[side], from[next], to[next], to[side]], CONCRETE);
        }
    }
    // Both parapets, and the slab, cut so that no triangle is a line.
    let caps: [&[usize]; 3] = [&[0, 1, 2, 11], &[3, 4, 5, 6], &[8, 9, 10, 11, 2, 3, 6, 7]];
    let (first, last) = (ring(points, &sections[0]), ring(points, &sections[sections.len() - 1]));
    for cap in caps {
        let back: Vec<Vec3> = cap.iter().rev().map(|&point| first[point]).collect();
        let front: Vec<Vec3> = cap.iter().map(|&point| last[point]).collect();
        // Both begin at point 8 or at a parapet's top, from which every other corner is seen.
        faces.polygon(&rotated(&back, cap.len() - 1), CONCRETE);
        faces.polygon(&front, CONCRETE);
    }
}

fn rotated(ring: &[Vec3], by: usize) -> Vec<Vec3> {
    ring[by..].iter().chain(&ring[..by]).copied().collect()
}

/// A fault of a bridge's solids.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BridgeSolidsError {
    /// A triangle of the deck.
    #[error("triangle {index} of the deck faces down at {at}")]
    FacesDown {
        /// Its place among the deck's.
        index: usize,
        /// One of its corners.
        at: Vec3,
    },
    /// The carriageway does not close the body.
    #[error(transparent)]
    Open(#[from] OpenSurfaceError),
}

impl BridgeSolids {
    /// Whether every triangle of the deck faces up, and the carriageway closes the body: nothing shows from inside.
    ///
    /// # Errors
    /// The first thing out of place.
    pub fn check(&self) -> Result<(), BridgeSolidsError> {
        for (index, triangle) in self.carriageway.triangles.iter().enumerate() {
            let [a, b, c] = triangle.map(|id| Vec3::from(self.carriageway.vertices[id.index()].position));
            if (b - a).truncate().perp_dot((c - a).truncate()) < 0.0 {
                return Err(BridgeSolidsError::FacesDown { index, at: a });
            }
        }
        Ok(deck_check::closed(&[&self.carriageway, &self.body])?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deck_profile::ClearancePoint;
    use crate::deck_profile::clearing;
    use proptest::prelude::*;
    use sandtable_geom::polyline::Polyline;

    fn options(length_m: f64) -> BridgeOptions {
        BridgeOptions {
            depth_m: depth_m(30.0),
            piers_m: vec![length_m / 3.0, length_m / 1.5],
            abutments_m: [Some(6.0), Some(6.0)],
            across: [Across::AsGround; 2],
            beyond: Continuations::default(),
            miter_limit: 2.0,
            texture_length_m: 15.0,
        }
    }

    fn alignment(line: &Polyline, level: Profile) -> Alignment {
        Alignment { level: Some(level), ..Alignment::on_ground(line.clone(), 8.0) }
    }

    /// The deck, and the bridge with elevations drawn 1.5 times as high.
    fn built(
        alignment: &Alignment,
        options: &BridgeOptions,
        ground: &GroundHeight<'_>,
        decks: &[SurfaceTriangle],
    ) -> (Vec<SurfaceTriangle>, BridgeSolids) {
        let mut sections = sections(alignment, options, ground);
        let deck = deck(&sections);
        end_parapets(&mut sections, alignment.width.widest_m(), &Deck::new(decks).expect("sound"));
        for section in &mut sections {
            section.edges_m = section.edges_m.map(|edge_m| edge_m * 1.5);
        }
        let drawn = |at| ground(at).map(|height_m| height_m * 1.5);
        (deck, build(alignment, &sections, options, &drawn))
    }

    #[test]
    fn parapets_stop_where_another_deck_goes_on() {
        let at = |x: f32, y: f32| Vec3::new(x, y, 50.0);
        let beside =
            [[at(20.0, 4.0), at(60.0, 4.0), at(60.0, 9.0)], [at(20.0, 4.0), at(60.0, 9.0), at(20.0, 9.0)]];
        let line = Polyline::new([DVec2::ZERO, DVec2::new(90.0, 0.0)], 0.0).expect("a line");
        let options = BridgeOptions { piers_m: vec![40.0], ..options(90.0) };
        let level = Profile::straight(90.0, [50.0; 2]);
        let (_, bridge) = built(&alignment(&line, level), &options, &|_| Some(50.0), &beside);
        bridge.check().expect("sound");
        let highest = |side: f32| {
            let corners = bridge.body.vertices.iter().map(|vertex| vertex.position);
            let here = corners.filter(|at| (at[0] - 40.0).abs() < 0.1 && at[1] * side > 3.9);
            here.map(|at| at[2]).fold(f32::NEG_INFINITY, f32::max) - 75.0
        };
        assert!(highest(1.0) < 1e-3 && highest(-1.0) > 1.0, "{} {}", highest(1.0), highest(-1.0));
    }

    fn valley(at: DVec2) -> Option<f64> {
        Some(100.0 + at.length() * 0.02 - 30.0 * (1.0 - (at.length() - 60.0).abs() / 60.0).max(0.0))
    }

    #[test]
    fn piers_end_below_the_ground_and_reach_the_soffit() {
        for quarter in 0..4 {
            let turn = |at: DVec2| (0..quarter).fold(at, |at, _| at.perp());
            let points = [DVec2::ZERO, DVec2::new(120.0, 0.0)].map(turn);
            let line = Polyline::new(points, 0.0).expect("a line");
            let profile = Profile::straight(120.0, [100.0, 102.4]);
            let (_, bridge) = built(&alignment(&line, profile.clone()), &options(120.0), &valley, &[]);
            bridge.check().expect("sound");
            assert_eq!(bridge.piers, 2);
            for station in [40.0, 80.0] {
                let at = line.at(station);
                let ground = valley(at).expect("ground") * 1.5;
                let soffit = profile.at(station) * 1.5 - depth_m(30.0);
                let near = bridge.body.vertices.iter().map(|vertex| Vec3::from(vertex.position));
                let near: Vec<Vec3> =
                    near.filter(|corner| corner.truncate().as_dvec2().distance(at) < 3.5).collect();
                assert!(near.iter().any(|corner| f64::from(corner.z) < ground - 2.9));
                assert!(near.iter().any(|corner| (f64::from(corner.z) - soffit).abs() < 0.5));
            }
        }
    }

    #[test]
    fn the_deck_s_ends_lie_as_the_ground_does_across_them() {
        let line = Polyline::new([DVec2::ZERO, DVec2::new(90.0, 0.0)], 0.0).expect("a line");
        let slope = |at: DVec2| Some(50.0 + at.y * 0.1);
        let level = Profile::straight(90.0, [50.0; 2]);
        let (deck, _) = built(&alignment(&line, level), &options(90.0), &slope, &[]);
        let height = |x: f32, y: f32| {
            let mut corners = deck.iter().flatten().filter(|corner| corner.x == x && corner.y == y);
            corners.next().expect("a corner").z
        };
        assert!((height(0.0, 4.0) - 50.4).abs() < 1e-4 && (height(0.0, -4.0) - 49.6).abs() < 1e-4);
        assert!((height(30.0, 4.0) - 50.0).abs() < 1e-4);
    }

    proptest! {
        #[test]
        fn every_bridge_is_closed_and_its_deck_faces_up(
            turns in prop::collection::vec((5.0..50.0f64, -1.5..1.5f64), 1..12),
            heights in prop::collection::vec(90.0..130.0f64, 13),
            quarter in 0u32..4,
        ) {
            let (mut heading, mut at) = (f64::from(quarter) * std::f64::consts::FRAC_PI_2, DVec2::new(3000.0, 900.0));
            let mut points = vec![at];
            for (length, turn) in turns {
                heading += turn;
                at += DVec2::new(libm::cos(heading), libm::sin(heading)) * length;
                points.push(at);
            }
            let line = Polyline::new(points, 0.01).expect("a line");
            let floors: Vec<ClearancePoint> = line.stations().iter().zip(&heights)
                .map(|(&station_m, &level_m)| ClearancePoint { station_m, level_m }).collect();
            let ends = [floors[0].level_m, floors[floors.len() - 1].level_m];
            let profile = clearing(&Profile::straight(line.length(), ends), &floors, &[], 0.1);
            let (deck, bridge) = built(&alignment(&line, profile), &options(line.length()), &|_| Some(95.0), &[]);
            prop_assert_eq!(bridge.check(), Ok(()));
            let plan = |facet: &SurfaceTriangle| (facet[1] - facet[0]).truncate().perp_dot((facet[2] - facet[0]).truncate());
            prop_assert!(deck.iter().map(plan).all(|area| area >= 0.0));
            let area: f32 = deck.iter().map(plan).sum::<f32>() / 2.0;
            prop_assert!(f64::from(area) < 8.0 * line.length() * 1.3, "{} m²", area);
        }
    }
}
