//! Saving, and the questions before edits could be lost.

use egui::{Context, Id, Modal};

use crate::app::{ViewerApp, WindowRequest};
use crate::loading::opening_error;
use crate::saving_question::{Leaving, SavingQuestion};
use sandtable_editing::editor::{OnConflict, SaveError};
use sandtable_files::disk;

impl ViewerApp {
    /// Leaves the scene, after a question where edits would be lost.
    pub(super) fn leave(&mut self, leaving: Leaving) {
        let is_changed = self.session.as_ref().is_some_and(|session| session.editor.is_changed());
        match is_changed {
            true => self.question = Some(SavingQuestion::Unsaved(leaving)),
            false => self.leave_now(leaving),
        }
        self.context.request_repaint();
    }

    fn leave_now(&mut self, leaving: Leaving) {
        match leaving {
            Leaving::Close => self.requests.push(WindowRequest::Close),
            Leaving::Open(path) => self.open(&path),
            Leaving::Reload => self.reload(),
        }
    }

    /// Saves the edits into the scene file.
    pub(super) fn save(&mut self, on_conflict: OnConflict) {
        if self.session.is_none() {
            return self.refuse();
        }
        let Some(session) = &mut self.session else { return };
        let path = session.editor.source().path.clone();
        let name = disk::file_name(&path);
        if !session.editor.is_changed() && path.exists() {
            return self.tell(format!("{name} has nothing to save"));
        }
        match session.editor.save(on_conflict) {
            Ok(()) => {
                self.acknowledge_files();
                self.tell(format!("{name} is saved"));
            }
            Err(error @ (SaveError::ChangedOnDisk(_) | SaveError::Exists(_))) => {
                self.question = Some(SavingQuestion::Conflict(error.to_string()));
            }
            Err(error) => self.notices.warn(opening_error(&error)),
        }
    }

    fn tell(&mut self, text: String) {
        let now = self.context.input(|input| input.time);
        self.notices.tell(now, text);
    }

    /// Asks the question that is open.
    pub(super) fn show_question(&mut self, context: &Context) {
        let Some(question) = self.question.clone() else { return };
        let mut choice = None;
        Modal::new(Id::unique("question")).show(context, |ui| {
            ui.set_max_width(420.0);
            let (text, choices): (String, &[&str]) = match &question {
                SavingQuestion::Unsaved(Leaving::Close) => (
                    "The scene has edits that are not saved.".to_owned(),
                    &["Save and close", "Close without saving", "Cancel"],
                ),
                SavingQuestion::Unsaved(_) => (
                    "The scene has edits that are not saved.".to_owned(),
                    &["Save and go on", "Go on without saving", "Cancel"],
                ),
                SavingQuestion::Conflict(text) => (text.clone(), &["Save over it", "Cancel"]),
            };
            ui.label(text);
            ui.add_space(8.0);
            ui.horizontal(|ui| {
                for (index, text) in choices.iter().enumerate() {
                    if ui.button(*text).clicked() {
                        choice = Some((index, choices.len()));
                    }
                }
            });
        });
        let Some((index, count)) = choice else { return };
        self.question = None;
        match question {
            _ if index + 1 == count => {}
            SavingQuestion::Conflict(_) => self.save(OnConflict::Overwrite),
            SavingQuestion::Unsaved(leaving) if index == 0 => {
                self.save(OnConflict::Refuse);
                let is_saved = self.session.as_ref().is_some_and(|session| !session.editor.is_changed());
                if is_saved && self.question.is_none() {
                    self.leave_now(leaving);
                }
            }
            SavingQuestion::Unsaved(leaving) => self.leave_now(leaving),
        }
    }
}
