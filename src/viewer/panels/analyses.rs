//! Analyses with their legends, figures and tables: the scene's own, and the one that is tried.

use std::collections::BTreeSet;

use egui::{CollapsingHeader, Color32, Grid, Rect, ScrollArea, Sense, Stroke, Ui, pos2, vec2};

use crate::analysis_listing::{AnalysisListing, ListedTable, figure_text};
use sandtable_analysis::outcome::{Hatching, ValueClass};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_picture::analysis_look::hatch_color;

/// The size of a swatch, in points.
const SWATCH: egui::Vec2 = vec2(26.0, 14.0);
/// The distance of the lines of a swatch's hatching, in points.
const APART: f32 = 4.5;
/// The ground under the tint of a swatch.
const GROUND: Color32 = Color32::from_rgb(236, 233, 222);
/// The most rows of a table that are shown.
const MOST_ROWS: usize = 100;
/// The height from which a table is scrolled, in points.
const TABLE_HEIGHT: f32 = 180.0;

/// The state that the panel shows.
pub struct AnalysesPanel<'a> {
    /// The scene's own.
    pub scene: &'a [AnalysisListing],
    /// The one that is tried.
    pub tried: Option<&'a AnalysisListing>,
    /// Whether the ground has changed since that was made.
    pub is_outdated: bool,
    /// The features that are not drawn.
    pub hidden: &'a BTreeSet<FeatureId>,
}

/// A choice in the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnalysesEvent {
    /// Shows or hides an analysis.
    Visibility(FeatureId),
    /// Writes the one that is tried into the scene.
    Keep,
    /// Takes it away.
    Discard,
}

/// Draws the analyses.
pub fn analyses_panel(ui: &mut Ui, panel: &AnalysesPanel<'_>) -> Option<AnalysesEvent> {
    let mut event = None;
    if panel.scene.is_empty() && panel.tried.is_none() {
        ui.weak("The scene has no analyses.");
    }
    for (number, listing) in panel.scene.iter().enumerate() {
        event = listing_rows(ui, listing, (number, panel.hidden)).or(event);
    }
    if let Some(tried) = panel.tried {
        ui.separator();
        ui.horizontal(|ui| {
            ui.strong("Not in the scene yet");
            let keep = ui.button("Keep").on_hover_text("Writes it into the scene as an [[analysis]] table");
            if keep.clicked() {
                event = Some(AnalysesEvent::Keep);
            }
            if ui.button("Discard").on_hover_text("Takes it away").clicked() {
                event = Some(AnalysesEvent::Discard);
            }
        });
        if panel.is_outdated {
            let color = ui.visuals().warn_fg_color;
            ui.colored_label(color, "The ground has changed since it was made: run it again.");
        }
        event = listing_rows(ui, tried, (panel.scene.len(), panel.hidden)).or(event);
    }
    event
}

/// An analysis with a box that shows or hides it.
fn listing_rows(
    ui: &mut Ui,
    listing: &AnalysisListing,
    (number, hidden): (usize, &BTreeSet<FeatureId>),
) -> Option<AnalysesEvent> {
    let mut event = None;
    ui.horizontal(|ui| {
        let mut is_shown = !hidden.contains(&listing.feature);
        let name = format!("Show {}", listing.name);
        if ui.checkbox(&mut is_shown, "").accessible_name(name).changed() {
            event = Some(AnalysesEvent::Visibility(listing.feature));
        }
        let header = CollapsingHeader::new(&listing.name).id_salt(("analysis", number)).default_open(true);
        header.show(ui, |ui| listing_body(ui, listing, number)).header_response.on_hover_text(format!(
            "{}\nMethod: {}\n{}",
            listing.kind.summary,
            listing.kind.source,
            listing.kind.limits.join("\n")
        ));
    });
    event
}

fn listing_body(ui: &mut Ui, listing: &AnalysisListing, number: usize) {
    for class in &listing.classes {
        ui.horizontal(|ui| {
            class_swatch(ui, class);
            ui.label(&class.label);
        });
    }
    for (noun, color) in &listing.lines {
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(SWATCH, Sense::hover());
            let stroke = Stroke::new(2.5, screen_color(*color));
            ui.painter_at(rect).line_segment([rect.left_center(), rect.right_center()], stroke);
            ui.label(*noun);
        });
    }
    if !listing.figures.is_empty() {
        Grid::new(("figures", number)).num_columns(2).show(ui, |ui| {
            for figure in &listing.figures {
                ui.weak(&figure.name);
                ui.label(figure_text(figure));
                ui.end_row();
            }
        });
    }
    for (index, table) in listing.tables.iter().enumerate() {
        table_rows(ui, table, (number, index));
    }
    let shows_nothing = listing.classes.is_empty() && listing.features == 0 && listing.tables.is_empty();
    if shows_nothing && listing.figures.is_empty() {
        ui.weak("It found nothing here.");
    }
    for note in &listing.notes {
        ui.weak(note);
    }
}

fn table_rows(ui: &mut Ui, table: &ListedTable, id: (usize, usize)) {
    ui.label(&table.title);
    ScrollArea::both()
        .id_salt(("scrolled", id))
        .max_height(TABLE_HEIGHT)
        .min_scrolled_height(TABLE_HEIGHT)
        .show(ui, |ui| {
            Grid::new(("table", id)).num_columns(table.columns.len()).striped(true).show(ui, |ui| {
                for heading in &table.columns {
                    ui.weak(heading);
                }
                ui.end_row();
                for row in table.rows.iter().take(MOST_ROWS) {
                    for cell in row {
                        ui.label(cell);
                    }
                    ui.end_row();
                }
            });
        });
    if table.rows.len() > MOST_ROWS {
        ui.weak(format!("and {} more: sandtable analyze prints all", table.rows.len() - MOST_ROWS));
    }
}

fn screen_color(Srgba([red, green, blue, alpha]): Srgba) -> Color32 {
    Color32::from_rgba_unmultiplied(red, green, blue, alpha)
}

/// A class as it lies over the ground: its tint and its hatching.
fn class_swatch(ui: &mut Ui, class: &ValueClass) {
    let (rect, _) = ui.allocate_exact_size(SWATCH, Sense::hover());
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 1.0, GROUND);
    painter.rect_filled(rect, 1.0, screen_color(Srgba(class.look.tint)));
    let ink = screen_color(hatch_color(class.look.tint));
    for [from, to] in hatching_lines(class.look.hatching, rect) {
        painter.line_segment([from, to], Stroke::new(1.0, ink));
    }
}

/// The lines of hatching in a rectangle, which may lead out of it.
fn hatching_lines(hatching: Hatching, rect: Rect) -> Vec<[egui::Pos2; 2]> {
    let count = |length: f32| (length / APART) as i16;
    let rising = (0..=count(rect.width() + rect.height())).map(|number| {
        let x = rect.left() + f32::from(number) * APART;
        [pos2(x, rect.top()), pos2(x - rect.height(), rect.bottom())]
    });
    let falling = (0..=count(rect.width() + rect.height())).map(|number| {
        let x = rect.right() - f32::from(number) * APART;
        [pos2(x, rect.top()), pos2(x + rect.height(), rect.bottom())]
    });
    let rows = (1..=count(rect.height())).map(|number| rect.top() + f32::from(number) * APART);
    match hatching {
        Hatching::None => Vec::new(),
        Hatching::Single => rising.collect(),
        Hatching::Crossed => rising.chain(falling).collect(),
        Hatching::Level => rows.map(|y| [pos2(rect.left(), y), pos2(rect.right(), y)]).collect(),
        Hatching::Dots => rows
            .flat_map(|y| {
                (0..=count(rect.width())).map(move |number| {
                    let at = pos2(rect.left() + f32::from(number) * APART, y);
                    [at, at + vec2(1.2, 0.0)]
                })
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use sandtable_analysis::outcome::Figure;

    fn listing(name: &str, feature: u32) -> AnalysisListing {
        let class =
            |from: f32, label: &str, hatching| ValueClass::new(from, label, [200, 0, 0, 90], hatching);
        AnalysisListing {
            name: name.to_owned(),
            kind: sandtable_catalog::kind("obstacles").expect("a kind"),
            feature: FeatureId(feature),
            classes: vec![
                class(1.0, "restricted", Hatching::Single),
                class(2.0, "severely restricted", Hatching::Crossed),
            ],
            lines: [("stream", Srgba::opaque(0, 0, 255))].into(),
            figures: vec![Figure::new("unrestricted", 12.0, "km²")],
            features: 1,
            tables: vec![ListedTable {
                title: "Legs".into(),
                columns: vec!["to".into()],
                rows: vec![vec!["the pass".into()]],
            }],
            notes: vec!["nothing is known of woods".into()],
        }
    }

    struct PanelTest {
        hidden: BTreeSet<FeatureId>,
        events: Vec<AnalysesEvent>,
    }

    #[test]
    fn legends_figures_and_tables_are_listed_and_each_is_hidden_by_its_box() {
        let draw = |ui: &mut Ui, state: &mut PanelTest| {
            let (own, tried) = ([listing("Overlay", 7)], listing("Tried", 9));
            let panel =
                AnalysesPanel { scene: &own, tried: Some(&tried), is_outdated: true, hidden: &state.hidden };
            state.events.extend(analyses_panel(ui, &panel));
        };
        let state = PanelTest { hidden: BTreeSet::new(), events: Vec::new() };
        let mut harness = Harness::builder().with_size([360.0, 900.0]).build_ui_state(draw, state);
        for label in
            ["severely restricted", "stream", "12 km²", "Legs", "the pass", "nothing is known of woods"]
        {
            assert_eq!(harness.query_all_by_label(label).count(), 2, "{label}");
        }
        assert!(harness.query_by_label_contains("The ground has changed").is_some());
        for label in ["Show Overlay", "Show Tried", "Keep", "Discard"] {
            harness.get_by_label(label).click();
            harness.run();
        }
        let shown = |id| AnalysesEvent::Visibility(FeatureId(id));
        assert_eq!(harness.state().events, [shown(7), shown(9), AnalysesEvent::Keep, AnalysesEvent::Discard]);
    }

    #[test]
    fn hatchings_of_swatches_differ() {
        let rect = Rect::from_min_size(pos2(0.0, 0.0), SWATCH);
        let all = [Hatching::None, Hatching::Single, Hatching::Crossed, Hatching::Dots, Hatching::Level];
        let drawn = all.map(|hatching| hatching_lines(hatching, rect));
        for (index, lines) in drawn.iter().enumerate() {
            assert!(drawn[..index].iter().all(|other| other != lines), "{index}");
        }
    }
}
