//! Makes the draw list of a scene for a camera: refines the ground, drapes features over it, places solids and models.

mod airspace;
pub mod all_round;
mod analyses;
pub mod analysis_look;
mod canopy;
mod class_hatching;
pub mod detail;
mod drapes;
pub mod graphic_colors;
mod graphic_lines;
mod graphics;
mod ground;
mod haze;
mod hole;
mod lake_tint;
mod line_scale;
mod line_view;
mod markings;
pub mod models;
pub mod nested;
pub mod nested_ground;
mod nested_plan;
mod nested_surface;
mod overlay;
pub mod panorama;
pub mod placed_text;
mod post_tint;
pub mod recut;
pub mod setting;
pub mod sheet_cuts;
mod sight;
mod solids;
pub mod standing;
mod symbols;
mod table;
pub mod tried_analysis;
mod uprights;
pub mod voids;

use std::sync::Arc;

use glam::{Mat4, Vec3};

use crate::detail::Viewer;
use crate::nested_ground::NestedHeights;
use crate::placed_text::PlacedText;
use crate::setting::PictureSetting;
use sandtable_description::words::TableTop;
use sandtable_draw::ground::GroundMap;
use sandtable_draw::lighting::Lighting;
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh, FeatureId, MaterialId};
use sandtable_geom::aabb::Aabb;
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_scene::framing::fitted_view::fitted_aim;
use sandtable_scene::framing::parallel_view::parallel_camera;
use sandtable_scene::ground_map_cache::GroundMapKey;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::{SceneView, ViewAim};
use sandtable_view::axes::DirectionAxes;
use sandtable_view::camera::{Camera, CameraError, far_m};

/// The draw list of a scene for one camera.
pub struct ViewDraw {
    /// The draw list.
    pub list: DrawList,
    /// The displayed ground.
    pub displayed: Arc<DisplayedTerrain>,
    /// Triangles of the ground among those drawn.
    pub ground_triangles: usize,
    /// The texts of tactical graphics.
    pub graphic_texts: Vec<PlacedText>,
    /// The heights of the nested grounds among them.
    pub nested: NestedHeights,
}

/// The camera for a view on a picture of `size` pixels, its far plane behind the whole scene; for a panorama one in perspective
/// toward its middle, see [`panorama`].
///
/// # Errors
/// See [`CameraError`].
pub fn camera(scene: &SceneModel, view: &SceneView, size: (u32, u32)) -> Result<Camera, CameraError> {
    let (min, max) = scene.bounds;
    let (eye, target) = match view.aim {
        ViewAim::At { eye, target } => (eye, target),
        ViewAim::Fitted(fitted) => fitted_aim(scene, &fitted, view.fov_y_rad, size),
        ViewAim::Parallel(parallel) => return parallel_camera(scene, &parallel, size),
        ViewAim::Panorama(view) => {
            let toward = DirectionAxes::new(view.from_rad + view.span_rad * 0.5, 0.0).forward;
            (view.eye, view.eye + toward * far_m(&Aabb { min, max }, view.eye))
        }
    };
    Camera::new(eye, target, view.fov_y_rad, size, (0.5, far_m(&Aabb { min, max }, eye)))
}

/// The draw list for one camera. `progress` is called with the name of each step as it begins.
pub fn build_draw_list(scene: &SceneModel, camera: &Camera, progress: &dyn Fn(&'static str)) -> ViewDraw {
    drawn_for(scene, camera, ListPurpose::Picture, progress)
}

/// The geometry of [`build_draw_list`] for measurements: the ground is neither lit nor colored.
pub fn build_shapes(scene: &SceneModel, camera: &Camera, progress: &dyn Fn(&'static str)) -> ViewDraw {
    drawn_for(scene, camera, ListPurpose::Shapes, progress)
}

fn drawn_for(
    scene: &SceneModel,
    camera: &Camera,
    purpose: ListPurpose,
    progress: &dyn Fn(&'static str),
) -> ViewDraw {
    progress("refining terrain");
    let displayed = Arc::new(display(scene, camera));
    let ListedScene { list, ground_triangles, graphic_texts } =
        listed(scene, &displayed, Viewer::Camera(camera), purpose, progress);
    ViewDraw { list, displayed, ground_triangles, graphic_texts, nested: NestedHeights::default() }
}

/// The geometry of the ground and of the features on it, without what is only drawn on pictures, such as symbols,
/// tactical graphics and viewsheds.
pub fn build_relief(scene: &SceneModel, camera: &Camera, progress: &dyn Fn(&'static str)) -> DrawList {
    progress("refining terrain");
    let displayed = display(scene, camera);
    listed(scene, &displayed, Viewer::Camera(camera), ListPurpose::Relief, progress).list
}

/// The draw list of a scene whose terrain is shown as `displayed`, and how many of its triangles are ground: all models
/// wherever they stand, in the forms of their files. `progress` is called with the name of each step as it begins.
pub fn draw_list(
    scene: &SceneModel,
    displayed: &DisplayedTerrain,
    progress: &dyn Fn(&'static str),
) -> (DrawList, usize) {
    let listed = listed(scene, displayed, Viewer::Anyone, ListPurpose::Picture, progress);
    (listed.list, listed.ground_triangles)
}

/// A draw list with what else a picture needs.
struct ListedScene {
    list: DrawList,
    ground_triangles: usize,
    graphic_texts: Vec<PlacedText>,
}

/// What a draw list is made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ListPurpose {
    /// For a picture.
    Picture,
    /// For measurements: the ground is not lit.
    Shapes,
    /// For models: as for measurements, without what is only drawn on or beside the ground.
    Relief,
}

/// Whether `camera` shows the scene as a block on a table.
pub fn shows_table(scene: &SceneModel, camera: &Camera) -> bool {
    has_table(scene, PictureSetting::new(camera, scene.bounds))
}

fn has_table(scene: &SceneModel, setting: PictureSetting) -> bool {
    scene.table != TableTop::None && setting == PictureSetting::Block
}

fn listed(
    scene: &SceneModel,
    displayed: &DisplayedTerrain,
    viewer: Viewer<'_>,
    purpose: ListPurpose,
    progress: &dyn Fn(&'static str),
) -> ListedScene {
    let camera = viewer.camera();
    let to_sun = scene.sunlight.to_sun(camera);
    let level = camera.map_or(0, |camera| ground::map_level(scene, camera));
    let lighting = match camera {
        Some(camera) => lighting(scene, camera, to_sun),
        None => Lighting { to_sun, ..Lighting::default() },
    };
    let key = GroundMapKey { level, to_sun };
    let is_lit = purpose == ListPurpose::Picture;
    let makes_map = is_lit && !scene.has_map(key);
    if makes_map {
        // The map and the features need these: neither is to wait for the other to make them.
        scene.ground();
        scene.water();
    }
    let mut map = None;
    let mut listed = rayon::in_place_scope(|scope| {
        if is_lit {
            scope.spawn(|_| map = Some(scene.map(key, || ())));
        }
        let list = DrawList { lighting, ..DrawList::default() };
        let shaped = shaped(list, scene, displayed, viewer, purpose, progress);
        if makes_map {
            // What of it is not done beside the features, on one thread all.
            progress("lighting terrain");
        }
        shaped
    });
    listed.list.ground = Some(map.unwrap_or_else(|| Arc::new(GroundMap::level())));
    listed
}

/// The list with all that is drawn, whose ground is not lit.
fn shaped(
    mut list: DrawList,
    scene: &SceneModel,
    displayed: &DisplayedTerrain,
    viewer: Viewer<'_>,
    purpose: ListPurpose,
    progress: &dyn Fn(&'static str),
) -> ListedScene {
    let camera = viewer.camera();
    let setting = camera.map(|camera| PictureSetting::new(camera, scene.bounds));
    let walls = ground::add(&mut list, scene, displayed);
    let ground_triangles = list.triangle_count();
    progress("draping features");
    let raised = drapes::add(&mut list, scene, displayed, viewer);
    let annotated = camera.filter(|_| purpose != ListPurpose::Relief);
    if annotated.is_some() {
        overlay::add_ground_tints(&mut list, scene, displayed);
    }
    let graphic_texts = annotated.map(|_| overlay::add(&mut list, scene, viewer, displayed, progress));
    progress("setting models");
    ground::add_plinth(&mut list, scene, walls);
    if annotated.is_some() && setting.is_some_and(|setting| has_table(scene, setting)) {
        table::add(&mut list, scene);
    }
    solids::add(&mut list, scene);
    raised.add_to(&mut list);
    if annotated.is_some() {
        voids::add(&mut list, scene);
    }
    uprights::add(&mut list, scene, displayed);
    models::add(&mut list, scene, displayed, viewer);
    if annotated.is_some() {
        airspace::add(&mut list, scene);
    }
    ListedScene { list, ground_triangles, graphic_texts: graphic_texts.unwrap_or_default() }
}

/// The light, the haze and the backdrop of a picture; `to_sun` is the unit vector toward the sun.
pub fn lighting(scene: &SceneModel, camera: &Camera, to_sun: Vec3) -> Lighting {
    let setting = PictureSetting::new(camera, scene.bounds);
    let (lighting, (min, max)) = (Lighting::default(), scene.bounds);
    let haze = haze::haze(lighting.haze.color, scene.haze_m, camera, Aabb { min, max }, setting);
    Lighting { to_sun, haze, backdrop: setting.backdrop(), ..lighting }
}

/// The ground as `camera` shows it, off by at most the scene's own tolerance.
pub fn display(scene: &SceneModel, camera: &Camera) -> DisplayedTerrain {
    scene.ground().displayed_to(camera, scene.tolerance_px)
}

fn add_mesh(
    list: &mut DrawList,
    mesh: DrawMesh,
    material: MaterialId,
    layer: DepthLayer,
    feature: FeatureId,
) {
    let triangles = 0..mesh.triangles.len() as u32;
    let mesh = list.add_mesh(mesh);
    list.items.push(DrawItem { mesh, triangles, material, world_from_mesh: Mat4::IDENTITY, layer, feature });
}
