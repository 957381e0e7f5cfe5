//! Walks: cameras and edits in any order, after each of which the invariants hold.

use std::sync::Arc;

use glam::{DVec2, Vec3};
use sandtable_earthworks::brush::Crater;
use sandtable_view::camera::Camera;
use sandtable_walk::Walk;
use sandtable_walk::frame::WalkOptions;

use super::byte_source::ByteSource;
use super::shapes::{SIDE_M, built};

/// The most steps of a walk.
const MOST_STEPS: usize = 24;

/// Walks over a scene that `bytes` choose.
pub fn walk(bytes: &[u8]) {
    let bytes = &mut ByteSource::new(bytes);
    let Some(scene) = built(bytes) else { return };
    let mut walk = Walk::new(Arc::new(scene), WalkOptions::default());
    let mut camera = None;
    for _ in 0..=bytes.below(MOST_STEPS) {
        match bytes.byte() {
            0..96 => {
                let [x, y] = [0, 1].map(|_| bytes.between(-20.0, SIDE_M + 20.0));
                let radius_m = bytes.between(0.5, 80.0);
                let depth_m = radius_m * bytes.between(0.02, 1.0);
                let crater = Crater { center: DVec2::new(x, y), radius_m, depth_m, rim_m: 1.0 };
                walk.edit(|lattice| crater.apply(lattice)).expect("all of it is in memory");
            }
            96..112 => walk.set_tolerance_px(bytes.between(0.0, 30.0) as f32),
            _ => {
                let [eye, target] = [0, 1].map(|_| {
                    let [x, y] = [0, 1].map(|_| bytes.between(-100.0, SIDE_M + 100.0) as f32);
                    Vec3::new(x, y, bytes.between(0.0, 500.0) as f32)
                });
                let to = Camera::new(eye, target, 0.8, (320, 240), (0.5, 5000.0));
                camera = to.ok().or(camera);
            }
        }
        if let Some(camera) = &camera {
            walk.update(camera).expect("all of it is in memory");
            walk.check();
        }
    }
}
