//! Tools at work: clicks in the view become edits and measurements, and their lines lie over the picture.

use std::time::{Duration, Instant};

use egui::{CollapsingHeader, Color32, Painter, Pos2, Rect, RichText, Stroke, Ui};
use glam::{DVec2, Vec2};

use crate::active_tool::{ActiveTool, ToolPreview};
use crate::app::ViewerApp;
use crate::ghost::show_ghost;
use crate::measuring::{MeasureKind, Measuring, volume_text};
use crate::opened::OpenedScene;
use crate::paging::PagedTerrain;
use crate::panels::tools::{ToolEvent, ToolsPanel, tools_panel};
use crate::session::EditOutcome;
use crate::view_area::ViewEvent;
use crate::window_point::window_point;
use sandtable_editing::edit::SceneEdit;
use sandtable_editing::tool::{DrawingTool, ToolKind, ToolSettings, ToolShape};
use sandtable_view::camera::Camera;

/// How often the earth of an edit that is being drawn is computed anew while the pointer moves.
const PREVIEW_EVERY: Duration = Duration::from_millis(150);
/// Pieces that each leg of a line is drawn in, so that it follows the ground.
const LEG_PIECES: u16 = 24;
/// A double click with no tool goes to this share of the distance.
const APPROACH: f64 = 0.35;

/// How points are joined over the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ToolLine {
    /// From the first to the last.
    Line,
    /// And back to the first.
    Outline,
    /// As a line, without its vertices.
    Ring,
    /// Not at all.
    Places,
}

impl ToolLine {
    fn closed(is_closed: bool) -> Self {
        if is_closed { Self::Outline } else { Self::Line }
    }
}

impl ViewerApp {
    /// Takes what the user did in the view: with a tool it draws, without one it picks.
    pub(super) fn take_view_event(&mut self, event: ViewEvent) {
        let Some((opened, camera)) = self.opened.as_mut().zip(self.view.camera) else { return };
        match (event, &mut self.tool) {
            (ViewEvent::Click(pixel), None) => self.pick(pixel),
            (ViewEvent::DoubleClick(pixel), None) => {
                if let Some(place) = opened.pick_ground(&camera, pixel) {
                    opened.go_toward(place.world, place.place.distance_m * APPROACH);
                }
            }
            (ViewEvent::Enter, None) => {
                let (width, height) = camera.size();
                self.pick(Vec2::new(width as f32, height as f32) * 0.5);
            }
            (ViewEvent::Click(pixel), Some(_)) => {
                if let Some(place) = opened.pick_ground(&camera, pixel) {
                    self.use_tool_at(place.place.at);
                }
            }
            (ViewEvent::Dragged { to, turns }, _) => self.move_part(to, turns),
            (ViewEvent::DoubleClick(_) | ViewEvent::Enter, Some(_)) => self.finish_tool(),
        }
    }

    fn use_tool_at(&mut self, at: DVec2) {
        let edit = match (&mut self.tool, &self.session) {
            (Some(ActiveTool::Measure(measuring)), _) => {
                measuring.click(at);
                let looks_around = measuring.kind == MeasureKind::Viewshed;
                self.measure_again();
                if looks_around {
                    self.look_around(at);
                }
                return;
            }
            (Some(ActiveTool::Pick(picking)), _) => {
                picking.click(at);
                self.note_picked();
                return;
            }
            (Some(ActiveTool::Draw(tool)), Some(session)) => tool.click(at.to_array(), &session.settings),
            _ => None,
        };
        if let Some(edit) = edit {
            self.edit(&edit);
        }
    }

    fn finish_tool(&mut self) {
        let edit = match (&mut self.tool, &self.session) {
            (Some(ActiveTool::Measure(measuring)), _) => {
                measuring.finish();
                None
            }
            (Some(ActiveTool::Pick(_)), _) => {
                self.tool = None;
                None
            }
            (Some(ActiveTool::Draw(tool)), Some(session)) => tool.finish(&session.settings),
            _ => None,
        };
        if let Some(edit) = edit {
            self.edit(&edit);
        }
    }

    /// Makes an edit; says why where it cannot be made. Returns whether it was made.
    pub(super) fn edit(&mut self, edit: &SceneEdit) -> bool {
        self.refuse();
        let Some((opened, session)) = self.opened.as_mut().zip(self.session.as_mut()) else { return false };
        let outcome = session.apply(edit, opened);
        let is_made = outcome.is_ok();
        match outcome {
            Ok(outcome) => self.note_outcome(outcome),
            Err(error) => self.notices.warn(error),
        }
        is_made
    }

    /// Why nothing is edited in what is open; `None` where it is.
    pub(super) fn refusal(&self) -> Option<String> {
        self.opened.as_ref()?.paged.as_ref().map(PagedTerrain::refusal)
    }

    /// Says why something is not done to what is open.
    pub(super) fn refuse(&mut self) {
        let refusal = self.refusal();
        refusal.into_iter().for_each(|refusal| self.notices.warn(refusal));
    }

    /// Lets the window follow an edit.
    pub(super) fn note_outcome(&mut self, outcome: EditOutcome) {
        self.preview = None;
        self.renew_viewshed();
        self.analyzing.outdate();
        if outcome == EditOutcome::Rebuild {
            self.rebuild();
        }
        self.measure_again();
        self.context.request_repaint();
    }

    /// Takes a tool, or another one.
    pub(super) fn take_tool(&mut self, tool: Option<ActiveTool>) {
        (self.tool, self.preview) = (tool, None);
    }

    /// Leaves what the tool began, then the tool; returns whether there was one.
    pub(super) fn leave_tool(&mut self) -> bool {
        match self.tool.take() {
            None => false,
            Some(ActiveTool::Pick(_)) => true,
            Some(ActiveTool::Draw(tool)) => {
                self.tool = tool.is_begun().then(|| ActiveTool::Draw(DrawingTool::new(tool.kind)));
                true
            }
            Some(ActiveTool::Measure(measuring)) => {
                let is_begun = !measuring.points.is_empty();
                self.tool = is_begun.then(|| ActiveTool::Measure(Measuring::new(measuring.kind)));
                true
            }
        }
    }

    /// Takes back the last point of what is drawn or measured.
    pub(super) fn take_back_point(&mut self) {
        let is_taken = match &mut self.tool {
            Some(ActiveTool::Draw(tool)) => tool.take_back(),
            Some(ActiveTool::Measure(measuring)) => measuring.take_back(),
            Some(ActiveTool::Pick(picking)) => picking.take_back(),
            None => false,
        };
        if is_taken {
            self.preview = None;
            self.measure_again();
            self.note_picked();
        }
    }

    /// What to do next with the tool; empty without one.
    pub(super) fn tool_hint(&self) -> &'static str {
        match &self.tool {
            Some(ActiveTool::Draw(tool)) => tool.hint(),
            Some(ActiveTool::Pick(picking)) => picking.hint(),
            Some(ActiveTool::Measure(measuring)) => match measuring.kind {
                MeasureKind::Line | MeasureKind::Area => "Click along it; a double click ends it",
                MeasureKind::Sight => "Click where the eye is, then at what it looks at",
                MeasureKind::Viewshed => "Click where the eye is",
            },
            None => "",
        }
    }

    pub(super) fn show_tools(&mut self, ui: &mut Ui) {
        let hint = self.tool_hint();
        let refusal = self.refusal();
        let moved = self.session.as_ref().and_then(|session| session.moved);
        let moved = moved
            .map(|moved| format!("cut {}, filled {}", volume_text(moved.cut_m3), volume_text(moved.fill_m3)));
        let history = self.session.as_ref().map_or([false; 3], |session| {
            [session.editor.can_undo(), session.editor.can_redo(), session.editor.is_changed()]
        });
        let mut unused = ToolSettings::for_cell(1.0);
        let mut panel = ToolsPanel {
            drawing: match &self.tool {
                Some(ActiveTool::Draw(tool)) => Some(tool.kind),
                _ => None,
            },
            measuring: match &self.tool {
                Some(ActiveTool::Measure(measuring)) => Some(measuring),
                _ => None,
            },
            settings: self.session.as_mut().map_or(&mut unused, |session| &mut session.settings),
            refusal: refusal.as_deref(),
            hint,
            preview: self.preview.map(|preview| preview.preview),
            moved,
            history,
            has_viewshed: self.viewshed.is_some(),
        };
        let header =
            CollapsingHeader::new(RichText::new("Tools").strong()).id_salt("Tools").default_open(true);
        let event = header.show(ui, |ui| tools_panel(ui, &mut panel)).body_returned.flatten();
        match event {
            Some(ToolEvent::Draw(kind)) => self.take_tool(Some(ActiveTool::Draw(DrawingTool::new(kind)))),
            Some(ToolEvent::Measure(kind)) => self.take_tool(Some(ActiveTool::Measure(Measuring::new(kind)))),
            Some(ToolEvent::Away) => self.take_tool(None),
            Some(ToolEvent::ClearViewshed) => self.clear_viewshed(),
            Some(ToolEvent::Run(command)) => self.run(command),
            None => {}
        }
    }

    /// Lets the tool follow the pointer, computes the earth of its edit, and draws its lines over the picture in `rect`.
    pub(super) fn show_tool(&mut self, ui: &Ui, rect: Rect) {
        let Some((opened, camera)) = self.opened.as_ref().zip(self.view.camera) else { return };
        let hovered = self.view.hovered.as_ref().map(|place| place.place.at);
        let (points, shape, radius_m) = match &mut self.tool {
            None => {
                let part = self.picked.as_ref().and_then(|picked| picked.part.as_ref());
                let Some((part, target)) = part.zip(self.view.dragged_to()) else { return };
                let painter = ui.painter_at(rect);
                show_ghost(&painter, rect, (opened, &camera), &self.view, (part, target));
                (vec![part.at, target.to], ToolLine::Line, None)
            }
            Some(ActiveTool::Draw(tool)) => {
                tool.hover(hovered.map(|at| at.to_array()));
                let points: Vec<DVec2> = tool.drawn().into_iter().map(DVec2::from).collect();
                let radius_m = self.session.as_ref().map(|session| session.settings.radius_m);
                let radius_m = radius_m.filter(|_| tool.kind == ToolKind::Crater);
                (points, ToolLine::closed(tool.kind.shape() == ToolShape::Outline), radius_m)
            }
            Some(ActiveTool::Measure(measuring)) => {
                (measuring.points.clone(), ToolLine::closed(measuring.kind == MeasureKind::Area), None)
            }
            Some(ActiveTool::Pick(picking)) => {
                let (points, is_closed) = picking.outline(hovered);
                let shape = if picking.is_joined() { ToolLine::closed(is_closed) } else { ToolLine::Places };
                (points, shape, None)
            }
        };
        draw_line(&ui.painter_at(rect), rect, (opened, &camera), &points, shape);
        if let (Some(radius_m), Some(center)) = (radius_m, points.last()) {
            let ring: Vec<DVec2> = (0..=32u16)
                .map(|step| {
                    *center + DVec2::from_angle(f64::from(step) * std::f64::consts::TAU / 32.0) * radius_m
                })
                .collect();
            draw_line(&ui.painter_at(rect), rect, (opened, &camera), &ring, ToolLine::Ring);
        }
        self.foresee(ui);
    }

    /// Computes the earth of the edit that is being drawn, from time to time.
    fn foresee(&mut self, ui: &Ui) {
        let Some(ActiveTool::Draw(tool)) = &self.tool else { return };
        let Some((opened, session)) = self.opened.as_ref().zip(self.session.as_ref()) else { return };
        let is_fresh = self.preview.is_some_and(|preview| preview.since.elapsed() < PREVIEW_EVERY);
        if !tool.kind.moves_earth() || is_fresh {
            return;
        }
        let pending = tool.pending(&session.settings);
        let preview = pending
            .and_then(|edit| session.editor.preview(&edit, &opened.scene, opened.walk.elevations()).ok());
        self.preview = preview.map(|preview| ToolPreview { preview, since: Instant::now() });
        if self.preview.is_some() && ui.input(|input| input.pointer.is_moving()) {
            ui.ctx().request_repaint_after(PREVIEW_EVERY);
        }
    }
}

/// Draws a line over the ground, closed where it is an outline, with its vertices.
fn draw_line(
    painter: &Painter,
    rect: Rect,
    (opened, camera): (&OpenedScene, &Camera),
    points: &[DVec2],
    shape: ToolLine,
) {
    let origin = opened.scene.lattice.origin();
    let on_screen = |at: DVec2| -> Option<Pos2> {
        let z = opened.ground_z(at - origin)?;
        window_point(camera, rect, (at - origin).extend(z).as_vec3()).map(|(at, _)| at)
    };
    let closing =
        (shape == ToolLine::Outline).then(|| points.last().copied().zip(points.first().copied())).flatten();
    let legs = points.windows(2).map(|pair| (pair[0], pair[1])).chain(closing);
    let strokes =
        [Stroke::new(4.0, Color32::from_black_alpha(150)), Stroke::new(2.0, Color32::from_rgb(255, 214, 64))];
    for (from, to) in legs.filter(|_| shape != ToolLine::Places) {
        let piece = |step: u16| on_screen(from.lerp(to, f64::from(step) / f64::from(LEG_PIECES)));
        let places: Vec<Option<Pos2>> = (0..=LEG_PIECES).map(piece).collect();
        for stroke in strokes {
            for pair in places.windows(2) {
                if let (Some(from), Some(to)) = (pair[0], pair[1]) {
                    painter.line_segment([from, to], stroke);
                }
            }
        }
    }
    if shape == ToolLine::Ring {
        return;
    }
    for place in points.iter().filter_map(|&at| on_screen(at)) {
        painter.circle(place, 4.0, Color32::from_rgb(255, 214, 64), Stroke::new(1.5, Color32::BLACK));
    }
}
