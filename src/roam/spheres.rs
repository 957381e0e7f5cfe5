//! Nested spheres: one radius a vertex says from where the vertex is wanted.
//!
//! A vertex is active exactly while the eye is inside its sphere. Each sphere holds the spheres of the vertex's
//! children, so whoever is inside a child's is inside its parents': the active vertices are closed under parents
//! by themselves, and no split is ever forced.
//!
//! `R = r` for a vertex without children, else `R = max(r, max over children c of |p − p_c| + R_c)`, with `r` the
//! distance within which the vertex's own error shows (constrained nested error criterion; Lindstrom and Pascucci
//! 2001 nest spheres the same way). What `r` is differs: see [`OwnRadius`].

use rayon::prelude::*;

use crate::roam::errors::ErrorMap;
use crate::roam::errors::midpoint::midpoint_error_at;
use crate::roam::errors::scan::larger;
use crate::roam::field::{FieldRow, HeightField};
use crate::roam::graph::{Vertex, VertexKind};
use crate::roam::layout::PatchLayout;
use crate::roam::levels::{ChildRows, PassRow, SweepRows, both_sides, for_rows};
use crate::roam::patched_ground::PatchedGround;
use crate::roam::roughness::Roughness;
use crate::view::camera::Camera;

/// Spheres grow by this share from child to parent, so that rounding of f32 radii and f64 distances can never make
/// a child's sphere reach out of its parent's. Smaller than any error that shows, a thousand times the rounding.
const MARGIN: f64 = 1e-6;

/// The radius of every vertex's sphere, meters in drawn world space about the drawn vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereMap {
    radii: Vec<f32>,
}

/// What a vertex's own radius is, before it is grown to hold its children's spheres.
///
/// `reach`, the papers' λ·d/τ, is meters of distance per meter of drawn error: see [`reach`]. No error gives radius
/// 0, an infinite one an infinite radius.
#[derive(Clone, Copy, Debug)]
pub enum OwnRadius<'a> {
    /// `r = reach · δ`, where δ is the vertex's error as drawn (nested error criterion). Errors raised to those of
    /// the children give the same nested spheres as the vertices' own: a child's sphere, which the parent's holds,
    /// already reaches as far as the child's error does.
    Plain {
        /// δ without exaggeration.
        errors: &'a ErrorMap,
        /// Meters per meter, finite and not negative.
        reach: f32,
    },
    /// `r' = k · reach · δ` with δ the vertex's own midpoint error and `k = 1 − 1/(f + 1 + ξ)` of its local roughness
    /// f: fewer triangles on flat ground (constrained nested error criterion). Promises nothing.
    Constrained {
        /// Meters per meter, finite and not negative.
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
        /// Meters per meter, finite and not negative.
        reach: f32,
    },
}

/// Meters of distance per meter of drawn error for a tolerance of `tolerance_px` in every corner of the camera's
/// picture, where pixels are largest; `camera.pixels_per_meter(1.0) / tolerance_px`, as the paper has it, holds in
/// its middle only.
pub fn reach(camera: &Camera, tolerance_px: f32) -> f32 {
    let corner = 1.0 + camera.tan_half_fov().length_squared();
    camera.pixels_per_meter(1.0) * corner / tolerance_px
}

impl OwnRadius<'_> {
    /// The own radius of a vertex of the layout, meters; 0 for patch corners, which are always there.
    #[inline]
    pub fn of(&self, ground: PatchedGround<'_>, vertex: Vertex) -> f32 {
        if ground.layout.is_corner(vertex) {
            return 0.0;
        }
        match *self {
            Self::Plain { errors, reach } => plain_radius(errors.at(ground.layout, vertex), reach),
            Self::Constrained { reach, roughness } => {
                let reach = f64::from(reach) * roughness.factor(ground.layout.post(vertex));
                let error = midpoint_error_at(ground.lattice, ground.layout, vertex);
                scaled(error, |error| reach * error)
            }
            Self::Bounding { errors, reach } => scaled(errors.at(ground.layout, vertex), |error| {
                (f64::from(reach) * error + error + extent(ground, vertex)) * (1.0 + MARGIN)
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

/// See [`OwnRadius::Plain`].
#[inline]
fn plain_radius(error: f32, reach: f32) -> f32 {
    scaled(error, |error| f64::from(reach) * error)
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

/// The largest drawn distance from a vertex to the corners of the triangles it splits, meters.
fn extent(ground: PatchedGround<'_>, vertex: Vertex) -> f64 {
    let center = ground.position(vertex).as_dvec3();
    let parents = vertex.parents().into_iter().filter(|&parent| ground.layout.contains(parent));
    let corners = vertex.hypotenuse().into_iter().chain(parents);
    corners.map(|corner| ground.position(corner).as_dvec3().distance(center)).fold(0.0, f64::max)
}

impl SphereMap {
    /// Nested spheres about own radii `reach · δ`: see [`OwnRadius::Plain`].
    pub fn plain(ground: PatchedGround<'_>, errors: &ErrorMap, reach: f32) -> Self {
        Self::of(ground, &OwnRadius::Plain { errors, reach })
    }

    /// Nested spheres about own radii `k · reach · δ`: see [`OwnRadius::Constrained`].
    pub fn constrained(ground: PatchedGround<'_>, reach: f32, roughness: &Roughness) -> Self {
        Self::of(ground, &OwnRadius::Constrained { reach, roughness })
    }

    /// Nested spheres that keep a tolerance, from exact errors: see [`OwnRadius::Bounding`].
    pub fn bounding(ground: PatchedGround<'_>, errors: &ErrorMap, reach: f32) -> Self {
        Self::of(ground, &OwnRadius::Bounding { errors, reach })
    }

    /// Nested spheres about the given own radii; in parallel, the same for any number of threads.
    pub fn of(ground: PatchedGround<'_>, own: &OwnRadius<'_>) -> Self {
        let columns = ground.layout.columns();
        let mut radii = vec![0.0; ground.layout.vertex_count()];
        radii.par_chunks_mut(columns).enumerate().for_each(|(y, row)| {
            if let OwnRadius::Plain { errors, reach } = *own {
                let errors = errors.row(ground.layout, y).iter();
                let radius = |&error: &f32| plain_radius(error, reach);
                row.iter_mut().zip(errors.map(radius)).for_each(|(slot, radius)| *slot = radius);
                return;
            }
            for (x, radius) in row.iter_mut().enumerate() {
                *radius = own.of(ground, Vertex::new(x as i32, y as i32));
            }
        });
        Self::nested(ground, radii)
    }

    /// The spheres whose own radii, in the order of [`PatchLayout::index`], are given: each grown until it holds those of
    /// its children. A vertex that never shows has radius 0 and an own radius of 0; infinite radii are allowed.
    ///
    /// In parallel over rows, the same for any number of threads.
    ///
    /// # Panics
    /// Where there is not one radius a vertex.
    pub fn nested(ground: PatchedGround<'_>, own: Vec<f32>) -> Self {
        assert_eq!(own.len(), ground.layout.vertex_count(), "one radius a vertex");
        let (mut radii, layout, field) = (own, ground.layout, HeightField::of(ground));
        let columns = layout.columns();
        let mut step = 1;
        while step < layout.patch() as usize {
            if step > 1 {
                let half = step / 2;
                for_rows(&mut radii, columns, half, SweepRows::Even, |y, row, beside| {
                    let nest = Nest::of(&field, y, both_sides(y, half, layout.rows()), beside);
                    let first = if (y / step).is_multiple_of(2) { step } else { 0 };
                    for x in (first..columns).step_by(2 * step) {
                        row[x] = larger(row[x], nest.about_edge(half, x));
                    }
                });
            }
            for_rows(&mut radii, columns, step, SweepRows::Odd, |y, row, beside| {
                let nest = Nest::of(&field, y, [y - step, y + step], beside);
                for x in (step..columns).step_by(2 * step) {
                    row[x] = larger(row[x], nest.about_center(step, x, row));
                }
            });
            step *= 2;
        }
        Self { radii }
    }

    /// The radius of a vertex's sphere, meters.
    #[inline]
    pub fn at(&self, layout: &PatchLayout, vertex: Vertex) -> f32 {
        self.radii[layout.index(vertex)]
    }

    /// All radii, in the order of [`PatchLayout::index`].
    pub fn values(&self) -> &[f32] {
        &self.radii
    }

    /// Whether every sphere holds those of its vertex's children.
    ///
    /// # Errors
    /// A sentence naming the first pair where it does not.
    pub fn check(&self, ground: PatchedGround<'_>) -> Result<(), String> {
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

    /// Sets the radii of a row of a pass again from the vertices' own and their children's spheres, which are as they
    /// shall be; adds the vertices whose radius changed to `changed`.
    pub(in crate::roam) fn renew_row(
        &mut self,
        ground: PatchedGround<'_>,
        field: &HeightField<'_>,
        row: PassRow,
        own: &OwnRadius<'_>,
        changed: &mut Vec<Vertex>,
    ) {
        let layout = ground.layout;
        match *own {
            OwnRadius::Plain { errors, reach } => {
                let errors = errors.row(layout, row.y);
                let own = |x: usize| plain_radius(errors[x], reach);
                self.put_row(layout, field, row, own, changed);
            }
            _ => {
                let own = |x: usize| own.of(ground, Vertex::new(x as i32, row.y as i32));
                self.put_row(layout, field, row, own, changed);
            }
        }
    }

    #[inline]
    fn put_row(
        &mut self,
        layout: &PatchLayout,
        field: &HeightField<'_>,
        row: PassRow,
        own: impl Fn(usize) -> f32,
        changed: &mut Vec<Vertex>,
    ) {
        let ChildRows { here, south, north } = row.of(&mut self.radii, layout);
        let nest = Nest::of(field, row.y, row.child_rows(layout.rows()), [south, north]);
        let mut put = |here: &mut [f32], x: usize, held: f32| {
            let radius = larger(own(x), held);
            if std::mem::replace(&mut here[x], radius) != radius {
                changed.push(Vertex::new(x as i32, row.y as i32));
            }
        };
        let reach = row.pass.child_reach();
        if row.pass.is_finest() {
            row.columns().for_each(|x| put(here, x, 0.0));
        } else if row.pass.kind == VertexKind::Center {
            row.columns().for_each(|x| put(here, x, nest.about_center(reach, x, here)));
        } else {
            row.columns().for_each(|x| put(here, x, nest.about_edge(reach, x)));
        }
    }
}

/// A row of vertices with the rows in which their children are: their places, and the radii of the children's spheres.
struct Nest<'a> {
    here: FieldRow<'a>,
    beside: [FieldRow<'a>; 2],
    radii: [&'a [f32]; 2],
}

impl<'a> Nest<'a> {
    fn of(field: &HeightField<'a>, y: usize, beside: [usize; 2], radii: [&'a [f32]; 2]) -> Self {
        Self { here: field.row(y), beside: beside.map(|y| field.row(y)), radii }
    }

    /// The radius about the edge middle in column `x` that holds the spheres of the centers around.
    #[inline]
    fn about_edge(&self, reach: usize, x: usize) -> f32 {
        let ([south, north], [below, above]) = (self.radii, &self.beside);
        let [west, east] = both_sides(x, reach, south.len());
        let (at, z) = (self.here.x(x), self.here.z(x));
        let [aside, ahead] = [west, east].map(|x| at - self.here.x(x));
        let [down, up] = [below, above].map(|row| self.here.y() - row.y());
        let squares = [
            square(aside, down, z - below.z(west)),
            square(ahead, down, z - below.z(east)),
            square(aside, up, z - above.z(west)),
            square(ahead, up, z - above.z(east)),
        ];
        holding(squares, [south[west], south[east], north[west], north[east]])
    }

    /// The radius about the center in column `x` that holds the spheres of the edge middles around; `row` has the radii
    /// of its own row.
    #[inline]
    fn about_center(&self, reach: usize, x: usize, row: &[f32]) -> f32 {
        let ([south, north], [below, above]) = (self.radii, &self.beside);
        let (west, east) = (x - reach, x + reach);
        let (at, z) = (self.here.x(x), self.here.z(x));
        let squares = [
            square(at - self.here.x(west), 0.0, z - self.here.z(west)),
            square(at - self.here.x(east), 0.0, z - self.here.z(east)),
            square(0.0, self.here.y() - below.y(), z - below.z(x)),
            square(0.0, self.here.y() - above.y(), z - above.z(x)),
        ];
        holding(squares, [row[west], row[east], south[x], north[x]])
    }
}

#[inline]
fn square(x: f64, y: f64, z: f64) -> f64 {
    x * x + y * y + z * z
}

/// The radius that holds the spheres of the given radii at the given squared distances; those that never show take no
/// room. All four at once: square roots come in pairs.
#[inline]
fn holding(squares: [f64; 4], radii: [f32; 4]) -> f32 {
    let distances = squares.map(f64::sqrt);
    let mut held = 0f32;
    for (distance, radius) in distances.into_iter().zip(radii) {
        let needed = ((distance + f64::from(radius)) * (1.0 + MARGIN)) as f32;
        held = larger(held, if radius == 0.0 { 0.0 } else { needed });
    }
    held
}
