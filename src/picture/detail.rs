//! Many models: where neither a model nor its shadow is in view it is left out, small ones are drawn in a simpler form,
//! woods of plants smaller than a pixel or two are left to their canopy, and equal ones form runs.
//!
//! A picture whose models have no more than `FULL_TRIANGLES` draws all of them in full. Past that, [`ModelDetail::form`]
//! chooses the form of each by its apparent size. Items are listed by model, form and part, for the runs of
//! [`DrawList::runs`].

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use glam::{Mat4, Vec3};
use rayon::prelude::*;

use crate::canopy::{CanopyPlant, canopies};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, FeatureId, MaterialId, MeshId};
use sandtable_draw::material::{Material, TextureId};
use sandtable_model::detail::{ApparentSize, DetailForm, ModelDetail};
use sandtable_model::impostor::Impostor;
use sandtable_model::{Model, ModelPart};
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;
use sandtable_view::frustum::Frustum;

/// The triangles of models up to which a picture shows every one of them in full: as many as a landscape's ground has.
pub(super) const FULL_TRIANGLES: usize = 250_000;

/// Small models of one kind are drawn as pictures on quads where they have this many triangles together; the pictures of
/// fewer would take longer to make than their meshes to draw.
const PICTURED_TRIANGLES: usize = 120_000;

/// The sine of the sun's height below which shadows are taken to be no longer: they reach a hundred times as far as what
/// casts them is high.
const LOWEST_SUN: f32 = 0.01;

/// The most boxes that a shadow is looked for in: more leave out more models beside the picture.
const MOST_BOXES: f32 = 16.0;

/// The viewer that models are drawn for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Viewer<'a> {
    /// None yet: all models, in full.
    Anyone,
    /// The camera of one picture.
    Camera(&'a Camera),
    /// A viewer who turns around at the eye of a camera.
    Around(&'a Camera),
}

impl<'a> Viewer<'a> {
    /// The camera; `None` for no viewer yet.
    pub fn camera(self) -> Option<&'a Camera> {
        match self {
            Self::Anyone => None,
            Self::Camera(camera) | Self::Around(camera) => Some(camera),
        }
    }
}

/// A model set in its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlacedModel {
    /// Which of the scene's models.
    pub model: usize,
    /// Its pose: a rotation, a uniform scale and a translation.
    pub world_from_model: Mat4,
    /// Which of its model's tints.
    pub tint: u8,
    /// The feature it is.
    pub feature: FeatureId,
}

/// The sphere around a model, in its own space.
#[derive(Clone, Copy, Debug, Default)]
struct BoundingSphere {
    center: Vec3,
    radius: f32,
}

/// Adds the models that `viewer` may see but for plants that are part of a canopy, and returns these.
pub(super) fn add(
    list: &mut DrawList,
    scene: &SceneModel,
    placed: &[PlacedModel],
    viewer: Viewer<'_>,
) -> Vec<CanopyPlant> {
    let mut canopy = Vec::new();
    let balls: Vec<BoundingSphere> = scene.models.iter().map(BoundingSphere::around).collect();
    let groups = match viewer {
        Viewer::Anyone => grouped(placed.iter().map(|stand| (stand, DetailForm::Full))),
        Viewer::Camera(camera) | Viewer::Around(camera) => {
            let frustum = Frustum::new(camera);
            let turns = matches!(viewer, Viewer::Around(_));
            let (to_sun, lowest_z) = (list.lighting.to_sun, scene.bounds.0.z);
            let in_view: Vec<&PlacedModel> = placed
                .par_iter()
                .filter(|stand| {
                    turns || balls[stand.model].in_world(stand).may_show(&frustum, to_sun, lowest_z)
                })
                .collect();
            let size = |stand: &PlacedModel| balls[stand.model].seen(stand, viewer, camera);
            let sizes: Vec<ApparentSize> = in_view.par_iter().map(|stand| size(stand)).collect();
            let are_canopy = canopies(scene, &in_view, &sizes);
            let sized = || in_view.par_iter().zip(&sizes).zip(&are_canopy);
            canopy = sized()
                .filter(|(_, is_canopy)| **is_canopy)
                .filter_map(|((stand, size), _)| CanopyPlant::new(scene, stand, size))
                .collect();
            let (in_view, sizes): (Vec<&PlacedModel>, Vec<ApparentSize>) = sized()
                .filter(|(_, is_canopy)| !**is_canopy)
                .map(|((stand, size), _)| (*stand, *size))
                .unzip();
            let forms = forms(scene, &in_view, &sizes);
            grouped(in_view.into_iter().zip(forms))
        }
    };
    let mut listed = ModelItems::new(list);
    for (&(model, form, tint), stands) in &groups {
        let details = || scene.details[model].get();
        let source = TintedModel { index: model, model: &scene.models[model], tint };
        match form {
            DetailForm::Full => listed.add_parts(&source, form, &source.model.parts, stands),
            DetailForm::Level(level) => {
                let parts = details().and_then(|detail| Some(&detail.levels.get(usize::from(level))?.parts));
                listed.add_parts(&source, form, parts.unwrap_or(&source.model.parts), stands);
            }
            DetailForm::Impostor(view) => match details().and_then(ModelDetail::impostor) {
                Some(impostor) => listed.add_views(&source, impostor, view.triangles(), stands),
                None => listed.add_parts(&source, DetailForm::Full, &source.model.parts, stands),
            },
        }
    }
    canopy
}

/// A form of equal models, for programs that choose forms themselves.
#[derive(Clone, Debug)]
pub struct ListedForm {
    /// Which models: the forms of the same models have the same number, the finest first.
    pub group: usize,
    /// How far its surface is off, in units of the model.
    pub error: f32,
    /// The center of the sphere around the model, in its own space.
    pub center: Vec3,
    /// The radius of that sphere.
    pub radius: f32,
    /// Whether it is a plant, whose tone the ground under it has.
    pub is_plant: bool,
    /// The items that draw it.
    pub items: Range<usize>,
}

/// Adds all models in full and, where they are many, also in their simpler forms.
pub(super) fn add_forms(list: &mut DrawList, scene: &SceneModel, placed: &[PlacedModel]) -> Vec<ListedForm> {
    let triangles = placed.iter().map(|stand| scene.models[stand.model].triangle_count());
    let are_many = triangles.sum::<usize>() > FULL_TRIANGLES;
    let groups = grouped(placed.iter().map(|stand| (stand, DetailForm::Full)));
    let (mut listed, mut forms) = (ModelItems::new(list), Vec::new());
    for (group, (&(index, _, tint), stands)) in groups.iter().enumerate() {
        let model = &scene.models[index];
        let source = TintedModel { index, model, tint };
        let BoundingSphere { center, radius } = BoundingSphere::around(model);
        let mut add = |form: DetailForm, parts: &[ModelPart], error: f32| {
            let first = listed.list.items.len();
            listed.add_parts(&source, form, parts, stands);
            let (items, is_plant) = (first..listed.list.items.len(), !model.tints.is_empty());
            forms.push(ListedForm { group, error, center, radius, is_plant, items });
        };
        add(DetailForm::Full, &model.parts, 0.0);
        if are_many {
            if scene.details[index].get().is_none() {
                // Another picture may have set the same value first.
                let _ = scene.details[index].set(ModelDetail::new(model));
            }
            let levels = scene.details[index].get().map(|detail| &detail.levels[..]).unwrap_or_default();
            for (number, level) in levels.iter().enumerate() {
                add(DetailForm::Level(number as u8), &level.parts, level.error);
            }
        }
    }
    forms
}

/// Placed models by model, form and tint.
type Groups<'a> = BTreeMap<(usize, DetailForm, u8), Vec<&'a PlacedModel>>;

fn grouped<'a>(stands: impl Iterator<Item = (&'a PlacedModel, DetailForm)>) -> Groups<'a> {
    let mut groups = Groups::new();
    for (stand, form) in stands {
        groups.entry((stand.model, form, stand.tint)).or_default().push(stand);
    }
    groups
}

fn forms(scene: &SceneModel, in_view: &[&PlacedModel], sizes: &[ApparentSize]) -> Vec<DetailForm> {
    let triangles: Vec<usize> = scene.models.iter().map(Model::triangle_count).collect();
    let total = in_view.iter().fold(0usize, |sum, stand| sum.saturating_add(triangles[stand.model]));
    if total <= FULL_TRIANGLES {
        return vec![DetailForm::Full; in_view.len()];
    }
    let pictured = prepare(scene, in_view, sizes);
    let form = |(stand, size): (&&PlacedModel, &ApparentSize)| {
        let is_pictured = pictured.contains(&stand.model);
        scene.details[stand.model].get().map_or(DetailForm::Full, |detail| detail.form(size, is_pictured))
    };
    in_view.par_iter().zip(sizes).map(form).collect()
}

/// Makes the simpler forms of the models in view that this picture needs, where they are not yet made, and returns the
/// models that it shows as pictures on quads where they are small: what other pictures made is not asked.
///
/// Not by `get_or_init`: making them runs on several threads, and one that helps another picture meanwhile could wait for
/// itself.
fn prepare(scene: &SceneModel, in_view: &[&PlacedModel], sizes: &[ApparentSize]) -> BTreeSet<usize> {
    let mut wanted: BTreeMap<usize, usize> = BTreeMap::new();
    for (stand, size) in in_view.iter().zip(sizes) {
        *wanted.entry(stand.model).or_default() +=
            usize::from(size.is_small()) * scene.models[stand.model].triangle_count();
    }
    wanted.par_iter().for_each(|(&model, &small)| {
        let (detail, model) = (&scene.details[model], &scene.models[model]);
        if detail.get().is_none() {
            // Another picture may have set the same value first.
            let _ = detail.set(ModelDetail::new(model));
        }
        if let Some(detail) = detail.get().filter(|_| small >= PICTURED_TRIANGLES) {
            detail.make_impostor(model);
        }
    });
    wanted.into_iter().filter(|(_, small)| *small >= PICTURED_TRIANGLES).map(|(model, _)| model).collect()
}

impl BoundingSphere {
    fn around(model: &Model) -> Self {
        let bounds = model.bounds().unwrap_or_default();
        Self { center: bounds.center(), radius: bounds.radius() }
    }

    fn in_world(&self, stand: &PlacedModel) -> Self {
        let scale = stand.world_from_model.x_axis.truncate().length();
        Self { center: stand.world_from_model.transform_point3(self.center), radius: self.radius * scale }
    }

    /// Whether it or its shadow on ground no lower than `lowest_z` may be in view.
    fn may_show(&self, frustum: &Frustum, to_sun: Vec3, lowest_z: f32) -> bool {
        let is_seen = |center: Vec3| frustum.may_see(center - self.radius, center + self.radius);
        if is_seen(self.center) {
            return true;
        }
        // Down to where the sun's ray through its top meets the lowest ground, box by box.
        let fall = -to_sun * ((self.center.z + self.radius - lowest_z).max(0.0) / to_sun.z.max(LOWEST_SUN));
        let boxes = (fall.length() / (2.0 * self.radius)).ceil().clamp(1.0, MOST_BOXES);
        let half = fall * (0.5 / boxes);
        let reach = half.abs() + self.radius;
        (0..boxes as u32).any(|index| {
            let middle = self.center + half * (2 * index + 1) as f32;
            frustum.may_see(middle - reach, middle + reach)
        })
    }

    /// The apparent size of the model in this sphere of model space.
    fn seen(&self, stand: &PlacedModel, viewer: Viewer<'_>, camera: &Camera) -> ApparentSize {
        let world = self.in_world(stand);
        let scale = if self.radius > 0.0 { world.radius / self.radius } else { 1.0 };
        let offset = camera.eye() - world.center;
        let depth_m = match viewer {
            Viewer::Around(_) => offset.length(),
            _ => -offset.dot(camera.forward()),
        };
        let near = (depth_m - world.radius).max(camera.planes().0);
        let px_per_unit = camera.pixels_per_meter(near) * scale;
        let toward = camera.toward_eye(world.center);
        let along = |axis: glam::Vec4| axis.truncate().dot(toward);
        let axes = &stand.world_from_model;
        let toward_eye = Vec3::new(along(axes.x_axis), along(axes.y_axis), along(axes.z_axis));
        ApparentSize { px_per_unit, across_px: 2.0 * self.radius * px_per_unit, toward_eye }
    }
}

/// A model in one of its tints.
struct TintedModel<'a> {
    index: usize,
    model: &'a Model,
    tint: u8,
}

/// A draw list with the meshes, textures and materials of each model so far.
struct ModelItems<'a> {
    list: &'a mut DrawList,
    /// The meshes of the parts of a model in a form.
    meshes: BTreeMap<(usize, DetailForm), Vec<MeshId>>,
    /// The first texture of each model.
    textures: BTreeMap<usize, TextureId>,
    /// The first material of each model in a tint.
    materials: BTreeMap<(usize, u8), MaterialId>,
    impostors: BTreeMap<usize, (MeshId, TextureId)>,
    impostor_materials: BTreeMap<(usize, u8), MaterialId>,
}

impl TintedModel<'_> {
    /// A material in the tint.
    fn tinted(&self, material: &Material) -> Material {
        let tint = self.model.tints.get(usize::from(self.tint)).copied();
        let base_color = tint.map_or(material.base_color, |tint| multiplied(material.base_color, tint));
        Material { base_color, ..material.clone() }
    }
}

impl<'a> ModelItems<'a> {
    fn new(list: &'a mut DrawList) -> Self {
        Self {
            list,
            meshes: BTreeMap::new(),
            textures: BTreeMap::new(),
            materials: BTreeMap::new(),
            impostors: BTreeMap::new(),
            impostor_materials: BTreeMap::new(),
        }
    }

    fn add_parts(
        &mut self,
        source: &TintedModel<'_>,
        form: DetailForm,
        parts: &[ModelPart],
        stands: &[&PlacedModel],
    ) {
        let MaterialId(first) = self.materials_of(source);
        let list = &mut *self.list;
        let listed = || parts.iter().map(|part| list.add_mesh(part.mesh.clone())).collect();
        let meshes = self.meshes.entry((source.index, form)).or_insert_with(listed).clone();
        for (part, mesh) in parts.iter().zip(meshes) {
            let triangles = 0..part.mesh.triangles.len() as u32;
            self.add_items(mesh, triangles, MaterialId(part.material.0 + first), stands);
        }
    }

    fn add_views(
        &mut self,
        source: &TintedModel<'_>,
        impostor: &Impostor,
        triangles: std::ops::Range<u32>,
        stands: &[&PlacedModel],
    ) {
        let list = &mut *self.list;
        let (mesh, texture) = *self.impostors.entry(source.index).or_insert_with(|| {
            (list.add_mesh(impostor.mesh.clone()), list.add_texture(impostor.texture.clone()))
        });
        let material = *self.impostor_materials.entry((source.index, source.tint)).or_insert_with(|| {
            let material = source.tinted(&impostor.material);
            list.add_material(Material { texture: Some(texture), ..material })
        });
        self.add_items(mesh, triangles, material, stands);
    }

    /// The first material of a model in a tint.
    fn materials_of(&mut self, source: &TintedModel<'_>) -> MaterialId {
        let (list, model) = (&mut *self.list, source.model);
        let TextureId(texture) = *self.textures.entry(source.index).or_insert_with(|| {
            let first = TextureId(list.textures.len() as u32);
            list.textures.extend(model.textures.iter().cloned());
            first
        });
        *self.materials.entry((source.index, source.tint)).or_insert_with(|| {
            let first = MaterialId(list.materials.len() as u32);
            list.materials.extend(model.materials.iter().map(|material| Material {
                texture: material.texture.map(|TextureId(id)| TextureId(id + texture)),
                ..source.tinted(material)
            }));
            first
        })
    }

    fn add_items(
        &mut self,
        mesh: MeshId,
        triangles: std::ops::Range<u32>,
        material: MaterialId,
        stands: &[&PlacedModel],
    ) {
        self.list.items.extend(stands.iter().map(|stand| DrawItem {
            mesh,
            triangles: triangles.clone(),
            material,
            world_from_mesh: stand.world_from_model,
            layer: DepthLayer::Solid,
            feature: stand.feature,
        }));
    }
}

fn multiplied(color: Srgba, tint: Srgba) -> Srgba {
    let Srgba([red, green, blue, _]) = Srgba::from_linear(color.linear() * tint.linear());
    Srgba([red, green, blue, color.0[3]])
}
