//! The form of a new analysis: its kind, and a field for each of the kind's parameters.

use egui::{ComboBox, Response, TextEdit, Ui};

use sandtable_catalog::kind::{AnalysisFamily, AnalysisKind};
use sandtable_catalog::kinds;
use sandtable_catalog::parameter::{
    AnalysisParameter, PHASE_PREFIX, ParameterDefault, ParameterForm, SOURCE_GROUND,
};
use sandtable_editing::analysis_draft::{AnalysisDraft, DraftField};

/// The width of a field, in points.
const FIELD_WIDTH: f32 = 140.0;

/// An analysis that is being made.
#[derive(Clone, Copy)]
pub struct RunningAnalysis<'a> {
    /// What is being done.
    pub step: &'a str,
    /// Since when, seconds.
    pub seconds: u64,
    /// Which share of it is done, 0..=1, where it says so.
    pub share: Option<f64>,
}

/// The state that the form shows.
pub struct AnalysisForm<'a> {
    /// What is being prepared.
    pub draft: Option<&'a mut AnalysisDraft>,
    /// The names of vehicles.
    pub vehicles: &'a [String],
    /// The names of the scene's phases.
    pub phases: &'a [String],
    /// What is wrong beside the fields; empty for nothing.
    pub problem: &'a str,
    /// What is being made; `None` while nothing is.
    pub running: Option<RunningAnalysis<'a>>,
    /// The parameter whose positions are picked on the ground.
    pub picking: Option<&'a str>,
}

/// A choice in the form.
#[derive(Clone, Copy, Debug)]
pub enum AnalysisFormEvent {
    /// Prepares an analysis of a kind.
    Kind(&'static AnalysisKind),
    /// Makes it.
    Run,
    /// Ends making it.
    Stop,
    /// Picks positions of a parameter on the ground.
    Pick(&'static AnalysisParameter),
    /// Picks no more.
    Away,
}

/// Draws the form.
pub fn analysis_form(ui: &mut Ui, form: &mut AnalysisForm<'_>) -> Option<AnalysisFormEvent> {
    let chosen = form.draft.as_ref().map(|draft| draft.kind);
    let mut event = kind_choice(ui, chosen).map(AnalysisFormEvent::Kind);
    let Some(draft) = form.draft.as_deref_mut() else { return event };
    ui.label(draft.kind.summary);
    ui.collapsing("Method and limits", |ui| {
        ui.label(format!("Method: {}", draft.kind.source));
        for limit in draft.kind.limits {
            ui.weak(*limit);
        }
    });
    ui.horizontal(|ui| {
        let label = ui.label("name").on_hover_text("Its name in the legend.");
        let field =
            TextEdit::singleline(&mut draft.name).hint_text(draft.kind.title).desired_width(FIELD_WIDTH);
        ui.add(field).labelled_by(label.id);
    });
    for field in &mut draft.fields {
        event = field_rows(ui, field, (form.vehicles, form.phases, form.picking)).or(event);
    }
    if !form.problem.is_empty() {
        ui.colored_label(ui.visuals().error_fg_color, form.problem);
    }
    ui.horizontal(|ui| match form.running {
        Some(RunningAnalysis { step, seconds, share }) => {
            ui.spinner();
            let share = share.map(|share| format!(" {:.0} %", (share * 100.0).floor())).unwrap_or_default();
            ui.label(format!("{step}{share}, {seconds} s"));
            if ui.button("Stop").clicked() {
                event = Some(AnalysisFormEvent::Stop);
            }
        }
        None => {
            if ui.button("Run").clicked() {
                event = Some(AnalysisFormEvent::Run);
            }
        }
    });
    event
}

/// The kinds, by family.
fn kind_choice(ui: &mut Ui, chosen: Option<&'static AnalysisKind>) -> Option<&'static AnalysisKind> {
    let mut choice = None;
    ui.horizontal(|ui| {
        let label = ui.label("kind");
        let text = chosen.map_or("choose one", |kind| kind.title);
        let combo = ComboBox::from_id_salt("kind of analysis").selected_text(text).width(200.0);
        let combo = combo.height(420.0).show_ui(ui, |ui| {
            for family in AnalysisFamily::ALL {
                ui.weak(family.title());
                for kind in kinds().filter(|kind| kind.family == family) {
                    let is_chosen = chosen.is_some_and(|chosen| chosen.name == kind.name);
                    if ui.selectable_label(is_chosen, kind.title).on_hover_text(kind.summary).clicked() {
                        choice = Some(kind);
                    }
                }
            }
        });
        combo.response.labelled_by(label.id);
    });
    choice
}

/// The field of a parameter, and what is wrong with it.
fn field_rows(
    ui: &mut Ui,
    field: &mut DraftField,
    (vehicles, phases, picking): (&[String], &[String], Option<&str>),
) -> Option<AnalysisFormEvent> {
    let mut event = None;
    let parameter = field.parameter;
    ui.horizontal(|ui| {
        let label = ui.label(parameter.name).on_hover_text(parameter.doc);
        let response = match parameter.form {
            ParameterForm::Word(words) => choice(ui, field, words.iter().copied()),
            ParameterForm::Vehicle => choice(ui, field, vehicles.iter().map(String::as_str)),
            _ => {
                let text = TextEdit::singleline(&mut field.text).hint_text(hint(parameter));
                let response = ui.add(text.desired_width(FIELD_WIDTH));
                if response.changed() {
                    field.problem = None;
                }
                response
            }
        };
        response.labelled_by(label.id).on_hover_text(parameter.doc);
        if parameter.form == ParameterForm::Ground {
            ground_choice(ui, field, phases);
        }
        let allowed = allowed(parameter);
        if !allowed.is_empty() {
            ui.weak(allowed);
        }
        if parameter.form.is_positions() {
            let is_picked = picking == Some(parameter.name);
            let button = ui.selectable_label(is_picked, "Pick").on_hover_text("Click on the ground");
            let button = button.accessible_name(format!("Pick {}", parameter.name));
            if button.clicked() {
                let chosen = AnalysisFormEvent::Pick(parameter);
                event = Some(if is_picked { AnalysisFormEvent::Away } else { chosen });
            }
        }
    });
    if let Some(problem) = &field.problem {
        ui.colored_label(ui.visuals().error_fg_color, problem);
    }
    event
}

/// A choice among the grounds that a scene has itself: before its earthworks, and in its phases.
fn ground_choice(ui: &mut Ui, field: &mut DraftField, phases: &[String]) {
    let button = ui.menu_button("Choose", |ui| {
        let of_phases = phases.iter().map(|phase| format!("{PHASE_PREFIX}{phase}"));
        for ground in std::iter::once(SOURCE_GROUND.to_owned()).chain(of_phases) {
            if ui.button(&ground).clicked() {
                field.set(ground);
                ui.close();
            }
        }
    });
    button.response.on_hover_text("The elevation before the scene's earthworks, or the ground of a phase");
}

/// A choice among words.
fn choice<'a>(ui: &mut Ui, field: &mut DraftField, words: impl Iterator<Item = &'a str>) -> Response {
    let combo = ComboBox::from_id_salt(("word of", field.parameter.name)).selected_text(field.text.as_str());
    let combo = combo.show_ui(ui, |ui| {
        for word in words {
            if ui.selectable_label(field.text == word, word).clicked() {
                field.set(word.to_owned());
            }
        }
    });
    combo.response
}

/// What holds where a field is empty.
fn hint(parameter: &AnalysisParameter) -> &'static str {
    match (parameter.default, parameter.form) {
        (ParameterDefault::Required, ParameterForm::Ground) => "a file, source, or phase:NAME",
        (ParameterDefault::Required, _) => "needed",
        _ => parameter.default_text(),
    }
}

/// The unit of a parameter's numbers, and their range.
fn allowed(parameter: &AnalysisParameter) -> String {
    match parameter.form {
        ParameterForm::Number { least, greatest } | ParameterForm::Numbers { least, greatest } => {
            format!("{} {least} to {greatest}", parameter.unit).trim_start().to_owned()
        }
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    struct FormTest {
        draft: Option<AnalysisDraft>,
        running: bool,
        events: Vec<AnalysisFormEvent>,
    }

    fn form(draft: Option<AnalysisDraft>, running: bool) -> Harness<'static, FormTest> {
        let draw = |ui: &mut Ui, state: &mut FormTest| {
            let vehicles = ["lorry".to_owned(), "tracked".to_owned()];
            let mut form = AnalysisForm {
                draft: state.draft.as_mut(),
                vehicles: &vehicles,
                phases: &["morning".to_owned(), "noon".to_owned()],
                problem: "",
                running: state.running.then_some(RunningAnalysis {
                    step: "analyzing",
                    seconds: 3,
                    share: Some(0.379),
                }),
                picking: None,
            };
            state.events.extend(analysis_form(ui, &mut form));
        };
        let state = FormTest { draft, running, events: Vec::new() };
        Harness::builder().with_size([420.0, 900.0]).build_ui_state(draw, state)
    }

    #[test]
    fn kinds_stand_by_family_and_one_is_chosen() {
        let mut harness = form(None, false);
        harness.get_by_label("kind").click();
        harness.run();
        harness.get_by_label("Observation and fire");
        harness.get_by_label("Slope").click();
        harness.run();
        let chosen = harness.state().events.first().copied();
        assert!(matches!(chosen, Some(AnalysisFormEvent::Kind(kind)) if kind.name == "slope"), "{chosen:?}");
    }

    #[test]
    fn every_kind_has_its_fields_with_ranges_units_and_a_pick_of_positions() {
        for kind in kinds() {
            let harness = form(Some(AnalysisDraft::new(kind)), false);
            for parameter in kind.all_parameters() {
                assert!(harness.query_all_by_label(parameter.name).count() > 0, "{}", parameter.name);
            }
            assert!(harness.query_by_label("Pick extent").is_some(), "{}", kind.name);
            harness.get_by_label("Run");
        }
        let penalty = kinds().flat_map(|kind| kind.parameters).find(|known| known.name == "apart_m");
        assert_eq!(penalty.map(allowed), Some("m 0 to 100000".to_owned()));
    }

    #[test]
    fn a_vehicle_is_chosen_and_what_is_wrong_stands_at_its_field() {
        let mut draft = AnalysisDraft::new(sandtable_catalog::kind("time").expect("a kind"));
        draft.field_mut("from").expect("there").problem = Some("`from`: state it".to_owned());
        let mut harness = form(Some(draft), false);
        harness.get_by_label("`from`: state it");
        harness.get_by_label("vehicle").click();
        harness.run();
        harness.get_by_label("lorry").click();
        harness.run();
        let draft = harness.state_mut().draft.as_mut().expect("there");
        assert_eq!(draft.field_mut("vehicle").expect("there").text, "lorry");
        harness.get_by_label("Pick from").click();
        harness.run();
        let events = &harness.state().events;
        let is_pick = |event: &AnalysisFormEvent| matches!(event, AnalysisFormEvent::Pick(known) if known.name == "from");
        assert!(events.iter().any(is_pick), "{events:?}");
    }

    #[test]
    fn a_phase_to_compare_with_is_chosen() {
        let cut_fill = AnalysisDraft::new(sandtable_catalog::kind("cut-fill").expect("a kind"));
        let mut harness = form(Some(cut_fill), false);
        harness.get_by_label("Choose").click();
        harness.run();
        harness.get_by_label("source");
        harness.get_by_label("phase:noon").click();
        harness.run();
        let draft = harness.state_mut().draft.as_mut().expect("there");
        assert_eq!(draft.field_mut("against").expect("there").text, "phase:noon");
    }

    #[test]
    fn while_an_analysis_is_made_its_step_is_told_and_it_is_stopped() {
        let slope = AnalysisDraft::new(sandtable_catalog::kind("slope").expect("a kind"));
        let mut harness = form(Some(slope), true);
        harness.get_by_label("analyzing 37 %, 3 s");
        assert!(harness.query_by_label("Run").is_none());
        harness.get_by_label("Stop").click();
        harness.run_steps(2);
        let events = &harness.state().events;
        assert!(matches!(events[..], [AnalysisFormEvent::Stop]), "{events:?}");
    }
}
