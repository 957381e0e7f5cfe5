//! Coarser levels of a model: points are collapsed into their neighbors one by one, cheapest first.
//!
//! # How
//! ```text
//!     p ── q          Every step moves a point p into a neighbor q (a half-edge collapse): the triangles
//!    ╱ ╲  ╱           between them vanish, the others around p now reach q. Positions, normals, texture
//!   ·────·            coordinates and colors are always those of the file.
//! ```
//! The cost of a step is the sum of squared distances of q from all planes of p and q (`quadric`) plus the squared change
//! in appearance (`appearance`). Borders and seams have planes of their own, upright on the surface, that keep their
//! line. A vertex at p becomes the one at q with which it shares a vanishing triangle; a vertex without such a
//! counterpart, such as that of the third face at a box's corner, keeps its attributes. A step is refused where a
//! triangle would flip or the surface would close on itself (the link condition: Dey et al., "Topology preserving edge
//! contraction", 1999).
//!
//! The error of a level is measured, not summed up: the greatest distance of a point of the file from the coarser surface
//! near the point into which it was collapsed.
//!
//! # Why our own
//! `meshopt` needs a C++ compiler; its port `meshopt-rs` (0.1.2) reads positions only and simplifies one index buffer, so
//! that parts of a model come apart where materials meet; the geometry libraries with quadrics (`baby_shark`,
//! `threecrate-simplification`) drop texture coordinates. None measures its error.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DVec3, Vec3};

use crate::appearance::difference;
use crate::quadric::{Quadric, edges, quadrics};
use crate::soup::{PointId, Soup, SoupWedge, WedgeId};
use crate::{Model, ModelPart};
use sandtable_draw::list::DrawVertex;
use sandtable_geom::triangle;

/// Models of fewer triangles have no levels: they cost no more than the items that draw them.
pub const MIN_TRIANGLES: usize = 64;

/// Models of more triangles have no levels: simplification takes some microseconds and half a kilobyte a triangle.
pub const MAX_TRIANGLES: usize = 1 << 20;

/// The parts of the model's triangles at which its levels aim.
const TARGETS: [f64; 3] = [0.5, 0.25, 0.0625];

/// A level is kept where it has at most this part of the previous one's triangles: less would not be worth the memory.
const MAX_REMAINDER: f64 = 0.75;

/// Simplification ends where a step costs as much as an error of this part of the model's radius: so coarse a level could
/// only be drawn a few pixels tall, where an impostor is better.
const MAX_STEP: f64 = 0.1;

/// A level has at least this part of the model's area. Twigs and lattices vanish piece by piece and would look thinner
/// and thinner; their far form is the impostor, which keeps the area that they cover.
const MIN_AREA: f64 = 0.85;

/// The cosine of the greatest rotation of a triangle in one step: 75°.
const MIN_FLIP_COS: f64 = 0.25;

/// A point with more triangles around it is not collapsed: bounds the time that a hostile fan can take.
const MAX_RING: usize = 64;

/// A coarser level of a model.
#[derive(Clone, Debug)]
pub struct DetailLevel {
    /// Meshes of one material each, with the model's materials.
    pub parts: Vec<ModelPart>,
    /// The greatest distance of its surface from the model's, in the model's units.
    pub error: f32,
}

impl DetailLevel {
    /// The number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.parts.iter().map(|part| part.mesh.triangles.len()).sum()
    }
}

/// The coarser levels of a model, finest first: triangles fall and errors do not.
///
/// None for models of fewer than [`MIN_TRIANGLES`] or more than [`MAX_TRIANGLES`], and for those that cannot be
/// simplified.
pub fn levels(model: &Model) -> Vec<DetailLevel> {
    let count = model.triangle_count();
    if !(MIN_TRIANGLES..=MAX_TRIANGLES).contains(&count) {
        return Vec::new();
    }
    let mut simplifier = Simplifier::new(model);
    let mut levels: Vec<DetailLevel> = Vec::new();
    let (mut previous, min_area) = (count, simplifier.soup.area() * MIN_AREA);
    for target in TARGETS {
        let stop = simplifier.simplify_to((count as f64 * target) as usize);
        if simplifier.soup.area() < min_area {
            break;
        }
        if simplifier.soup.triangle_count as f64 <= previous as f64 * MAX_REMAINDER {
            previous = simplifier.soup.triangle_count;
            let finer = levels.last().map_or(0.0, |level| level.error);
            let error = finer.max(simplifier.error() as f32);
            levels.push(DetailLevel { parts: simplifier.soup.parts(model), error });
        }
        if stop == StopReason::NoCandidates {
            break;
        }
    }
    levels
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StopReason {
    /// The target is reached.
    Reached,
    /// No allowed step is left.
    NoCandidates,
}

/// A step that may be allowed; its cost is never above the true one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct CollapseCandidate {
    /// The bits of a cost that is not negative, which rise as it does.
    cost: u64,
    from: PointId,
    to: PointId,
}

struct CollapseStep {
    cost: f64,
    /// The change in appearance, in the model's units.
    change: f64,
    moves: Vec<WedgeMove>,
}

/// A wedge at the collapsed point and the vertex that replaces it.
#[derive(Clone, Copy)]
struct WedgeMove {
    wedge: WedgeId,
    vertex: DrawVertex,
}

struct Simplifier {
    soup: Soup,
    quadrics: Vec<Quadric>,
    /// The point into which each was collapsed; itself where it was not.
    collapsed_into: Vec<PointId>,
    candidates: BinaryHeap<Reverse<CollapseCandidate>>,
    /// The greatest change in appearance so far, in the model's units.
    change: f64,
    max_cost: f64,
}

impl Simplifier {
    fn new(model: &Model) -> Self {
        let soup = Soup::new(model);
        let radius = model.bounds().map_or(0.0, |bounds| f64::from(bounds.size().length()) * 0.5);
        let edges = edges(&soup);
        let mut simplifier = Self {
            quadrics: quadrics(&soup, &edges),
            collapsed_into: (0..soup.points.len() as u32).map(PointId).collect(),
            candidates: BinaryHeap::with_capacity(edges.len() * 2),
            change: 0.0,
            max_cost: (MAX_STEP * radius) * (MAX_STEP * radius),
            soup,
        };
        for edge in edges {
            simplifier.push_both(edge.a, edge.b);
        }
        simplifier
    }

    /// Adds the steps between two points with the cost of their shape alone: appearance is added when they are popped.
    fn push_both(&mut self, a: PointId, b: PointId) {
        for (from, to) in [(a, b), (b, a)] {
            let cost = self.shape_cost(from, to).to_bits();
            self.candidates.push(Reverse(CollapseCandidate { cost, from, to }));
        }
    }

    fn shape_cost(&self, from: PointId, to: PointId) -> f64 {
        let both = self.quadrics[from.0 as usize].plus(&self.quadrics[to.0 as usize]);
        both.squared_distances(self.soup.position(to))
    }

    fn simplify_to(&mut self, triangles: usize) -> StopReason {
        while self.soup.triangle_count > triangles {
            let Some(Reverse(candidate)) = self.candidates.pop() else { return StopReason::NoCandidates };
            let Some(step) = self.step(candidate.from, candidate.to) else { continue };
            let cost = step.cost.to_bits();
            if cost > candidate.cost {
                self.candidates.push(Reverse(CollapseCandidate { cost, ..candidate }));
            } else if step.cost > self.max_cost {
                return StopReason::NoCandidates;
            } else {
                self.apply(candidate.from, candidate.to, &step);
            }
        }
        StopReason::Reached
    }

    /// The step from one point into another; `None` where they are not neighbors or the step is not allowed.
    fn step(&self, from: PointId, to: PointId) -> Option<CollapseStep> {
        let ring = self.soup.ring(from);
        if ring.len() > MAX_RING || self.soup.ring(to).len() > MAX_RING {
            return None;
        }
        let (removed, moved): (Vec<u32>, Vec<u32>) =
            ring.iter().partition(|&&triangle| self.soup.corners(triangle).contains(&to));
        if removed.is_empty()
            || moved.iter().any(|&triangle| self.flips(triangle, from, to))
            || !self.keeps_link_condition(&removed, from, to)
        {
            return None;
        }
        let moves = self.wedge_moves(&removed, &moved, from, to);
        let change = self.appearance_change(&moved, from, &moves);
        Some(CollapseStep { cost: self.shape_cost(from, to) + change * change, change, moves })
    }

    /// The wedges at `from` with their vertices at `to`.
    fn wedge_moves(&self, removed: &[u32], moved: &[u32], from: PointId, to: PointId) -> Vec<WedgeMove> {
        let wedge_at = |triangle: u32, point: PointId| {
            let wedges = self.soup.triangles[triangle as usize];
            wedges.into_iter().find(|&id| self.soup.wedge(id).point == point)
        };
        let position = self.soup.position(to).as_vec3().to_array();
        let mut moves: Vec<WedgeMove> = Vec::with_capacity(4);
        for &triangle in removed.iter().chain(moved) {
            let Some(wedge) = wedge_at(triangle, from) else { continue };
            if moves.iter().all(|known| known.wedge != wedge) {
                let template = wedge_at(triangle, to).unwrap_or(wedge);
                let vertex = DrawVertex { position, ..self.soup.wedge(template).vertex };
                moves.push(WedgeMove { wedge, vertex });
            }
        }
        moves
    }

    /// Whether the common neighbors of both points are just the third corners of the removed triangles.
    fn keeps_link_condition(&self, removed: &[u32], from: PointId, to: PointId) -> bool {
        let corners = removed.iter().flat_map(|&triangle| self.soup.corners(triangle));
        let mut third: Vec<PointId> = corners.filter(|&point| point != from && point != to).collect();
        third.sort_unstable();
        third.dedup();
        let neighbors = self.soup.neighbors(to);
        let common =
            self.soup.neighbors(from).into_iter().filter(|point| neighbors.binary_search(point).is_ok());
        common.eq(third)
    }

    /// Whether a triangle rotates too far where `from` moves to `to`.
    fn flips(&self, triangle: u32, from: PointId, to: PointId) -> bool {
        let corners = self.soup.corners(triangle);
        let before = triangle::normal(self.soup.corner_positions(triangle));
        let moved = |point: PointId| self.soup.position(if point == from { to } else { point });
        let after = triangle::normal(corners.map(moved));
        let lengths = before.length() * after.length();
        before != DVec3::ZERO && before.dot(after) <= MIN_FLIP_COS * lengths
    }

    /// The change in appearance at `from`, in the model's units: for each wedge that at the nearest point of its moved
    /// triangles, of all wedges the greatest.
    fn appearance_change(&self, moved: &[u32], from: PointId, moves: &[WedgeMove]) -> f64 {
        let position = self.soup.position(from);
        let mut nearest: Vec<Option<(f64, f64)>> = vec![None; moves.len()];
        for &triangle in moved {
            let wedges = self.soup.triangles[triangle as usize];
            let move_of = |id: WedgeId| moves.iter().position(|each| each.wedge == id);
            let Some(index) = wedges.into_iter().find_map(move_of) else { continue };
            let corners =
                wedges.map(|id| move_of(id).map_or(self.soup.wedge(id).vertex, |index| moves[index].vertex));
            let points = corners.map(|corner| Vec3::from(corner.position).as_dvec3());
            let weights = triangle::nearest_weights(position, points);
            let distance = triangle::point_at(points, weights).distance_squared(position);
            if nearest[index].is_none_or(|(known, _)| distance < known) {
                let WedgeMove { wedge, vertex } = &moves[index];
                let reach = position.distance(Vec3::from(vertex.position).as_dvec3());
                let expected = &self.soup.wedge(*wedge).vertex;
                let change = difference(expected, corners.each_ref(), weights, reach);
                nearest[index] = Some((distance, change));
            }
        }
        nearest.into_iter().flatten().map(|(_, change)| change).fold(0.0, f64::max)
    }

    fn apply(&mut self, from: PointId, to: PointId, step: &CollapseStep) {
        let mut targets = Vec::with_capacity(step.moves.len());
        for &WedgeMove { wedge, vertex } in &step.moves {
            let part = self.soup.wedge(wedge).part;
            targets.push((wedge, self.soup.find_or_add_wedge(SoupWedge { point: to, part, vertex })));
        }
        let third = self.soup.collapse(from, to, &targets);
        for point in std::iter::once(to).chain(third) {
            // The hub of a fan keeps removed triangles: compacting it at every step takes the square of its width.
            if self.soup.ring(point).len() <= 2 * MAX_RING {
                self.soup.compact_ring(point);
            }
        }
        self.quadrics[to.0 as usize] = self.quadrics[to.0 as usize].plus(&self.quadrics[from.0 as usize]);
        self.collapsed_into[from.0 as usize] = to;
        self.change = self.change.max(step.change);
        for neighbor in self.soup.neighbors(to) {
            self.push_both(to, neighbor);
        }
    }

    /// The greatest distance of the model's points from the surface, or the greatest change in appearance if that is
    /// more; in the model's units.
    fn error(&mut self) -> f64 {
        let mut error = self.change;
        for point in (0..self.collapsed_into.len() as u32).map(PointId) {
            let target = self.target(point);
            error = error.max(self.distance(point, target));
        }
        error
    }

    /// The point of the surface into which `point` was collapsed in the end; shortens the path to it.
    fn target(&mut self, point: PointId) -> PointId {
        let mut target = point;
        while self.collapsed_into[target.0 as usize] != target {
            target = self.collapsed_into[target.0 as usize];
        }
        let mut next = point;
        while next != target {
            next = std::mem::replace(&mut self.collapsed_into[next.0 as usize], target);
        }
        target
    }

    /// The distance of a point from the surface near `target`: walks from the triangles there to nearer ones.
    fn distance(&self, point: PointId, target: PointId) -> f64 {
        if point == target {
            return 0.0;
        }
        let position = self.soup.position(point);
        let distance = |triangle: u32| triangle::distance(position, self.soup.corner_positions(triangle));
        let nearest_around = |points: &[PointId]| {
            let rings = points.iter().map(|&corner| self.soup.ring(corner));
            let triangles = rings.filter(|ring| ring.len() <= 2 * MAX_RING).flatten();
            triangles.map(|&triangle| (distance(triangle), triangle)).min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let Some((mut best, mut triangle)) = nearest_around(&[target]) else {
            return position.distance(self.soup.position(target));
        };
        while let Some((nearer, next)) = nearest_around(&self.soup.corners(triangle))
            && nearer < best
        {
            (best, triangle) = (nearer, next);
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec2};

    use super::*;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::list::{DrawMesh, MaterialId};
    use sandtable_draw::material::{Material, TextureId};
    use sandtable_mesh::sink::{MeshSink, VertexId};

    /// A grid of `side` × `side` cells on the unit square, bent by `height` and turned by `turn`.
    fn sheet(side: u32, turn: Quat, height: &dyn Fn(Vec2) -> f32, color: &dyn Fn(Vec2) -> Srgba) -> Model {
        let mut mesh = DrawMesh::default();
        for row in 0..=side {
            for column in 0..=side {
                let at = Vec2::new(column as f32, row as f32) / side as f32;
                mesh.vertex(DrawVertex {
                    position: (turn * at.extend(height(at))).to_array(),
                    normal: (turn * Vec3::Z).to_array(),
                    uv: at.to_array(),
                    color: color(at),
                });
            }
        }
        let id = |column: u32, row: u32| VertexId(row * (side + 1) + column);
        for row in 0..side {
            for column in 0..side {
                let [a, b, c, d] =
                    [id(column, row), id(column + 1, row), id(column + 1, row + 1), id(column, row + 1)];
                mesh.triangle([a, b, c]);
                mesh.triangle([a, c, d]);
            }
        }
        let part = ModelPart { name: "sheet".into(), mesh, material: MaterialId(0) };
        let material = Material { texture: Some(TextureId(0)), ..Material::default() };
        Model { parts: vec![part], materials: vec![material], ..Model::default() }
    }

    fn turns() -> impl Iterator<Item = Quat> {
        [0.0, 0.6, 1.9, 4.0]
            .into_iter()
            .map(|angle| Quat::from_axis_angle(Vec3::new(1.0, 2.0, 3.0).normalize(), angle))
    }

    fn area(parts: &[ModelPart]) -> f32 {
        let doubled = parts.iter().flat_map(|part| {
            part.mesh.triangles.iter().map(|corners| {
                let [a, b, c] = corners.map(|id| Vec3::from(part.mesh.vertices[id.index()].position));
                (b - a).cross(c - a).length()
            })
        });
        doubled.sum::<f32>() * 0.5
    }

    #[test]
    fn a_flat_sheet_loses_triangles_but_no_area_and_keeps_its_appearance() {
        for turn in turns() {
            let model = sheet(12, turn, &|_| 0.0, &|_| Srgba::WHITE);
            let levels = levels(&model);
            assert_eq!(levels.len(), 3);
            for (level, most) in levels.iter().zip([144, 72, 18]) {
                assert!(level.triangle_count() <= most, "{}", level.triangle_count());
                assert!((area(&level.parts) - 1.0).abs() < 1e-4);
                assert!(level.error < 1e-4, "{}", level.error);
            }
        }
    }

    #[test]
    fn errors_rise_from_level_to_level_and_hold_for_every_point_of_the_model() {
        for turn in turns() {
            let model = sheet(24, turn, &|at| 0.1 * libm::sinf(at.x * 9.0) * at.y, &|_| Srgba::WHITE);
            let levels = levels(&model);
            assert!(levels.windows(2).all(|pair| pair[0].error <= pair[1].error));
            for level in &levels {
                let surface: Vec<[DVec3; 3]> = triangles_of(&level.parts);
                for vertex in &model.parts[0].mesh.vertices {
                    let at = Vec3::from(vertex.position).as_dvec3();
                    let distance = |&corners: &[DVec3; 3]| triangle::distance(at, corners);
                    let off = surface.iter().map(distance).fold(f64::INFINITY, f64::min);
                    assert!(off <= f64::from(level.error) + 1e-6, "{off} where {} is stated", level.error);
                }
            }
            assert!(levels[0].error > 0.0 && levels[0].error < 0.02, "{}", levels[0].error);
        }
    }

    fn triangles_of(parts: &[ModelPart]) -> Vec<[DVec3; 3]> {
        let of_part = |part: &ModelPart| -> Vec<[DVec3; 3]> {
            let at = |id: VertexId| Vec3::from(part.mesh.vertices[id.index()].position).as_dvec3();
            part.mesh.triangles.iter().map(|corners| corners.map(at)).collect()
        };
        parts.iter().flat_map(of_part).collect()
    }

    #[test]
    fn a_painted_border_on_flat_ground_is_kept_or_stated_as_an_error() {
        let stripe = |at: Vec2| if at.x < 0.5 { Srgba::WHITE } else { Srgba::opaque(0, 0, 0) };
        let painted = levels(&sheet(16, Quat::IDENTITY, &|_| 0.0, &stripe));
        let plain = levels(&sheet(16, Quat::IDENTITY, &|_| 0.0, &|_| Srgba::WHITE));
        assert!(plain.last().is_some_and(|level| level.error < 1e-4));
        for level in &painted {
            let black = level.parts[0].mesh.triangles.iter().filter(|corners| {
                corners.iter().all(|id| level.parts[0].mesh.vertices[id.index()].color != Srgba::WHITE)
            });
            assert!(black.count() > 0);
        }
        assert!(painted[0].error < 0.04, "{}", painted[0].error);
    }

    #[test]
    fn parts_that_meet_do_not_come_apart() {
        let mut model = sheet(16, Quat::IDENTITY, &|at| 0.2 * at.x * at.x, &|_| Srgba::WHITE);
        let whole = model.parts[0].mesh.clone();
        let (left, right): (Vec<_>, Vec<_>) = whole.triangles.iter().partition(|corners| {
            corners.iter().map(|id| whole.vertices[id.index()].uv[0]).sum::<f32>() < 1.5
        });
        let part = |triangles, material| ModelPart {
            name: String::new(),
            mesh: DrawMesh { vertices: whole.vertices.clone(), triangles },
            material: MaterialId(material),
        };
        model.parts = vec![part(left, 0), part(right, 1)];
        model.materials.push(model.materials[0].clone());
        for level in levels(&model) {
            assert_eq!(level.parts.len(), 2);
            let border = |part: &ModelPart| {
                let on_border = part.mesh.vertices.iter().filter(|vertex| (vertex.uv[0] - 0.5).abs() < 1e-6);
                let mut rows: Vec<u32> = on_border.map(|vertex| vertex.uv[1].to_bits()).collect();
                rows.sort_unstable();
                rows
            };
            assert_eq!(border(&level.parts[0]), border(&level.parts[1]));
            assert!((level.parts[0].mesh.triangles.len() as i64).abs_diff(0) > 0);
        }
    }

    #[test]
    fn small_models_have_no_levels() {
        assert!(levels(&sheet(5, Quat::IDENTITY, &|_| 0.0, &|_| Srgba::WHITE)).is_empty());
        assert!(levels(&Model::default()).is_empty());
    }
}
