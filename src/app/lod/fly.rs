//! One method on one flight: only the update is under the clock.

use std::time::Instant;

use glam::{UVec2, Vec2};

use crate::app::lod::follow::Follow;
use crate::app::lod::method::LodMethod;
use crate::app::lod::prepared::PreparedGround;
use crate::app::lod::report::FlightReport;
use crate::roam::frames::LastFrame;
use crate::roam::measure::{HeightDifference, height_difference};
use crate::roam::shown::PatchList;
use crate::terrain::lattice::Post;
use crate::view::camera::Camera;

/// Frames whose heights are compared with the elevation model, spread evenly over the flight: enough to even out
/// what one view happens to see, few enough to take no longer than the flight.
pub const MEASURED: usize = 8;

/// Flies `method`, which `follow` is. The first frame, which has none before it, starts the method and is not
/// counted.
pub fn fly(
    method: LodMethod,
    follow: &mut dyn Follow,
    terrain: &PreparedGround,
    flight: &[Camera],
) -> FlightReport {
    let measured: Vec<usize> = measured_frames(flight.len()).collect();
    let mut last = LastFrame::default();
    let mut tally = FlightTally::default();
    for (frame, camera) in flight.iter().enumerate() {
        if frame == 0 {
            follow.prepare(camera);
        }
        let start = Instant::now();
        follow.update(camera);
        let update_ms = start.elapsed().as_secs_f64() * 1e3;
        let shown = follow.shown();
        let change = last.compare(&shown);
        if frame > 0 {
            let indices: usize = shown.iter().map(|list| list.indices).sum();
            let triangles = triangles(&shown);
            tally.times_ms.push(update_ms);
            tally.triangles += triangles;
            tally.most_triangles = tally.most_triangles.max(triangles);
            tally.most_patches = tally.most_patches.max(shown.len());
            tally.vertices += indices;
            tally.appeared += change.appeared;
            tally.uploads.push(follow.sent_bytes());
        }
        if measured.contains(&frame) {
            tally.difference = tally.difference.with(difference_in_view(terrain, camera, &shown));
        }
    }
    tally.report(method)
}

fn triangles(shown: &[PatchList]) -> usize {
    shown.iter().map(|list| list.triangles.len()).sum()
}

/// How far what is shown is off at the posts in the picture: a patch can be large, and what of it is out of view may
/// be left as it comes.
fn difference_in_view(terrain: &PreparedGround, camera: &Camera, shown: &[PatchList]) -> HeightDifference {
    let (lattice, size) = (&terrain.lattice, UVec2::from(camera.size()).as_vec2());
    let seen_px = |post: Post, shown_m: f64| {
        let (at, height_m) = (lattice.position(post), lattice.height(post));
        let ground = camera.project(at.extend(height_m))?.pixel;
        let is_in_view = ground.cmpge(Vec2::ZERO).all() && ground.cmple(size).all();
        if !is_in_view || f64::from(height_m) == shown_m {
            return is_in_view.then_some(0.0);
        }
        // What is shown nearer than the picture begins is not seen.
        let shown = camera.project(at.extend(shown_m as f32));
        Some(shown.map_or(0.0, |shown| f64::from(shown.pixel.distance(ground))))
    };
    height_difference(lattice, &terrain.layout, shown, seen_px)
}

/// The frames that are measured, from the first to the last.
fn measured_frames(frames: usize) -> impl Iterator<Item = usize> {
    let count = MEASURED.min(frames);
    (0..count).map(move |at| at * (frames - 1) / (count - 1).max(1))
}

/// What adds up over the frames.
#[derive(Default)]
struct FlightTally {
    times_ms: Vec<f64>,
    uploads: Vec<usize>,
    triangles: usize,
    most_triangles: usize,
    most_patches: usize,
    vertices: usize,
    appeared: usize,
    difference: HeightDifference,
}

impl FlightTally {
    fn report(mut self, method: LodMethod) -> FlightReport {
        let frames = self.times_ms.len();
        self.times_ms.sort_by(f64::total_cmp);
        self.uploads.sort_unstable();
        let mean = |sum: usize| sum as f64 / frames.max(1) as f64;
        let at = |share: f64| ((frames as f64 * share).ceil() as usize).saturating_sub(1);
        let time = |share: f64| self.times_ms.get(at(share)).copied().unwrap_or(0.0);
        FlightReport {
            method,
            frames,
            triangles: mean(self.triangles),
            most_triangles: self.most_triangles,
            most_patches: self.most_patches,
            vertices_sent: mean(self.vertices),
            changed_per_frame: mean(self.appeared),
            update_ms_median: time(0.5),
            update_ms_p99: time(0.99),
            upload_bytes_median: self.uploads.get(at(0.5)).copied().unwrap_or(0),
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
        let tally =
            FlightTally { times_ms, uploads: (0..200).collect(), triangles: 1000, ..FlightTally::default() };
        let report = tally.report(method);
        assert_eq!((report.update_ms_median, report.update_ms_p99), (100.0, 198.0));
        assert_eq!((report.upload_bytes_median, report.triangles), (99, 5.0));
    }
}
