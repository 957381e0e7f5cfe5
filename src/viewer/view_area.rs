//! The scene's picture in the window: pointer and keys move the camera; labels lie over it.

use egui::{Color32, EventFilter, Id, Painter, Pos2, Rect, Response, Role, Sense, TextureId, Ui, WidgetInfo};
use egui::{PointerButton, pos2};
use glam::{Vec2, Vec3};

use crate::scene::SceneLabel;
use crate::view::camera::Camera;
use crate::viewer::commands::{HeldMotion, held};
use crate::viewer::labels::{self, LabelLayer, LabelPicture};
use crate::viewer::opened::OpenedScene;

/// How much nearer a point of the wheel's way comes.
const ZOOM_PER_POINT: f32 = 0.004;
/// A double click goes to this share of the distance.
const APPROACH: f32 = 0.35;

/// The view's state between frames.
#[derive(Default)]
pub struct ViewArea {
    /// The picture's size, in pixels; 0 before the first frame.
    pub size: (u32, u32),
    /// The camera of the frame before.
    pub camera: Option<Camera>,
    /// The place under the pointer.
    pub hovered: Option<Vec3>,
    /// What is shown over the picture.
    pub shows_labels: bool,
    grabbed: Option<Vec3>,
    labels: LabelLayer,
}

/// What the user did in the view besides moving.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViewEvent {
    /// Clicked at a pixel.
    Pick(Vec2),
}

impl ViewArea {
    /// A view with labels.
    pub fn new() -> Self {
        Self { shows_labels: true, ..Self::default() }
    }

    /// The view's place among what can have the keys.
    pub fn id() -> Id {
        Id::unique("view of the scene")
    }

    /// Draws the picture `texture` over all of what `ui` has left, and moves the camera of `opened`.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        opened: &mut OpenedScene,
        texture: Option<TextureId>,
    ) -> Option<ViewEvent> {
        let rect = ui.available_rect_before_wrap();
        let response = ui.interact(rect, Self::id(), Sense::click_and_drag());
        ui.advance_cursor_after_rect(rect);
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "View of the scene"));
        let scale = ui.ctx().pixels_per_point();
        let side = |points: f32| (points * scale).round().clamp(1.0, 16_384.0) as u32;
        self.size = (side(rect.width()), side(rect.height()));
        let event = match opened.camera(self.size) {
            Ok(camera) => self.take_input(ui, opened, &response, &camera),
            Err(_) => None,
        };
        let seconds = ui.input(|input| input.stable_dt);
        opened.advance(seconds);
        if opened.steering.is_under_way() {
            ui.ctx().request_repaint();
        }
        if let Some(texture) = texture {
            let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(texture, rect, whole, Color32::WHITE);
        }
        if let (true, Ok(camera)) = (self.shows_labels, opened.camera(self.size)) {
            self.show_labels(ui, rect, opened, &camera);
        }
        event
    }

    fn take_input(
        &mut self,
        ui: &Ui,
        opened: &mut OpenedScene,
        response: &Response,
        camera: &Camera,
    ) -> Option<ViewEvent> {
        let scale = ui.ctx().pixels_per_point();
        let to_pixel = |at: Pos2| {
            let offset = (at - response.rect.min) * scale;
            Vec2::new(offset.x, offset.y)
        };
        let pointer = ui.input(|input| input.pointer.latest_pos());
        let hovered = response.contains_pointer().then_some(pointer).flatten();
        self.hovered = hovered.and_then(|at| opened.ground_at(camera, to_pixel(at)));
        if response.drag_started()
            || ui.input(|input| input.pointer.any_pressed()) && response.contains_pointer()
        {
            response.request_focus();
        }
        let keys = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        if response.has_focus() {
            ui.ctx().memory_mut(|memory| memory.set_focus_lock_filter(Self::id(), keys));
        }
        if response.drag_started() {
            let origin = ui.input(|input| input.pointer.press_origin()).or(pointer);
            let place = origin.and_then(|at| opened.ground_at(camera, to_pixel(at)));
            self.grabbed = Some(place.unwrap_or_else(|| opened.focus(camera)));
        }
        if response.dragged()
            && let (Some(grabbed), Some(at)) = (self.grabbed, pointer)
        {
            let drag = ui.input(|input| input.pointer.delta()) * scale;
            let drag = Vec2::new(drag.x, drag.y);
            let is_moved =
                !response.dragged_by(PointerButton::Primary) || ui.input(|input| input.modifiers.shift);
            if is_moved {
                let to = to_pixel(at);
                opened.steering.pan(grabbed, camera.ray_through(to - drag), camera.ray_through(to));
            } else if drag != Vec2::ZERO {
                opened.steering.turn(drag, camera.size().1 as f32, Some(grabbed));
            }
        }
        if response.drag_stopped() {
            self.grabbed = None;
        }
        self.take_wheel(ui, opened, hovered.is_some(), camera);
        self.take_keys(ui, opened, response, camera);
        let clicked = response.clicked().then(|| response.interact_pointer_pos());
        if response.double_clicked()
            && let Some(place) = self.hovered
        {
            let distance_m = camera.eye().distance(place) * APPROACH;
            opened.steering.go_toward(place, distance_m);
        }
        // Enter and the space bar click the middle.
        clicked.map(|at| ViewEvent::Pick(to_pixel(at.unwrap_or(response.rect.center()))))
    }

    fn take_wheel(&self, ui: &Ui, opened: &mut OpenedScene, is_hovered: bool, camera: &Camera) {
        if !is_hovered {
            return;
        }
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let zoom = libm::expf(scroll * ZOOM_PER_POINT) * pinch;
        if zoom != 1.0 {
            let place = self.hovered.unwrap_or_else(|| opened.focus(camera));
            opened.steering.zoom(place, zoom);
            ui.ctx().request_repaint();
        }
    }

    fn take_keys(&self, ui: &Ui, opened: &mut OpenedScene, response: &Response, camera: &Camera) {
        if ui.ctx().text_edit_focused() {
            return;
        }
        let mut motions = ui.input(held);
        // Arrows go from button to button where one of them has the keys.
        let has_others_focus = ui.ctx().memory(|memory| memory.focused()).is_some_and(|id| id != response.id);
        if has_others_focus {
            let is_letter = |motion: &HeldMotion| {
                use HeldMotion::{LookDown, LookUp, TurnLeft, TurnRight};
                !matches!(motion, TurnLeft | TurnRight | LookUp | LookDown)
            };
            motions.retain(is_letter);
        }
        if motions.is_empty() {
            return;
        }
        let (is_fast, seconds) = ui.input(|input| (input.modifiers.shift, input.stable_dt));
        let focus = opened.focus(camera);
        let lattice = std::sync::Arc::clone(opened.walk.lattice());
        let ground = |at: Vec3| crate::viewer::ground_ray::ground_z(&lattice, at);
        opened.steering.hold(&motions, is_fast, seconds, focus, &ground);
        ui.ctx().request_repaint();
    }

    fn show_labels(&mut self, ui: &Ui, rect: Rect, opened: &OpenedScene, camera: &Camera) {
        let painter: Painter = ui.painter_at(rect);
        let size = |label: &SceneLabel| {
            painter.layout_no_wrap(label.text.clone(), labels::font(label.kind), Color32::BLACK).size()
        };
        let is_seen = |at: Vec3| opened.is_seen(camera, at);
        let picture = LabelPicture { camera, rect, is_seen: &is_seen, size: &size };
        let placed = self.labels.place(&opened.scene.labels, &picture);
        labels::paint(&painter, &opened.scene.labels, &placed);
        if self.labels.is_changing() {
            ui.ctx().request_repaint();
        }
    }
}
