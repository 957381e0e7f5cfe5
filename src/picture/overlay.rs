//! Overlays on the ground: tints of visibility, then lines of sight and tactical graphics.

use std::collections::BTreeSet;

use crate::graphic_lines::{CASING, GraphicPen, GraphicView, LinePlan, add_parts};
use crate::placed_text::PlacedText;
use crate::{graphics, sight};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::DrawList;
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

/// The lines of sight and tactical graphics for an eye that turns around where `camera` is, in drawing order, and their
/// texts. They are planned on the finest ground.
pub(super) fn planned(
    scene: &SceneModel,
    camera: &Camera,
    ground: &dyn TriangleSurface,
) -> (Vec<LinePlan>, Vec<PlacedText>) {
    if scene.graphics.is_empty() && scene.sight.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let view = GraphicView::around(scene, camera, ground);
    let (mut pen, mut texts) = (GraphicPen::default(), Vec::new());
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

/// The colors of all that [`planned`] plans, each once.
pub(super) fn colors(scene: &SceneModel) -> BTreeSet<[u8; 4]> {
    let lines = sight::line_colors(scene).filter(|_| !scene.sight.is_empty());
    let casing = [CASING].into_iter().filter(|_| !scene.graphics.is_empty() || !scene.sight.is_empty());
    lines.chain(graphics::colors(scene)).chain(casing).map(|Srgba(color)| color).collect()
}

/// Adds what the camera sees of it; returns its texts. `progress` is called with the name of each step as it begins.
pub(super) fn add(
    list: &mut DrawList,
    scene: &SceneModel,
    camera: &Camera,
    displayed: &dyn TriangleSurface,
    progress: &dyn Fn(&'static str),
) -> Vec<PlacedText> {
    if scene.graphics.is_empty() && scene.sight.is_empty() {
        return Vec::new();
    }
    let view = GraphicView::new(scene, camera, displayed);
    let (mut pen, mut texts) = (GraphicPen::default(), Vec::new());
    if !scene.sight.is_empty() {
        progress("computing sight");
        sight::add(list, scene, &view, &mut pen, &mut texts);
    }
    progress("drawing graphics");
    let [mut casings, mut lines] = pen.draped(displayed);
    let ([more_casings, more_lines], more) = graphics::draped(scene, &view, displayed);
    casings.extend(more_casings);
    lines.extend(more_lines);
    texts.extend(more);
    add_parts(list, casings.into_iter().chain(lines));
    names_first(&mut texts);
    texts
}

/// Puts what graphics can do without after the names of all of them.
fn names_first(texts: &mut [PlacedText]) {
    texts.sort_by_key(|text| text.is_repeat);
}
