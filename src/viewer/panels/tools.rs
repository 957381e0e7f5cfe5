//! The tools: what is drawn or measured by clicks, its sizes, and the history of edits.

use egui::{DragValue, Grid, Rect, Sense, Stroke, TextEdit, Ui, WidgetInfo, pos2, vec2};

use crate::commands::{ViewCommand, key_text};
use crate::measuring::{MeasureKind, Measuring, area_text, volume_text};
use sandtable_base::message::choice::Choice;
use sandtable_editing::effect::EditPreview;
use sandtable_editing::tool::{ToolKind, ToolSettings};
use sandtable_raster::answer::Answer;
use sandtable_terrain::profile::ProfileStation;

/// The height of a profile, in points.
const PROFILE_HEIGHT: f32 = 90.0;

/// The state that the panel shows of the tools.
pub struct ToolsPanel<'a> {
    /// The tool that draws.
    pub drawing: Option<ToolKind>,
    /// The measurement.
    pub measuring: Option<&'a Measuring>,
    /// The sizes of tools.
    pub settings: &'a mut ToolSettings,
    /// What to do next with the tool.
    pub hint: &'a str,
    /// The earth that the edit would move that is being drawn.
    pub preview: Option<EditPreview>,
    /// What the last edit moved.
    pub moved: Option<String>,
    /// Whether there is an edit to undo, to redo, and something to save.
    pub history: [bool; 3],
    /// Whether what is seen from a place is tinted.
    pub has_viewshed: bool,
    /// Why nothing is drawn here; `None` where it is.
    pub refusal: Option<&'a str>,
}

/// A choice in the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToolEvent {
    /// Draws with a tool.
    Draw(ToolKind),
    /// Measures.
    Measure(MeasureKind),
    /// Puts the tool away.
    Away,
    /// Takes the tint of a viewshed away.
    ClearViewshed,
    /// A command of the history.
    Run(ViewCommand),
}

/// Draws the tools.
pub fn tools_panel(ui: &mut Ui, panel: &mut ToolsPanel<'_>) -> Option<ToolEvent> {
    let mut event = None;
    ui.horizontal(|ui| {
        let commands =
            [("Undo", ViewCommand::Undo), ("Redo", ViewCommand::Redo), ("Save", ViewCommand::Save)];
        for ((text, command), is_possible) in commands.into_iter().zip(panel.history) {
            ui.add_enabled_ui(is_possible, |ui| {
                if ui.button(text).on_hover_text(key_text(command)).clicked() {
                    event = Some(ToolEvent::Run(command));
                }
            });
        }
        if panel.history[2] {
            ui.weak("not saved");
        }
    });
    ui.weak("Dig and draw");
    ui.add_enabled_ui(panel.refusal.is_none(), |ui| {
        ui.horizontal_wrapped(|ui| {
            for choice in ToolKind::CHOICES {
                let is_chosen = panel.drawing == Some(choice.value);
                if ui.selectable_label(is_chosen, choice.word).on_hover_text(choice.meaning).clicked() {
                    event = Some(if is_chosen { ToolEvent::Away } else { ToolEvent::Draw(choice.value) });
                }
            }
        });
    });
    if let Some(refusal) = panel.refusal {
        ui.label(refusal);
    }
    if let Some(kind) = panel.drawing {
        sizes(ui, kind, panel.settings);
        ui.label(panel.hint);
        if let Some(preview) = panel.preview {
            let [cut, fill] = [preview.cut_m3, preview.fill_m3].map(volume_text);
            ui.label(format!("would cut {cut}, fill {fill}, on {}", area_text(preview.area_m2)));
            if !preview.is_resolved {
                ui.colored_label(
                    ui.visuals().warn_fg_color,
                    "too small for the posts of this ground to show",
                );
            }
        }
    }
    if let Some(moved) = &panel.moved {
        ui.label(moved);
    }
    ui.weak("Measure");
    ui.horizontal_wrapped(|ui| {
        for (name, kind) in MeasureKind::ALL {
            let is_chosen = panel.measuring.is_some_and(|measuring| measuring.kind == kind);
            let is_possible = panel.refusal.is_none() || kind != MeasureKind::Viewshed;
            ui.add_enabled_ui(is_possible, |ui| {
                if ui.selectable_label(is_chosen, name).clicked() {
                    event = Some(if is_chosen { ToolEvent::Away } else { ToolEvent::Measure(kind) });
                }
            });
        }
    });
    if panel.has_viewshed && ui.button("Clear viewshed").clicked() {
        event = Some(ToolEvent::ClearViewshed);
    }
    if let Some(measuring) = panel.measuring {
        if measuring.facts.is_empty() {
            ui.label("Click on the ground");
        }
        measuring.facts.iter().for_each(|fact| {
            ui.label(fact);
        });
        if !measuring.profile.is_empty() {
            profile_chart(ui, &measuring.profile);
        }
    }
    event
}

fn sizes(ui: &mut Ui, kind: ToolKind, settings: &mut ToolSettings) {
    Grid::new("sizes").num_columns(2).show(ui, |ui| {
        let mut size = |name: &str, value: &mut f64, unit: &str| {
            let label = ui.label(name);
            let range = 0.1..=10_000.0;
            let speed = (*value * 0.02).max(0.05);
            ui.add(DragValue::new(value).range(range).speed(speed).suffix(unit)).labelled_by(label.id);
            ui.end_row();
        };
        match kind {
            ToolKind::Crater => size("Radius", &mut settings.radius_m, " m"),
            ToolKind::Trench => size("Width", &mut settings.trench_m, " m"),
            ToolKind::Track => size("Gauge", &mut settings.gauge_m, " m"),
            ToolKind::Raise => size("Height", &mut settings.height_m, " m"),
            ToolKind::Road => size("Width", &mut settings.road_m, " m"),
            ToolKind::River => size("Width", &mut settings.river_m, " m"),
            ToolKind::Level | ToolKind::Area | ToolKind::Model | ToolKind::Label => {}
        }
        let mut word = |name: &str, value: &mut String| {
            let label = ui.label(name);
            ui.add(TextEdit::singleline(value).desired_width(150.0)).labelled_by(label.id);
            ui.end_row();
        };
        match kind {
            ToolKind::Area => word("Cover", &mut settings.cover),
            ToolKind::Model => word("Model", &mut settings.model),
            ToolKind::Label => word("Text", &mut settings.text),
            _ => {}
        }
        if kind == ToolKind::Model {
            let label = ui.label("Heading");
            ui.add(DragValue::new(&mut settings.heading_deg).range(0.0..=360.0).suffix("°"))
                .labelled_by(label.id);
            ui.end_row();
        }
    });
}

/// The ground along a line, from its start at the left.
fn profile_chart(ui: &mut Ui, profile: &[ProfileStation]) {
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), PROFILE_HEIGHT), Sense::hover());
    let heights = || profile.iter().filter_map(|station| station.ground.height_m());
    let (low, high) = heights()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), height| (low.min(height), high.max(height)));
    let text = format!("Profile from {low:.0} to {high:.0} m");
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &text));
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, ui.visuals().extreme_bg_color);
    let length = profile.last().map_or(1.0, |last| last.station_m).max(1e-6);
    let span = (high - low).max(1e-6);
    let inner: Rect = rect.shrink(4.0);
    let place = |station: &ProfileStation| match station.ground {
        Answer::Height(height) => Some(pos2(
            inner.left() + (station.station_m / length) as f32 * inner.width(),
            inner.bottom() - ((height - low) / span) as f32 * inner.height(),
        )),
        _ => None,
    };
    let stroke = Stroke::new(1.5, ui.visuals().text_color());
    for pair in profile.windows(2) {
        if let (Some(from), Some(to)) = (place(&pair[0]), place(&pair[1])) {
            painter.line_segment([from, to], stroke);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    #[test]
    fn a_tool_is_taken_put_away_and_its_sizes_are_named() {
        struct ToolsTest {
            drawing: Option<ToolKind>,
            settings: ToolSettings,
        }
        let draw = |ui: &mut Ui, state: &mut ToolsTest| {
            let mut panel = ToolsPanel {
                drawing: state.drawing,
                measuring: None,
                settings: &mut state.settings,
                hint: "Click on the ground",
                preview: None,
                moved: None,
                history: [true, false, true],
                has_viewshed: false,
                refusal: None,
            };
            match tools_panel(ui, &mut panel) {
                Some(ToolEvent::Draw(kind)) => state.drawing = Some(kind),
                Some(ToolEvent::Away) => state.drawing = None,
                _ => {}
            }
        };
        let state = ToolsTest { drawing: None, settings: ToolSettings::for_cell(30.0) };
        let mut harness = Harness::new_ui_state(draw, state);
        assert!(harness.query_by_label("Radius").is_none());
        harness.get_by_label("crater").click();
        harness.run();
        assert_eq!(harness.state().drawing, Some(ToolKind::Crater));
        harness.get_by_label("Radius");
        harness.get_by_label("not saved");
        harness.get_by_label("crater").click();
        harness.run();
        assert_eq!(harness.state().drawing, None);
    }
}
