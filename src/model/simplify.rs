//! Simpler forms of a model: points drawn into their neighbors one by one, cheapest first.
//!
//! # How
//! ```text
//!     p ── q          Every step moves a point p into a neighbor q (a half-edge collapse): the triangles
//!    ╱ ╲  ╱           between them go, the others around p now reach q. No place is ever made up, and normals,
//!   ·────·            texture coordinates and colors are those of the file.
//! ```
//! What a step costs is the sum of squared distances of q from all the planes that p and q stand for (`quadric`), and
//! what it changes of the looks there (`nearest::difference`). Borders and seams have planes of their own, upright
//! on the surface, that keep their line. A vertex at p becomes the one at q that it shares a vanishing triangle with;
//! one that has no such counterpart, such as that of the third face at a box's corner, moves to q with the looks it
//! has. A step is refused where a triangle would turn over, and where the surface would close on itself (the link
//! condition: Dey and others, "Topology preserving edge contraction", 1999).
//!
//! The error of a level is measured, not summed up: the greatest distance of a point of the file from the simpler
//! surface near the point it went into.
//!
//! # Why our own
//! `meshopt` needs a C++ compiler; its port `meshopt-rs` (0.1.2) knows positions only and simplifies one index
//! buffer, so that parts of a model come apart where materials meet; the geometry libraries that have quadrics
//! (`baby_shark`, `threecrate-simplification`) drop texture coordinates. None measures what it did.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DVec3, Vec3};

use crate::draw::list::DrawVertex;
use crate::model::nearest::{blend, difference, nearest_shares};
use crate::model::quadric::Quadric;
use crate::model::soup::{PointId, Soup, SoupWedge, WedgeId};
use crate::model::{Model, ModelPart};

/// Models of fewer triangles have no levels: they cost no more than the items that draw them.
pub const FEWEST_TRIANGLES: usize = 64;

/// Models of more triangles have no levels: simplifying takes some microseconds a triangle, and half a kilobyte.
pub const MOST_TRIANGLES: usize = 1 << 20;

/// The shares of the model's triangles that its levels aim for.
const SHARES: [f64; 3] = [0.5, 0.25, 0.0625];

/// A level is kept where it has at most this part of the triangles of the one before: less would not pay for the
/// memory.
const WORTH_KEEPING: f64 = 0.75;

/// Simplification ends where a step would cost as much as being off by this part of the model's radius: a form so coarse
/// could only stand in for a model that is a few pixels tall, and an impostor does that better.
const LARGEST_STEP: f64 = 0.1;

/// A level has at least this part of the model's area. Twigs and lattices, which vanish piece by piece and not by
/// getting coarser, would look thinner and thinner; their far form is the impostor, which keeps what they cover.
const LEAST_AREA: f64 = 0.85;

/// The cosine of the most that a triangle may turn in one step: 75°.
const LEAST_TURN_COS: f64 = 0.25;

/// A point with more triangles around it stays where it is; bounds the time that a hostile fan can take.
const WIDEST_RING: usize = 64;

/// A simpler form of a model.
#[derive(Clone, Debug)]
pub struct DetailLevel {
    /// Meshes with one material each, materials as in the model.
    pub parts: Vec<ModelPart>,
    /// How far its surface is off the model's, in the model's units.
    pub error: f32,
}

impl DetailLevel {
    /// How many triangles it has.
    pub fn triangle_count(&self) -> usize {
        self.parts.iter().map(|part| part.mesh.triangles.len()).sum()
    }
}

/// The simpler forms of a model, finest first, each with fewer triangles and no smaller an error than the one before.
///
/// None for models of fewer than [`FEWEST_TRIANGLES`] or more than [`MOST_TRIANGLES`], and for those that do not let
/// themselves be simplified.
pub fn levels(model: &Model) -> Vec<DetailLevel> {
    let count = model.triangle_count();
    if !(FEWEST_TRIANGLES..=MOST_TRIANGLES).contains(&count) {
        return Vec::new();
    }
    let mut simplifier = Simplifier::new(model);
    let mut levels: Vec<DetailLevel> = Vec::new();
    let (mut before, least_area) = (count, simplifier.soup.area() * LEAST_AREA);
    for share in SHARES {
        let done = simplifier.simplify_to((count as f64 * share) as usize);
        if simplifier.soup.area() < least_area {
            break;
        }
        if simplifier.soup.left as f64 <= before as f64 * WORTH_KEEPING {
            before = simplifier.soup.left;
            let finer = levels.last().map_or(0.0, |level| level.error);
            let error = finer.max(simplifier.error() as f32);
            levels.push(DetailLevel { parts: simplifier.soup.parts(model), error });
        }
        if done == StopReason::NothingLeft {
            break;
        }
    }
    levels
}

/// Why simplifying ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StopReason {
    /// There are no more triangles than wanted.
    Reached,
    /// No step is left that may be done.
    NothingLeft,
}

/// A step that may be worth doing; its cost is never above the true one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct CollapseCandidate {
    /// The bits of a cost that is not negative, which rise as it does.
    cost: u64,
    from: PointId,
    to: PointId,
}

/// A step that can be done.
struct CollapseStep {
    cost: f64,
    looks: f64,
    wedges: Vec<(WedgeId, DrawVertex)>,
}

struct Simplifier {
    soup: Soup,
    quadrics: Vec<Quadric>,
    /// Where each point went; itself where it still stands.
    into: Vec<PointId>,
    heap: BinaryHeap<Reverse<CollapseCandidate>>,
    /// The greatest change of looks so far, in the model's units.
    looks: f64,
    largest_cost: f64,
}

impl Simplifier {
    fn new(model: &Model) -> Self {
        let soup = Soup::of(model);
        let radius = model.bounds().map_or(0.0, |(min, max)| f64::from((max - min).length()) * 0.5);
        let edges = edges(&soup);
        let mut simplifier = Self {
            quadrics: quadrics(&soup, &edges),
            into: (0..soup.points.len() as u32).map(PointId).collect(),
            heap: BinaryHeap::with_capacity(edges.len() * 2),
            looks: 0.0,
            largest_cost: (LARGEST_STEP * radius) * (LARGEST_STEP * radius),
            soup,
        };
        for edge in edges {
            simplifier.push(edge.a, edge.b);
            simplifier.push(edge.b, edge.a);
        }
        simplifier
    }

    /// Adds a step with the cost of its shape alone; its looks are counted when its turn comes.
    fn push(&mut self, from: PointId, to: PointId) {
        let cost = self.shape_cost(from, to).to_bits();
        self.heap.push(Reverse(CollapseCandidate { cost, from, to }));
    }

    fn shape_cost(&self, from: PointId, to: PointId) -> f64 {
        let both = self.quadrics[from.0 as usize].plus(&self.quadrics[to.0 as usize]);
        both.squared_distances(self.soup.at(to))
    }

    fn simplify_to(&mut self, triangles: usize) -> StopReason {
        while self.soup.left > triangles {
            let Some(Reverse(candidate)) = self.heap.pop() else { return StopReason::NothingLeft };
            let Some(step) = self.step(candidate.from, candidate.to) else { continue };
            let cost = step.cost.to_bits();
            if cost > candidate.cost {
                self.heap.push(Reverse(CollapseCandidate { cost, ..candidate }));
            } else if step.cost > self.largest_cost {
                return StopReason::NothingLeft;
            } else {
                self.apply(candidate.from, candidate.to, &step);
            }
        }
        StopReason::Reached
    }

    /// The step from one point into another; `None` where they are no neighbors or it may not be done.
    fn step(&self, from: PointId, to: PointId) -> Option<CollapseStep> {
        let ring = self.soup.triangles_at(from);
        if ring.len() > WIDEST_RING || self.soup.triangles_at(to).len() > WIDEST_RING {
            return None;
        }
        let (going, staying): (Vec<u32>, Vec<u32>) =
            ring.iter().partition(|&&triangle| self.soup.corners(triangle).contains(&to));
        let closes = || !self.keeps_links(&going, from, to);
        if going.is_empty() || staying.iter().any(|&triangle| self.turns_over(triangle, from, to)) || closes()
        {
            return None;
        }
        let wedges = self.counterparts(&going, &staying, from, to);
        let looks = self.looks_after(&staying, from, &wedges);
        Some(CollapseStep { cost: self.shape_cost(from, to) + looks * looks, looks, wedges })
    }

    /// What each wedge at `from` looks like at `to`.
    fn counterparts(
        &self,
        going: &[u32],
        staying: &[u32],
        from: PointId,
        to: PointId,
    ) -> Vec<(WedgeId, DrawVertex)> {
        let at = |triangle: u32, point: PointId| {
            let wedges = self.soup.triangles[triangle as usize];
            wedges.into_iter().find(|&id| self.soup.wedge(id).point == point)
        };
        let position = self.soup.at(to).as_vec3().to_array();
        let mut pairs: Vec<(WedgeId, DrawVertex)> = Vec::with_capacity(4);
        for &triangle in going.iter().chain(staying) {
            let Some(source) = at(triangle, from) else { continue };
            if pairs.iter().all(|(known, _)| *known != source) {
                let target = at(triangle, to).unwrap_or(source);
                pairs.push((source, DrawVertex { position, ..self.soup.wedge(target).vertex }));
            }
        }
        pairs
    }

    /// Whether the points next to both ends are just the third corners of the triangles that go.
    fn keeps_links(&self, going: &[u32], from: PointId, to: PointId) -> bool {
        let mut third: Vec<PointId> = going
            .iter()
            .flat_map(|&triangle| self.soup.corners(triangle))
            .filter(|&point| point != from && point != to)
            .collect();
        third.sort_unstable();
        third.dedup();
        let beside_to = self.soup.neighbors(to);
        let common =
            self.soup.neighbors(from).into_iter().filter(|point| beside_to.binary_search(point).is_ok());
        common.eq(third)
    }

    fn turns_over(&self, triangle: u32, from: PointId, to: PointId) -> bool {
        let corners = self.soup.corners(triangle);
        let before = normal(corners.map(|point| self.soup.at(point)));
        let after = normal(corners.map(|point| self.soup.at(if point == from { to } else { point })));
        let lengths = before.length() * after.length();
        before != DVec3::ZERO && before.dot(after) <= LEAST_TURN_COS * lengths
    }

    /// How much the looks at `from` change, in the model's units.
    fn looks_after(&self, staying: &[u32], from: PointId, pairs: &[(WedgeId, DrawVertex)]) -> f64 {
        let place = self.soup.at(from);
        let mut least: Vec<Option<(f64, f64)>> = vec![None; pairs.len()];
        for &triangle in staying {
            let wedges = self.soup.triangles[triangle as usize];
            let moved = |id: WedgeId| pairs.iter().position(|&(source, _)| source == id);
            let Some(pair) = wedges.into_iter().find_map(moved) else { continue };
            let corners = wedges.map(|id| moved(id).map_or(self.soup.wedge(id).vertex, |pair| pairs[pair].1));
            let points = corners.map(|corner| Vec3::from(corner.position).as_dvec3());
            let shares = nearest_shares(place, points);
            let distance = blend(points, shares).distance_squared(place);
            if least[pair].is_none_or(|(known, _)| distance < known) {
                let (source, target) = &pairs[pair];
                let reach = place.distance(Vec3::from(target.position).as_dvec3());
                let wanted = &self.soup.wedge(*source).vertex;
                least[pair] = Some((distance, difference(wanted, corners.each_ref(), shares, reach)));
            }
        }
        least.into_iter().flatten().map(|(_, off)| off).fold(0.0, f64::max)
    }

    fn apply(&mut self, from: PointId, to: PointId, step: &CollapseStep) {
        let targets: Vec<(WedgeId, WedgeId)> = step
            .wedges
            .iter()
            .map(|(source, vertex)| {
                let part = self.soup.wedge(*source).part;
                (*source, self.soup.wedge_like(vertex, to, part))
            })
            .collect();
        let ring = std::mem::take(&mut self.soup.around[from.0 as usize]);
        let mut touched = vec![to];
        for &triangle in &ring {
            let corners = self.soup.corners(triangle);
            let wedges = &mut self.soup.triangles[triangle as usize];
            if corners.contains(&to) {
                *wedges = [wedges[0]; 3];
                self.soup.left -= 1;
                touched.extend(corners.into_iter().filter(|&point| point != from && point != to));
            } else {
                for (source, target) in &targets {
                    *wedges = wedges.map(|id| if id == *source { *target } else { id });
                }
            }
        }
        self.soup.around[to.0 as usize].extend(ring);
        // The hub of a fan keeps what is gone: looking it through at every step would take the square of its width.
        touched.retain(|&point| self.soup.triangles_at(point).len() <= 2 * WIDEST_RING);
        touched.iter().for_each(|&point| self.soup.tidy(point));
        self.quadrics[to.0 as usize] = self.quadrics[to.0 as usize].plus(&self.quadrics[from.0 as usize]);
        self.into[from.0 as usize] = to;
        self.looks = self.looks.max(step.looks);
        for neighbor in self.soup.neighbors(to) {
            self.push(to, neighbor);
            self.push(neighbor, to);
        }
    }

    /// How far the surface is off the model's by now, in the model's units.
    fn error(&mut self) -> f64 {
        let mut farthest = self.looks;
        for point in (0..self.into.len() as u32).map(PointId) {
            let target = self.target(point);
            farthest = farthest.max(self.distance(point, target));
        }
        farthest
    }

    /// The point that still stands where `point` went. All on the way there are told, so that the next way is short.
    fn target(&mut self, point: PointId) -> PointId {
        let mut target = point;
        while self.into[target.0 as usize] != target {
            target = self.into[target.0 as usize];
        }
        let mut next = point;
        while next != target {
            next = std::mem::replace(&mut self.into[next.0 as usize], target);
        }
        target
    }

    /// How far a point lies from the surface near the point it went into: from the triangles there on to nearer ones
    /// for as long as there are any.
    fn distance(&self, point: PointId, target: PointId) -> f64 {
        if point == target {
            return 0.0;
        }
        let place = self.soup.at(point);
        let distance = |triangle: u32| {
            let corners = self.soup.corners(triangle).map(|corner| self.soup.at(corner));
            blend(corners, nearest_shares(place, corners)).distance(place)
        };
        let nearest_around = |points: &[PointId]| {
            let rings = points.iter().map(|&corner| self.soup.triangles_at(corner));
            let around = rings.filter(|ring| ring.len() <= 2 * WIDEST_RING).flatten();
            around.map(|&triangle| (distance(triangle), triangle)).min_by(|a, b| a.0.total_cmp(&b.0))
        };
        let Some((mut best, mut triangle)) = nearest_around(&[target]) else {
            return place.distance(self.soup.at(target));
        };
        while let Some((nearer, next)) = nearest_around(&self.soup.corners(triangle))
            && nearer < best
        {
            (best, triangle) = (nearer, next);
        }
        best
    }
}

fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// An edge of the surface, `a` below `b`.
struct SurfaceEdge {
    a: PointId,
    b: PointId,
    kind: EdgeKind,
    /// One of its triangles.
    triangle: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EdgeKind {
    /// Two triangles meet in the same two wedges.
    Smooth,
    /// Something ends here: the surface, a material, a texture, a smooth patch.
    Seam,
}

/// Every edge once, in a fixed order.
fn edges(soup: &Soup) -> Vec<SurfaceEdge> {
    let mut uses: Vec<([PointId; 2], [WedgeId; 2], u32)> = Vec::with_capacity(soup.triangles.len() * 3);
    for (triangle, &[a, b, c]) in (0..).zip(&soup.triangles) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let SoupWedge { point: start, .. } = *soup.wedge(from);
            let SoupWedge { point: end, .. } = *soup.wedge(to);
            let (points, wedges) =
                if start < end { ([start, end], [from, to]) } else { ([end, start], [to, from]) };
            uses.push((points, wedges, triangle));
        }
    }
    uses.sort_unstable();
    let kind = |uses: &[([PointId; 2], [WedgeId; 2], u32)]| match uses {
        [one, other] if one.1 == other.1 => EdgeKind::Smooth,
        _ => EdgeKind::Seam,
    };
    uses.chunk_by(|one, other| one.0 == other.0)
        .map(|uses| SurfaceEdge { a: uses[0].0[0], b: uses[0].0[1], kind: kind(uses), triangle: uses[0].2 })
        .collect()
}

/// The planes that each point of the model stands for.
fn quadrics(soup: &Soup, edges: &[SurfaceEdge]) -> Vec<Quadric> {
    let mut quadrics = vec![Quadric::default(); soup.points.len()];
    let mut add = |point: PointId, plane: &Quadric| {
        quadrics[point.0 as usize] = quadrics[point.0 as usize].plus(plane);
    };
    let face_normal = |triangle: u32| normal(soup.corners(triangle).map(|point| soup.at(point)));
    for triangle in 0..soup.triangles.len() as u32 {
        let corners = soup.corners(triangle);
        let Some(unit) = face_normal(triangle).try_normalize() else { continue };
        let plane = Quadric::plane(unit, soup.at(corners[0]));
        corners.iter().for_each(|&point| add(point, &plane));
    }
    for edge in edges.iter().filter(|edge| edge.kind == EdgeKind::Seam) {
        let along = soup.at(edge.b) - soup.at(edge.a);
        let Some(upright) = along.cross(face_normal(edge.triangle)).try_normalize() else { continue };
        let plane = Quadric::plane(upright, soup.at(edge.a));
        add(edge.a, &plane);
        add(edge.b, &plane);
    }
    quadrics
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec2};

    use super::*;
    use crate::draw::color::Srgba;
    use crate::draw::list::{DrawMesh, MaterialId};
    use crate::draw::material::{Material, TextureId};
    use crate::mesh::sink::{MeshSink, VertexId};

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
    fn a_flat_sheet_loses_triangles_but_no_area_and_nothing_of_its_looks() {
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
                    let distance =
                        |&corners: &[DVec3; 3]| blend(corners, nearest_shares(at, corners)).distance(at);
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
