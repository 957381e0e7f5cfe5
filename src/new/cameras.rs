//! The cameras of a new scene: the whole ground, what the vector files hold, and the boldest relief from low above.

use std::ops::Range;

use glam::{DVec2, DVec3};

use sandtable_geom::azimuth::heading;
use sandtable_geom::rect::Rect;
use sandtable_scene::framing::main_part::main_part;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::sunlight::{ALTITUDE_DEG, LEFT_DEG};
use sandtable_terrain::lattice::{Lattice, Post};

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

/// Ground whose normal has less than this of the light's direction looks dark, whatever it is made of.
const DARK: f64 = 0.25;
/// Where the ground before a block is looked at, in sixteenths of its longer side from its middle: fine enough for a ridge.
const APPROACH: Range<u32> = 8..32;
/// Where the ground beside and behind a block is looked at, in sixteenths of its longer side from its middle: it widens like
/// the view.
const FLANKS: Range<u32> = 0..16;
/// What ground that ends beside the block costs, where ground that hides as much as there is to see costs 1.
const ENDED: f64 = 3.0;
/// The same for ground that ends before the block, where the walls of the model are in the way.
const BEYOND: f64 = 4.0;
/// Where there is no ground before any block, that with the greatest difference of heights is the best still.
const LEAST_HELD: f64 = 0.01;
/// Along each side of a block as many places are looked at: enough to compare directions.
const PLACES: u32 = 48;

/// The cameras for a scene whose vectors, if any, lie within `vectors` in the scene's system, and whose heights are drawn
/// `exaggeration` times; the first is the default.
pub(super) fn cameras(scene: &SceneModel, vectors: Rect, exaggeration: f64) -> Vec<CameraDraft> {
    let lattice = &scene.lattice;
    let ground = lattice.map_extent();
    let on_map = |part: Rect| Rect { min: part.min + lattice.origin(), max: part.max + lattice.origin() };
    let main_part = main_part(scene);
    let mut cameras = vec![CameraDraft {
        name: "overview",
        about: match main_part {
            None => "The whole ground from the south, as large as it fits into the picture.",
            Some(_) => {
                "The ground past whose ends the picture runs, so that it is filled; without `shows`, the whole of it."
            }
        },
        azimuth_deg: None,
        pitch_deg: None,
        shown: main_part.map(on_map),
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
    let on_ground = vectors.intersection(&ground);
    let in_world = Rect { min: on_ground.min - lattice.origin(), max: on_ground.max - lattice.origin() };
    let subject = (!on_ground.is_empty()).then_some(in_world);
    cameras.extend(boldest_block(lattice, subject).map(|block| CameraDraft {
        name: "relief",
        about: match subject {
            Some(_) => "The boldest relief among the features, from low above the ground before it.",
            None => "The boldest relief, from low above the ground before it.",
        },
        azimuth_deg: Some(best_approach(lattice, block, exaggeration)),
        pitch_deg: Some(LOW_PITCH_DEG),
        shown: Some(on_map(block)),
    }));
    cameras
}

/// The block of the ground with the greatest difference of heights and a block around it, from the south-west post on, moved
/// inward at the border of the model; of those whose middle lies in `subject`, where that is stated and holds any. The difference
/// counts by how much ground there is in and before what is shown, lest the walls of the model hide it or a picture show its end.
/// `None` on level ground.
fn boldest_block(lattice: &Lattice, subject: Option<Rect>) -> Option<Rect> {
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
    let is_subject = |&(left, below): &(u32, u32)| {
        let middle = DVec2::new(f64::from(left), f64::from(below)) + f64::from(side) / 2.0;
        subject.is_none_or(|subject| subject.contains(middle * lattice.cell()))
    };
    let among: Vec<(u32, u32)> = corners.clone().filter(is_subject).collect();
    let among = if among.is_empty() { corners.collect() } else { among };
    let block = |(column, row): (u32, u32)| {
        let min = lattice.position(Post { column, row }).as_dvec2();
        let size = lattice.cell() * f64::from(side);
        let extent = lattice.extent();
        let most = (extent.max - size * 3.0).max(extent.min);
        let min = (min - size).clamp(extent.min, most);
        Rect { min, max: min + size * 3.0 }.intersection(&extent)
    };
    let worth = |corner: (u32, u32)| f64::from(relief(&corner)) * held_share(lattice, block(corner)).powi(2);
    let (corner, worth) = among
        .into_iter()
        .map(|corner| (corner, worth(corner)))
        .fold(((0, 0), 0.0), |best, next| if next.1 > best.1 { next } else { best });
    (worth > 0.0).then(|| block(corner))
}

/// The share of a block and of the ground before and beside it, from the best of the low camera's directions, that holds data.
fn held_share(lattice: &Lattice, block: Rect) -> f64 {
    let held = places(block).filter(|at| is_held(lattice, *at)).count() as f64 / f64::from(PLACES * PLACES);
    let before = LOW_AZIMUTHS_DEG.map(|azimuth_deg| {
        let seen = approach(block, azimuth_deg).chain(flanks(block, azimuth_deg));
        seen.filter(|at| is_held(lattice, *at)).count() as f64 / (APPROACH.len() + 2 * FLANKS.len()) as f64
    });
    (held * before.into_iter().fold(0.0, f64::max)).max(LEAST_HELD)
}

fn is_held(lattice: &Lattice, at: DVec2) -> bool {
    lattice.cell_at(at).is_some_and(|(post, _)| !lattice.height(post).is_nan())
}

/// Places on the ground before a block, toward the eye of a camera that looks toward `azimuth_deg`.
fn approach(block: Rect, azimuth_deg: f64) -> impl Iterator<Item = DVec2> {
    let (center, reach, toward) = (block.center(), block.size().max_element(), heading(azimuth_deg));
    APPROACH.map(move |step| center - toward * (reach * f64::from(step) / 16.0))
}

/// Places on the ground at both sides of a block and behind it, where such a camera sees the ground end if it does.
fn flanks(block: Rect, azimuth_deg: f64) -> impl Iterator<Item = DVec2> {
    let (center, reach, toward) = (block.center(), block.size().max_element(), heading(azimuth_deg));
    FLANKS.flat_map(move |step| {
        let away = f64::from(step) / 16.0;
        [1.0, -1.0].map(|side| center + (toward * away - toward.perp() * side * (0.55 + 0.35 * away)) * reach)
    })
}

/// The direction toward `block`, degrees clockwise from north, from which most of it is lit and the ground before it is low;
/// beyond the border of the data there is none: the walls of the ground's block would be in the way, and its end would show.
fn best_approach(lattice: &Lattice, block: Rect, exaggeration: f64) -> f64 {
    let heights = || places(block).filter_map(|at| lattice.cell_at(at)).map(|(post, _)| lattice.height(post));
    let (low, high) = heights()
        .filter(|height| !height.is_nan())
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), height| (low.min(height), high.max(height)));
    let cost = |azimuth_deg: f64| {
        let approach = approach(block, azimuth_deg)
            .map(|at| lattice.cell_at(at).map_or(f32::NAN, |(post, _)| lattice.height(post)));
        let (beyond, highest) = approach.fold((0, low), |(beyond, highest), height| {
            (beyond + u32::from(height.is_nan()), highest.max(height))
        });
        let hidden = f64::from((highest - low) / (high - low).max(f32::MIN_POSITIVE));
        let ends = flanks(block, azimuth_deg).filter(|at| !is_held(lattice, *at)).count();
        let ended = ends as f64 / (2 * FLANKS.len()) as f64;
        let before = f64::from(beyond) / APPROACH.len() as f64;
        hidden + BEYOND * before + ENDED * ended + dark_share(lattice, block, azimuth_deg, exaggeration)
    };
    let [first, others @ ..] = LOW_AZIMUTHS_DEG.map(|azimuth| (azimuth, cost(azimuth)));
    others.into_iter().fold(first, |best, next| if next.1 < best.1 { next } else { best }).0
}

/// Places spread evenly over a block.
fn places(block: Rect) -> impl Iterator<Item = DVec2> {
    let share = |index: u32| (f64::from(index) + 0.5) / f64::from(PLACES);
    (0..PLACES).flat_map(move |row| {
        (0..PLACES).map(move |column| block.min + block.size() * DVec2::new(share(column), share(row)))
    })
}

/// The share of a block that is dark in a low view toward `azimuth_deg`, without cast shadows.
fn dark_share(lattice: &Lattice, block: Rect, azimuth_deg: f64, exaggeration: f64) -> f64 {
    let [_, left_of_low_view] = LEFT_DEG;
    let altitude = ALTITUDE_DEG.to_radians();
    let azimuth = (azimuth_deg - f64::from(left_of_low_view)).to_radians();
    let level = libm::cos(altitude);
    let to_sun = DVec3::new(libm::sin(azimuth) * level, libm::cos(azimuth) * level, libm::sin(altitude));
    let normals = places(block).filter_map(|at| {
        let (cell, _) = lattice.cell_at(at)?;
        let [south_west, south_east, north_west, north_east] = lattice.corner_heights(cell).map(f64::from);
        let rise = DVec2::new(
            south_east + north_east - south_west - north_west,
            north_west + north_east - south_west - south_east,
        );
        let slope = rise / 2.0 / lattice.cell() * exaggeration;
        Some((-slope).extend(1.0).normalize()).filter(|normal| !normal.is_nan())
    });
    let (dark, all) = normals
        .fold((0_u32, 0_u32), |(dark, all), normal| (dark + u32::from(normal.dot(to_sun) < DARK), all + 1));
    f64::from(dark) / f64::from(all.max(1))
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
        let block = boldest_block(&lattice, None).expect("there is a hill");
        assert!(block.contains(DVec2::new(700.0, 600.0)), "{block:?}");
        assert_eq!(
            best_approach(&lattice, block, 1.0),
            30.0,
            "from the south-west, past the end of the ridge"
        );
    }

    #[test]
    fn of_a_masked_ground_the_relief_that_has_ground_before_it_is_shown() {
        let height = |index: u32| {
            let (column, row) = ((index % 101) as f32, (index / 101) as f32);
            let cone = |east: f32, north: f32, top: f32| top - 20.0 * f32::hypot(column - east, row - north);
            let height = cone(25.0, 35.0, 300.0).max(cone(88.0, 55.0, 280.0)).max(0.0);
            if column < 80.0 && row < 30.0 { f32::NAN } else { height }
        };
        let heights = (0..101 * 101).map(height).collect();
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 101, heights).expect("sound");
        let block = boldest_block(&lattice, None).expect("there are hills");
        assert!(block.contains(DVec2::new(880.0, 550.0)), "{block:?}");
    }

    #[test]
    fn a_slope_is_seen_from_where_the_light_falls_on_it() {
        let falls_west: Vec<f32> = (0..101 * 101).map(|index: u32| 20.0 * (index % 101) as f32).collect();
        let lattice = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 101, falls_west).expect("sound");
        let block = Rect { min: DVec2::splat(400.0), max: DVec2::splat(600.0) };
        assert_eq!(dark_share(&lattice, block, 0.0, 1.0), 0.0, "the light comes from the west");
        assert_eq!(dark_share(&lattice, block, 180.0, 1.0), 1.0);
    }

    #[test]
    fn level_ground_has_no_boldest_relief() {
        let level = Lattice::new(DVec2::ZERO, DVec2::splat(10.0), 9, vec![5.0; 81]).expect("sound");
        assert_eq!(boldest_block(&level, None), None);
    }
}
