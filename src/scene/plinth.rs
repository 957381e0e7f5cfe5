//! The block under the ground: walls from the edge of the displayed ground down to a level base, so that a terrain seen
//! whole looks like a sand table, not like a sheet in the air. The walls show the soil in section:
//!
//! ```text
//!   ╱╲__╱╲   the ground
//!  ╱╲__╱╲ ╲  topsoil: follows the ground
//!  │       │ subsoil: down to a fixed depth below the lowest ground
//!  ├───────┤ clay
//!  ├───────┤ rock, down to the base
//!  └───────┘
//! ```

use glam::{DVec2, Vec2, Vec3};

use sandtable_draw::border::border_edges;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DrawMesh, DrawVertex};
use sandtable_mesh::sink::MeshSink;
use sandtable_raster::answer::Answer;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::query::{Interpolation, ground_height};

/// The depth of the base below the lowest ground, as a part of the ground's longer side.
const DEPTH: f64 = 0.03;

/// The thickness of the topsoil, as a part of the depth of the base.
const TOPSOIL: f32 = 0.2;

/// The levels of the strata between the base and the lowest ground, from below, as parts of that depth. All lie below
/// the topsoil of the lowest ground, so that no stratum is cut by it.
const LEVELS: [f32; 2] = [0.34, 0.66];

/// The most posts without data, as a share of all, over which the block still has a rectangular base.
const MOST_MISSING: f64 = 0.1;

/// The colors of the strata from below, each at its lower and at its upper edge: rock, clay, subsoil, topsoil. Light, so that
/// they can be told apart on walls in the shade.
const STRATA: [[Srgba; 2]; 4] = [
    [Srgba::opaque(146, 137, 129), Srgba::opaque(157, 148, 139)],
    [Srgba::opaque(186, 157, 130), Srgba::opaque(194, 166, 139)],
    [Srgba::opaque(234, 211, 178), Srgba::opaque(242, 221, 190)],
    [Srgba::opaque(141, 116, 92), Srgba::opaque(153, 128, 102)],
];

/// World Z of the foot of the walls under a ground that is drawn over `bounds`.
pub fn base_z((min, max): (Vec3, Vec3)) -> f32 {
    min.z - (f64::from((max - min).truncate().max_element()) * DEPTH) as f32
}

/// World Z of what shows where there is no ground: the plate's top, or the foot of the walls.
pub fn floor_z(lattice: &Lattice, bounds: (Vec3, Vec3)) -> f32 {
    let foot = base_z(bounds);
    if has_plate(lattice) { foot + (bounds.0.z - foot) * LEVELS[0] } else { foot }
}

/// Whether the block has a rectangular base though its ground is none.
fn has_plate(lattice: &Lattice) -> bool {
    let missing = lattice.missing_posts();
    missing > 0 && missing as f64 <= MOST_MISSING * lattice.heights().len() as f64
}

/// The heights of the strata under a place.
#[derive(Clone, Copy, Debug)]
struct SoilSection {
    base_z: f32,
    depth_m: f32,
}

impl SoilSection {
    /// World Z of the base, the edges between strata and the ground, from below, where the ground is at `ground_z`.
    fn levels(&self, ground_z: f32) -> [f32; STRATA.len() + 1] {
        let at = |part: f32| self.base_z + self.depth_m * part;
        [at(0.0), at(LEVELS[0]), at(LEVELS[1]), ground_z - self.depth_m * TOPSOIL, ground_z]
    }
}

/// Walls under the border edges of `ground`, a mesh of the displayed heights in `lattice`, which is drawn over
/// `bounds`, down to [`base_z`].
///
/// A border edge gets a wall where there is no ground beyond it: at the lattice's border and around holes, not
/// where a neighboring patch is merely out of view.
pub fn plinth(ground: &DrawMesh, lattice: &Lattice, bounds: (Vec3, Vec3)) -> DrawMesh {
    let mut walls = DrawMesh::default();
    let base_z = base_z(bounds);
    let section = SoilSection { base_z, depth_m: bounds.0.z - base_z };
    for (from, to) in border_edges(ground) {
        let along = to.truncate() - from.truncate();
        let Some(outward) = Vec2::new(along.y, -along.x).try_normalize() else {
            continue;
        };
        if !is_ground_beyond(lattice, (from + to).truncate() / 2.0, outward) {
            add_wall(&mut walls, (from, to), &section, outward);
        }
    }
    walls
}

/// The lowest stratum as a plate under all of the rectangle that `bounds` covers in plan, where the ground reaches its
/// borders almost everywhere: a model that was turned into another coordinate system ends in steps, and its base is to
/// be straight. `None` where the ground fills the rectangle, so that the walls are straight, or leaves much of it free.
pub fn base_plate(lattice: &Lattice, bounds: (Vec3, Vec3)) -> Option<DrawMesh> {
    if !has_plate(lattice) {
        return None;
    }
    let (min, max) = (bounds.0.truncate(), bounds.1.truncate());
    let foot = base_z(bounds);
    let top = floor_z(lattice, bounds);
    let mut plate = DrawMesh::default();
    let mut quad = |corners: [Vec3; 4], normal: Vec3, colors: [Srgba; 2]| {
        let normal = normal.to_array();
        let ids = [0, 1, 2, 3].map(|corner: usize| {
            let (position, color) = (corners[corner].to_array(), colors[corner / 2]);
            plate.vertex(DrawVertex { position, normal, uv: [0.0; 2], color })
        });
        plate.triangle([ids[0], ids[1], ids[2]]);
        plate.triangle([ids[0], ids[2], ids[3]]);
    };
    let ring = [min, Vec2::new(max.x, min.y), max, Vec2::new(min.x, max.y)];
    for side in 0..4 {
        let (from, to) = (ring[side], ring[(side + 1) % 4]);
        let outward = Vec2::new(to.y - from.y, from.x - to.x).normalize_or_zero().extend(0.0);
        quad([from.extend(foot), to.extend(foot), to.extend(top), from.extend(top)], outward, STRATA[0]);
    }
    quad(ring.map(|corner| corner.extend(top)), Vec3::Z, [STRATA[0][1]; 2]);
    Some(plate)
}

fn is_ground_beyond(lattice: &Lattice, middle: Vec2, outward: Vec2) -> bool {
    let step = lattice.cell().min_element() * 0.25;
    let beyond: DVec2 = lattice.origin() + middle.as_dvec2() + outward.as_dvec2() * step;
    matches!(ground_height(lattice, Interpolation::Planar, beyond), Answer::Height(_))
}

/// Adds a wall in strata under the edge from `from` to `to`.
fn add_wall(walls: &mut DrawMesh, (from, to): (Vec3, Vec3), section: &SoilSection, outward: Vec2) {
    let normal = outward.extend(0.0).to_array();
    let levels = [from, to].map(|end| section.levels(end.z));
    for (stratum, colors) in STRATA.iter().enumerate() {
        let mut corner = |end: usize, edge: usize| {
            let position = [from, to][end].with_z(levels[end][stratum + edge]).to_array();
            walls.vertex(DrawVertex { position, normal, uv: [0.0; 2], color: colors[edge] })
        };
        let corners = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        walls.triangle([corners[0], corners[1], corners[2]]);
        walls.triangle([corners[0], corners[2], corners[3]]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_mesh::sink::VertexId;

    /// Two by one cells; the eastern one is left out of the mesh, as if it were out of view.
    fn western_cell(lattice: &Lattice) -> DrawMesh {
        let mut mesh = DrawMesh::default();
        let plan = [(0, 0), (1, 0), (1, 1), (0, 1)];
        let ids: Vec<VertexId> = plan
            .iter()
            .map(|&(column, row)| {
                let position = lattice.position(sandtable_terrain::lattice::Post { column, row }).extend(5.0);
                mesh.vertex(DrawVertex {
                    position: position.to_array(),
                    normal: [0.0, 0.0, 1.0],
                    uv: [0.0; 2],
                    color: Srgba::WHITE,
                })
            })
            .collect();
        mesh.triangle([ids[0], ids[1], ids[2]]);
        mesh.triangle([ids[0], ids[2], ids[3]]);
        mesh
    }

    #[test]
    fn walls_stand_at_the_world_s_edge_and_face_outward_but_not_at_the_edge_of_view() {
        let lattice =
            Lattice::new(DVec2::new(700.0, 900.0), DVec2::splat(10.0), 3, vec![5.0; 6]).expect("sound");
        let bounds = (Vec3::Z * 5.0, Vec3::new(20.0, 10.0, 5.0));
        let walls = plinth(&western_cell(&lattice), &lattice, bounds);
        assert_eq!(walls.triangles.len(), 3 * 2 * STRATA.len(), "south, west and north");
        for triangle in &walls.triangles {
            let [a, b, c] = triangle.map(|id| Vec3::from(walls.vertices[id.index()].position));
            let normal = Vec3::from(walls.vertices[triangle[0].index()].normal);
            assert!((b - a).cross(c - a).dot(normal) > 0.0, "{a} {b} {c} faces {normal}");
        }
    }

    #[test]
    fn strata_are_level_below_the_lowest_ground_and_the_topsoil_follows_the_ground() {
        let section = SoilSection { base_z: 100.0, depth_m: 50.0 };
        let (low, high) = (section.levels(150.0), section.levels(900.0));
        assert!(low.windows(2).all(|pair| pair[0] < pair[1]), "{low:?}");
        assert_eq!(low[..3], high[..3]);
        assert_eq!((low[0], high[4], high[4] - high[3]), (100.0, 900.0, low[4] - low[3]));
    }

    #[test]
    fn a_block_with_ragged_borders_has_a_straight_base_and_no_other_has_a_plate() {
        let lattice = |missing: usize| {
            let mut heights = vec![5.0; 100];
            heights[..missing].fill(f32::NAN);
            Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 10, heights).expect("sound")
        };
        let bounds = (Vec3::Z * 5.0, Vec3::new(90.0, 90.0, 5.0));
        assert!(base_plate(&lattice(0), bounds).is_none() && base_plate(&lattice(40), bounds).is_none());
        let plate = base_plate(&lattice(4), bounds).expect("a plate");
        assert_eq!(plate.triangles.len(), 10);
        for triangle in &plate.triangles {
            let [a, b, c] = triangle.map(|id| Vec3::from(plate.vertices[id.index()].position));
            let normal = Vec3::from(plate.vertices[triangle[0].index()].normal);
            assert!((b - a).cross(c - a).dot(normal) > 0.0, "{a} {b} {c} faces {normal}");
        }
    }
}
