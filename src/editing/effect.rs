//! The effect of an edit on a scene that is shown, so that as little as possible is rebuilt.

use std::ops::Range;

use glam::{DVec2, Vec2};

use crate::edit::{EditPlace, SceneEdit};
use crate::scene_text::number_at;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::{Document, LabelTable};
use sandtable_description::features::ModelPlacement;
use sandtable_description::words::Footing;
use sandtable_earthworks::earthwork::{Earthwork, MovedEarth, foreseen};
use sandtable_geom::rect::Rect;
use sandtable_scene::assets::Assets;
use sandtable_scene::attributes::DefaultCounts;
use sandtable_scene::earthworks::{NamedEarthwork, of_table};
use sandtable_scene::placed_model::Placement;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::sources::Sources;
use sandtable_scene::world_frame::WorldFrame;
use sandtable_terrain::lattice::Lattice;

/// How far a model's pad may move ground beside its footprint, in cells: as far as its batters reach, and the pad's margin.
const PAD_REACH_CELLS: f64 = 66.0;
/// The footprint of a pad's margin, as a multiple of the model's own radius.
const PAD_MARGIN: f32 = 1.3;

/// The effect of an edit on a scene.
#[derive(Clone, Debug, PartialEq)]
pub enum EditEffect {
    /// The picture stays; views or the texts around the picture may differ.
    Views,
    /// [`dig`](sandtable_earthworks::earthwork::dig) these earthworks, except in [`SceneModel::held`]: the ground and its
    /// draped features change. What stands there keeps its height, and what is computed from the ground stays as it is,
    /// until the scene is built anew.
    Dig(Vec<Earthwork>),
    /// The posts of the last earthwork get their former heights back; without one since the scene was built, the scene is
    /// rebuilt.
    TakeBack,
    /// A model stands elsewhere or looks elsewhere.
    Move(MovedModel),
    /// The scene is rebuilt from [`SceneSource`](crate::editor::SceneSource).
    Rebuild,
}

/// A model that was moved or turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovedModel {
    /// Its number among the scene's placements.
    pub placement: usize,
    /// World X and Y of its origin.
    pub at: Vec2,
    /// The heading of its front, radians clockwise from north.
    pub heading_rad: f32,
}

/// The earth that an edit would move; zeros for one that moves none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EditPreview {
    /// Earth cut, cubic meters.
    pub cut_m3: f64,
    /// Earth filled, cubic meters.
    pub fill_m3: f64,
    /// Area of the ground that changes, square meters.
    pub area_m2: f64,
    /// Whether the posts of the elevation model are close enough to show it.
    pub is_resolved: bool,
}

/// What an edit does, and what undoing it does.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EffectOfEdit {
    pub forward: EditEffect,
    pub back: EditEffect,
}

impl EffectOfEdit {
    fn both(effect: EditEffect) -> Self {
        Self { forward: effect.clone(), back: effect }
    }
}

/// The effect on `scene` of an edit between two documents.
///
/// # Errors
/// The points of an earthwork cannot be brought to the scene's system.
pub(super) fn effect(
    edit: &SceneEdit,
    [before, after]: [&Document; 2],
    assets: &Assets,
    scene: &SceneModel,
) -> Result<EffectOfEdit, Diagnostic> {
    let rebuild = EffectOfEdit::both(EditEffect::Rebuild);
    Ok(match edit {
        SceneEdit::Add(table) if matches!(table.name.as_str(), "camera" | "flight") => {
            EffectOfEdit::both(EditEffect::Views)
        }
        SceneEdit::Add(table) if table.name == "earthwork" => {
            let works = added_works([before, after], assets, scene)?;
            if works.iter().all(|work| work.bounds(&scene.lattice).is_none()) {
                EffectOfEdit::both(EditEffect::Views)
            } else if works.iter().any(|work| meets_a_pad(work, scene)) {
                rebuild
            } else {
                EffectOfEdit { forward: EditEffect::Dig(works), back: EditEffect::TakeBack }
            }
        }
        SceneEdit::Set { place: EditPlace::Table { name, .. }, keys, .. }
            if name == "model" && matches!(keys[..], [ref key] if key == "at" || key == "heading") =>
        {
            moved([before, after], scene).unwrap_or(rebuild)
        }
        SceneEdit::Set { place: EditPlace::Root, keys, .. } if matches!(keys[..], [ref key] if key == "title" || key == "subtitle") => {
            EffectOfEdit::both(EditEffect::Views)
        }
        _ => rebuild,
    })
}

/// The earth that an edit between two documents would move.
///
/// # Errors
/// As for [`effect`].
pub(super) fn preview(
    edit: &SceneEdit,
    documents: [&Document; 2],
    assets: &Assets,
    scene: &SceneModel,
    ground: &Lattice,
) -> Result<EditPreview, Diagnostic> {
    let is_earthwork = matches!(edit, SceneEdit::Add(table) if table.name == "earthwork");
    let works = if is_earthwork { added_works(documents, assets, scene)? } else { Vec::new() };
    let MovedEarth { volumes, area_m2 } = foreseen(&works, ground, &scene.held);
    let cell_m = ground.cell().max_element();
    Ok(EditPreview {
        cut_m3: volumes.cut_m3,
        fill_m3: volumes.fill_m3,
        area_m2,
        is_resolved: works.iter().all(|work| work.is_resolved(cell_m)),
    })
}

/// The works of the earthworks at the end of the second document that the first lacks; those of another phase are none.
fn added_works(
    [before, after]: [&Document; 2],
    assets: &Assets,
    scene: &SceneModel,
) -> Result<Vec<Earthwork>, Diagnostic> {
    let frame = WorldFrame::new(after, &scene.crs, &scene.stated_crs, scene.lattice.map_extent());
    let sources = Sources::new(&frame, assets);
    let mut works = Vec::new();
    for table in after.earthworks.iter().skip(before.earthworks.len()) {
        let named = of_table(table, &sources, &mut DefaultCounts::default())?;
        works.extend(named.into_iter().map(|NamedEarthwork { work, .. }| work));
    }
    Ok(works)
}

/// Whether ground that an earthwork changes, or decides by its height, is leveled for a model, which is done after it.
fn meets_a_pad(work: &Earthwork, scene: &SceneModel) -> bool {
    let Some(bounds) = work.bounds(&scene.lattice) else { return false };
    let beside_m = PAD_REACH_CELLS * scene.lattice.cell().max_element();
    let on_pads = scene.placements.iter().filter(|placement| placement.standing.footing == Footing::Pad);
    on_pads.into_iter().any(|placement| {
        let box_ = scene.models[placement.model].bounds().unwrap_or_default();
        let radius = box_.min.truncate().length().max(box_.max.truncate().length());
        let radius_m = f64::from(radius * std::f32::consts::SQRT_2 * placement.scale * PAD_MARGIN);
        let at = placement.at.as_dvec2();
        Rect { min: at, max: at }.grown(radius_m + beside_m).meets(&bounds)
    })
}

/// The one model that stands or looks otherwise in the second document; `None` where the ground depends on it, or the
/// scene does not say which it is.
fn moved([before, after]: [&Document; 2], scene: &SceneModel) -> Option<EffectOfEdit> {
    let is_other = |(old, new): (&ModelPlacement, &ModelPlacement)| {
        old.at.as_deref() != new.at.as_deref() || heading_deg(old) != heading_deg(new)
    };
    let number = before.models.iter().zip(&after.models).position(is_other)?;
    let (old, new) = (&before.models[number], &after.models[number]);
    if before.models.len() != after.models.len() || *new.footing == Footing::Pad {
        return None;
    }
    let from = pose(before, old, scene)?;
    let to = pose(after, new, scene)?;
    let placement = if has_own_numbers(before, number) {
        number
    } else {
        only(scene.placements.iter().enumerate().filter(|(_, placement)| from.is_of(placement)))?.0
    };
    // Off the model the decoder does not know, but the scene would not be built.
    scene.lattice.cell_at(to.at.as_dvec2())?;
    let [forward, back] = [to, from].map(|pose| EditEffect::Move(MovedModel { placement, ..pose }));
    Some(EffectOfEdit { forward, back })
}

/// Where a model at one place stands, as the scene builds it.
fn pose(document: &Document, table: &ModelPlacement, scene: &SceneModel) -> Option<MovedModel> {
    let frame = WorldFrame::new(document, &scene.crs, &scene.stated_crs, scene.lattice.map_extent());
    let at: DVec2 = frame.point(table.at.as_ref()?, table.crs.as_ref()).ok()?;
    let heading_rad = (heading_deg(table) as f32).to_radians();
    Some(MovedModel { placement: 0, at: at.as_vec2(), heading_rad })
}

/// Whether the models of the tables up to a number have the numbers of their tables: whether each is a model at one place.
fn has_own_numbers(document: &Document, number: usize) -> bool {
    document.models.iter().take(number + 1).all(|table| table.at.is_some())
}

/// The only element; `None` of none or several.
fn only<T>(mut all: impl Iterator<Item = T>) -> Option<T> {
    let first = all.next()?;
    all.next().is_none().then_some(first)
}

impl MovedModel {
    fn is_of(&self, placement: &Placement) -> bool {
        placement.at == self.at && placement.heading_rad == self.heading_rad
    }
}

/// The heading of a model at one place, degrees.
fn heading_deg(table: &ModelPlacement) -> f64 {
    table.heading.value(&|_| None)
}

/// The table of the scene file `text`, decoded as `document`, that places a model alone; `None` for models of files, those
/// of included files, and where two stand alike.
pub(super) fn place_of_model(
    document: &Document,
    text: &str,
    placement: usize,
    scene: &SceneModel,
) -> Option<EditPlace> {
    let wanted = scene.placements.get(placement)?;
    let stands_there =
        |table: &&ModelPlacement| pose(document, table, scene).is_some_and(|pose| pose.is_of(wanted));
    let table = if has_own_numbers(document, placement) {
        document.models.get(placement)?
    } else {
        only(document.models.iter().filter(stands_there))?
    };
    place_at(text, "model", table.at.as_ref()?.span()?)
}

/// The table that states a label at one place; as [`place_of_model`].
pub(super) fn place_of_label(
    document: &Document,
    text: &str,
    label: usize,
    scene: &SceneModel,
) -> Option<EditPlace> {
    let wanted = scene.labels.get(label)?.ground.truncate();
    let frame = WorldFrame::new(document, &scene.crs, &scene.stated_crs, scene.lattice.map_extent());
    let stands_there = |table: &&LabelTable| {
        let at = table.at.as_ref().and_then(|at| frame.point(at, table.crs.as_ref()).ok());
        at.is_some_and(|at| at.as_vec2() == wanted)
    };
    let table = only(document.labels.iter().filter(stands_there))?;
    place_at(text, "label", table.at.as_ref()?.span()?)
}

/// The table of a list around the bytes `span`; `None` in an included file.
fn place_at(text: &str, name: &str, span: Range<usize>) -> Option<EditPlace> {
    let number = (span.end <= text.len()).then(|| number_at(text, name, span.start)).flatten()?;
    Some(EditPlace::table(name, number))
}
