//! Draw lists with nested grounds: each ground with its features, without the part that a finer one shows.
//!
//! ```text
//!  ───────┐   ┌──────────   The border between two grounds runs along posts of the coarser one, whose means differ from
//!  coarse │───│  coarse     the samples of the finer: each ground ends in a skirt, a wall downward in its own colors, so
//!         │   │             that no gap shows. What lies on the ground is cut at the border, solids triangle by triangle.
//! ```

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, Mat4, Vec2, Vec3};
use rayon::prelude::*;

use crate::detail::Viewer;
use crate::hole::{cut_hole, skirt};
use crate::nested_ground::{NestedGround, NestedHeights};
use crate::nested_surface::{NestedSurface, SurfacePart};
use crate::setting::PictureSetting;
use crate::{
    ViewDraw, airspace, display, drapes, ground, has_table, lighting, models, overlay, solids, table,
    uprights, voids,
};
use sandtable_draw::ground::GroundMap;
use sandtable_draw::ground_inset::GroundInset;
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, FeatureId, MaterialId, MeshId};
use sandtable_draw::material::TextureId;
use sandtable_geom::rect::Rect;
use sandtable_roam::displayed::DisplayedTerrain;
use sandtable_scene::feature::{FeatureKind, SceneFeature};
use sandtable_scene::ground_map::{form_level, ground_map};
use sandtable_scene::ground_map_cache::GroundMapKey;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::texture_shading::sky_in_part;
use sandtable_view::camera::Camera;

/// How deep skirts reach below the border of a ground, in cells of the coarser of the two that meet there: deeper than means
/// of samples are off, and not so deep that they come out of a slope.
const SKIRT_CELLS: f64 = 1.0;

/// The draw list for one camera of a scene and the nested grounds of its picture, the coarsest first. `progress` is called with
/// the name of each step as it begins.
pub fn build_nested_draw_list(
    scene: &SceneModel,
    nested: &[NestedGround],
    camera: &Camera,
    progress: &dyn Fn(&'static str),
) -> ViewDraw {
    progress("refining terrain");
    let to_sun = scene.sunlight.to_sun(Some(camera));
    let displayed = Arc::new(display(scene, camera));
    let parts: Vec<ShownPart<'_>> = nested.par_iter().map(|ground| ShownPart::new(ground, camera)).collect();
    let level = ground::map_level(scene, camera).max(0);
    let map = scene.map(GroundMapKey { level, to_sun }, || progress("lighting terrain"));
    let lit = lighting(scene, camera, to_sun);
    let mut list = DrawList { ground: Some(Arc::clone(&map)), lighting: lit, ..DrawList::default() };

    progress("draping features");
    let walls = ground::add(&mut list, scene, &displayed);
    add_features(&mut list, scene, &displayed, camera);
    if let Some(hole) = parts.first().map(|part| part.ground.rect()) {
        let depth_m = skirt_depth_m(scene);
        cut_hole(&mut list, &hole);
        skirt(&mut list, &hole, depth_m);
    }
    let ids = feature_ids(&scene.features);
    let mut around = GroundInset { map: Arc::clone(&map), origin: Vec2::ZERO };
    for (index, part) in parts.iter().enumerate() {
        let NestedGround { scene: own, origin, .. } = part.ground;
        let inset = inset(part, scene, &around, to_sun);
        let mut of_part = DrawList::default();
        ground::add(&mut of_part, own, &part.displayed);
        add_features(&mut of_part, own, &part.displayed, &part.camera);
        let coarser = index.checked_sub(1).map_or(scene, |index| &parts[index].ground.scene);
        skirt(&mut of_part, &own.lattice.extent(), skirt_depth_m(coarser));
        if let Some(finer) = parts.get(index + 1) {
            let Rect { min, max } = finer.ground.rect();
            let hole = Rect { min: min - *origin, max: max - *origin };
            cut_hole(&mut of_part, &hole);
            skirt(&mut of_part, &hole, skirt_depth_m(own));
        }
        let of_outer = |feature: FeatureId| outer_feature(feature, &own.features, &ids);
        append(&mut list, of_part, origin.as_vec2().extend(0.0), of_outer);
        around = inset.clone();
        list.insets.push(inset);
    }
    let is_ground = |item: &&DrawItem| item.layer == DepthLayer::Ground;
    let ground_triangles = list.items.iter().filter(is_ground).map(|item| item.triangles.len()).sum();

    progress("setting models");
    ground::add_plinth(&mut list, scene, walls);
    if has_table(scene, PictureSetting::new(camera, scene.bounds)) {
        table::add(&mut list, scene);
    }
    voids::add(&mut list, scene);
    let surface = NestedSurface {
        outer: SurfacePart { surface: Arc::clone(&displayed), origin: DVec2::ZERO },
        nested: parts.iter().map(ShownPart::surface).collect(),
    };
    let graphic_texts = overlay::add(&mut list, scene, Viewer::Camera(camera), &surface, progress);
    airspace::add(&mut list, scene);
    list.items.sort_by_key(|item| item.layer);
    overlay::add_ground_tints(&mut list, scene, &surface);
    ViewDraw { list, displayed, ground_triangles, graphic_texts, nested: NestedHeights::new(nested) }
}

/// A nested ground as a camera shows it.
struct ShownPart<'a> {
    ground: &'a NestedGround,
    /// The camera in its world space.
    camera: Camera,
    displayed: Arc<DisplayedTerrain>,
}

impl<'a> ShownPart<'a> {
    fn new(ground: &'a NestedGround, camera: &Camera) -> Self {
        let camera = camera.moved(-ground.origin.as_vec2().extend(0.0));
        Self { ground, camera, displayed: Arc::new(display(&ground.scene, &camera)) }
    }

    fn surface(&self) -> (Rect, SurfacePart) {
        let part = SurfacePart { surface: Arc::clone(&self.displayed), origin: self.ground.origin };
        (self.ground.rect(), part)
    }
}

/// How deep the skirts of what is beside the ground of `coarser` reach.
fn skirt_depth_m(coarser: &SceneModel) -> f32 {
    coarser.scale.world_z((coarser.lattice.cell().max_element() * SKIRT_CELLS) as f32)
}

/// What lies and stands on a ground.
fn add_features(list: &mut DrawList, scene: &SceneModel, displayed: &DisplayedTerrain, camera: &Camera) {
    let viewer = Viewer::Camera(camera);
    let raised = drapes::add(list, scene, displayed, viewer);
    solids::add(list, scene);
    raised.add_to(list);
    uprights::add(list, scene, displayed);
    models::add(list, scene, displayed, viewer);
}

/// The ground map of a part, in the colors of `scene`, with the light that passes the ground `around` it.
fn inset(part: &ShownPart<'_>, scene: &SceneModel, around: &GroundInset, to_sun: Vec3) -> GroundInset {
    let NestedGround { scene: own, origin, .. } = part.ground;
    let key = GroundMapKey { level: ground::map_level(own, &part.camera).max(0), to_sun };
    let (mut map, origin) = (ground_map(own, key), origin.as_vec2());
    let GroundMap { origin: first, cell, columns, .. } = map;
    map.posts.par_chunks_mut(columns as usize).enumerate().for_each(|(row, posts)| {
        for (column, post) in posts.iter_mut().enumerate() {
            let at = origin + first + cell * Vec2::new(column as f32, row as f32);
            let light = around.map.sample(at - around.origin);
            post.sun_visibility = post.sun_visibility.min(light.sun_visibility);
            post.sky_visibility = sky_in_part(scene.texture, post.sky_visibility, light.sky_visibility);
        }
    });
    map.ramp = scene.ramp();
    map.contours = scene.contours;
    map.cover = scene.cover();
    map.z_factor = around.map.z_factor;
    map.shade_gain = around.map.shade_gain;
    map.detail = around.map.detail;
    map.form_level = form_level(&scene.lattice);
    GroundInset { map: Arc::new(map), origin }
}

/// What a feature is known by in all grounds of a picture.
type FeatureKey<'a> = (FeatureKind, &'a str, usize, usize, Option<usize>);

fn feature_key(feature: &SceneFeature) -> FeatureKey<'_> {
    let SceneFeature { kind, name, origin } = feature;
    (*kind, name, origin.span.start, origin.span.end, origin.number)
}

/// The id of each of a scene's features.
fn feature_ids(features: &[SceneFeature]) -> BTreeMap<FeatureKey<'_>, FeatureId> {
    let mut ids = BTreeMap::new();
    for (index, feature) in features.iter().enumerate() {
        ids.entry(feature_key(feature)).or_insert(FeatureId::of_index(index));
    }
    ids
}

/// The id in the outer scene of a feature of a part.
fn outer_feature(
    feature: FeatureId,
    own: &[SceneFeature],
    ids: &BTreeMap<FeatureKey<'_>, FeatureId>,
) -> FeatureId {
    let Some(found) = feature.index().and_then(|index| own.get(index)) else { return feature };
    ids.get(&feature_key(found)).copied().unwrap_or(FeatureId::GROUND)
}

/// Adds the items of `part`, `moved` and with the features that `feature` gives.
fn append(list: &mut DrawList, part: DrawList, moved: Vec3, feature: impl Fn(FeatureId) -> FeatureId) {
    let [textures, materials, meshes] =
        [list.textures.len(), list.materials.len(), list.meshes.len()].map(|count| count as u32);
    list.textures.extend(part.textures);
    list.materials.extend(part.materials.into_iter().map(|mut material| {
        material.texture = material.texture.map(|texture| TextureId(texture.0 + textures));
        material
    }));
    list.meshes.extend(part.meshes);
    list.items.extend(part.items.into_iter().map(|item| DrawItem {
        mesh: MeshId(item.mesh.0 + meshes),
        material: MaterialId(item.material.0 + materials),
        world_from_mesh: Mat4::from_translation(moved) * item.world_from_mesh,
        feature: feature(item.feature),
        ..item
    }));
}
