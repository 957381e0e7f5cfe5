//! The footprint of a model, and the ground under it.
//!
//! A footprint is the rectangle, along the model's axes, around the vertices in the lowest tenth of its height: the feet of
//! a tower and the trunk of a tree, not their platform or crown. It is a rectangle, not a hull, since most models are
//! built square and the report lists four corners.
//!
//! The ground under it is the displayed triangles cut to the rectangle: exact, not sampled.

use glam::{DVec2, DVec3, Vec3};

use sandtable_geom::aabb::Aabb;
use sandtable_geom::polygon;
use sandtable_model::Model;
use sandtable_terrain::triangle_surface::{SurfaceTriangle, TriangleSurface};

/// The part of a model's height that is its foot.
const FOOT_PART: f32 = 0.1;
/// The least half side of a footprint, in model units: that of a pole or a board.
const LEAST_HALF: f32 = 0.01;

/// The rectangle where a model touches the ground, in model space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelFootprint {
    /// The front left corner as seen from before it, at the model's lowest point.
    pub min: Vec3,
    /// The back right corner, at the same height.
    pub max: Vec3,
}

impl ModelFootprint {
    /// The footprint of a model; a point at its origin where it has no vertices.
    pub fn of(model: &Model) -> Self {
        let bounds = model.bounds().unwrap_or_default();
        let foot_z = bounds.min.z + (bounds.max.z - bounds.min.z) * FOOT_PART;
        let vertices = model.parts.iter().flat_map(|part| &part.mesh.vertices);
        let feet = vertices.map(|vertex| Vec3::from(vertex.position)).filter(|at| at.z <= foot_z);
        let foot = Aabb::around(feet).unwrap_or_default();
        let half = (foot.size() / 2.0).max(Vec3::splat(LEAST_HALF));
        let (min, max) = (foot.center() - half, foot.center() + half);
        Self { min: min.with_z(bounds.min.z), max: max.with_z(bounds.min.z) }
    }

    /// Its corners, counter-clockwise seen from above: front left, front right, back right and back left, as seen from
    /// before the model.
    pub fn corners(&self) -> [Vec3; 4] {
        let Self { min, max } = *self;
        [min, min.with_x(max.x), max, max.with_x(min.x)]
    }

    /// The footprint with every side moved out by `part` of the longer one.
    pub fn grown(&self, part: f32) -> Self {
        let by = ((self.max - self.min).max_element() * part) * Vec3::new(1.0, 1.0, 0.0);
        Self { min: self.min - by, max: self.max + by }
    }

    /// Half its diagonal, in model units.
    pub fn radius(&self) -> f32 {
        (self.max - self.min).length() / 2.0
    }
}

/// The ground under a convex outline: its displayed triangles, cut to it, seen from a place of reference.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Under {
    /// The corners of the cut triangles; X and Y from the place of reference.
    corners: Vec<DVec3>,
    area_m2: f64,
    /// The integrals over the area of X, Y and Z, and of the gradient.
    moment: DVec3,
    rise: DVec2,
}

impl Under {
    /// The ground of `facets` under `outline`, counter-clockwise, seen from `at`; `None` where there is none.
    pub fn cut(facets: &dyn TriangleSurface, outline: &[DVec2; 4], at: DVec2) -> Option<Self> {
        let local = outline.map(|corner| corner - at);
        let (mut under, mut piece, mut scratch) = (Self::default(), Vec::new(), Vec::new());
        facets.visit_facets(&polygon::bounds(outline), &mut |facet| {
            piece.clear();
            piece.extend(facet.iter().map(|corner| corner.truncate().as_dvec2() - at));
            polygon::clip_convex(&mut piece, &mut scratch, &local);
            if piece.len() >= 3 {
                under.add(facet, at, &piece);
            }
        });
        (under.area_m2 > 0.0).then_some(under)
    }

    fn add(&mut self, facet: &SurfaceTriangle, at: DVec2, piece: &[DVec2]) {
        let [a, b, c] = facet.map(Vec3::as_dvec3);
        let normal = (b - a).cross(c - a);
        let gradient = -normal.truncate() / normal.z;
        let z = |p: DVec2| a.z + gradient.dot(p + at - a.truncate());
        for corners in polygon::fan(piece) {
            let area = polygon::doubled_triangle_area(corners) / 2.0;
            let middle = corners.iter().sum::<DVec2>() / 3.0;
            self.area_m2 += area;
            self.moment += middle.extend(z(middle)) * area;
            self.rise += gradient * area;
        }
        self.corners.extend(piece.iter().map(|&p| p.extend(z(p))));
    }

    /// The part of the outline that has ground under it, in square meters.
    pub fn area_m2(&self) -> f64 {
        self.area_m2
    }

    /// The mean gradient: rise per meter east and north.
    pub fn gradient(&self) -> DVec2 {
        self.rise / self.area_m2
    }

    /// The lowest ground, as measured from a plane through the place of reference at Z 0 that rises by `lean`.
    pub fn lowest(&self, lean: DVec2) -> f64 {
        self.above(lean).fold(f64::INFINITY, f64::min)
    }

    /// The highest ground, measured so.
    pub fn highest(&self, lean: DVec2) -> f64 {
        self.above(lean).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The mean ground, measured so.
    pub fn mean(&self, lean: DVec2) -> f64 {
        let middle = self.moment / self.area_m2;
        middle.z - lean.dot(middle.truncate())
    }

    fn above(&self, lean: DVec2) -> impl Iterator<Item = f64> + '_ {
        self.corners.iter().map(move |corner| corner.z - lean.dot(corner.truncate()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::color::Srgba;
    use sandtable_draw::list::{DrawMesh, DrawVertex, MaterialId};
    use sandtable_mesh::sink::MeshSink;
    use sandtable_model::ModelPart;
    use sandtable_terrain::full_resolution::FullResolution;
    use sandtable_terrain::lattice::Lattice;

    fn model(points: &[[f32; 3]]) -> Model {
        let mut mesh = DrawMesh::default();
        for &position in points {
            mesh.vertex(DrawVertex { position, normal: [0.0; 3], uv: [0.0; 2], color: Srgba::WHITE });
        }
        Model {
            parts: vec![ModelPart { name: String::new(), mesh, material: MaterialId(0) }],
            ..Model::default()
        }
    }

    #[test]
    fn a_tree_stands_on_its_trunk_and_not_on_its_crown() {
        let tree = model(&[[-0.5, -0.4, -1.0], [0.5, 0.4, 0.0], [-4.0, -4.0, 3.0], [4.0, 4.0, 9.0]]);
        let footprint = ModelFootprint::of(&tree);
        assert_eq!(footprint.min, Vec3::new(-0.5, -0.4, -1.0));
        assert_eq!(footprint.max, Vec3::new(0.5, 0.4, -1.0));
    }

    #[test]
    fn a_pole_and_an_empty_model_have_a_footprint() {
        for points in [&[[2.0, 3.0, 0.0], [2.0, 3.0, 9.0]][..], &[]] {
            let footprint = ModelFootprint::of(&model(points));
            assert!(footprint.radius() > 0.01, "{footprint:?}");
        }
    }

    #[test]
    fn on_a_plane_all_is_the_plane_s_at_four_rotations() {
        let rise = DVec2::new(0.3, -0.2);
        let at = |index: u32| DVec2::new(f64::from(index % 21), f64::from(index / 21)) * 5.0;
        let heights = (0..441).map(|index| (200.0 + at(index).dot(rise)) as f32).collect();
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(5.0), 21, heights).expect("sound");
        let lattice = lattice.stretched(2.0);
        let finest = FullResolution { lattice: &lattice };
        for quarter in 0..4 {
            let turn = DVec2::from_angle(0.3 + f64::from(quarter) * std::f64::consts::FRAC_PI_2);
            let at = DVec2::new(48.0, 51.0);
            let outline = [(-9.0, -6.0), (9.0, -6.0), (9.0, 6.0), (-9.0, 6.0)]
                .map(|(x, y)| at + turn.rotate(DVec2::new(x, y)));
            let under = Under::cut(&finest, &outline, at).expect("on the ground");
            assert!((under.area_m2() - 216.0).abs() < 1e-6);
            assert!((under.gradient() - rise * 2.0).length() < 1e-5);
            let middle = 2.0 * (200.0 + at.dot(rise));
            assert!((under.mean(DVec2::ZERO) - middle).abs() < 1e-3);
            let corners = outline.map(|corner| 2.0 * (200.0 + corner.dot(rise)));
            let lowest = corners.into_iter().fold(f64::INFINITY, f64::min);
            assert!((under.lowest(DVec2::ZERO) - lowest).abs() < 1e-3);
            let spread = under.highest(rise * 2.0) - under.lowest(rise * 2.0);
            assert!(spread.abs() < 1e-3, "nothing is left above its own plane: {spread}");
        }
    }
}
