//! The setting of a picture, by its camera: a plan, a model on a table, or a landscape under the sky.

use glam::Vec3;

use sandtable_draw::backdrop::Backdrop;
use sandtable_scene::plinth::base_z;
use sandtable_view::camera::Camera;

/// A view is a plan where it looks down more steeply than this: sine of the angle below the horizon.
const PLAN_DOWN: f32 = 0.985;

/// How far below the horizon a picture may end at its upper border and still show hills against the sky: sine of the
/// angle, 10°.
const SKYLINE: f32 = 0.174;

/// Points along each side of the block that are looked for in the picture: the part of a side between two of them is
/// narrower than a picture of any use.
const RIM_POINTS: u16 = 64;

/// The way in which a picture presents the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureSetting {
    /// Seen from straight above.
    Plan,
    /// Looked down upon, its edge in view from outside: a block on a table.
    Block,
    /// Looked down upon from within: nothing but ground.
    Ground,
    /// The horizon is just above the picture, and hills stand against the sky.
    Skyline,
    /// The horizon is in view.
    Landscape,
}

impl PictureSetting {
    /// The setting of a picture of the ground in the box `bounds` by `camera`.
    pub fn new(camera: &Camera, bounds: (Vec3, Vec3)) -> Self {
        let top = (camera.forward() + camera.up() * camera.tan_half_fov().y).normalize_or_zero();
        let is_low = top.z > -SKYLINE;
        let rim =
            if is_inside(camera.eye(), bounds) { RimInView::None } else { RimInView::new(camera, bounds) };
        if -camera.forward().z > PLAN_DOWN {
            Self::Plan
        } else if top.z > 0.0 {
            Self::Landscape
        } else if rim == RimInView::Near || (rim == RimInView::Far && !is_low) {
            Self::Block
        } else if is_low {
            Self::Skyline
        } else {
            Self::Ground
        }
    }

    /// The backdrop behind the scene.
    pub fn backdrop(self) -> Backdrop {
        match self {
            Self::Landscape | Self::Skyline => Backdrop::Sky,
            Self::Plan | Self::Block | Self::Ground => Backdrop::Studio,
        }
    }
}

/// Whether an eye is within the block: over it, and below its highest ground.
fn is_inside(eye: Vec3, (min, max): (Vec3, Vec3)) -> bool {
    eye.truncate().cmpge(min.truncate()).all() && eye.cmple(max).all()
}

/// What a picture shows of the block's edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum RimInView {
    /// Nothing.
    None,
    /// Edges behind the ground.
    Far,
    /// The foot of a wall.
    Near,
}

impl RimInView {
    fn new(camera: &Camera, (min, max): (Vec3, Vec3)) -> Self {
        let (width, height) = camera.size();
        let is_seen = |point: Vec3| {
            camera.project(point).is_some_and(|seen| {
                (0.0..=width as f32).contains(&seen.pixel.x) && (0.0..=height as f32).contains(&seen.pixel.y)
            })
        };
        let foot_z = base_z((min, max));
        let at = |(x, y): (f32, f32), outward: Vec3| {
            let foot = Vec3::new(x, y, foot_z);
            if is_seen(foot) && outward.dot(camera.toward_eye(foot)) > 0.0 {
                Self::Near
            } else if [foot_z, min.z, max.z].iter().any(|&z| is_seen(foot.with_z(z))) {
                Self::Far
            } else {
                Self::None
            }
        };
        let parts = (0..=RIM_POINTS).map(|step| f32::from(step) / f32::from(RIM_POINTS));
        let along = parts.flat_map(|part| {
            let middle = min.lerp(max, part);
            [
                at((middle.x, min.y), -Vec3::Y),
                at((middle.x, max.y), Vec3::Y),
                at((min.x, middle.y), -Vec3::X),
                at((max.x, middle.y), Vec3::X),
            ]
        });
        along.max().unwrap_or(Self::None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: (Vec3, Vec3) = (Vec3::ZERO, Vec3::new(10_000.0, 8000.0, 900.0));

    fn setting(eye: (f32, f32, f32), target: (f32, f32, f32)) -> PictureSetting {
        let camera = Camera::new(eye.into(), target.into(), 0.5, (160, 90), (1.0, 1e6)).expect("sound");
        PictureSetting::new(&camera, BOUNDS)
    }

    #[test]
    fn the_camera_decides_what_the_scene_is_shown_as() {
        let from_above = setting((5000.0, -9000.0, 12_000.0), (5000.0, 4000.0, 0.0));
        assert_eq!(from_above, PictureSetting::Block);
        assert_eq!(from_above.backdrop(), Backdrop::Studio);
        let along = setting((5000.0, -9000.0, 1200.0), (5000.0, 4000.0, 900.0));
        assert_eq!((along, along.backdrop()), (PictureSetting::Landscape, Backdrop::Sky));
        assert_eq!(setting((5000.0, 3990.0, 20_000.0), (5000.0, 4000.0, 0.0)), PictureSetting::Plan);
        assert_eq!(setting((5000.0, 3000.0, 800.0), (5000.0, 3900.0, 0.0)), PictureSetting::Ground);
        assert_eq!(setting((5000.0, 500.0, 850.0), (5000.0, -300.0, 0.0)), PictureSetting::Ground);
        let over_hills = setting((5000.0, -100.0, 3000.0), (5000.0, 8000.0, 0.0));
        assert_eq!((over_hills, over_hills.backdrop()), (PictureSetting::Skyline, Backdrop::Sky));
    }
}
