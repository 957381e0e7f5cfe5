//! Which posts can be seen from one point.

use glam::DVec2;
use rayon::prelude::*;

use crate::terrain::lattice::{Lattice, Post};
use crate::terrain::query::Answer;
use crate::terrain::sight::Curvature;
use crate::terrain::sight::line::{End, Sight, line_of_sight};

/// What a viewshed is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewshedOptions {
    /// Who looks.
    pub observer: End,
    /// Metres above the ground of what is looked for, at every post.
    pub target_above_m: f64,
    /// How far is looked, in metres along the ground; without limit where infinite.
    pub range_m: f64,
    /// The directions looked into.
    pub sector: Sector,
    /// The Earth's curvature and refraction.
    pub curvature: Curvature,
}

/// Directions, as azimuths clockwise from north in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sector {
    /// Where it begins, 0..360.
    pub from_deg: f64,
    /// How far it turns clockwise from there, above 0 and up to 360.
    pub width_deg: f64,
}

impl Sector {
    /// All around.
    pub const ALL: Self = Self { from_deg: 0.0, width_deg: 360.0 };

    /// Whether a point as far away as `offset` (east, north) lies in it; both borders and the apex do.
    pub fn holds(&self, offset: DVec2) -> bool {
        if self.width_deg >= 360.0 || offset == DVec2::ZERO {
            return true;
        }
        let azimuth_deg = libm::atan2(offset.x, offset.y).to_degrees();
        (azimuth_deg - self.from_deg).rem_euclid(360.0) <= self.width_deg
    }
}

/// What a viewshed says of a post.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Seen {
    /// Beyond the range or out of the sector.
    Beyond,
    /// There is no data.
    NoData,
    /// Terrain stands between.
    Hidden,
    /// In sight.
    Visible,
}

/// What can be seen, post by post.
#[derive(Clone, Debug, PartialEq)]
pub struct Viewshed {
    /// Posts per row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Row by row from the south-west, as [`Lattice::heights`].
    pub posts: Vec<Seen>,
}

/// Looks from the observer to every post: [`Seen::Visible`] exactly where [`line_of_sight`] is clear.
///
/// # Errors
/// What the ground answers at the observer, where it has no height there.
pub fn viewshed(lattice: &Lattice, options: &ViewshedOptions) -> Result<Viewshed, Answer> {
    use crate::terrain::query::{Interpolation, ground_height};
    let ground = ground_height(lattice, Interpolation::Planar, options.observer.at);
    if ground.height_m().is_none() {
        return Err(ground);
    }
    let (columns, rows) = (lattice.columns(), lattice.rows());
    let posts = (0..columns as usize * rows as usize).into_par_iter();
    let look = |index: usize| {
        let post = Post { column: (index % columns as usize) as u32, row: (index / columns as usize) as u32 };
        see(lattice, options, post)
    };
    Ok(Viewshed { columns, rows, posts: posts.map(look).collect() })
}

/// What one line of sight says of a post.
fn see(lattice: &Lattice, options: &ViewshedOptions, post: Post) -> Seen {
    let at = lattice.map_position(post);
    let offset = at - options.observer.at;
    if offset.length() > options.range_m || !options.sector.holds(offset) {
        return Seen::Beyond;
    }
    let target = End { at, above_m: options.target_above_m };
    match line_of_sight(lattice, options.observer, target, options.curvature) {
        Sight::Clear => Seen::Visible,
        Sight::Blocked(_) => Seen::Hidden,
        Sight::NoGround(_) => Seen::NoData,
    }
}
