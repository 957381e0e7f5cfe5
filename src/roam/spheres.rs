//! Nested spheres: one radius a vertex says from where the vertex is wanted.
//!
//! A vertex is active exactly while the eye is inside its sphere. Each sphere holds the spheres of the vertex's
//! children, so whoever is inside a child's is inside its parents': the active vertices are closed under parents
//! by themselves, and no split is ever forced.
//!
//! `R = r` for a vertex without children, else `R = max(r, max over children c of |p − p_c| + R_c)`, with `r` the
//! distance within which the vertex's own error shows (constrained nested error criterion; Lindstrom and Pascucci
//! 2001 nest spheres the same way). What `r` is differs: see [`OwnRadius`].

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::roam::errors::ErrorMap;
use crate::roam::errors::midpoint::midpoint_error_at;
use crate::roam::field::Field;
use crate::roam::graph::Vertex;
use crate::roam::ground::Ground;
use crate::roam::layout::Layout;
use crate::roam::levels::{Pass, Rows, for_rows};
use crate::roam::roughness::Roughness;
use crate::view::camera::Camera;

/// Spheres grow by this share from child to parent, so that rounding of f32 radii and f64 distances can never make
/// a child's sphere reach out of its parent's. Smaller than any error that shows, a thousand times the rounding.
const MARGIN: f64 = 1e-6;

/// The radius of every vertex's sphere, metres in drawn world space about the drawn vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereMap {
    radii: Vec<f32>,
}

/// What a vertex's own radius is, before it is grown to hold its children's spheres.
///
/// `reach`, the papers' λ·d/τ, is metres of distance per metre of drawn error: see [`reach`]. No error gives radius
/// 0, an infinite one an infinite radius.
#[derive(Clone, Copy, Debug)]
pub enum OwnRadius<'a> {
    /// `r = reach · δ`, where δ is the vertex's error as drawn (nested error criterion). Errors raised to those of
    /// the children give the same nested spheres as the vertices' own: a child's sphere, which the parent's holds,
    /// already reaches as far as the child's error does.
    Plain {
        /// δ without exaggeration.
        errors: &'a ErrorMap,
        /// Metres per metre, finite and not negative.
        reach: f32,
    },
    /// `r' = k · reach · δ` with δ the vertex's own midpoint error and `k = 1 − 1/(f + 1 + ξ)` of its local roughness
    /// f: fewer triangles on flat ground (constrained nested error criterion). Promises nothing.
    Constrained {
        /// Metres per metre, finite and not negative.
        reach: f32,
        /// f.
        roughness: &'a Roughness,
    },
    /// `r = reach · e + e + extent` with `e` the exact error as drawn and `extent` the largest drawn distance from the
    /// vertex to the corners of the triangles it splits.
    ///
    /// A triangle's points lie within `extent` of its split vertex and the ground over or under them within `e` more,
    /// so from an eye outside the sphere every bit of a vertical error of length `e` is at least `reach · e` away:
    /// `|displayed − ground|` spans no more than the tolerance, wherever the eye is. This is a bound like that of
    /// `criterion::screen`, without its frustum.
    Bounding {
        /// Exact errors, without exaggeration.
        errors: &'a ErrorMap,
        /// Metres per metre, finite and not negative.
        reach: f32,
    },
}

/// Metres of distance per metre of drawn error for a tolerance of `tolerance_px` in every corner of the camera's
/// picture, where pixels are largest; `camera.pixels_per_metre(1.0) / tolerance_px`, as the paper has it, holds in
/// its middle only.
pub fn reach(camera: &Camera, tolerance_px: f32) -> f32 {
    let corner = 1.0 + camera.tan_half_fov().length_squared();
    camera.pixels_per_metre(1.0) * corner / tolerance_px
}

impl OwnRadius<'_> {
    /// The own radius of a vertex of the layout, metres; 0 for patch corners, which are always there.
    #[inline]
    pub fn of(&self, ground: Ground<'_>, vertex: Vertex) -> f32 {
        if ground.layout.is_corner(vertex) {
            return 0.0;
        }
        match *self {
            Self::Plain { errors, reach } => {
                let error = errors.at(ground.layout, vertex);
                scaled(error, |error| f64::from(reach) * error * f64::from(ground.exaggeration))
            }
            Self::Constrained { reach, roughness } => {
                let reach = f64::from(reach) * roughness.factor(ground.layout.post(vertex));
                let error = midpoint_error_at(ground.lattice, ground.layout, vertex);
                scaled(error, |error| reach * error * f64::from(ground.exaggeration))
            }
            Self::Bounding { errors, reach } => scaled(errors.at(ground.layout, vertex), |error| {
                let drawn = error * f64::from(ground.exaggeration);
                (f64::from(reach) * drawn + drawn + extent(ground, vertex)) * (1.0 + MARGIN)
            }),
        }
    }

    /// How many posts around a vertex its own radius reads beyond those of the triangles it splits.
    pub(in crate::roam) fn half_window(&self) -> (u32, u32) {
        match self {
            Self::Constrained { roughness, .. } => roughness.half_window(),
            _ => (0, 0),
        }
    }
}

/// The radius that a finite error has; 0 for no error, infinite for an infinite one.
#[inline]
fn scaled(error: f32, radius: impl FnOnce(f64) -> f64) -> f32 {
    match error {
        0.0 => 0.0,
        f32::INFINITY => f32::INFINITY,
        error => radius(f64::from(error)) as f32,
    }
}

/// The largest drawn distance from a vertex to the corners of the triangles it splits, metres.
fn extent(ground: Ground<'_>, vertex: Vertex) -> f64 {
    let center = ground.position(vertex).as_dvec3();
    let parents = vertex.parents().into_iter().filter(|&parent| ground.layout.contains(parent));
    let corners = vertex.hypotenuse().into_iter().chain(parents);
    corners.map(|corner| ground.position(corner).as_dvec3().distance(center)).fold(0.0, f64::max)
}

impl SphereMap {
    /// Nested spheres about own radii `reach · δ`: see [`OwnRadius::Plain`].
    pub fn plain(ground: Ground<'_>, errors: &ErrorMap, reach: f32) -> Self {
        Self::of(ground, &OwnRadius::Plain { errors, reach })
    }

    /// Nested spheres about own radii `k · reach · δ`: see [`OwnRadius::Constrained`].
    pub fn constrained(ground: Ground<'_>, reach: f32, roughness: &Roughness) -> Self {
        Self::of(ground, &OwnRadius::Constrained { reach, roughness })
    }

    /// Nested spheres that keep a tolerance, from exact errors: see [`OwnRadius::Bounding`].
    pub fn bounding(ground: Ground<'_>, errors: &ErrorMap, reach: f32) -> Self {
        Self::of(ground, &OwnRadius::Bounding { errors, reach })
    }

    /// Nested spheres about the given own radii; in parallel, the same for any number of threads.
    pub fn of(ground: Ground<'_>, own: &OwnRadius<'_>) -> Self {
        let columns = ground.layout.columns();
        let mut radii = vec![0.0; ground.layout.vertex_count()];
        radii.par_chunks_mut(columns).enumerate().for_each(|(y, row)| {
            for (x, radius) in row.iter_mut().enumerate() {
                *radius = own.of(ground, Vertex::new(x as i32, y as i32));
            }
        });
        Self::nested(ground, radii)
    }

    /// The spheres whose own radii, in the order of [`Layout::index`], are given: each grown until it holds those of
    /// its children. A vertex that never shows has radius 0 and an own radius of 0; infinite radii are allowed.
    ///
    /// In parallel over rows, the same for any number of threads.
    ///
    /// # Panics
    /// Where there is not one radius a vertex.
    pub fn nested(ground: Ground<'_>, own: Vec<f32>) -> Self {
        assert_eq!(own.len(), ground.layout.vertex_count(), "one radius a vertex");
        let mut radii = own;
        let (columns, places) = (ground.layout.columns(), Places::of(ground));
        let mut step = 1;
        while step < ground.layout.patch() as usize {
            if step > 1 {
                for_rows(&mut radii, columns, step / 2, Rows::Even, |y, row, beside| {
                    places.grow_edges(step, y, row, beside);
                });
            }
            for_rows(&mut radii, columns, step, Rows::Odd, |y, row, beside| {
                places.grow_centers(step, y, row, beside);
            });
            step *= 2;
        }
        Self { radii }
    }

    /// The radius of a vertex's sphere, metres.
    #[inline]
    pub fn at(&self, layout: &Layout, vertex: Vertex) -> f32 {
        self.radii[layout.index(vertex)]
    }

    /// All radii, in the order of [`Layout::index`].
    pub fn values(&self) -> &[f32] {
        &self.radii
    }

    /// Whether every sphere holds those of its vertex's children.
    ///
    /// # Errors
    /// A sentence naming the first pair where it does not.
    pub fn check(&self, ground: Ground<'_>) -> Result<(), String> {
        let layout = ground.layout;
        for index in 0..layout.vertex_count() {
            let vertex = Vertex::new((index % layout.columns()) as i32, (index / layout.columns()) as i32);
            if layout.is_corner(vertex) {
                continue;
            }
            let center = ground.position(vertex).as_dvec3();
            for child in vertex.children().filter(|&child| layout.contains(child)) {
                let (own, below) = (f64::from(self.radii[index]), f64::from(self.at(layout, child)));
                let needed = ground.position(child).as_dvec3().distance(center) + below;
                if below > 0.0 && own < needed {
                    return Err(format!(
                        "{vertex:?} has radius {own} m, its child {child:?} reaches to {needed} m"
                    ));
                }
            }
        }
        Ok(())
    }

    /// Sets the radius of a vertex of `pass` again from its own radius and its children's spheres, which are as they
    /// shall be; tells whether it changed.
    #[inline]
    pub(in crate::roam) fn renew(&mut self, field: &Field<'_>, pass: Pass, vertex: Vertex, own: f32) -> bool {
        let (layout, reach) = (field.layout(), pass.child_reach());
        let (center, mut radius) = (field.position(vertex), own);
        for &(x, y) in pass.child_offsets() {
            let child = vertex.moved(x * reach, y * reach);
            if layout.contains(child) {
                radius = radius.max(around(center, field.position(child), self.radii[layout.index(child)]));
            }
        }
        let slot = &mut self.radii[layout.index(vertex)];
        std::mem::replace(slot, radius) != radius
    }
}

/// The radius about `center` that holds the sphere of `radius` about `child`; 0 for a child that never shows.
#[inline]
fn around(center: DVec3, child: DVec3, radius: f32) -> f32 {
    if radius == 0.0 {
        return 0.0;
    }
    let distance = (center - child).length_squared().sqrt();
    ((distance + f64::from(radius)) * (1.0 + MARGIN)) as f32
}

/// Where vertices are drawn, read row by row: the same places as [`Ground::position`].
struct Places<'a> {
    ground: Ground<'a>,
    x: Vec<f32>,
}

impl<'a> Places<'a> {
    fn of(ground: Ground<'a>) -> Self {
        let columns = 0..ground.layout.columns() as i32;
        Self { ground, x: columns.map(|x| ground.plan(Vertex::new(x, 0)).x).collect() }
    }

    /// The heights of a row of vertices and its Y; vertices beyond the last post have that post's height.
    fn row(&self, y: usize) -> PlaceRow<'_> {
        let first = self.ground.layout.post(Vertex::new(0, y as i32));
        let start = self.ground.lattice.index(first);
        let heights = &self.ground.lattice.heights()[start..start + self.ground.lattice.columns() as usize];
        let y = self.ground.plan(Vertex::new(0, y as i32)).y;
        PlaceRow { x: &self.x, y, heights, exaggeration: self.ground.exaggeration }
    }

    /// Grows the edge middles of row `y` at `step` to hold the centres of half the step beside it.
    fn grow_edges(&self, step: usize, y: usize, row: &mut [f32], beside: [&[f32]; 2]) {
        let half = step / 2;
        let first = if (y / step).is_multiple_of(2) { step } else { 0 };
        let here = self.row(y);
        let south = (!beside[0].is_empty()).then(|| (self.row(y - half), beside[0]));
        let north = (!beside[1].is_empty()).then(|| (self.row(y + half), beside[1]));
        let columns = row.len();
        for x in (first..columns).step_by(2 * step) {
            let center = here.at(x);
            let mut radius = row[x];
            for (places, radii) in [&south, &north].into_iter().flatten() {
                if x >= half {
                    radius = radius.max(around(center, places.at(x - half), radii[x - half]));
                }
                if x + half < columns {
                    radius = radius.max(around(center, places.at(x + half), radii[x + half]));
                }
            }
            row[x] = radius;
        }
    }

    /// Grows the centres of row `y` at `step` to hold the four edge middles around each.
    fn grow_centers(&self, step: usize, y: usize, row: &mut [f32], beside: [&[f32]; 2]) {
        let [here, south, north] = [y, y - step, y + step].map(|y| self.row(y));
        for x in (step..row.len()).step_by(2 * step) {
            let center = here.at(x);
            let radius = around(center, here.at(x - step), row[x - step])
                .max(around(center, here.at(x + step), row[x + step]))
                .max(around(center, south.at(x), beside[0][x]))
                .max(around(center, north.at(x), beside[1][x]));
            row[x] = row[x].max(radius);
        }
    }
}

/// One row of [`Places`].
struct PlaceRow<'a> {
    x: &'a [f32],
    y: f32,
    heights: &'a [f32],
    exaggeration: f32,
}

impl PlaceRow<'_> {
    fn at(&self, x: usize) -> DVec3 {
        let height = self.heights[x.min(self.heights.len() - 1)];
        let z = if height.is_nan() { 0.0 } else { height * self.exaggeration };
        Vec3::new(self.x[x], self.y, z).as_dvec3()
    }
}
