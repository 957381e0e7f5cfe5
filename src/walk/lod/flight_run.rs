//! One method on one flight: what it shows, sends and costs.

use glam::{UVec2, Vec2};

use crate::lod::lod_ground::LodGround;
use crate::lod::method::LodMethod;
use sandtable_roam::frames::LastFrame;
use sandtable_roam::measure::{HeightDifference, height_difference};
use sandtable_roam::shown::PatchList;
use sandtable_terrain::lattice::Post;
use sandtable_view::camera::Camera;

/// Frames whose heights are compared with the elevation model, spread evenly over the flight: enough to even out the
/// views, few enough to take no longer than the flight.
pub const MEASURED: usize = 8;

/// Measurements of one method on a flight, over all frames but the first.
#[derive(Clone, Debug, PartialEq)]
pub struct FlightReport {
    /// The method.
    pub method: LodMethod,
    /// Frames counted.
    pub frames: usize,
    /// Triangles shown, mean over frames.
    pub triangles: f64,
    /// Triangles shown, the most in any frame.
    pub most_triangles: usize,
    /// Patches in view, the most in any frame.
    pub most_patches: usize,
    /// Vertices that the index lists name, mean over frames: three a triangle, fewer in strips.
    pub vertices_sent: f64,
    /// Triangles that the frame before did not show, mean over frames.
    pub changed_per_frame: f64,
    /// Milliseconds to bring triangles and lists up to date.
    pub update_ms_median: f64,
    /// The same, in all but one of a hundred frames.
    pub update_ms_p99: f64,
    /// Bytes of index lists sent a frame.
    pub upload_bytes_median: usize,
    /// Heights shown less those of the elevation model.
    pub difference: HeightDifference,
}

/// A flight to be flown by several methods.
pub struct FlightPlan<'a> {
    /// The ground.
    pub ground: &'a LodGround,
    /// A camera for each frame.
    pub cameras: &'a [Camera],
    /// The most triangles, for methods that keep a budget.
    pub budget: Option<usize>,
    /// The time in seconds since any moment; only updates are timed.
    pub seconds: &'a dyn Fn() -> f64,
}

impl FlightPlan<'_> {
    /// Flies `method`. The first frame, which has none before it, starts the method and is not counted.
    pub fn fly(&self, method: LodMethod) -> FlightReport {
        let mut follower = method.follower(self.ground, self.budget);
        let measured: Vec<usize> = measured_frames(self.cameras.len()).collect();
        let mut last = LastFrame::default();
        let mut totals = FlightTotals::default();
        for (frame, camera) in self.cameras.iter().enumerate() {
            if frame == 0 {
                follower.prepare(camera);
            }
            let start = (self.seconds)();
            follower.update(camera);
            let update_ms = ((self.seconds)() - start) * 1e3;
            let shown = follower.shown();
            let change = last.compare(&shown);
            if frame > 0 {
                let triangles = shown.iter().map(|list| list.triangles.len()).sum();
                totals.times_ms.push(update_ms);
                totals.triangles += triangles;
                totals.most_triangles = totals.most_triangles.max(triangles);
                totals.most_patches = totals.most_patches.max(shown.len());
                totals.vertices += shown.iter().map(|list| list.indices).sum::<usize>();
                totals.appeared += change.appeared;
                totals.uploads.push(follower.sent_bytes());
            }
            if measured.contains(&frame) {
                totals.difference = totals.difference.with(self.difference_in_view(camera, &shown));
            }
        }
        totals.report(method)
    }

    /// The difference of heights at the posts in the picture: a patch can be large, and its part out of view may have
    /// any error.
    fn difference_in_view(&self, camera: &Camera, shown: &[PatchList]) -> HeightDifference {
        let (lattice, size) = (self.ground.measured.lattice(), UVec2::from(camera.size()).as_vec2());
        let error_px = |post: Post, shown_m: f64| {
            let (at, height_m) = (lattice.position(post), lattice.height(post));
            let pixel = camera.project(at.extend(height_m))?.pixel;
            let is_in_view = pixel.cmpge(Vec2::ZERO).all() && pixel.cmple(size).all();
            if !is_in_view || f64::from(height_m) == shown_m {
                return is_in_view.then_some(0.0);
            }
            // A shown position before the near plane is not visible.
            let shown = camera.project(at.extend(shown_m as f32));
            Some(shown.map_or(0.0, |shown| f64::from(shown.pixel.distance(pixel))))
        };
        height_difference(lattice, self.ground.measured.layout(), shown, error_px)
    }
}

/// The frames that are measured, from the first to the last.
fn measured_frames(frames: usize) -> impl Iterator<Item = usize> {
    let count = MEASURED.min(frames);
    (0..count).map(move |at| at * (frames - 1) / (count - 1).max(1))
}

/// Sums over the frames.
#[derive(Default)]
struct FlightTotals {
    times_ms: Vec<f64>,
    uploads: Vec<usize>,
    triangles: usize,
    most_triangles: usize,
    most_patches: usize,
    vertices: usize,
    appeared: usize,
    difference: HeightDifference,
}

impl FlightTotals {
    fn report(mut self, method: LodMethod) -> FlightReport {
        let frames = self.times_ms.len();
        self.times_ms.sort_by(f64::total_cmp);
        self.uploads.sort_unstable();
        let mean = |sum: usize| sum as f64 / frames.max(1) as f64;
        let rank = |share: f64| ((frames as f64 * share).ceil() as usize).saturating_sub(1);
        let time_ms = |share: f64| self.times_ms.get(rank(share)).copied().unwrap_or_default();
        FlightReport {
            method,
            frames,
            triangles: mean(self.triangles),
            most_triangles: self.most_triangles,
            most_patches: self.most_patches,
            vertices_sent: mean(self.vertices),
            changed_per_frame: mean(self.appeared),
            update_ms_median: time_ms(0.5),
            update_ms_p99: time_ms(0.99),
            upload_bytes_median: self.uploads.get(rank(0.5)).copied().unwrap_or_default(),
            difference: self.difference,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measured_frames_are_few_and_reach_from_end_to_end() {
        assert_eq!(measured_frames(2).collect::<Vec<_>>(), [0, 1]);
        assert_eq!(measured_frames(8).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5, 6, 7]);
        let many: Vec<usize> = measured_frames(240).collect();
        assert_eq!((many.len(), many[0], many[7]), (MEASURED, 0, 239));
    }

    #[test]
    fn medians_and_percentiles_are_times_that_were_measured() {
        let method = LodMethod::Full;
        let times_ms: Vec<f64> = (1..=200).rev().map(f64::from).collect();
        let totals = FlightTotals {
            times_ms,
            uploads: (0..200).collect(),
            triangles: 1000,
            ..FlightTotals::default()
        };
        let report = totals.report(method);
        assert_eq!((report.update_ms_median, report.update_ms_p99), (100.0, 198.0));
        assert_eq!((report.upload_bytes_median, report.triangles), (99, 5.0));
    }
}
