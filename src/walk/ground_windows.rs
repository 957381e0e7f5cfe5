//! Finer posts of the ground around the eye than those of the overview by which terrain on disk is tinted and lit.
//!
//! ```text
//!  ┌────────────────┐   the overview: all of the terrain
//!  │   ┌────────┐   │   windows of as many posts each, half as far apart from one to the next, around the eye and
//!  │   │ ┌────┐ │   │   ahead of it; the finest has every sample
//!  │   │ │  ∧ │ │   │
//!  │   │ └────┘ │   │   It takes an eye near the ground to see finer posts: from far away there are fewer windows.
//!  │   └────────┘   │
//!  └────────────────┘
//! ```

use std::ops::Range;
use std::sync::Arc;

use glam::{DVec2, Vec3};

use sandtable_draw::ground::GroundMap;
use sandtable_draw::ground_window::GroundWindow;
use sandtable_raster::reduced::{reduced_part, reduced_size};
use sandtable_raster::windows::Windows;
use sandtable_scene::ground_window::{WindowGround, ground_window};
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::{Lattice, LatticeError, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::query::windowed::LatticePartError;

/// Posts along the sides of a window: 16 MB on the device. Of a picture a thousand pixels high, its border is where a pixel
/// is a quarter of a post wide.
const SIDE: u32 = 1024;

/// Windows move by this many posts: smaller steps make them anew more often, larger ones let their border come nearer.
const STEP: u32 = SIDE / 8;

/// How far ahead of the eye the middle of a window lies, as a share of its width: behind the eye nothing is seen.
const AHEAD: f64 = 0.25;

/// Posts beside a window that its slopes and its light are computed with.
const BORDER: u32 = 16;

/// The most windows; each makes the posts twice as fine.
const MOST_WINDOWS: u32 = 8;

/// The point of view on a terrain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundWindowView {
    /// The eye's world X and Y.
    pub eye: DVec2,
    /// How far it is above the ground, or from it, in meters.
    pub distance_m: f64,
    /// World X and Y of the place in the middle of the picture.
    pub focus: DVec2,
    /// The width of a pixel at a distance of one meter, in meters.
    pub pixel: f64,
}

/// The light of windows.
#[derive(Clone)]
pub struct GroundWindowLight {
    /// The overview.
    pub scene: Arc<SceneModel>,
    /// Its ground map.
    pub map: Arc<GroundMap>,
    /// Unit vector toward the sun.
    pub to_sun: Vec3,
}

/// The place of a window: it has every `every`-th sample of the terrain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GroundWindowPlan {
    every: u32,
    columns: Range<u32>,
    rows: Range<u32>,
}

impl GroundWindowPlan {
    /// The step between its samples, in samples of the terrain east and north.
    pub fn every(&self) -> u32 {
        self.every
    }
}

/// Makes the windows of a terrain.
pub struct GroundWindowMaker<W> {
    samples: W,
    origin: DVec2,
    cell: DVec2,
}

impl<W: Windows> GroundWindowMaker<W> {
    /// For a terrain in meters.
    ///
    /// # Errors
    /// It is no lattice.
    pub fn new(samples: W) -> Result<Self, LatticeError> {
        let (origin, cell) = Lattice::frame(samples.metadata())?;
        Ok(Self { samples, origin, cell })
    }

    /// The windows to show with `map`, the coarsest first; none where the map is fine enough.
    pub fn plans(&self, map: &GroundMap, view: &GroundWindowView) -> Vec<GroundWindowPlan> {
        let all = f64::from(map.cell.x) / self.cell.x;
        let mut every = (all.round() as u32).next_power_of_two();
        let (mut plans, pixel_m) = (Vec::new(), view.distance_m * view.pixel);
        while every > 1 && plans.len() < MOST_WINDOWS as usize && f64::from(every) * self.cell.x > pixel_m {
            every /= 2;
            plans.push(self.plan(every, view));
        }
        plans
    }

    fn plan(&self, every: u32, view: &GroundWindowView) -> GroundWindowPlan {
        let cell = self.cell * f64::from(every);
        let (columns, rows) = reduced_size(self.samples.size(), every);
        let most_ahead_m = AHEAD * f64::from(SIDE) * cell.min_element();
        let middle = (view.eye + (view.focus - view.eye).clamp_length_max(most_ahead_m)) / cell;
        let range = |middle: f64, count: u32| {
            let width = SIDE.min(count);
            let first = (middle - f64::from(width) / 2.0) / f64::from(STEP);
            let first = (first.round().max(0.0) as u32).saturating_mul(STEP).min(count - width);
            first..first + width
        };
        GroundWindowPlan { every, columns: range(middle.x, columns), rows: range(middle.y, rows) }
    }

    /// Makes a window.
    ///
    /// # Errors
    /// See [`LatticePartError`].
    pub fn window(
        &mut self,
        plan: &GroundWindowPlan,
        light: &GroundWindowLight,
    ) -> Result<GroundWindow, LatticePartError> {
        let GroundWindowPlan { every, columns, rows } = plan;
        let size = reduced_size(self.samples.size(), *every);
        let around = |range: &Range<u32>, count: u32| {
            range.start.saturating_sub(BORDER)..(range.end + BORDER).min(count)
        };
        let (across, along) = (around(columns, size.0), around(rows, size.1));
        let heights = reduced_part(&mut self.samples, *every, across.clone(), along.clone())?;
        let first = Post { column: across.start, row: along.start };
        let place = (self.origin, self.cell * f64::from(*every));
        let lattice = Lattice::part(place, first, across.len() as u32, heights)?;
        let inner = PostRect {
            first: Post { column: columns.start - across.start, row: rows.start - along.start },
            last: Post { column: columns.end - 1 - across.start, row: rows.end - 1 - along.start },
        };
        Ok(ground_window(&light.scene, &light.map, &WindowGround { lattice, inner }, light.to_sun))
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use sandtable_editing::viewing::open_to_view;
    use sandtable_scene::ground_map_cache::GroundMapKey;

    fn scene() -> (Arc<SceneModel>, GroundWindowLight) {
        let editor = open_to_view(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml")), &[])
            .expect("readable");
        let scene = Arc::new(editor.source().build(&|_| ()).expect("sound"));
        let to_sun = Vec3::new(-0.5, 0.5, 0.7).normalize();
        let map = scene.map(GroundMapKey { level: 0, to_sun }, || ());
        (Arc::clone(&scene), GroundWindowLight { scene, map, to_sun })
    }

    #[test]
    fn a_window_as_fine_as_the_map_has_its_heights_slopes_and_no_more_light() {
        let (scene, light) = scene();
        let (map, lattice) = (&light.map, (*scene.lattice).clone());
        let inner = PostRect { first: Post { column: 3, row: 5 }, last: Post { column: 40, row: 30 } };
        let window = ground_window(&scene, map, &WindowGround { lattice, inner }, light.to_sun);
        assert_eq!((window.first, window.size()), ([3, 5], Some([38, 26])));
        let mut lit = 0;
        for (index, post) in window.posts.iter().enumerate() {
            let own = &map.posts[(5 + index / 38) * map.columns as usize + 3 + index % 38];
            let surface = |post: &sandtable_draw::ground::GroundPost| {
                (post.height_m, post.slope_east, post.slope_north)
            };
            assert_eq!(surface(post), surface(own));
            assert!(post.sun_visibility <= own.sun_visibility && post.sky_visibility <= own.sky_visibility);
            lit += usize::from(post.sun_visibility > 0.5);
        }
        assert!(lit > 500, "{lit} posts in the sun");
    }

    #[test]
    fn windows_are_nested_around_the_eye_and_fewer_from_far_away() {
        let samples = sandtable_raster::raster::Samples::F32(vec![0.0; 4097 * 4097]);
        let north_west = DVec2::new(0.0, 40_960.0);
        let raster = sandtable_raster::raster::Raster::new(4097, samples)
            .placed(sandtable_raster::raster::north_up_nodes(north_west, DVec2::splat(10.0)));
        let mut maker = GroundWindowMaker::new(raster).expect("a lattice");
        let (_, light) = scene();
        let map = GroundMap { cell: glam::Vec2::splat(160.0), ..(*light.map).clone() };
        let view = |distance_m: f64| GroundWindowView {
            eye: DVec2::new(20_000.0, 9_000.0),
            distance_m,
            focus: DVec2::new(20_000.0, 60_000.0),
            pixel: 1e-3,
        };
        let plans = maker.plans(&map, &view(300.0));
        assert_eq!(plans.iter().map(|plan| plan.every).collect::<Vec<_>>(), [8, 4, 2, 1]);
        for pair in plans.windows(2) {
            let held = |range: &Range<u32>| (range.start * 2, (range.end - 1) * 2);
            let (columns, rows) = (held(&pair[0].columns), held(&pair[0].rows));
            assert!(columns.0 <= pair[1].columns.start && pair[1].columns.end - 1 <= columns.1, "{pair:?}");
            assert!(rows.0 <= pair[1].rows.start && pair[1].rows.end - 1 <= rows.1, "{pair:?}");
        }
        // Ahead of the eye, in the finest.
        assert!(plans[3].rows.contains(&900) && plans[3].rows.end > 1600, "{:?}", plans[3]);
        assert_eq!(maker.plans(&map, &view(50_000.0)).len(), 2);
        assert!(maker.plans(&map, &view(200_000.0)).is_empty());
        let window = maker.window(&plans[3], &light).expect("readable");
        assert_eq!(window.size(), Some([1024, 1024]));
        assert_eq!(window.first, [plans[3].columns.start, plans[3].rows.start]);
    }
}
