//! The cameras of a new scene: the whole ground, what the vector files hold, and the boldest relief from low above.

use glam::DVec2;

use crate::geom::rect::Rect;
use crate::scene::SceneModel;
use crate::terrain::lattice::{Lattice, Post};

/// A fitted camera as its table states it; angles in degrees.
pub(super) struct CameraDraft {
    pub name: &'static str,
    /// A comment for the scene file.
    pub about: &'static str,
    pub azimuth_deg: Option<f64>,
    pub pitch_deg: Option<f64>,
    /// The corners of what it shows, in the scene's system.
    pub shown: Option<Rect>,
}

/// Vectors that cover more than this share of the ground, along one side at least, need no camera of their own.
const NEARLY_ALL: f64 = 0.7;
/// The margin around the vectors, as a share of their extent.
const MARGIN: f64 = 0.05;
/// The ground is compared in this many blocks along its longer side.
const BLOCKS: u32 = 10;
/// The low camera's angle below the horizon.
const LOW_PITCH_DEG: f64 = 14.0;
/// The directions in which the low camera may look: light from the upper left models the ground.
const LOW_AZIMUTHS_DEG: [f64; 5] = [0.0, -30.0, 30.0, -60.0, 60.0];

/// The cameras for a scene whose vectors, if any, lie within `vectors` in the scene's system; the first is the default.
pub(super) fn cameras(scene: &SceneModel, vectors: Rect) -> Vec<CameraDraft> {
    let lattice = &scene.lattice;
    let ground = lattice.map_extent();
    let mut cameras = vec![CameraDraft {
        name: "overview",
        about: "The whole ground from the south, as large as it fits into the picture.",
        azimuth_deg: None,
        pitch_deg: None,
        shown: None,
    }];
    let shown = vectors.grown(vectors.size().max_element() * MARGIN).intersection(&ground);
    if !shown.is_empty() && (shown.size() / ground.size()).min_element() < NEARLY_ALL {
        cameras.push(CameraDraft {
            name: "features",
            about: "The part of the ground on which there are features.",
            azimuth_deg: None,
            pitch_deg: None,
            shown: Some(shown),
        });
    }
    cameras.extend(boldest_block(lattice).map(|block| {
        let shown = Rect { min: block.min + lattice.origin(), max: block.max + lattice.origin() };
        CameraDraft {
            name: "relief",
            about: "The boldest relief, from low above the ground before it.",
            azimuth_deg: Some(lowest_approach(lattice, block)),
            pitch_deg: Some(LOW_PITCH_DEG),
            shown: Some(shown),
        }
    }));
    cameras
}

/// The block of the ground with the greatest difference of heights and half a block around it, from the south-west post on;
/// `None` on level ground.
fn boldest_block(lattice: &Lattice) -> Option<Rect> {
    let side = (lattice.columns().max(lattice.rows()) / BLOCKS).max(2);
    let relief = |&(left, below): &(u32, u32)| {
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for row in below..(below + side).min(lattice.rows()) {
            for column in left..(left + side).min(lattice.columns()) {
                let height = lattice.height(Post { column, row });
                low = low.min(height);
                high = high.max(height);
            }
        }
        high - low
    };
    let corners = (0..lattice.rows())
        .step_by(side as usize)
        .flat_map(|row| (0..lattice.columns()).step_by(side as usize).map(move |column| (column, row)));
    let ((left, below), relief) = corners
        .map(|corner| (corner, relief(&corner)))
        .fold(((0, 0), 0.0), |best, next| if next.1 > best.1 { next } else { best });
    let min = lattice.position(Post { column: left, row: below }).as_dvec2();
    let size = lattice.cell() * f64::from(side);
    (relief > 0.0)
        .then(|| Rect { min: min - size / 2.0, max: min + size * 1.5 }.intersection(&lattice.extent()))
}

/// The direction toward `block` with the lowest ground before it, degrees clockwise from north; beyond the border of the
/// data there is none, and the walls of the ground's block would be in the way.
fn lowest_approach(lattice: &Lattice, block: Rect) -> f64 {
    let (center, reach) = (block.center(), block.size().max_element());
    let highest = |azimuth_deg: f64| {
        let (sin, cos) = (libm::sin(azimuth_deg.to_radians()), libm::cos(azimuth_deg.to_radians()));
        let approach = (2..8).map(|step| {
            let at = center - DVec2::new(sin, cos) * (reach * f64::from(step) / 4.0);
            lattice.cell_at(at).map_or(f32::NAN, |(post, _)| lattice.height(post))
        });
        approach.fold((0, f32::NEG_INFINITY), |(beyond, highest), height| {
            (beyond + u32::from(height.is_nan()), highest.max(height))
        })
    };
    let [first, others @ ..] = LOW_AZIMUTHS_DEG.map(|azimuth| (azimuth, highest(azimuth)));
    others.into_iter().fold(first, |best, next| if next.1 < best.1 { next } else { best }).0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Level ground of 100 by 80 cells of 10 m, with a hill around column 70, row 60 and a ridge south of it.
    fn hill() -> Lattice {
        let height = |index: u32| {
            let (column, row) = ((index % 101) as f32, (index / 101) as f32);
            let hill = 300.0 - 20.0 * f32::hypot(column - 70.0, row - 60.0);
            let ridge = if (30.0..34.0).contains(&row) && column > 55.0 { 90.0 } else { 0.0 };
            hill.max(ridge)
        };
        Lattice::new(DVec2::new(500.0, 900.0), DVec2::splat(10.0), 101, (0..101 * 81).map(height).collect())
            .expect("sound")
    }

    #[test]
    fn the_boldest_relief_is_seen_across_the_lowest_ground() {
        let lattice = hill();
        let block = boldest_block(&lattice).expect("there is a hill");
        assert!(block.contains(DVec2::new(700.0, 600.0)), "{block:?}");
        assert_eq!(lowest_approach(&lattice, block), 30.0, "from the south-west, past the end of the ridge");
    }

    #[test]
    fn level_ground_has_no_boldest_relief() {
        let level = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 9, vec![5.0; 81]).expect("sound");
        assert_eq!(boldest_block(&level), None);
    }
}
