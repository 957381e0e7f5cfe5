//! The phases of a scene: one of them is shown, and another is built as edits are, on a thread.

use egui::{ComboBox, Ui};

use crate::app::ViewerApp;
use crate::commands::{ViewCommand, key_text};
use crate::loading::opening_error;

impl ViewerApp {
    /// The names of the scene's phases, in its order, and the number of the one that is shown; `None` where it has none.
    fn phases(&self) -> Option<(Vec<String>, usize)> {
        let editor = &self.session.as_ref()?.editor;
        let phases = &editor.document().phases;
        let names: Vec<String> = phases.iter().map(|phase| phase.name.to_string()).collect();
        let shown = editor.source().phase.as_ref();
        let number = shown.and_then(|shown| names.iter().position(|name| name == shown)).unwrap_or(0);
        (!names.is_empty()).then_some((names, number))
    }

    /// Shows the phase of a name.
    pub(super) fn show_phase(&mut self, name: &str) {
        let Some(session) = &mut self.session else { return self.refuse() };
        if let Err(error) = session.editor.show_phase(name) {
            return self.notices.warn(opening_error(&error));
        }
        self.analyzing.outdate();
        self.rebuild();
    }

    /// Shows the phase so many places after the one that is shown, or before it where `steps` is negative; after the last
    /// comes the first.
    pub(super) fn step_phase(&mut self, steps: isize) {
        let Some((names, number)) = self.phases() else { return };
        if names.len() > 1 {
            let stepped = (number as isize).wrapping_add(steps).rem_euclid(names.len() as isize);
            self.show_phase(&names[stepped as usize]);
        }
    }

    /// The choice of a phase, where the scene has some; the one that is chosen.
    pub(super) fn phase_choice(&self, ui: &mut Ui) -> Option<String> {
        let (names, number) = self.phases()?;
        let mut chosen = None;
        let combo = ComboBox::from_id_salt("phase").selected_text(&names[number]);
        let combo = combo.show_ui(ui, |ui| {
            for (index, name) in names.iter().enumerate() {
                if ui.selectable_label(index == number, name).clicked() && index != number {
                    chosen = Some(name.clone());
                }
            }
        });
        combo.response.accessible_name("Phase").on_hover_text(format!(
            "The phase of the scene. Keys: {}, {}",
            key_text(ViewCommand::PreviousPhase),
            key_text(ViewCommand::NextPhase)
        ));
        chosen
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use egui::{Key, Modifiers};
    use egui_kittest::kittest::Queryable;

    use crate::app_tests::{AppHarness, app, key, until, window};

    fn shown(harness: &mut AppHarness) -> (Option<String>, usize) {
        until(harness, |app| !app.is_busy());
        harness.run_steps(2);
        let app = app(harness);
        let phase = app.session.as_ref().expect("open").editor.source().phase.clone();
        (phase, app.opened.as_ref().expect("open").scene.features.len())
    }

    #[test]
    fn a_phase_is_chosen_and_stepped_to_and_built_beside_the_frames() {
        let mut harness = window(Some(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/phases.toml"))));
        let (first, morning) = shown(&mut harness);
        assert_eq!(first, None, "the first");
        harness.get_by_label("Phase").click();
        harness.run_steps(3);
        harness.get_by_label("noon").click();
        harness.step();
        harness.step();
        let (phase, noon) = shown(&mut harness);
        assert_eq!(phase.as_deref(), Some("noon"));
        assert!(noon != morning, "a bridge more: {noon}, {morning}");
        key(&mut harness, Modifiers::NONE, Key::Period);
        assert_eq!(shown(&mut harness).0.as_deref(), Some("dusk"));
        key(&mut harness, Modifiers::NONE, Key::Period);
        let (phase, features) = shown(&mut harness);
        assert_eq!((phase.as_deref(), features), (Some("morning"), morning), "after the last the first");
        key(&mut harness, Modifiers::NONE, Key::Comma);
        assert_eq!(shown(&mut harness).0.as_deref(), Some("dusk"));
        let is_changed = app(&harness).session.as_ref().is_some_and(|session| session.editor.is_changed());
        assert!(!is_changed, "no edit was made");
    }

    #[test]
    fn a_phase_that_is_not_there_is_named_and_the_one_shown_stays() {
        let mut harness = window(Some(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes/phases.toml"))));
        harness.state_mut().as_mut().expect("shown").show_phase("night");
        assert_eq!(shown(&mut harness).0, None);
        assert!(app(&harness).notice_texts().any(|text| text.contains("night")), "it is named");
    }
}
