//! What lies over everything else on the ground: tints of sight, then lines of sight and tactical graphics.

use crate::draw::list::DrawList;
use crate::scene::SceneModel;
use crate::scene::picture::graphic_lines::{GraphicPen, GraphicView, add_parts};
use crate::scene::picture::placed_text::PlacedText;
use crate::scene::picture::{graphics, sight};
use crate::terrain::triangle_surface::TriangleSurface;
use crate::view::camera::Camera;

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
    texts
}
