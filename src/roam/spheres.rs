//! Nested spheres: a radius for each vertex, which is needed while the eye is inside its sphere.
//!
//! A vertex is active exactly while the eye is inside its sphere. Each sphere holds the spheres of the vertex's children,
//! so an eye inside a child's is inside its parents': the active vertices are closed under parents, and no split is forced.
//!
//! `R = r` for a vertex without children, else `R = max(r, max over children c of |p − p_c| + R_c)`, with `r` the distance
//! within which the vertex's own error shows (constrained nested error criterion; Lindstrom and Pascucci 2001 nest spheres
//! the same way). For `r` see [`OwnRadius`].

use rayon::prelude::*;

use crate::errors::ErrorMap;
use crate::errors::midpoint::midpoint_error_at;
use crate::errors::scan::larger;
use crate::field::HeightField;
use crate::graph::Vertex;
use crate::layout::PatchLayout;
use crate::levels::{ChildPlaces, PassRow, StridedColumns, SweepRows, both_sides, for_rows};
use crate::patched_ground::PatchedGround;
use crate::roughness::Roughness;
use crate::sphere_nest::{MARGIN, SphereNest};
use sandtable_view::camera::Camera;

/// The radius of every vertex's sphere, meters in world space about the displayed vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereMap {
    radii: Vec<f32>,
}

/// A vertex's own radius, before it is grown to hold its children's spheres.
///
/// `reach`, the papers' λ·d/τ, is meters of distance per meter of error, finite and not negative: see [`reach`]. No error
/// gives radius 0, an infinite one an infinite radius.
#[derive(Clone, Copy, Debug)]
pub enum OwnRadius<'a> {
    /// `r = reach · δ` with δ the vertex's error (nested error criterion). Errors raised to those of the children give the
    /// same nested spheres as the vertices' own: a child's sphere, which the parent's holds, already reaches as far as the
    /// child's error does.
    Plain {
        /// δ.
        errors: &'a ErrorMap,
        /// Meters per meter.
        reach: f32,
    },
    /// `r' = k · reach · δ` with δ the vertex's own midpoint error and `k = 1 − 1/(f + 1 + ξ)` of its local roughness f:
    /// fewer triangles on flat ground (constrained nested error criterion). It promises no bound.
    Constrained {
        /// Meters per meter.
        reach: f32,
        /// f.
        roughness: &'a Roughness,
    },
    /// `r = reach · e + e + extent` with `e` the exact error and `extent` the largest distance from the vertex to the
    /// corners of the triangles it splits.
    ///
    /// A triangle's points lie within `extent` of its split vertex and the ground over or under them within `e` more, so
    /// from an eye outside the sphere a vertical error of length `e` is at least `reach · e` away everywhere:
    /// `|displayed − ground|` spans no more than the tolerance. This is a bound like that of `criterion::screen`, without
    /// its frustum.
    Bounding {
        /// Exact errors.
        errors: &'a ErrorMap,
        /// Meters per meter.
        reach: f32,
    },
}

/// Meters of distance per meter of error for a tolerance of `tolerance_px` in every corner of the camera's picture, where
/// pixels are largest; the papers' `camera.pixels_per_meter(1.0) / tolerance_px` holds in its middle only.
pub fn reach(camera: &Camera, tolerance_px: f32) -> f32 {
    // A length δ at distance d from the eye, θ off the viewing direction, spans at most δ / (d · cos² θ) on the picture's
    // plane: cos θ since depth is shorter than distance, and once more since the plane is met at a slant.
    let corner = 1.0 + camera.tan_half_fov().length_squared();
    camera.pixels_per_meter(1.0) * corner / tolerance_px
}

impl OwnRadius<'_> {
    /// The own radius of a vertex of the layout, meters; 0 for patch corners, which are always active.
    #[inline]
    pub fn at(&self, ground: PatchedGround<'_>, vertex: Vertex) -> f32 {
        if ground.layout.is_corner(vertex) {
            return 0.0;
        }
        match *self {
            Self::Plain { errors, reach } => plain_radius(errors.at(ground.layout, vertex), reach),
            Self::Constrained { reach, roughness } => {
                let reach = f64::from(reach) * roughness.factor(ground.layout.post(vertex));
                scaled(midpoint_error_at(ground.lattice, ground.layout, vertex), |error| reach * error)
            }
            Self::Bounding { errors, reach } => scaled(errors.at(ground.layout, vertex), |error| {
                (f64::from(reach) * error + error + extent(ground, vertex)) * (1.0 + MARGIN)
            }),
        }
    }

    /// How many posts around a vertex its own radius reads beyond those of the triangles it splits.
    pub(crate) fn half_window(&self) -> (u32, u32) {
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

/// The radius of a finite error; 0 for no error, infinite for an infinite one.
#[inline]
fn scaled(error: f32, radius: impl FnOnce(f64) -> f64) -> f32 {
    match error {
        0.0 => 0.0,
        f32::INFINITY => f32::INFINITY,
        error => radius(f64::from(error)) as f32,
    }
}

/// The largest distance from a vertex to the corners of the triangles it splits, meters.
fn extent(ground: PatchedGround<'_>, vertex: Vertex) -> f64 {
    let center = ground.position(vertex).as_dvec3();
    let distance = |corner| ground.position(corner).as_dvec3().distance(center);
    ground.diamond_corners(vertex).map(distance).fold(0.0, f64::max)
}

impl SphereMap {
    /// Nested spheres about own radii `reach · δ`: see [`OwnRadius::Plain`].
    pub fn plain(ground: PatchedGround<'_>, errors: &ErrorMap, reach: f32) -> Self {
        Self::new(ground, &OwnRadius::Plain { errors, reach })
    }

    /// Nested spheres about own radii `k · reach · δ`: see [`OwnRadius::Constrained`].
    pub fn constrained(ground: PatchedGround<'_>, reach: f32, roughness: &Roughness) -> Self {
        Self::new(ground, &OwnRadius::Constrained { reach, roughness })
    }

    /// Nested spheres that keep a tolerance, from exact errors: see [`OwnRadius::Bounding`].
    pub fn bounding(ground: PatchedGround<'_>, errors: &ErrorMap, reach: f32) -> Self {
        Self::new(ground, &OwnRadius::Bounding { errors, reach })
    }

    /// Nested spheres about own radii; in parallel, the same for any number of threads.
    pub fn new(ground: PatchedGround<'_>, own: &OwnRadius<'_>) -> Self {
        let columns = ground.layout.columns();
        let mut radii = vec![0.0; ground.layout.vertex_count()];
        radii.par_chunks_mut(columns).enumerate().for_each(|(y, row)| {
            if let OwnRadius::Plain { errors, reach } = *own {
                let errors = errors.row(ground.layout, y).iter();
                row.iter_mut().zip(errors).for_each(|(slot, &error)| *slot = plain_radius(error, reach));
                return;
            }
            for (x, radius) in row.iter_mut().enumerate() {
                *radius = own.at(ground, Vertex::new(x as i32, y as i32));
            }
        });
        Self::nested(ground, radii)
    }

    /// The spheres about given own radii, in the order of [`PatchLayout::index`], each grown until it holds those of its
    /// children. A vertex that never shows has radius 0 and an own radius of 0; infinite radii are allowed.
    ///
    /// In parallel over rows, the same for any number of threads.
    ///
    /// # Panics
    /// Unless there is one radius a vertex.
    pub fn nested(ground: PatchedGround<'_>, own: Vec<f32>) -> Self {
        assert_eq!(own.len(), ground.layout.vertex_count(), "one radius a vertex");
        let (mut radii, layout, field) = (own, ground.layout, HeightField::new(ground));
        let columns = layout.columns();
        let mut step = 1;
        while step < layout.patch() as usize {
            let (half, shift) = (step / 2, step.trailing_zeros() + 1);
            if step > 1 {
                for_rows(&mut radii, columns, half, SweepRows::Even, |y, row, [south, north]| {
                    let sides = both_sides(y, half, layout.rows());
                    let nest = SphereNest::new(&field, y, sides, ChildPlaces::Aslant(half));
                    let first = if (y / step).is_multiple_of(2) { step } else { 0 };
                    nest.grow(StridedColumns::until(first, columns, shift), row, [south, north]);
                });
            }
            for_rows(&mut radii, columns, step, SweepRows::Odd, |y, row, [south, north]| {
                let nest = SphereNest::new(&field, y, [y - step, y + step], ChildPlaces::Along(step));
                nest.grow(StridedColumns::until(step, columns, shift), row, [south, north]);
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

    /// The radii of the row of vertices `y`.
    #[inline]
    pub(crate) fn row(&self, layout: &PatchLayout, y: usize) -> &[f32] {
        &self.radii[y * layout.columns()..][..layout.columns()]
    }

    /// All radii, in the order of [`PatchLayout::index`].
    pub fn values(&self) -> &[f32] {
        &self.radii
    }

    /// Checks that every sphere holds those of its vertex's children.
    ///
    /// # Panics
    /// Where one does not.
    pub fn check(&self, ground: PatchedGround<'_>) {
        for (vertex, child) in ground.layout.descents() {
            let [own, below] = [vertex, child].map(|vertex| f64::from(self.at(ground.layout, vertex)));
            let [center, at] = [vertex, child].map(|vertex| ground.position(vertex).as_dvec3());
            let needed = at.distance(center) + below;
            assert!(
                below == 0.0 || own >= needed,
                "{vertex:?} has radius {own} m, its child {child:?} reaches to {needed} m"
            );
        }
    }

    /// Sets the radii of a row of a pass again from the vertices' own radii and their children's spheres; adds the vertices
    /// whose radius changed to `changed`. `held` is scratch.
    pub(crate) fn renew_row(
        &mut self,
        ground: PatchedGround<'_>,
        field: &HeightField<'_>,
        row: PassRow,
        own: &OwnRadius<'_>,
        held: &mut Vec<f32>,
        changed: &mut Vec<Vertex>,
    ) {
        let layout = ground.layout;
        let mut rows = row.values(&mut self.radii, layout);
        match row.pass.children() {
            Some(places) => {
                let nest = SphereNest::new(field, row.y, row.child_rows(layout.rows()), places);
                nest.measure(row.columns, [rows.here, rows.south, rows.north], held);
            }
            None => {
                held.clear();
                held.resize(row.columns.count, 0.0);
            }
        }
        if let OwnRadius::Plain { errors, reach } = *own {
            let errors = errors.row(layout, row.y);
            let radius = |x: usize| plain_radius(errors[x], reach);
            row.renew(&mut rows, |_, index, x| larger(radius(x), held[index]), changed);
        } else {
            let radius = |x: usize| own.at(ground, Vertex::new(x as i32, row.y as i32));
            row.renew(&mut rows, |_, index, x| larger(radius(x), held[index]), changed);
        }
    }
}
