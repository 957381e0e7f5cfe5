//! An open scene: its walk, its camera, what of it is shown, and what the renderer has to take over.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use glam::{Vec2, Vec3};

use crate::draw::lighting::Lighting;
use crate::draw::list::{DrawList, FeatureId};
use crate::draw::patches::GroundChanges;
use crate::geom::aabb::Aabb;
use crate::pipeline::walk::Walk;
use crate::pipeline::walk::frame::{WalkError, WalkOptions, WalkStatistics};
use crate::scene::picture;
use crate::scene::{SceneModel, SceneView};
use crate::view::camera::{Camera, CameraError};
use crate::viewer::ground_ray::{ground_hit, ground_z, is_in_sight};
use crate::viewer::steering::{CameraPose, Steering};

/// The size that cameras are fitted to before the window has one.
const FIRST_SIZE: (u32, u32) = (1280, 720);
/// How much farther the eye may go before models in the form for their distance are made anew, as a share of the scene's
/// diagonal: less would make them anew on every flight across it.
const EYE_SHARE: f32 = 0.1;
/// How near to a label ground may lie that would hide it, as a share of the distance: half a cell of ground far away.
const LABEL_SLACK: f32 = 0.01;

/// An open scene.
pub struct OpenedScene {
    /// Its file.
    pub path: PathBuf,
    /// The scene.
    pub scene: Arc<SceneModel>,
    /// The ground from frame to frame.
    pub walk: Walk,
    /// The camera.
    pub steering: Steering,
    /// The camera whose triangles are shown while another flies on; `None` for the camera itself.
    pub frozen: Option<CameraPose>,
    list: DrawList,
    /// Where the eye was when the list was made.
    list_eye: Vec3,
    hidden: BTreeSet<FeatureId>,
    needs_load: bool,
}

/// What a frame shows.
pub struct SceneFrame {
    /// The list to load before anything else; `None` where the renderer has it.
    pub load: Option<DrawList>,
    /// What changed on the ground.
    pub changes: GroundChanges,
    /// How it is seen.
    pub camera: Camera,
    /// The light for that camera.
    pub lighting: Lighting,
    /// What the update did.
    pub statistics: WalkStatistics,
    /// How long it took.
    pub update_ms: f32,
}

/// Why a frame cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum SceneFrameError {
    /// The camera sees nothing.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// The ground cannot be read.
    #[error(transparent)]
    Walk(#[from] WalkError),
}

impl OpenedScene {
    /// A scene, seen through its first camera. Measures the ground, lights it and sets the models: it is for a thread.
    ///
    /// # Errors
    /// Its first camera sees nothing.
    pub fn new(
        path: PathBuf,
        scene: SceneModel,
        progress: &dyn Fn(&'static str),
    ) -> Result<Self, CameraError> {
        let scene = Arc::new(scene);
        progress("measuring the ground");
        let camera = picture::camera(&scene, &scene.cameras[0], FIRST_SIZE)?;
        let to_sun = Some(scene.sunlight.to_sun(Some(&camera)));
        let walk = Walk::new(Arc::clone(&scene), WalkOptions { to_sun, ..WalkOptions::default() });
        let list = walk.static_list(&camera, progress);
        let steering = Steering::new(CameraPose::of(&camera));
        let hidden = BTreeSet::new();
        Ok(Self {
            path,
            scene,
            walk,
            steering,
            frozen: None,
            list,
            list_eye: camera.eye(),
            hidden,
            needs_load: true,
        })
    }

    /// The box of the scene in world space.
    pub fn bounds(&self) -> Aabb {
        let (min, max) = self.scene.bounds;
        Aabb { min, max }
    }

    /// The camera on a picture of `size` pixels.
    ///
    /// # Errors
    /// See [`CameraError`].
    pub fn camera(&self, size: (u32, u32)) -> Result<Camera, CameraError> {
        self.steering.pose.camera(size, &self.bounds())
    }

    /// The pose of one of the scene's cameras on a picture of `size` pixels.
    ///
    /// # Errors
    /// See [`CameraError`].
    pub fn pose_of(&self, view: &SceneView, size: (u32, u32)) -> Result<CameraPose, CameraError> {
        Ok(CameraPose::of(&picture::camera(&self.scene, view, size)?))
    }

    /// Lets `seconds` pass.
    pub fn advance(&mut self, seconds: f32) {
        let lattice = self.walk.lattice();
        self.steering.advance(seconds, &|at| ground_z(lattice, at));
    }

    /// What the renderer has to take over for a picture of `size` pixels.
    ///
    /// # Errors
    /// See [`SceneFrameError`].
    pub fn frame(&mut self, size: (u32, u32)) -> Result<SceneFrame, SceneFrameError> {
        let camera = self.camera(size)?;
        let (min, max) = self.scene.bounds;
        let has_moved = self.list_eye.distance(camera.eye()) > (max - min).length() * EYE_SHARE;
        if self.walk.list_depends_on_eye() && has_moved && !self.steering.is_under_way() {
            self.renew_list(&camera);
        }
        let load = std::mem::take(&mut self.needs_load).then(|| self.shown_list());
        if load.is_some() {
            self.walk.forget_handed();
        }
        let started = Instant::now();
        let refined_for = match self.frozen {
            Some(pose) => pose.camera(size, &self.bounds())?,
            None => camera,
        };
        let mut frame = self.walk.update(&refined_for)?;
        let update_ms = started.elapsed().as_secs_f32() * 1e3;
        if !self.hidden.is_empty() {
            for drapes in &mut frame.changes.drapes {
                drapes.pieces.retain(|piece| !self.hidden.contains(&piece.feature));
            }
        }
        let (changes, statistics) = (frame.changes, frame.statistics);
        Ok(SceneFrame { load, changes, lighting: self.walk.lighting(&camera), camera, statistics, update_ms })
    }

    /// Hands everything over again: to a renderer that starts anew.
    pub fn reload(&mut self) {
        self.needs_load = true;
    }

    /// Hides these features and shows all others.
    pub fn hide(&mut self, hidden: &BTreeSet<FeatureId>) {
        self.hidden.clone_from(hidden);
        self.needs_load = true;
    }

    /// Moves the sun, and lights the ground anew.
    pub fn set_sun(&mut self, to_sun: Vec3) {
        self.walk.set_sun(to_sun);
        if let Ok(camera) = self.camera(FIRST_SIZE) {
            self.renew_list(&camera);
        }
    }

    fn renew_list(&mut self, camera: &Camera) {
        self.list = self.walk.static_list(camera, &|_| ());
        self.list_eye = camera.eye();
        self.needs_load = true;
    }

    fn shown_list(&self) -> DrawList {
        let mut list = self.list.clone();
        list.items.retain(|item| !self.hidden.contains(&item.feature));
        list
    }

    /// The place on the ground at a pixel of `camera`'s picture.
    pub fn ground_at(&self, camera: &Camera, pixel: Vec2) -> Option<Vec3> {
        let (from, ray) = (camera.ray_origin(pixel), camera.ray_through(pixel).try_normalize()?);
        ground_hit(self.walk.lattice(), from, ray, camera.planes().1)
    }

    /// The place in the middle of the picture; without ground there, one at the level of the scene's middle, or ahead.
    pub fn focus(&self, camera: &Camera) -> Vec3 {
        let (width, height) = camera.size();
        let middle = Vec2::new(width as f32, height as f32) * 0.5;
        self.ground_at(camera, middle).unwrap_or_else(|| {
            let center = self.bounds().center();
            let ahead_m = (center - camera.eye()).dot(camera.forward()).max(100.0);
            camera.eye() + camera.forward() * ahead_m
        })
    }

    /// Whether a place is in sight from the eye.
    pub fn is_seen(&self, camera: &Camera, at: Vec3) -> bool {
        let slack_m =
            (camera.eye().distance(at) * LABEL_SLACK).max(self.walk.lattice().cell().max_element() as f32);
        is_in_sight(self.walk.lattice(), camera.eye(), at + Vec3::Z * 2.0, slack_m)
    }

    /// The box of a feature on the map, in world X and Y; `None` of one that is nowhere.
    pub fn feature_box(&self, feature: FeatureId) -> Option<(Vec2, Vec2)> {
        let scene = &self.scene;
        let ribbons = scene.ribbons.iter().filter(|ribbon| ribbon.feature == feature);
        let ribbons =
            ribbons.flat_map(|ribbon| ribbon.plan.vertices.iter().map(|vertex| vertex.at.as_vec2()));
        let solids = scene.solids.iter().filter(|solid| solid.feature == feature);
        let solids = solids
            .flat_map(|solid| &solid.mesh.vertices)
            .map(|vertex| Vec3::from(vertex.position).truncate());
        let models = scene.placements.iter().filter(|placement| placement.feature == feature);
        let points = ribbons.chain(solids).chain(models.map(|placement| placement.at));
        points.fold(None, |found: Option<(Vec2, Vec2)>, at| {
            Some(found.map_or((at, at), |(min, max)| (min.min(at), max.max(at))))
        })
    }

    /// Goes to where a feature fills a good part of the picture; says whether it is anywhere.
    pub fn go_to_feature(&mut self, feature: FeatureId) -> bool {
        let Some((min, max)) = self.feature_box(feature) else { return false };
        let middle = ((min + max) * 0.5).extend(0.0);
        let place = middle.with_z(ground_z(self.walk.lattice(), middle).unwrap_or(self.bounds().center().z));
        self.steering.go_toward(place, (min.distance(max) * 1.2).max(60.0));
        true
    }
}
