//! The ground on which a camera sees lines: which of their legs are in view, how near they come, and the dashes of those
//! that are dashed on the picture.

use glam::DVec3;

use crate::line_scale::LineScale;
use sandtable_geom::rect::Rect;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::full_resolution::FullResolution;
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;

/// The finest ground of a scene, seen by a camera.
pub(super) struct LineView<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// The part of space in view; `None` where the eye turns around.
    pub frustum: Option<Frustum>,
    /// The finest ground.
    pub ground: FullResolution<'a>,
    /// The lowest and the highest ground.
    pub z: [f32; 2],
    /// The pixels of the picture.
    pub scale: LineScale<'a>,
    extent: Rect,
}

impl<'a> LineView<'a> {
    /// The ground of `scene`, with the camera and the pixels of `scale`.
    pub fn new(scene: &'a SceneModel, camera: &'a Camera, scale: LineScale<'a>) -> Self {
        let lattice = scene.ground().lattice();
        let (min, max) = scene.bounds;
        Self {
            camera,
            frustum: scale.frustum(),
            ground: FullResolution { lattice },
            z: [min.z, max.z],
            scale,
            extent: lattice.extent(),
        }
    }

    /// Whether a leg, or ground within `margin_m` of it, may be in view.
    pub fn may_see(&self, [from, to]: [DVec3; 2], margin_m: f64) -> bool {
        let reach = Rect::around([from.truncate(), to.truncate()]).grown(margin_m);
        let [low, high] = self.z;
        let [min, max] = [(reach.min, low), (reach.max, high)].map(|(at, z)| at.as_vec2().extend(z));
        self.frustum.is_none_or(|frustum| frustum.may_see(min, max)) && reach.meets(&self.extent)
    }

    /// How near a leg comes to the eye; infinite for parallel rays, which show it as wide at any distance.
    pub fn nearest_m(&self, [from, to]: [DVec3; 2]) -> f64 {
        if self.camera.parallel_frame().is_some() {
            return f64::INFINITY;
        }
        let (eye, leg) = (self.camera.eye().as_dvec3(), to - from);
        let part = ((eye - from).dot(leg) / leg.length_squared()).clamp(0.0, 1.0);
        eye.distance(from + leg * part)
    }
}

/// The dashes of a run of vertices: `px` has the lengths of a dash and of the gap after it, `length_px` that of a leg on the
/// picture, and `toward` the vertex at a share of a leg.
pub(super) fn dashes<V: Copy>(
    run: &[V],
    px: [f64; 2],
    length_px: impl Fn(&V, &V) -> f64,
    toward: impl Fn(&V, &V, f64) -> V,
) -> Vec<Vec<V>> {
    let mut dashes = vec![Vec::from_iter(run.first().copied())];
    // Pixels since the dash began.
    let mut along_px = 0.0;
    for leg in run.windows(2) {
        let length_px = length_px(&leg[0], &leg[1]);
        let mut from_px = 0.0;
        while from_px < length_px {
            let is_dash = along_px < px[0];
            let end_px = if is_dash { px[0] } else { px[0] + px[1] };
            let to_px = (from_px + end_px - along_px).min(length_px);
            let vertex = toward(&leg[0], &leg[1], to_px / length_px);
            if is_dash {
                dashes.last_mut().expect("there is always one").push(vertex);
            }
            along_px += to_px - from_px;
            from_px = to_px;
            if along_px >= end_px - 1e-9 {
                if !is_dash {
                    dashes.push(vec![vertex]);
                    along_px = 0.0;
                } else {
                    along_px = end_px;
                }
            }
        }
    }
    dashes.retain(|dash| dash.len() > 1);
    dashes
}
