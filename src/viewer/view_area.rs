//! The scene's picture in the window: pointer and keys move the camera; labels lie over it.

use egui::{
    Color32, EventFilter, FontId, Id, Painter, PointerButton, Pos2, Rect, Response, Role, Sense, Ui,
    WidgetInfo,
};
use glam::{DVec2, DVec3, Vec2, Vec3};

use crate::commands::{HeldMotion, held};
use crate::labels::{self, LabelLayer, LabelPicture, PlacedLabel};
use crate::lettering::font;
use crate::line_names::LineNames;
use crate::line_piece::LinePicture;
use crate::opened::OpenedScene;
use crate::picked_part::{DragTarget, GrabTarget};
use crate::picture_paint::picture_shape;
use crate::symbol_layer::SymbolLayer;
use sandtable_scene::scene_label::SceneLabel;
use sandtable_view::camera::Camera;
use sandtable_view::navigation::{NavigationMode, NavigationSteps};
use sandtable_walk::pick::WalkPick;

/// Degrees that dragging over the height of the picture turns.
const DEG_PER_PICTURE: f64 = 110.0;
/// Degrees a second that a held key turns.
const DEG_PER_SECOND: f64 = 50.0;
/// How many times as near a held key comes in a second.
const NEARER_PER_SECOND: f64 = 4.0;
/// How many times as fast keys are with Shift.
const FAST: f64 = 4.0;
/// The longest time of one frame that keys count, in seconds: after a pause nothing leaps.
const LONGEST_STEP_S: f64 = 0.1;
/// How much nearer a point of the wheel's way comes.
const ZOOM_PER_POINT: f64 = 0.004;

/// The view's state between frames.
#[derive(Default)]
pub struct ViewArea {
    /// The picture's size, in pixels; 0 before the first frame.
    pub size: (u32, u32),
    /// The camera of the frame before.
    pub camera: Option<Camera>,
    /// Where the picture is, in points of the window.
    pub rect: Option<Rect>,
    /// The ground under the pointer.
    pub hovered: Option<WalkPick>,
    /// The time that each frame counts; `None` for the time that it takes.
    pub fixed_step_s: Option<f64>,
    /// What is shown over the picture.
    pub shows_labels: bool,
    /// What is moved by dragging from it.
    pub grabbed_part: Option<GrabTarget>,
    /// What is being moved, and how.
    moving: Option<PartMotion>,
    grabbed: Option<DVec3>,
    /// The labels of the frame before, and the pixels of a point.
    placed: Vec<PlacedLabel>,
    scale: f32,
    steps: NavigationSteps,
    pace: f64,
    labels: LabelLayer,
    names: LineNames,
    symbols: SymbolLayer,
}

/// A part of the scene that is being moved.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PartMotion {
    /// Whether it turns where it is.
    turns: bool,
    /// Map coordinates of the ground under the pointer; `None` off the ground.
    to: Option<DVec2>,
}

/// An action of the user in the view besides moving.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViewEvent {
    /// Clicked at a pixel.
    Click(Vec2),
    /// Clicked twice at a pixel.
    DoubleClick(Vec2),
    /// Pressed Enter or the space bar.
    Enter,
    /// Dragged what was picked to a place on the ground, map coordinates, with Ctrl or without.
    Dragged {
        /// Where to.
        to: DVec2,
        /// Whether it turns toward it.
        turns: bool,
    },
}

impl ViewArea {
    /// A view with labels.
    pub fn new() -> Self {
        Self { shows_labels: true, pace: 1.0, ..Self::default() }
    }

    /// The view's place among what can have the keys.
    pub fn id() -> Id {
        Id::unique("view of the scene")
    }

    /// Forgets the drawings over the last scene.
    pub fn forget(&mut self) {
        self.labels = LabelLayer::default();
        self.symbols.clear();
        self.placed.clear();
        self.names = LineNames::default();
    }

    /// Shows the scene's picture over all of what `ui` has left, and moves the camera of `opened`.
    pub fn show(&mut self, ui: &mut Ui, opened: &mut OpenedScene) -> Option<ViewEvent> {
        let rect = ui.available_rect_before_wrap();
        self.rect = Some(rect);
        let response = ui.interact(rect, Self::id(), Sense::click_and_drag());
        ui.advance_cursor_after_rect(rect);
        response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "View of the scene"));
        let scale = ui.ctx().pixels_per_point();
        self.scale = scale;
        let side = |points: f32| (points * scale).round().clamp(1.0, 16_384.0) as u32;
        self.size = (side(rect.width()), side(rect.height()));
        let event = match opened.camera(self.size) {
            Ok(camera) => self.take_input(ui, opened, &response, &camera),
            Err(_) => None,
        };
        let seconds = self.step_s(ui);
        let has_moved = opened.advance(seconds * self.pace, std::mem::take(&mut self.steps));
        if has_moved || opened.navigator.is_on_its_way() {
            ui.ctx().request_repaint();
        }
        ui.painter().add(picture_shape(rect));
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
        self.hovered = hovered.and_then(|at| opened.pick_ground(camera, to_pixel(at)));
        let is_pressed = ui.input(|input| input.pointer.any_pressed()) && response.contains_pointer();
        if is_pressed {
            response.request_focus();
        }
        if response.has_focus() {
            let keys =
                EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
            ui.ctx().memory_mut(|memory| memory.set_focus_lock_filter(Self::id(), keys));
        }
        if response.drag_started() {
            let origin = ui.input(|input| input.pointer.press_origin()).or(pointer);
            if origin.is_some_and(|at| self.is_on_part(opened, camera, to_pixel(at))) {
                let turns = ui.input(|input| input.modifiers.command);
                self.moving = Some(PartMotion { turns, to: None });
            }
            let place = origin.and_then(|at| opened.pick_ground(camera, to_pixel(at)));
            self.grabbed = Some(place.map_or_else(|| opened.focus(camera), |place| place.world));
        }
        if let Some(moving) = &mut self.moving {
            moving.to = self.hovered.as_ref().map(|place| place.place.at).or(moving.to);
        } else if response.dragged()
            && let (Some(grabbed), Some(at)) = (self.grabbed, pointer)
        {
            let is_moved =
                !response.dragged_by(PointerButton::Primary) || ui.input(|input| input.modifiers.shift);
            if is_moved {
                opened.drag(grabbed, camera, to_pixel(at));
            } else {
                let drag = ui.input(|input| input.pointer.delta()) * scale;
                self.turn_by(opened, grabbed, DVec2::new(f64::from(drag.x), f64::from(drag.y)));
            }
        }
        if response.drag_stopped() {
            self.grabbed = None;
            if let Some(PartMotion { turns, to: Some(to) }) = self.moving.take() {
                return Some(ViewEvent::Dragged { to, turns });
            }
        }
        self.take_wheel(ui, opened, hovered.is_some(), camera);
        self.take_keys(ui, opened, response, camera);
        let clicked_at = response.interact_pointer_pos().map(to_pixel);
        match clicked_at {
            Some(pixel) if response.double_clicked() => Some(ViewEvent::DoubleClick(pixel)),
            Some(pixel) if response.clicked_by(PointerButton::Primary) => Some(ViewEvent::Click(pixel)),
            None if response.clicked() => Some(ViewEvent::Enter),
            _ => None,
        }
    }

    /// Whether a pixel shows what can be dragged.
    fn is_on_part(&self, opened: &OpenedScene, camera: &Camera, pixel: Vec2) -> bool {
        match self.grabbed_part {
            Some(GrabTarget::Model(feature)) => {
                opened.pick(camera, pixel).is_some_and(|pick| pick.place.feature == feature)
            }
            Some(GrabTarget::Label(label)) => self.label_at(pixel) == Some(label),
            None => false,
        }
    }

    /// Where what is being dragged would stand, or what it would turn to.
    pub fn dragged_to(&self) -> Option<DragTarget> {
        let PartMotion { turns, to } = self.moving?;
        Some(DragTarget { to: to?, turns })
    }

    /// A label as it is shown; `None` of one that is not at its place.
    pub fn placed_label(&self, label: usize) -> Option<&PlacedLabel> {
        self.placed.iter().find(|placed| placed.index == label)
    }

    /// The label whose letters are at a pixel, by its number.
    pub fn label_at(&self, pixel: Vec2) -> Option<usize> {
        let rect = self.rect.filter(|_| self.shows_labels)?;
        let at = rect.min + egui::vec2(pixel.x, pixel.y) / self.scale.max(0.1);
        self.placed.iter().find(|label| label.letters.contains(at)).map(|label| label.index)
    }

    /// Turns by a drag in pixels: about what was grabbed, which follows the pointer, or the head, which follows it too.
    fn turn_by(&self, opened: &mut OpenedScene, grabbed: DVec3, drag: DVec2) {
        let radians = drag / f64::from(self.size.1.max(1)) * DEG_PER_PICTURE.to_radians();
        match opened.navigator.mode() {
            NavigationMode::Orbit => opened.turn(Some(grabbed), DVec2::new(radians.x, -radians.y)),
            NavigationMode::OnFoot | NavigationMode::Flight => {
                opened.turn(None, DVec2::new(-radians.x, radians.y));
            }
        }
    }

    /// The seconds that this frame counts.
    fn step_s(&self, ui: &Ui) -> f64 {
        let taken = || f64::from(ui.input(|input| input.stable_dt)).min(LONGEST_STEP_S);
        self.fixed_step_s.unwrap_or_else(taken)
    }

    fn take_wheel(&self, ui: &Ui, opened: &mut OpenedScene, is_hovered: bool, camera: &Camera) {
        if !is_hovered {
            return;
        }
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let nearer = libm::exp(f64::from(scroll) * ZOOM_PER_POINT) * f64::from(pinch);
        if nearer != 1.0 {
            let place = self.hovered.as_ref().map(|place| place.world);
            opened.zoom(place.unwrap_or_else(|| opened.focus(camera)), nearer.recip());
            ui.ctx().request_repaint();
        }
    }

    fn take_keys(&mut self, ui: &Ui, opened: &mut OpenedScene, response: &Response, camera: &Camera) {
        if ui.ctx().text_edit_focused() {
            return;
        }
        // Arrows go from button to button where one of them has the keys.
        let has_others_focus = ui.ctx().memory(|memory| memory.focused()).is_some_and(|id| id != response.id);
        self.pace = if ui.input(|input| input.modifiers.shift) { FAST } else { 1.0 };
        let seconds = self.step_s(ui) * self.pace;
        let turn = (DEG_PER_SECOND * seconds).to_radians();
        for motion in ui.input(held) {
            ui.ctx().request_repaint();
            let turned = match motion {
                HeldMotion::TurnLeft => DVec2::new(-turn, 0.0),
                HeldMotion::TurnRight => DVec2::new(turn, 0.0),
                HeldMotion::LookUp => DVec2::new(0.0, turn * 0.6),
                HeldMotion::LookDown => DVec2::new(0.0, -turn * 0.6),
                _ => DVec2::ZERO,
            };
            if turned != DVec2::ZERO && !has_others_focus {
                opened.turn(None, turned);
            }
            match motion {
                HeldMotion::Forward => self.steps.forward += 1.0,
                HeldMotion::Backward => self.steps.forward -= 1.0,
                HeldMotion::Right => self.steps.right += 1.0,
                HeldMotion::Left => self.steps.right -= 1.0,
                HeldMotion::Up => self.steps.up += 1.0,
                HeldMotion::Down => self.steps.up -= 1.0,
                HeldMotion::ZoomIn => {
                    opened.zoom(opened.focus(camera), libm::pow(NEARER_PER_SECOND, -seconds))
                }
                HeldMotion::ZoomOut => {
                    opened.zoom(opened.focus(camera), libm::pow(NEARER_PER_SECOND, seconds))
                }
                _ => {}
            }
        }
    }

    fn show_labels(&mut self, ui: &Ui, rect: Rect, opened: &OpenedScene, camera: &Camera) {
        let painter: Painter = ui.painter_at(rect);
        let size = |label: &SceneLabel| {
            painter.layout_no_wrap(label.text.clone(), font(label.kind), Color32::BLACK).size()
        };
        let widths = |letters: &[String], font: &FontId| {
            let width = |letter: &String| {
                painter.layout_no_wrap(letter.clone(), font.clone(), Color32::BLACK).size().x
            };
            (letters.iter().map(width).collect(), font.size)
        };
        let is_seen = |at: Vec3| opened.is_seen(camera, at);
        let taken = self.symbols.show(&painter, rect, opened, camera);
        let is_at_place = |label: usize| self.names.is_at_place(label);
        let picture = LabelPicture {
            camera,
            rect,
            taken: &taken,
            is_seen: &is_seen,
            is_at_place: &is_at_place,
            size: &size,
        };
        let placed = self.labels.place(&opened.scene.labels, &picture);
        let taken: Vec<Rect> = taken.into_iter().chain(placed.iter().map(|label| label.letters)).collect();
        let picture = LinePicture { camera, rect, taken: &taken, is_seen: &is_seen, widths: &widths };
        self.names.show(&painter, opened, &picture);
        labels::paint(&painter, &opened.scene.labels, &placed);
        self.placed = placed;
        if self.labels.is_changing() || self.names.is_changing() {
            ui.ctx().request_repaint();
        }
    }
}
