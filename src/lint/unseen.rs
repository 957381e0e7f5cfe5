//! Tables of which no camera shows anything.
//!
//! Boxes against the frustums of all cameras: what is found lies outside every picture, whatever hides what. What hills
//! hide is not found.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use crate::context::LintContext;
use crate::sink::FindingSink;
use crate::standing::reach;
use sandtable_description::finding_code::FindingCode;
use sandtable_geom::aabb::Aabb;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::scene_view::ViewAim;
use sandtable_sheet::picture::{PictureSize, framed_camera};
use sandtable_view::frustum::Frustum;

/// How far above the ground's box draped features and what stands on them may reach, meters: power lines over a gorge.
const ABOVE_M: f32 = 100.0;

/// Finds such tables.
pub fn check(context: &LintContext<'_>, sink: &mut FindingSink) {
    let scene = context.scene;
    // A panorama looks all around.
    if scene.cameras.iter().any(|view| matches!(view.aim, ViewAim::Panorama(_))) {
        return;
    }
    let frustums = scene.cameras.iter().map(|view| framed_camera(scene, view, PictureSize::of(scene, view)));
    let frustums: Vec<Frustum> = frustums.flatten().map(|(camera, _)| Frustum::new(&camera)).collect();
    // Without cameras, one is fitted to all of the scene; cameras without a picture are other findings.
    if context.document.cameras.is_empty() || frustums.is_empty() {
        return;
    }
    // By table: how many features it has, and whether one of them may be seen.
    let mut tables: BTreeMap<(usize, usize), (usize, bool)> = BTreeMap::new();
    for (feature, around) in scene.features.iter().zip(boxes(scene)) {
        let span = &feature.origin.span;
        let (count, is_seen) = tables.entry((span.start, span.end)).or_default();
        *count += 1;
        let may_be_seen = |Aabb { min, max }| frustums.iter().any(|frustum| frustum.may_see(min, max));
        *is_seen |= around.is_none_or(may_be_seen);
    }
    let unseen = tables.into_iter().filter(|((start, end), (_, is_seen))| !is_seen && start < end);
    for ((start, end), (count, _)) in unseen {
        let kind = scene.features.iter().find(|feature| feature.origin.span == (start..end));
        let noun = kind.map_or("features", |feature| feature.kind.noun(count));
        let message = match scene.cameras.len() {
            1 => format!("camera '{}' shows none of the {count} {noun} of this table", scene.cameras[0].name),
            cameras => format!("none of the {cameras} cameras shows any of the {count} {noun} of this table"),
        };
        sink.add(context.finding(FindingCode::OutOfView, start..end, message));
    }
}

/// The box of each feature in world space; `None` of one whose shapes are made for each picture.
fn boxes(scene: &SceneModel) -> Vec<Option<Aabb>> {
    let mut boxes: Vec<Option<Aabb>> = vec![None; scene.features.len()];
    let mut add = |feature: usize, around: Aabb| {
        if let Some(known) = boxes.get_mut(feature) {
            let whole = known.unwrap_or(around);
            *known = Some(Aabb { min: whole.min.min(around.min), max: whole.max.max(around.max) });
        }
    };
    let (low, high) = (scene.bounds.0.z, scene.bounds.1.z + ABOVE_M);
    for ribbon in &scene.ribbons {
        let Some(feature) = ribbon.feature.index() else { continue };
        for at in ribbon.plan.vertices.iter().map(|vertex| vertex.at.as_vec2()) {
            add(feature, Aabb { min: at.extend(low), max: at.extend(high) });
        }
    }
    for solid in &scene.solids {
        let Some(feature) = solid.feature.index() else { continue };
        let vertices = solid.mesh.vertices.iter().map(|vertex| Vec3::from(vertex.position));
        Aabb::around(vertices).into_iter().for_each(|around| add(feature, around));
    }
    let reaches: Vec<f32> = scene.models.iter().map(reach).collect();
    for placement in &scene.placements {
        let Some(feature) = placement.feature.index() else { continue };
        let reach = reaches[placement.model] * placement.scale;
        let (around, lift) = (Vec2::splat(reach), reach + placement.height.abs() as f32);
        add(
            feature,
            Aabb {
                min: (placement.at - around).extend(low - lift),
                max: (placement.at + around).extend(high + lift),
            },
        );
    }
    boxes
}
