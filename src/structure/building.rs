//! Buildings: a footprint, its heights and its roof become one closed solid.
//!
//! ```text
//!            ╱╲          top_z    ridge
//!          ╱____╲        eaves_z
//!          │    │        plaster
//!          ├────┤        base_z   shown only where the building does not stand on its lowest ground
//!          │    │        foundation, in the ground
//!          └────┘        foot_z
//! ```
//!
//! Walls have texture coordinates in bays and stories, so that a texture of one window gives them their rhythm; all other
//! faces have the texture's corner, which is white.

use glam::{DVec2, DVec3, Vec2, Vec3};

use crate::building_footprint::BuildingFootprint;
use crate::deck_check::{OpenSurfaceError, open_edges};
use crate::faces::Faces;
use crate::fence_band::{noise, shaded};
use crate::unit_roof::{UnitRoof, centroid};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::DrawMesh;
use sandtable_geom::polygon;
use sandtable_mesh::sink::VertexId;

/// The heights of a building in world Z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BuildingLevels {
    /// Where its walls end below.
    pub foot_z: f64,
    /// Where the plaster begins.
    pub base_z: f64,
    /// The lowest floor, from which stories are counted.
    pub floor_z: f64,
    /// Where the roof begins.
    pub eaves_z: f64,
    /// The ridge.
    pub top_z: f64,
}

/// The colors of a building.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// The walls.
    pub wall: Srgba,
    /// The roof.
    pub roof: Srgba,
    /// The walls below the base.
    pub foundation: Srgba,
}

/// The height of a story, meters.
pub const STORY_M: f64 = 3.0;
/// The width of a bay, a window with the wall beside it, meters; narrower than [`LEAST_BAY_M`] a wall has no window.
const BAY_M: f64 = 2.8;
const LEAST_BAY_M: f64 = 2.0;
/// The lowest walls with windows, meters: sheds have none.
const LEAST_WALL_M: f64 = 2.2;

const FOUNDATION: Srgba = Srgba::opaque(150, 144, 136);

/// Plasters of which a building takes one by where it stands.
const PLASTERS: [Srgba; 7] = [
    Srgba::opaque(238, 230, 214),
    Srgba::opaque(232, 220, 194),
    Srgba::opaque(226, 206, 172),
    Srgba::opaque(222, 214, 204),
    Srgba::opaque(234, 214, 196),
    Srgba::opaque(214, 204, 190),
    Srgba::opaque(242, 238, 228),
];

const TILES: [Srgba; 6] = [
    Srgba::opaque(178, 98, 72),
    Srgba::opaque(162, 86, 66),
    Srgba::opaque(188, 112, 80),
    Srgba::opaque(148, 92, 78),
    Srgba::opaque(120, 108, 104),
    Srgba::opaque(172, 104, 84),
];

/// Flat roofs of gravel, felt and concrete.
const FLATS: [Srgba; 5] = [
    Srgba::opaque(190, 184, 176),
    Srgba::opaque(176, 170, 164),
    Srgba::opaque(202, 196, 186),
    Srgba::opaque(184, 172, 160),
    Srgba::opaque(166, 162, 158),
];

impl Paint {
    /// The default paint: a plaster and a roof chosen by the position, so that they are the same in every picture.
    pub fn by_place(footprint: &BuildingFootprint, roof: &UnitRoof) -> Self {
        Self::at(centroid(footprint.exterior()), roof.run_m > 0.0)
    }

    /// The default paint of a building at a place, whose roof slopes or is flat.
    pub fn at(place: DVec2, is_sloped: bool) -> Self {
        let at = place.round();
        let pick = |colors: &[Srgba], salt: u64| {
            let share = (noise(at, salt) + 1.0) / 2.0;
            colors[((share * colors.len() as f64) as usize).min(colors.len() - 1)]
        };
        let tint = noise(at, 7) as f32 * 5.0;
        let roof = if is_sloped { pick(&TILES, 1) } else { pick(&FLATS, 2) };
        Self {
            wall: shaded(pick(&PLASTERS, 3), tint),
            roof: shaded(roof, tint * 1.4),
            foundation: FOUNDATION,
        }
    }
}

/// The building as a closed solid, faces outward.
pub fn raise(
    footprint: &BuildingFootprint,
    roof: &UnitRoof,
    levels: BuildingLevels,
    paint: Paint,
) -> DrawMesh {
    let mut faces = Faces::default();
    let rise = levels.top_z - levels.eaves_z;
    let on_roof = |at: &DVec3| DVec3 { z: levels.eaves_z + at.z * rise, ..*at }.as_vec3();
    for ring in &roof.edge {
        for (from, to) in polygon::edges(ring) {
            walls(&mut faces, [from, to], &on_roof, levels, paint);
        }
    }
    for face in &roof.faces {
        let plan: Vec<DVec2> = face.iter().map(|at| at.truncate()).collect();
        let corners: Vec<Vec3> = face.iter().map(on_roof).collect();
        match face.len() {
            3 => faces.polygon(&corners, paint.roof),
            _ => faces.flat(&corners, &polygon::triangulate_ring(&plan), paint.roof),
        }
    }
    floor(&mut faces, footprint, roof, levels.foot_z, paint);
    faces.into_mesh()
}

/// The wall over one side of the footprint, from its foot to the roof.
fn walls(
    faces: &mut Faces,
    [from, to]: [DVec3; 2],
    on_roof: &dyn Fn(&DVec3) -> Vec3,
    levels: BuildingLevels,
    paint: Paint,
) {
    let at = |plan: DVec3, z: f64| DVec3 { z, ..plan }.as_vec3();
    let mut foot_z = levels.foot_z;
    if levels.base_z > foot_z {
        let corners = [at(from, foot_z), at(to, foot_z), at(to, levels.base_z), at(from, levels.base_z)];
        faces.polygon(&corners, paint.foundation);
        foot_z = levels.base_z;
    }
    // Up to the eaves, and the gable over them.
    let uv = wall_uv((to - from).truncate().length(), levels);
    let [low, high] = [foot_z, levels.eaves_z].map(|z| [uv(0.0, z), uv(1.0, z)]);
    let [from_top, to_top] = [at(from, levels.eaves_z), at(to, levels.eaves_z)];
    let wall = [(at(from, foot_z), low[0]), (at(to, foot_z), low[1]), (to_top, high[1]), (from_top, high[0])];
    faces.textured(wall, paint.wall);
    let risen = [(to.z, on_roof(&to)), (from.z, on_roof(&from))].into_iter();
    let risen = risen.filter(|(rise, _)| *rise > 0.0).map(|(_, at)| at);
    let gable: Vec<Vec3> = [from_top, to_top].into_iter().chain(risen).collect();
    faces.polygon(&gable, paint.wall);
}

/// Texture coordinates on a wall of this length, by the share of it and the height: bays along it, stories down from the
/// eaves. The texture's corner everywhere where it has no window.
fn wall_uv(length_m: f64, levels: BuildingLevels) -> impl Fn(f64, f64) -> Vec2 {
    let height_m = levels.eaves_z - levels.floor_z;
    let has_windows = length_m >= LEAST_BAY_M && height_m >= LEAST_WALL_M;
    let (bays, stories) = ((length_m / BAY_M).round().max(1.0), (height_m / STORY_M).round().max(1.0));
    move |share, z| match has_windows {
        true => DVec2::new(share * bays, (levels.eaves_z - z) / height_m * stories).as_vec2(),
        false => Vec2::ZERO,
    }
}

/// What closes it below, facing down: the footprint with the vertices that the roof's edge added.
fn floor(faces: &mut Faces, footprint: &BuildingFootprint, roof: &UnitRoof, foot_z: f64, paint: Paint) {
    let down = |[a, b, c]: [DVec2; 3]| [c, b, a].map(|at| at.extend(foot_z).as_vec3());
    let rings: Vec<Vec<DVec2>> =
        roof.edge.iter().map(|ring| ring.iter().map(|at| at.truncate()).collect()).collect();
    let [outer, courtyards @ ..] = &rings[..] else { return };
    if footprint.has_courtyards() {
        for triangle in polygon::triangulate(outer, courtyards) {
            faces.polygon(&down(triangle), paint.foundation);
        }
        return;
    }
    let corners: Vec<Vec3> = outer.iter().rev().map(|at| at.extend(foot_z).as_vec3()).collect();
    let last = outer.len() - 1;
    let turned = |[a, b, c]: [usize; 3]| [last - c, last - b, last - a];
    let triangles: Vec<[usize; 3]> = polygon::triangulate_ring(outer).into_iter().map(turned).collect();
    faces.flat(&corners, &triangles, paint.foundation);
}

/// The measures of a sound building.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// Cubic meters within its faces.
    pub volume_m3: f64,
    /// Square meters of plan under its roof.
    pub roof_m2: f64,
}

/// A fault of a building's solid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BuildingSolidError {
    /// An edge belongs to one side only.
    #[error(transparent)]
    Open(#[from] OpenSurfaceError),
    /// Its faces look inward.
    #[error("it holds {volume_m3} m³: its faces look inward")]
    Inward {
        /// What they enclose, not above 0.
        volume_m3: f64,
    },
}

/// Checks that a building's mesh is closed: every edge of a triangle is that of another, the other way round; and faces
/// outward.
///
/// # Errors
/// The first fault found.
pub fn check(mesh: &DrawMesh) -> Result<Measures, BuildingSolidError> {
    if let Some((from, to)) = open_edges(&[mesh]).find(|(from, to)| from != to) {
        return Err(OpenSurfaceError { from, to }.into());
    }
    let (mut volume_m3, mut roof_m2) = (0.0, 0.0);
    let middle = mesh.vertices.first().map_or(DVec3::ZERO, |vertex| Vec3::from(vertex.position).as_dvec3());
    for triangle in &mesh.triangles {
        let corner = |id: VertexId| Vec3::from(mesh.vertices[id.index()].position).as_dvec3() - middle;
        let [a, b, c] = triangle.map(corner);
        volume_m3 += a.cross(b).dot(c) / 6.0;
        roof_m2 += ((b - a).truncate().perp_dot((c - a).truncate()) / 2.0).max(0.0);
    }
    if volume_m3 > 0.0 {
        Ok(Measures { volume_m3, roof_m2 })
    } else {
        Err(BuildingSolidError::Inward { volume_m3 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::roof::roof;
    use proptest::prelude::*;
    use sandtable_description::words;

    /// Every shape, and what it holds of the box from eaves to ridge over a house of 12 by 8 meters.
    const SHAPES: [(words::RoofShape, f64); 11] = [
        (words::RoofShape::Flat, 0.0),
        (words::RoofShape::Gabled, 1.0 / 2.0),
        // A half, less two sixths of the ends.
        (words::RoofShape::Hipped, 7.0 / 18.0),
        (words::RoofShape::Pyramidal, 1.0 / 3.0),
        (words::RoofShape::Skillion, 1.0 / 2.0),
        // Of each gable an eighth of the run is cut off, half as wide and half as high.
        (words::RoofShape::HalfHipped, 1.0 / 2.0 - 1.0 / 72.0),
        (words::RoofShape::Gambrel, 0.61),
        (words::RoofShape::Saltbox, 1.0 / 2.0),
        (words::RoofShape::Round, 0.765_366_865),
        (words::RoofShape::Mansard, 0.575_555_556),
        (words::RoofShape::Dome, 0.655_308_609),
    ];

    fn built(footprint: &BuildingFootprint, shape: words::RoofShape) -> (UnitRoof, DrawMesh) {
        let roof = roof(footprint, shape);
        let top_z = if roof.run_m > 0.0 { 9.0 } else { 6.0 };
        let levels = BuildingLevels { foot_z: -1.0, base_z: 0.0, floor_z: 0.0, eaves_z: 6.0, top_z };
        let paint = Paint::by_place(footprint, &roof);
        let mesh = raise(footprint, &roof, levels, paint);
        (roof, mesh)
    }

    #[test]
    fn every_house_is_closed_and_holds_what_it_should_however_it_is_turned() {
        for quarter in 0..4 {
            let ring: Vec<DVec2> = [(2.0, 1.0), (14.0, 1.0), (14.0, 9.0), (2.0, 9.0)]
                .map(|(x, y)| (0..quarter).fold(DVec2::new(x, y), |at, _| at.perp()))
                .to_vec();
            let house = BuildingFootprint::parts(&ring, &[]).remove(0);
            // Below the eaves 96 m² × 7 m; above them a share of 96 m² × 3 m.
            for (shape, share) in SHAPES {
                let (made, mesh) = built(&house, shape);
                let measures = check(&mesh).unwrap_or_else(|fault| panic!("{shape:?}: {fault}"));
                assert_eq!(made.shape, shape);
                let wanted = 672.0 + 288.0 * share;
                assert!((measures.volume_m3 - wanted).abs() < 0.02, "{shape:?} {measures:?}, not {wanted}");
                assert!((measures.roof_m2 - 96.0).abs() < 0.01);
            }
        }
    }

    #[test]
    fn walls_have_windows_by_bays_and_stories_and_narrow_ones_none() {
        let levels = BuildingLevels { foot_z: -1.0, base_z: 0.0, floor_z: 0.0, eaves_z: 6.2, top_z: 9.0 };
        assert_eq!(wall_uv(12.0, levels)(0.0, 6.2), Vec2::ZERO);
        assert_eq!(wall_uv(12.0, levels)(1.0, 0.0), Vec2::new(4.0, 2.0));
        assert_eq!(wall_uv(1.9, levels)(1.0, 0.0), Vec2::ZERO);
        assert_eq!(wall_uv(12.0, BuildingLevels { eaves_z: 2.0, ..levels })(1.0, 0.0), Vec2::ZERO);
    }

    #[test]
    fn a_courtyard_stays_open() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let outer = [at(0.0, 0.0), at(20.0, 0.0), at(20.0, 20.0), at(0.0, 20.0)];
        let yard = vec![at(5.0, 5.0), at(5.0, 15.0), at(15.0, 15.0), at(15.0, 5.0)];
        let house = BuildingFootprint::parts(&outer, &[yard]).remove(0);
        for (shape, _) in SHAPES {
            let measures = check(&built(&house, shape).1).expect("closed");
            // One slope lies over a courtyard too; all others are flat.
            let above = if shape == words::RoofShape::Skillion { 450.0 } else { 0.0 };
            assert!((measures.roof_m2 - 300.0).abs() < 0.01);
            assert!((measures.volume_m3 - 2100.0 - above).abs() < 0.1, "{shape:?}: {measures:?}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]

        #[test]
        fn whatever_the_ring_what_is_built_on_it_is_closed_and_roofs_its_area(
            points in proptest::collection::vec((0.0..40.0f64, 0.0..40.0f64), 3..12),
            offset in (0.0..9000.0f64, 0.0..9000.0f64),
            shape in 0..SHAPES.len(),
        ) {
            let ring: Vec<DVec2> = points.into_iter().map(|at| DVec2::from(at) + DVec2::from(offset)).collect();
            for footprint in BuildingFootprint::parts(&ring, &[]) {
                let (roof, mesh) = built(&footprint, SHAPES[shape].0);
                let measures = check(&mesh);
                prop_assert!(measures.is_ok(), "{:?} over {:?}: {:?}", roof.shape, footprint, measures);
                let roofed = measures.expect("checked").roof_m2;
                let off = (roofed - footprint.area_m2()).abs();
                prop_assert!(off < 0.05 + 1e-3 * footprint.area_m2(), "{roofed} over {}", footprint.area_m2());
            }
        }

        #[test]
        fn regular_and_stretched_plans_have_sound_hipped_roofs(
            count in 3u32..20, stretch in 0.3..1.0f64, turn in 0.0..6.3f64, radius in 2.0..30.0f64,
        ) {
            let vertex = |index: u32| {
                let angle = f64::from(index) * std::f64::consts::TAU / f64::from(count);
                let at = DVec2::new(libm::cos(angle), libm::sin(angle) * stretch) * radius;
                DVec2::new(libm::cos(turn), libm::sin(turn)).rotate(at)
            };
            let ring: Vec<DVec2> = (0..count).map(vertex).collect();
            let footprint = BuildingFootprint::parts(&ring, &[]).remove(0);
            let (roof, mesh) = built(&footprint, words::RoofShape::Hipped);
            prop_assert_eq!(roof.shape, words::RoofShape::Hipped);
            prop_assert!(check(&mesh).is_ok(), "{:?}", check(&mesh));
        }
    }
}
