//! Solids for printers: a relief over a rectangle, closed by walls and a level base, with joints to its neighbors.
//!
//! ```text
//!      ╱╲__╱╲        the relief
//!   B ──────────     a level line under it, a vertex below every vertex of the relief's border
//!   C ─┌┐──┌┐──      the upper edge of sockets, in which pegs stand with room around them
//!   D ─└┘──└┘──      their lower edge
//!   0 ──────────     the base
//! ```
//!
//! A wall is built of strips between these level lines, so that no vertex of one strip lies inside an edge of another.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use crate::sink::{MeshSink, VertexId};
use crate::trimesh::TriMesh;

/// The thickness of the block under the lowest relief, in millimeters: stiff enough for a plate of a hand's width, and high
/// enough for joints.
pub const BASE_MM: f32 = 5.0;

/// Heights in millimeters of the lower and upper edge of sockets, and of the level line over them.
const SOCKET_MM: [f32; 2] = [1.0, 3.0];
const BELT_MM: f32 = 4.0;

/// Half the width of a socket, and how far a peg stands out, in millimeters.
const SOCKET_HALF_MM: f32 = 3.0;
const PEG_MM: f32 = 4.0;

/// The room that a socket leaves around a peg, in millimeters: printers of molten plastic are as exact as that.
const CLEARANCE_MM: f32 = 0.15;

/// Where joints are, as shares of a side: the same seen from both pieces.
const JOINTS_AT: [f32; 2] = [0.25, 0.75];

/// A side shorter than this, in millimeters, has no room for two joints.
const LEAST_JOINED_MM: f32 = 40.0;

/// The joint of a block's side with its neighbor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// Nothing: the side is plane.
    None,
    /// Pegs that stand out.
    Peg,
    /// Sockets for pegs.
    Socket,
}

/// The solid under `relief`, a conforming mesh in millimeters over a rectangle with all of Z at [`BASE_MM`] or above.
/// `joints` are those of the south, east, north and west sides.
pub fn solid_block(relief: &TriMesh, joints: [Joint; 4]) -> TriMesh {
    let mut block = BlockBuilder::new(relief);
    let positions = || relief.positions.iter().map(|at| at.truncate());
    let min = positions().fold(Vec2::INFINITY, Vec2::min);
    let max = positions().fold(Vec2::NEG_INFINITY, Vec2::max);
    let walls = [
        BlockSide { axis: 0, aside: min.y, ends: [min.x, max.x], outward: Vec2::NEG_Y },
        BlockSide { axis: 1, aside: max.x, ends: [min.y, max.y], outward: Vec2::X },
        BlockSide { axis: 0, aside: max.y, ends: [max.x, min.x], outward: Vec2::Y },
        BlockSide { axis: 1, aside: min.x, ends: [max.y, min.y], outward: Vec2::NEG_X },
    ];
    for (wall, joint) in walls.iter().zip(joints) {
        let is_short = (wall.ends[1] - wall.ends[0]).abs() < LEAST_JOINED_MM;
        block.wall(wall, relief, if is_short { Joint::None } else { joint });
    }
    let [west_south, east_south, east_north, west_north] =
        walls.map(|wall| block.vertex(wall.at(wall.ends[0], 0.0)));
    block.quad([west_south, west_north, east_north, east_south]);
    block.mesh
}

/// A side of a block. Its places are named by their coordinate along it, the same number in every vertex above another.
#[derive(Clone, Copy, Debug)]
struct BlockSide {
    /// 0 where it runs along X, 1 where it runs along Y.
    axis: usize,
    /// Its coordinate on the other axis.
    aside: f32,
    /// Its coordinates along the axis, from left to right seen from outside.
    ends: [f32; 2],
    outward: Vec2,
}

impl BlockSide {
    fn at(&self, along: f32, z_mm: f32) -> Vec3 {
        let mut at = Vec3::new(self.aside, self.aside, z_mm);
        at[self.axis] = along;
        at
    }

    /// 1 where coordinates rise from left to right, otherwise -1.
    fn sign(&self) -> f32 {
        (self.ends[1] - self.ends[0]).signum()
    }

    /// The left and right edges of its sockets, from left to right.
    fn socket_edges(&self) -> Vec<f32> {
        let [left, right] = self.ends;
        let edges = |share: f32| {
            [-SOCKET_HALF_MM, SOCKET_HALF_MM].map(|aside| left + (right - left) * share + aside * self.sign())
        };
        JOINTS_AT.into_iter().flat_map(edges).collect()
    }
}

struct BlockBuilder {
    mesh: TriMesh,
    /// The vertices by the bits of their positions.
    ids: HashMap<[u32; 3], VertexId>,
}

impl BlockBuilder {
    /// The relief, with one vertex at each place: patches of a mesh may each have their own along their borders.
    fn new(relief: &TriMesh) -> Self {
        let mut block =
            Self { mesh: TriMesh::default(), ids: HashMap::with_capacity(relief.positions.len()) };
        let ids: Vec<VertexId> = relief.positions.iter().map(|&at| block.vertex(at)).collect();
        block.mesh.triangles =
            relief.triangles.iter().map(|corners| corners.map(|id| ids[id.index()])).collect();
        block
    }

    /// The vertex at a place, made on first use: strips and sides share theirs.
    fn vertex(&mut self, at: Vec3) -> VertexId {
        let mesh = &mut self.mesh;
        *self.ids.entry(at.to_array().map(f32::to_bits)).or_insert_with(|| mesh.vertex(at))
    }

    /// Two triangles, counterclockwise seen from outside.
    fn quad(&mut self, [a, b, c, d]: [VertexId; 4]) {
        self.mesh.triangle([a, b, c]);
        self.mesh.triangle([a, c, d]);
    }

    fn wall(&mut self, wall: &BlockSide, relief: &TriMesh, joint: Joint) {
        let is_over = |at: &&Vec3| at[1 - wall.axis] == wall.aside;
        let mut border: Vec<Vec3> = relief.positions.iter().filter(is_over).copied().collect();
        border.sort_by(|a, b| (a[wall.axis] * wall.sign()).total_cmp(&(b[wall.axis] * wall.sign())));
        border.dedup();
        let belt: Vec<f32> = border.iter().map(|at| at[wall.axis]).collect();
        for (ends, along) in border.windows(2).zip(belt.windows(2)) {
            let [left, right] = [0, 1].map(|end| self.vertex(wall.at(along[end], BELT_MM)));
            let [above_left, above_right] = [0, 1].map(|end| self.vertex(ends[end]));
            self.quad([left, right, above_right, above_left]);
        }
        // Every wall has the same level lines, whatever it joins: they meet at its corners.
        let edges = if joint == Joint::None { Vec::new() } else { wall.socket_edges() };
        let stations = [&wall.ends[..1], &edges, &wall.ends[1..]].concat();
        let [low, high] = SOCKET_MM;
        self.strip(wall, (&stations, high), (&belt, BELT_MM));
        self.strip(wall, (&wall.ends, 0.0), (&stations, low));
        for (number, ends) in stations.windows(2).enumerate() {
            let corners = [(ends[0], low), (ends[1], low), (ends[1], high), (ends[0], high)];
            let mouth = corners.map(|(along, z_mm)| self.vertex(wall.at(along, z_mm)));
            let outward = wall.outward.extend(0.0);
            match (number % 2, joint) {
                (1, Joint::Peg) => {
                    let aside = wall.sign() * CLEARANCE_MM;
                    let [left, right, below, above] =
                        [ends[0] + aside, ends[1] - aside, low + CLEARANCE_MM, high - CLEARANCE_MM];
                    let corners = [(left, below), (right, below), (right, above), (left, above)];
                    let root = corners.map(|(along, z_mm)| wall.at(along, z_mm));
                    let around = root.map(|at| self.vertex(at));
                    self.ring(mouth, around);
                    self.box_on(root, outward * PEG_MM);
                }
                (1, _) => self.box_on(
                    corners.map(|(along, z_mm)| wall.at(along, z_mm)),
                    -outward * (PEG_MM + CLEARANCE_MM),
                ),
                _ => self.quad(mouth),
            }
        }
    }

    /// The strip between two rectangles, the second within or beyond the first.
    fn ring(&mut self, outer: [VertexId; 4], inner: [VertexId; 4]) {
        for side in 0..4 {
            let next = (side + 1) % 4;
            self.quad([outer[side], outer[next], inner[next], inner[side]]);
        }
    }

    /// A box that stands out from a rectangle or, where `depth` points inward, a hole behind it.
    fn box_on(&mut self, corners: [Vec3; 4], depth: Vec3) {
        let [mouth, end] = [Vec3::ZERO, depth].map(|by| corners.map(|at| self.vertex(at + by)));
        self.ring(mouth, end);
        self.quad(end);
    }

    /// The triangles between two level lines of a wall, each with its vertices from left to right.
    fn strip(&mut self, wall: &BlockSide, (lower, low): (&[f32], f32), (upper, high): (&[f32], f32)) {
        let (mut left, mut above) = (0, 0);
        while left + 1 < lower.len() || above + 1 < upper.len() {
            let is_lower = match (lower.get(left + 1), upper.get(above + 1)) {
                (Some(lower), Some(upper)) => lower * wall.sign() < upper * wall.sign(),
                (next, _) => next.is_some(),
            };
            let [from, over] = [wall.at(lower[left], low), wall.at(upper[above], high)];
            let third =
                if is_lower { wall.at(lower[left + 1], low) } else { wall.at(upper[above + 1], high) };
            let corners = [from, third, over].map(|at| self.vertex(at));
            self.mesh.triangle(corners);
            if is_lower {
                left += 1;
            } else {
                above += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::check_solid;

    /// A relief of `columns` by `rows` cells of 10 mm with a hill in its middle.
    fn relief(columns: u32, rows: u32) -> TriMesh {
        let mut mesh = TriMesh::default();
        for row in 0..=rows {
            for column in 0..=columns {
                let hill = if column > 1 && row % 3 == 1 { 4.0 } else { 0.0 };
                mesh.vertex(Vec3::new(column as f32 * 10.0, row as f32 * 10.0, BASE_MM + hill));
            }
        }
        let id = |column: u32, row: u32| VertexId(row * (columns + 1) + column);
        for row in 0..rows {
            for column in 0..columns {
                let [a, b] = [id(column, row), id(column + 1, row)];
                let [c, d] = [id(column + 1, row + 1), id(column, row + 1)];
                mesh.triangle([a, b, c]);
                mesh.triangle([a, c, d]);
            }
        }
        mesh
    }

    #[test]
    fn a_block_is_closed_with_any_joints() {
        use Joint::{None, Peg, Socket};
        let plain = check_solid(&solid_block(&relief(5, 6), [None; 4])).expect("closed");
        let [wide, high] =
            [2.0 * SOCKET_HALF_MM, SOCKET_MM[1] - SOCKET_MM[0]].map(|side| side - 2.0 * CLEARANCE_MM);
        let peg_mm3 = wide * high * PEG_MM;
        for joints in [
            [Peg, None, None, None],
            [None, Peg, None, None],
            [None, None, Peg, None],
            [None, None, None, Peg],
        ] {
            let pegged = check_solid(&solid_block(&relief(5, 6), joints)).expect("closed");
            assert!((pegged - plain - 2.0 * f64::from(peg_mm3)).abs() < 0.01, "{joints:?}: {pegged}");
            let sockets = joints.map(|joint| if joint == Peg { Socket } else { None });
            let hollowed = check_solid(&solid_block(&relief(5, 6), sockets)).expect("closed");
            assert!(hollowed < plain - 2.0 * f64::from(peg_mm3), "{sockets:?}: {hollowed}");
        }
        check_solid(&solid_block(&relief(5, 6), [Socket, Peg, Peg, Socket])).expect("closed");
    }

    #[test]
    fn pegs_fit_into_the_sockets_of_the_neighbor() {
        let east = solid_block(&relief(6, 5), [Joint::None, Joint::Peg, Joint::None, Joint::None]);
        let west = solid_block(&relief(6, 5), [Joint::None, Joint::None, Joint::None, Joint::Socket]);
        let tips: Vec<Vec3> =
            east.positions.iter().filter(|at| at.x > 60.0).map(|at| at.with_x(at.x - 60.0)).collect();
        let ends: Vec<Vec3> =
            west.positions.iter().filter(|at| at.x > 0.0 && at.x < 9.0 && at.z < BELT_MM).copied().collect();
        assert_eq!((tips.len(), ends.len()), (8, 8));
        for tip in tips {
            let nearest = ends.iter().map(|end| end.distance(tip)).fold(f32::INFINITY, f32::min);
            assert!((nearest - CLEARANCE_MM * 3f32.sqrt()).abs() < 1e-4, "{tip}: {nearest}");
        }
    }

    #[test]
    fn a_small_block_has_no_room_for_joints() {
        let plain = solid_block(&relief(3, 3), [Joint::None; 4]);
        assert_eq!(solid_block(&relief(3, 3), [Joint::Peg; 4]), plain);
    }
}
