//! An open scene: its walk, its camera, the features shown, and the changes for the renderer.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use glam::{DVec2, DVec3, Vec2, Vec3};

use crate::analysis_listing::AnalysisListing;
use crate::finer_ground::FinerGround;
use crate::paging::PagedTerrain;
use crate::scene_jobs::{Reaching, Relisting};
use crate::scene_load::{LoaderSlot, SceneLoad};
use crate::shadow_state::{ShadowState, ShadowedView};
use sandtable_base::message::numbers::fixed;
use sandtable_draw::lighting::Lighting;
use sandtable_draw::list::{DrawList, FeatureId};
use sandtable_draw::patches::{GroundChanges, PatchId};
use sandtable_geom::aabb::Aabb;
use sandtable_geom::position::Position;
use sandtable_gpu::error::GpuError;
use sandtable_gpu::live::KeptPatches;
use sandtable_gpu::live::prepared::{PreparedShadows, PreparedWindows};
use sandtable_picture as picture;
use sandtable_query::positions::format_position;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::SceneView;
use sandtable_terrain::sight::ray::Ray;
use sandtable_view::camera::{Camera, CameraError, far_m};
use sandtable_view::navigation::pose::{ViewPicture, ViewPose};
use sandtable_view::navigation::{NavigatedSpace, NavigationSteps, Navigator, TRANSITION_S};
use sandtable_walk::Walk;
use sandtable_walk::frame::{ReachRenewal, WalkError, WalkOptions, WalkStatistics};
use sandtable_walk::pick::{PickedWorld, StandingIndex, WalkPick, described, pixel_ray};
use sandtable_walk::reach::ReachedGround;

/// The size that cameras are fitted to before the window has one.
pub const FIRST_SIZE: (u32, u32) = (1280, 720);
/// The picture that the ground is first made for where the window has none yet: as high as a new window's.
const OPENING_SIZE: (u32, u32) = (1280, 800);
/// How much farther the eye may go before models in the form for their distance are made anew, as a share of the scene's
/// diagonal: less would make them anew on every flight across it.
const EYE_SHARE: f32 = 0.1;
/// How near to a label ground may lie that would hide it, as a share of the distance: half a cell of ground far away.
const LABEL_SLACK: f64 = 0.01;
/// The nearest that is drawn, in meters, as in pictures.
const NEAR_M: f32 = 0.5;
/// The vertical field of view in degrees where a camera by parallel rays has none.
const FOV_DEG: f32 = 40.0;
/// How far from a stated position the eye stops, in meters: near enough to see houses, far enough to see the valley around.
const PLACE_DISTANCE_M: f64 = 600.0;
/// The least angle in degrees by which the eye looks down at what it goes to.
const APPROACH_DEG: f64 = 25.0;

/// An open scene.
pub struct OpenedScene {
    /// Its file.
    pub path: PathBuf,
    /// The scene.
    pub scene: Arc<SceneModel>,
    /// The ground from frame to frame; of terrain on disk, its overview.
    pub walk: Walk,
    /// The terrain on disk of which the scene is an overview; `None` where the scene is in memory.
    pub paged: Option<PagedTerrain>,
    /// Whether the renderer has the ground of the walk.
    shows_walk: bool,
    /// The camera's way.
    pub navigator: Navigator,
    /// The vertical field of view, radians.
    pub fov_y_rad: f32,
    /// The pose whose triangles are shown while the camera flies on; `None` for the camera's own.
    pub frozen: Option<ViewPose>,
    /// What stands.
    pub(super) list: Arc<DrawList>,
    pub(super) standing: StandingIndex,
    /// Where the eye was when the list was made.
    pub(super) list_eye: Vec3,
    /// Unit vector toward the sun of the next list.
    pub(super) wanted_sun: Vec3,
    pub(super) hidden: BTreeSet<FeatureId>,
    /// The scene's analyses in the panel.
    pub analyses: Vec<AnalysisListing>,
    /// What the renderer is to take over.
    pub(super) load: Option<SceneLoad>,
    /// The next list, while it is made.
    pub(super) relisting: Option<Relisting>,
    /// The ground for another picture, while it is made.
    pub(super) reaching: Option<Reaching>,
    /// The ground of the whole picture while one of fewer pixels is shown, or the reverse.
    pub(super) aside: Option<ReachedGround>,
    /// Whether the list is of old, or will be when the next one is there.
    pub(super) wants_list: bool,
    pub(super) shadows: ShadowState,
    /// Finer ground around the eye; `None` where the scene is in memory.
    pub(super) finer: Option<FinerGround>,
    /// The size of the picture, pixels.
    pub(super) size: (u32, u32),
    /// The pixels of it that are drawn.
    pub(super) drawn: (u32, u32),
    /// Whether it has had fewer pixels than its size.
    pub(super) is_lowered_at_times: bool,
}

/// The first view of a scene that is opened, so that nothing is left to be made for its first frame.
#[derive(Clone, Debug, Default)]
pub struct OpeningView {
    /// From where; `None` for its first camera.
    pub seen: Option<SeenFrom>,
    /// The features that are not shown.
    pub hidden: BTreeSet<FeatureId>,
}

/// The point of view on a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenFrom {
    /// The pose, in a scene of a vertical scale.
    pub pose: ViewPose,
    /// That scale.
    pub scale: f32,
    /// The vertical field of view, radians.
    pub fov_y_rad: f32,
    /// The picture, pixels.
    pub size: (u32, u32),
}

impl SeenFrom {
    /// The pose in a scene of another vertical scale.
    pub fn pose_at(&self, scale: f32) -> ViewPose {
        let mut pose = self.pose;
        pose.eye.z *= f64::from(scale / self.scale);
        pose
    }
}

/// The content of a frame.
pub struct SceneFrame {
    /// The list to load before anything else; `None` where the renderer has it.
    pub load: Option<SceneLoad>,
    /// Shadows to take over; `None` where the renderer has them.
    pub shadows: Option<PreparedShadows>,
    /// Windows of finer ground to take over; `None` where the renderer has them.
    pub windows: Option<PreparedWindows>,
    /// What changed on the ground.
    pub changes: GroundChanges,
    /// How it is seen.
    pub camera: Camera,
    /// The size in pixels at which it is drawn.
    pub drawn: (u32, u32),
    /// Whether the next frame begins to make a ground that suits that size.
    pub wants_ground: bool,
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
    /// The device cannot hold the scene.
    #[error(transparent)]
    Graphics(#[from] GpuError),
}

impl OpenedScene {
    /// A scene, seen through its first camera. Measures the ground, lights it, sets the models and brings all of it to the
    /// renderer of `slot`, with the ground as `view` shows it: it is for a thread.
    ///
    /// # Errors
    /// Its first camera sees nothing, or the device cannot hold it.
    pub fn new(
        path: PathBuf,
        scene: SceneModel,
        paged: Option<PagedTerrain>,
        (view, slot): (&OpeningView, &LoaderSlot),
        progress: &dyn Fn(&'static str),
    ) -> Result<Self, SceneFrameError> {
        let scene = Arc::new(scene);
        progress("measuring the ground");
        let camera = picture::camera(&scene, &scene.cameras[0], FIRST_SIZE)?;
        let to_sun = Some(scene.sunlight.to_sun(Some(&camera)));
        let options = WalkOptions { to_sun, renewal: ReachRenewal::ByTask, ..WalkOptions::default() };
        let walk = Walk::new(Arc::clone(&scene), options);
        let mut list = walk.static_list(&camera, progress);
        list.items.retain(|item| !view.hidden.contains(&item.feature));
        let list = Arc::new(list);
        let (min, max) = scene.bounds;
        let space = NavigatedSpace { min: min.as_dvec3(), max: max.as_dvec3() };
        let mut opened = Self {
            path,
            navigator: Navigator::new(ViewPose::of_camera(&camera), space),
            fov_y_rad: field_of_view(&camera),
            frozen: None,
            standing: StandingIndex::new(Arc::clone(&list)),
            list_eye: camera.eye(),
            wanted_sun: walk.to_sun(),
            hidden: view.hidden.clone(),
            analyses: scene.analyses.iter().map(AnalysisListing::new).collect(),
            load: Some(SceneLoad::unprepared(&list)),
            relisting: None,
            reaching: None,
            aside: None,
            wants_list: false,
            shadows: ShadowState::default(),
            finer: None,
            size: view.seen.map_or(OPENING_SIZE, |seen| seen.size),
            drawn: view.seen.map_or(OPENING_SIZE, |seen| seen.size),
            is_lowered_at_times: false,
            list,
            scene,
            walk,
            paged,
            shows_walk: true,
        };
        progress("showing the ground");
        // Rays of the pointer need it.
        opened.walk.sight();
        let seen = opened.opening_camera(view)?;
        if let Some(task) = opened.walk.reach_task(&seen) {
            opened.walk.take_reach(task.ground());
        }
        let first = opened.walk.update(&seen)?.changes;
        let first = opened.without_hidden(first);
        progress("sending the scene to the adapter");
        let shadowed = ShadowedView { camera: seen, ground: opened.walk.shown_ground() };
        let mut prepared = slot.prepare(&opened.list, &shadowed, &first)?;
        if opened.paged.is_some() {
            slot.expect_windows(&mut prepared)?;
        }
        if prepared.is_some() {
            opened.shadows.made_for(seen);
            let list = Arc::clone(&opened.list);
            opened.load = Some(SceneLoad { list, prepared, kept: KeptPatches::None });
        }
        Ok(opened)
    }

    /// The camera that it is first seen through.
    fn opening_camera(&self, view: &OpeningView) -> Result<Camera, CameraError> {
        let (pose, fov_y_rad, size) = match &view.seen {
            Some(seen) => (seen.pose_at(self.scene.scale.0), seen.fov_y_rad, seen.size),
            None => (self.navigator.pose(), self.fov_y_rad, OPENING_SIZE),
        };
        self.camera_of(&pose, fov_y_rad, size)
    }

    /// Changes of the ground without what is hidden.
    fn without_hidden(&self, mut changes: GroundChanges) -> GroundChanges {
        if !self.hidden.is_empty() {
            for drapes in &mut changes.drapes {
                drapes.pieces.retain(|piece| !self.hidden.contains(&piece.feature));
            }
        }
        changes
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
        self.camera_from(&self.navigator.pose(), size)
    }

    fn camera_from(&self, pose: &ViewPose, size: (u32, u32)) -> Result<Camera, CameraError> {
        self.camera_of(pose, self.fov_y_rad, size)
    }

    fn camera_of(&self, pose: &ViewPose, fov_y_rad: f32, size: (u32, u32)) -> Result<Camera, CameraError> {
        let planes = (NEAR_M, far_m(&self.bounds(), pose.eye.as_vec3()));
        pose.camera(&ViewPicture { fov_y_rad, size, planes })
    }

    /// The current point of view, on a picture of `size` pixels.
    pub fn seen_from(&self, size: (u32, u32)) -> SeenFrom {
        let (pose, scale) = (self.navigator.pose(), self.scene.scale.0);
        SeenFrom { pose, scale, fov_y_rad: self.fov_y_rad, size: (size.0.max(16), size.1.max(16)) }
    }

    /// Goes to one of the scene's cameras, on a picture of `size` pixels.
    ///
    /// # Errors
    /// See [`CameraError`].
    pub fn go_to_view(&mut self, view: &SceneView, size: (u32, u32)) -> Result<(), CameraError> {
        let camera = picture::camera(&self.scene, view, size)?;
        self.fov_y_rad = field_of_view(&camera);
        self.navigator.go_to(ViewPose::of_camera(&camera), TRANSITION_S);
        Ok(())
    }

    /// Goes to where `place` lies in the middle of the picture, `distance_m` away, looking down at it.
    pub fn go_toward(&mut self, place: DVec3, distance_m: f64) {
        let pose = self.navigator.pose();
        let pose = ViewPose { pitch_rad: pose.pitch_rad.min(-APPROACH_DEG.to_radians()), ..pose };
        let eye = place - pose.forward() * distance_m;
        self.navigator.go_to(ViewPose { eye, ..pose }, TRANSITION_S);
    }

    /// Lets `seconds` pass with steps; returns whether the camera moved.
    pub fn advance(&mut self, seconds: f64, steps: NavigationSteps) -> bool {
        let ground = (&self.walk, self.paged.as_ref());
        self.navigator.advance(seconds, steps, &|at| ground_z(ground, at))
    }

    /// Turns the eye about `pivot`, radians to the right and up over it; or the view alone, where there is no pivot.
    pub fn turn(&mut self, pivot: Option<DVec3>, turn: DVec2) {
        let ground = (&self.walk, self.paged.as_ref());
        match pivot {
            Some(pivot) => self.navigator.orbit(pivot, turn, &|at| ground_z(ground, at)),
            None => self.navigator.look(turn),
        }
    }

    /// Moves the ground along, so that `grabbed` lies under a pixel of `camera`'s picture.
    pub fn drag(&mut self, grabbed: DVec3, camera: &Camera, pixel: Vec2) {
        let ground = (&self.walk, self.paged.as_ref());
        self.navigator.drag(grabbed, camera.ray_through(pixel).as_dvec3(), &|at| ground_z(ground, at));
    }

    /// Comes nearer to `place`, until it is `factor` times as far away.
    pub fn zoom(&mut self, place: DVec3, factor: f64) {
        let ground = (&self.walk, self.paged.as_ref());
        self.navigator.zoom(place, factor, &|at| ground_z(ground, at));
    }

    /// The changes that the renderer has to take over for a picture of `size` pixels, of which `drawn_size` says how many are
    /// drawn of what a camera sees.
    ///
    /// # Errors
    /// See [`SceneFrameError`].
    pub fn frame(
        &mut self,
        size: (u32, u32),
        drawn_size: impl FnOnce(&Camera) -> (u32, u32),
    ) -> Result<SceneFrame, SceneFrameError> {
        let camera = self.camera(size)?;
        (self.size, self.drawn) = (size, drawn_size(&camera));
        self.is_lowered_at_times |= self.drawn != size;
        let drawn = camera.resized(self.drawn);
        self.exchange_ground(&drawn);
        let (min, max) = self.scene.bounds;
        let has_moved = self.list_eye.distance(camera.eye()) > (max - min).length() * EYE_SHARE;
        let is_near = !has_moved || self.relisting.is_some() || self.navigator.is_on_its_way();
        if self.walk.list_depends_on_eye() && !is_near {
            self.relist();
        }
        let load = self.load.take();
        if load.as_ref().is_some_and(|load| load.kept == KeptPatches::None) {
            self.finer.iter_mut().for_each(FinerGround::forget_handed);
        }
        if load.as_ref().is_some_and(|load| load.prepared.is_none()) {
            self.walk.forget_handed();
            self.paged.iter_mut().for_each(PagedTerrain::forget_handed);
            self.shows_walk = true;
        }
        let started = Instant::now();
        let refined_for = match self.frozen {
            Some(pose) => self.camera_from(&pose, size)?,
            None => camera,
        };
        let (changes, statistics) = self.updated(&refined_for)?;
        let update_ms = started.elapsed().as_secs_f32() * 1e3;
        let shadows = self.shadows.take_ready();
        let windows = self.finer.as_mut().and_then(FinerGround::take_ready);
        Ok(SceneFrame {
            load,
            shadows,
            windows,
            changes,
            lighting: self.walk.lighting(&camera),
            camera,
            drawn: self.drawn,
            wants_ground: self.wants_ground(&drawn),
            statistics,
            update_ms,
        })
    }

    /// What changed on the ground: on that of the walk until the terrain on disk, where there is one, has come.
    fn updated(&mut self, camera: &Camera) -> Result<(GroundChanges, WalkStatistics), SceneFrameError> {
        if let Some(paged) = self.paged.as_mut().filter(|paged| paged.is_shown()) {
            let (mut changes, statistics) = paged.update(camera);
            if self.shows_walk && !changes.vertices.is_empty() {
                self.shows_walk = false;
                let patches = self.scene.ground().layout().patch_count() as u32;
                changes.dropped.extend((0..patches).map(PatchId));
            }
            if !self.shows_walk {
                return Ok((changes, statistics));
            }
        }
        let frame = self.walk.update(camera)?;
        Ok((self.without_hidden(frame.changes), frame.statistics))
    }

    /// Hands everything over again, to a renderer that starts again.
    pub fn reload(&mut self) {
        self.load = Some(SceneLoad::unprepared(&self.list));
        self.shadows.forget();
    }

    /// Hides these features and shows all others, as soon as the new lists are ready.
    pub fn hide(&mut self, hidden: &BTreeSet<FeatureId>) {
        self.hidden.clone_from(hidden);
        self.walk.renew_laid();
        self.relist();
    }

    /// Moves the sun; the new light is shown as soon as it is computed.
    pub fn set_sun(&mut self, to_sun: Vec3) {
        self.wanted_sun = to_sun;
        self.relist();
    }

    /// What the picture of `camera` shows at a pixel; `None` for the sky.
    pub fn pick(&self, camera: &Camera, pixel: Vec2) -> Option<WalkPick> {
        let ray = pixel_ray(camera, pixel);
        match &self.paged {
            Some(paged) => self.pick_page(paged, ray, Some(&self.standing)),
            None => self.walk.pick(ray, Some(&self.standing)),
        }
    }

    /// The draped feature, or the ground, at a pixel; `None` for the sky.
    pub fn pick_ground(&self, camera: &Camera, pixel: Vec2) -> Option<WalkPick> {
        let ray = pixel_ray(camera, pixel);
        match &self.paged {
            Some(paged) => self.pick_page(paged, ray, None),
            None => self.walk.pick(ray, None),
        }
    }

    /// The same of terrain on disk: heights are those of its pages in memory, and none where no page is.
    fn pick_page(
        &self,
        paged: &PagedTerrain,
        ray: Ray,
        standing: Option<&StandingIndex>,
    ) -> Option<WalkPick> {
        let ground = self.meets_ground(ray);
        let ground_m = ground.map_or(f64::MAX, |at| at.distance(ray.origin));
        let solid = standing.and_then(|index| index.pick(ray, ground_m));
        let (distance_m, feature) = solid.or_else(|| ground.map(|_| (ground_m, FeatureId::GROUND)))?;
        let direction = ray.direction.normalize_or_zero();
        let world = ground.filter(|_| solid.is_none()).unwrap_or(ray.origin + direction * distance_m);
        let page = paged.pages().and_then(|pages| pages.page_at(world.truncate()));
        let at = self.scene.lattice.origin() + world.truncate();
        let picked = PickedWorld { world, at, distance_m, feature };
        Some(described(&self.scene, page.map(Arc::as_ref), picked))
    }

    /// Where a ray meets the ground that is shown.
    fn meets_ground(&self, ray: Ray) -> Option<DVec3> {
        let hit = self.walk.pick_ground(ray);
        self.paged.as_ref().map_or(hit, |paged| paged.pick(ray, hit))
    }

    /// World Z of the ground at a world position; `None` without data.
    pub fn ground_z(&self, at: DVec2) -> Option<f64> {
        ground_z((&self.walk, self.paged.as_ref()), at)
    }

    /// The place in the middle of the picture; without ground there, one ahead at the distance of the scene's middle.
    pub fn focus(&self, camera: &Camera) -> DVec3 {
        let (width, height) = camera.size();
        let middle = Vec2::new(width as f32, height as f32) * 0.5;
        self.meets_ground(pixel_ray(camera, middle)).unwrap_or_else(|| {
            let ahead_m = (self.bounds().center() - camera.eye()).dot(camera.forward()).max(100.0);
            (camera.eye() + camera.forward() * ahead_m).as_dvec3()
        })
    }

    /// Whether no ground hides a place from the eye.
    pub fn is_seen(&self, camera: &Camera, at: Vec3) -> bool {
        let origin = camera.eye().as_dvec3();
        let direction = (at + Vec3::Z * 2.0).as_dvec3() - origin;
        let distance_m = direction.length();
        if distance_m == 0.0 {
            return true;
        }
        let slack_m = (distance_m * LABEL_SLACK).max(self.walk.lattice().cell().max_element());
        let hit = self.meets_ground(Ray { origin, direction });
        hit.is_none_or(|hit| hit.distance(origin) > distance_m - slack_m)
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
        let middle = ((min + max) * 0.5).as_dvec2();
        let z = self.ground_z(middle).unwrap_or(f64::from(self.bounds().center().z));
        self.go_toward(middle.extend(z), (f64::from(min.distance(max)) * 1.2).max(60.0));
        true
    }

    /// Goes to a position, two numbers being those of the scene's system; returns the place in words, with its height.
    ///
    /// # Errors
    /// A sentence, where the position has no coordinates in the scene's system, or lies off its ground.
    pub fn go_to_position(&mut self, position: &Position) -> Result<String, String> {
        let crs = &self.scene.crs;
        let at = position.in_system(crs).map_err(|error| format!("no such place: {error}"))?;
        let written = format!("{} ({})", format_position(crs, at), crs.name());
        let world = at - self.scene.lattice.origin();
        let bounds = self.bounds();
        let is_within = (world.cmpge(bounds.min.truncate().as_dvec2())
            & world.cmple(bounds.max.truncate().as_dvec2()))
        .all();
        if !is_within {
            return Err(format!("{written} lies off the ground of the scene"));
        }
        // Of terrain on disk, the overview has ground where no page is in memory yet.
        let z = self.ground_z(world);
        let height = z.map(|z| self.scene.scale.elevation_m(z));
        self.go_toward(world.extend(z.unwrap_or(f64::from(bounds.center().z))), PLACE_DISTANCE_M);
        let height = height.map_or("no data here".to_owned(), |height_m| format!("{} m", fixed(height_m, 1)));
        let square = position.side_m().filter(|side_m| *side_m > 1.0);
        let square = square.map(|side_m| format!(", the middle of a square of {side_m:.0} m"));
        Ok(format!("{written}: {height}{}", square.unwrap_or_default()))
    }
}

/// World Z of the ground at a world position, by the page in memory there, or else by the walk; `None` without data.
fn ground_z((walk, paged): (&Walk, Option<&PagedTerrain>), at: DVec2) -> Option<f64> {
    match paged.and_then(|paged| paged.height(at)) {
        Some(height) => height.height_m().map(|height_m| walk.scene().scale.world_z(height_m)),
        None => walk.ground_z(at),
    }
}

fn field_of_view(camera: &Camera) -> f32 {
    match camera.parallel_frame() {
        None => 2.0 * libm::atanf(camera.tan_half_fov().y),
        Some(_) => FOV_DEG.to_radians(),
    }
}
