//! What happens beside the user: scenes that are opened, files that change on disk.

use std::path::PathBuf;
use std::time::Instant;

use egui::Ui;

use crate::draw::list::FeatureId;
use crate::pipeline::files;
use crate::pipeline::fingerprint::fingerprint;
use crate::viewer::app::{OpeningFailure, ViewerApp};
use crate::viewer::loading::LoadedFile;
use crate::viewer::panels::light::LightPanel;
use crate::viewer::panels::tree::TreePanel;
use crate::viewer::session::EditingSession;
use crate::viewer::watch::{FileWatch, WatchState};

impl ViewerApp {
    /// Takes over a scene that was opened meanwhile.
    pub(super) fn follow_loading(&mut self, ui: &Ui) {
        let Some(loading) = &mut self.loading else { return };
        let Some(result) = loading.poll() else { return };
        let path = loading.path.clone();
        self.loading = None;
        match result {
            Ok(loaded) => self.take_over(path, loaded, ui),
            // The last good scene stays, and the error with it.
            Err(message) if self.opened.is_some() => {
                self.notices.warn(format!("{} cannot be opened:\n{message}", files::file_name(&path)));
            }
            Err(message) => {
                self.watch_files(std::slice::from_ref(&path));
                self.failure = Some(OpeningFailure { path, message });
            }
        }
    }

    /// Shows a scene; the camera stays where the same file was shown before.
    fn take_over(&mut self, path: PathBuf, loaded: LoadedFile, ui: &Ui) {
        let LoadedFile { mut opened, editor, source } = loaded;
        match self.opened.as_ref().filter(|before| before.path == path) {
            Some(before) => {
                let mut pose = before.navigator.pose();
                pose.eye.z *= f64::from(opened.scene.scale.0 / before.scene.scale.0);
                opened.navigator.set_mode(before.navigator.mode());
                opened.navigator.place(pose, &|_| None);
                opened.fov_y_rad = before.fov_y_rad;
                let count = opened.scene.features.len();
                self.tree.hidden.retain(|id: &FeatureId| id.index().is_some_and(|index| index < count));
                if !self.tree.hidden.is_empty() {
                    opened.hide(&self.tree.hidden);
                }
                if editor.is_some() {
                    self.notices.clear();
                    self.notices.tell(ui.input(|input| input.time), "the file was read again");
                }
            }
            None => {
                self.camera_number = 0;
                (self.tree, self.picked, self.tool) = (TreePanel::default(), None, None);
                self.notices.clear();
                self.recent.add(&path);
            }
        }
        self.detail.tolerance_px = opened.walk.tolerance_px();
        self.detail.frozen = false;
        self.light = LightPanel::new(opened.walk.to_sun(), f64::from(opened.scene.scale.0));
        let watched: Vec<PathBuf> = opened.scene.files.iter().cloned().chain([source.path.clone()]).collect();
        self.watch_files(&watched);
        match (editor, &mut self.session) {
            (Some(editor), _) => {
                self.fingerprint = fingerprint(&source.path, &opened.scene.files).ok();
                self.session = Some(EditingSession::new(editor, &opened));
                self.opened = Some(opened);
            }
            (None, Some(session)) => {
                session.rebuilt();
                let is_outdated = session.editor.text() != source.text;
                self.opened = Some(opened);
                if is_outdated {
                    self.rebuild();
                }
            }
            (None, None) => self.opened = Some(opened),
        }
    }

    fn watch_files(&mut self, files: &[PathBuf]) {
        let context = self.context.clone();
        self.watch = FileWatch::start(files, move || context.request_repaint());
    }

    /// Reads files again that changed on disk.
    pub(super) fn follow_files(&mut self, ui: &Ui) {
        let Some(watch) = &mut self.watch else { return };
        match watch.poll(Instant::now()) {
            WatchState::Unchanged => {}
            WatchState::Changing(rest) => ui.ctx().request_repaint_after(rest),
            WatchState::Changed => self.follow_change(),
        }
    }

    /// Reads files again that another program changed; edits that are not saved come before.
    fn follow_change(&mut self) {
        let held = self.opened.as_ref().zip(self.session.as_ref());
        let held =
            held.map(|(opened, session)| (session.editor.source().path.clone(), opened.scene.files.clone()));
        let now = held.and_then(|(path, files)| fingerprint(&path, &files).ok());
        if now.is_some() && now == self.fingerprint {
            return;
        }
        self.fingerprint = now;
        if self.session.as_ref().is_some_and(|session| session.editor.is_changed()) {
            self.notices
                .warn("the file has changed on disk; Ctrl+R reads it, without the edits that are not saved");
        } else {
            self.reload();
        }
    }
}
