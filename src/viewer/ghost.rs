//! The ghost of what is being dragged: the edges of a model's box, the frame of a label, where it will stand.

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke};
use glam::Vec3;

use crate::opened::OpenedScene;
use crate::picked_part::{DragTarget, GrabTarget, PickedPart, heading_deg};
use crate::view_area::ViewArea;
use crate::window_point::window_point;
use sandtable_picture::models::PlacementMove;
use sandtable_view::camera::Camera;

/// Wide and dark below, narrow and light above, so that it shows on any ground.
const STROKES: [(f32, Color32); 2] =
    [(3.0, Color32::from_black_alpha(150)), (1.4, Color32::from_rgb(255, 214, 64))];

impl OpenedScene {
    /// The edges of a model's box as a drag would leave it, in world space; none where it would have no ground.
    pub fn ghost_edges(&self, part: &PickedPart, target: DragTarget) -> Vec<[Vec3; 2]> {
        let Some(GrabTarget::Model(feature)) = part.grab else { return Vec::new() };
        let number = self.scene.placements.iter().position(|placement| placement.feature == feature);
        let corners = number.and_then(|number| {
            let pose = self.walk.model_pose(number);
            let pose = match target.turns {
                true => {
                    let heading_rad = (heading_deg(part.at, target.to) as f32).to_radians();
                    PlacementMove { heading_rad, ..pose }
                }
                false => PlacementMove { at: (target.to - self.scene.lattice.origin()).as_vec2(), ..pose },
            };
            self.walk.model_box(number, pose)
        });
        let Some(corners) = corners else { return Vec::new() };
        let pairs = (0..8usize).flat_map(|from| [1, 2, 4].map(|axis| (from, from | axis)));
        pairs.filter(|(from, to)| from != to).map(|(from, to)| [corners[from], corners[to]]).collect()
    }
}

/// Draws the ghost of a part over the picture in `rect`.
pub fn show_ghost(
    painter: &Painter,
    rect: Rect,
    (opened, camera): (&OpenedScene, &Camera),
    view: &ViewArea,
    (part, target): (&PickedPart, DragTarget),
) {
    let on_screen = |at: Vec3| window_point(camera, rect, at).map(|(at, _)| at);
    let edges = opened.ghost_edges(part, target);
    let edges: Vec<[Pos2; 2]> =
        edges.into_iter().filter_map(|[from, to]| Some([on_screen(from)?, on_screen(to)?])).collect();
    let frame = || -> Option<Rect> {
        let Some(GrabTarget::Label(label)) = part.grab else { return None };
        let placed = view.placed_label(label)?;
        let at = target.to - opened.scene.lattice.origin();
        let to = on_screen(at.extend(opened.ground_z(at)?).as_vec3())?;
        Some(placed.letters.translate(to - placed.ground))
    };
    let frame = frame();
    for (width, color) in STROKES {
        let stroke = Stroke::new(width, color);
        edges.iter().for_each(|&edge| {
            painter.line_segment(edge, stroke);
        });
        if let Some(frame) = frame {
            let [a, b, c, d] =
                [frame.left_top(), frame.right_top(), frame.right_bottom(), frame.left_bottom()];
            painter.add(Shape::closed_line(vec![a, b, c, d], stroke));
        }
    }
}
