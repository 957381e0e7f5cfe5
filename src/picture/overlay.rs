//! Overlays on the ground: tints of visibility and of analyses, then their lines, lines of sight and tactical graphics.

use std::collections::BTreeSet;
use std::ops::Range;

use crate::detail::Viewer;
use crate::graphic_lines::{CASING, GraphicPen, GraphicView, LinePlan, add_parts};
use crate::placed_text::PlacedText;
use crate::post_tint::{self, TINT_LAYER, TintPlan};
use crate::{add_mesh, analyses, graphics, sight};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawList};
use sandtable_ribbon::drape::drape;
use sandtable_scene::analyses::SceneAnalysis;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

/// The lines of sight and tactical graphics for an eye that turns around where `camera` is, in drawing order, and their
/// texts, with those of an analysis that is tried. They are planned on the finest ground.
pub(super) fn planned(
    (scene, tried): (&SceneModel, Option<&SceneAnalysis>),
    camera: &Camera,
) -> (Vec<LinePlan>, Vec<PlacedText>) {
    if !scene.has_overlay() && tried.is_none() {
        return (Vec::new(), Vec::new());
    }
    let view = GraphicView::around(scene, camera);
    let (mut pen, mut texts) = (GraphicPen::default(), Vec::new());
    analyses::draw((scene, tried), &view, &mut pen, &mut texts);
    sight::draw(scene, &view, &mut pen, &mut texts);
    let [mut casings, mut lines] = pen.into_plans();
    for ([more_casings, more_lines], more) in graphics::each(scene, &view, GraphicPen::into_plans) {
        casings.extend(more_casings);
        lines.extend(more_lines);
        texts.extend(more);
    }
    casings.extend(lines);
    names_first(&mut texts);
    (casings, texts)
}

/// The colors of all that [`planned`] plans of the scene, each once.
pub(super) fn colors(scene: &SceneModel) -> BTreeSet<[u8; 4]> {
    let lines = sight::line_colors(scene).filter(|_| !scene.sight.is_empty());
    let casing = [CASING].into_iter().filter(|_| scene.has_overlay());
    let analyses = scene.analyses.iter().flat_map(|analysis| analyses::colors(analysis, scene));
    let all = lines.chain(graphics::colors(scene)).chain(analyses).chain(casing);
    all.map(|Srgba(color)| color).collect()
}

/// Adds what the viewer sees of it, where `viewer` has a camera; returns its texts. `progress` is called with the name of each step as it begins.
pub(super) fn add(
    list: &mut DrawList,
    scene: &SceneModel,
    viewer: Viewer<'_>,
    displayed: &dyn TriangleSurface,
    progress: &dyn Fn(&'static str),
) -> Vec<PlacedText> {
    let Some(camera) = viewer.camera().filter(|_| scene.has_overlay()) else { return Vec::new() };
    let view = match viewer {
        Viewer::Around(_) => GraphicView::around(scene, camera),
        Viewer::Camera(_) | Viewer::Anyone => GraphicView::new(scene, camera),
    };
    let (mut pen, mut texts) = (GraphicPen::default(), Vec::new());
    if !scene.sight.is_empty() {
        progress("computing sight");
    }
    add_tints(list, sight::tints(scene), DepthLayer::Draped(TINT_LAYER), displayed);
    progress("drawing graphics");
    analyses::draw((scene, None), &view, &mut pen, &mut texts);
    sight::draw(scene, &view, &mut pen, &mut texts);
    let [mut casings, mut lines] = pen.draped(displayed);
    let ([more_casings, more_lines], more) = graphics::draped(scene, &view, displayed);
    casings.extend(more_casings);
    lines.extend(more_lines);
    texts.extend(more);
    add_parts(list, casings.into_iter().chain(lines));
    names_first(&mut texts);
    texts
}

/// The layer of tints of the ground: over what covers it, under water and roads, whose colors they leave as they are.
pub(super) const GROUND_TINT_LAYER: u8 = 0;

/// Adds the tints of analyses where they belong among what lies on the ground; returns the items that they are.
pub(super) fn add_ground_tints(
    list: &mut DrawList,
    scene: &SceneModel,
    displayed: &dyn TriangleSurface,
) -> Range<usize> {
    let layer = DepthLayer::Draped(GROUND_TINT_LAYER);
    let at = list.items.partition_point(|item| item.layer <= layer);
    let above = list.items.split_off(at);
    add_tints(list, analyses::tints(scene), layer, displayed);
    let added = at..list.items.len();
    list.items.extend(above);
    added
}

fn add_tints(list: &mut DrawList, tints: Vec<TintPlan>, layer: DepthLayer, displayed: &dyn TriangleSurface) {
    for TintPlan { plan, color, texture, feature } in tints {
        let mesh = drape(&plan, displayed);
        if !mesh.triangles.is_empty() {
            let material = post_tint::add_material(list, color, texture);
            add_mesh(list, mesh, material, layer, feature);
        }
    }
}

/// Puts what graphics can do without after the names of all of them.
fn names_first(texts: &mut [PlacedText]) {
    texts.sort_by_key(|text| text.is_repeat);
}
