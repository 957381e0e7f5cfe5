//! Background events: scenes that are opened, files that change on disk.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use egui::Ui;

use crate::analyzing::Analyzing;
use crate::app::{OpeningFailure, ViewerApp};
use crate::lettering;
use crate::loading::{LoadedFile, opening_error};
use crate::paging::PagingStage;
use crate::panels::light::LightPanel;
use crate::panels::tree::TreePanel;
use crate::saving_question::Leaving;
use crate::session::EditingSession;
use crate::watch::{FileWatch, WatchState};
use crate::worker::{WorkerJob, drop_apart};
use sandtable_draw::list::FeatureId;
use sandtable_files::disk;
use sandtable_files::fingerprint::fingerprint;

/// How often the share of a terrain that is measured is shown anew.
const PROGRESS_EVERY: Duration = Duration::from_millis(500);

/// The files of the scene that is shown.
#[derive(Default)]
pub struct FollowedFiles {
    /// What they held when they were read or saved last.
    fingerprint: Option<String>,
    watch: Option<FileWatch>,
    check: Option<FileCheck>,
    /// Whether a file changed while they were read.
    changed_meanwhile: bool,
}

/// Files that are being read, to know whether they hold what they held.
struct FileCheck {
    purpose: CheckPurpose,
    job: WorkerJob<Option<String>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CheckPurpose {
    /// The scene is read again where they hold something else.
    Compare,
    /// The window itself has written them.
    Acknowledge,
}

impl ViewerApp {
    /// Takes over what stands, where it was set anew meanwhile.
    pub(super) fn follow_relisting(&mut self) {
        let Some(opened) = &mut self.opened else { return };
        let followed = [
            opened.follow_relisting(&self.context, &self.slot),
            opened.follow_shadows(&self.context, &self.slot),
        ];
        for error in followed.into_iter().filter_map(Result::err) {
            self.notices.warn(opening_error(&error));
        }
        if let Err(failure) = opened.follow_finer_ground(&self.context, &self.slot) {
            self.notices.warn(format!("finer ground cannot be shown: {failure}"));
        }
        if let Err(failure) = opened.follow_reach(&self.context) {
            self.notices.warn(format!("measuring the ground for this picture failed: {failure}"));
        }
    }

    /// Takes over what was read of terrain on disk.
    pub(super) fn follow_paging(&mut self) {
        let Some(paged) = self.opened.as_mut().and_then(|opened| opened.paged.as_mut()) else { return };
        let before = paged.stage();
        paged.follow();
        match paged.stage() {
            stage @ PagingStage::Failed(_) if stage == before => {}
            PagingStage::Failed(text) => self.notices.warn(format!("the terrain cannot be read: {text}")),
            PagingStage::Measuring(_) => self.context.request_repaint_after(PROGRESS_EVERY),
            PagingStage::Shown => {}
        }
    }

    /// Takes over a scene that was opened meanwhile.
    pub(super) fn follow_loading(&mut self, ui: &Ui) {
        let Some(loading) = &mut self.loading else { return };
        let Some(result) = loading.poll() else { return };
        let (path, replaces) = (loading.path.clone(), loading.replaces.take());
        self.loading = None;
        match result {
            Ok(_) if self.is_edited_since(replaces.as_deref()) => self.keep_edits(path),
            Ok(loaded) => self.take_over(path, loaded, ui),
            // The last good scene stays, and the error with it.
            Err(message) if self.opened.is_some() => {
                self.notices.warn(format!("{} cannot be opened:\n{message}", disk::file_name(&path)));
            }
            Err(message) => {
                self.watch_files(std::slice::from_ref(&path));
                self.failure = Some(OpeningFailure { path, message });
            }
        }
    }

    /// Whether the scene has edits that were made after its text was `replaced`, which is to be replaced.
    fn is_edited_since(&self, replaced: Option<&str>) -> bool {
        let Some((replaced, session)) = replaced.zip(self.session.as_ref()) else { return false };
        session.editor.is_changed() && session.editor.text() != replaced
    }

    /// Keeps the scene that was edited while the file at `path` was opened; another file is opened after a question.
    fn keep_edits(&mut self, path: PathBuf) {
        match self.opened.as_ref().is_some_and(|opened| opened.path == path) {
            true => self.follow_change(),
            false => self.leave(Leaving::Open(path)),
        }
    }

    /// Shows a scene; the camera stays where the same file was shown before.
    fn take_over(&mut self, path: PathBuf, loaded: LoadedFile, ui: &Ui) {
        let LoadedFile { mut opened, editor, source, fingerprint } = loaded;
        match self.opened.as_ref().filter(|before| before.path == path) {
            Some(before) => {
                let pose = before.seen_from(self.view.size).pose_at(opened.scene.scale.0);
                opened.navigator.set_mode(before.navigator.mode());
                opened.navigator.place(pose, &|_| None);
                opened.fov_y_rad = before.fov_y_rad;
                let count = opened.scene.features.len();
                self.tree.hidden.retain(|id: &FeatureId| id.index().is_some_and(|index| index < count));
                if self.tree.hidden != opened.hidden {
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
                self.viewshed = None;
                self.analyzing = Analyzing::default();
                self.notices.clear();
                self.recent.add(&path);
            }
        }
        self.view.forget();
        let given = self.opened.as_ref().and_then(|before| before.scene.font.as_ref());
        if given != opened.scene.font.as_ref() {
            lettering::set_fonts(&self.context, opened.scene.font.as_ref());
        }
        self.detail.tolerance_px = opened.walk.tolerance_px();
        (self.detail.frozen, self.detail.is_fixed) = (false, opened.paged.is_some());
        self.light = LightPanel::new(opened.walk.to_sun(), f64::from(opened.scene.scale.0));
        let watched: Vec<PathBuf> = opened.scene.files.iter().cloned().chain([source.path.clone()]).collect();
        self.watch_files(&watched);
        if opened.paged.is_some() {
            (self.session, self.files.fingerprint, self.files.check) = (None, None, None);
        }
        let before = match (editor, &mut self.session) {
            (Some(editor), _) => {
                (self.files.fingerprint, self.files.check) = (fingerprint, None);
                self.session = Some(EditingSession::new(editor, &opened));
                self.opened.replace(opened)
            }
            (None, Some(session)) => {
                let is_outdated = session.editor.text() != source.text;
                session.rebuilt(source.text);
                let before = self.opened.replace(opened);
                if is_outdated {
                    self.rebuild();
                }
                before
            }
            (None, None) => self.opened.replace(opened),
        };
        drop_apart(before);
        self.renew_viewshed();
        self.renew_analysis();
    }

    fn watch_files(&mut self, files: &[PathBuf]) {
        let context = self.context.clone();
        self.files.watch = FileWatch::start(files, move || context.request_repaint());
    }

    /// Reads files again that changed on disk.
    pub(super) fn follow_files(&mut self, ui: &Ui) {
        self.follow_check();
        let Some(watch) = &mut self.files.watch else { return };
        match watch.poll(Instant::now()) {
            WatchState::Unchanged => {}
            WatchState::Changing(rest) => ui.ctx().request_repaint_after(rest),
            WatchState::Changed if self.files.check.is_some() => self.files.changed_meanwhile = true,
            WatchState::Changed => self.check_files(CheckPurpose::Compare),
        }
    }

    /// Takes the files as they are for what is shown.
    pub(super) fn acknowledge_files(&mut self) {
        self.check_files(CheckPurpose::Acknowledge);
    }

    fn check_files(&mut self, purpose: CheckPurpose) {
        let Some((opened, session)) = self.opened.as_ref().zip(self.session.as_ref()) else {
            // A file that could not be opened.
            return self.reload();
        };
        let (path, files) = (session.editor.source().path.clone(), opened.scene.files.clone());
        let job = WorkerJob::start(&self.context, move || fingerprint(&path, &files).ok());
        self.files.check = Some(FileCheck { purpose, job });
    }

    fn follow_check(&mut self) {
        let Some(check) = &self.files.check else { return };
        let Some(now) = check.job.poll() else { return };
        let (now, purpose) = (now.ok().flatten(), check.purpose);
        self.files.check = None;
        let is_known = now.is_some() && now == self.files.fingerprint;
        self.files.fingerprint = now;
        if purpose == CheckPurpose::Compare && !is_known {
            self.follow_change();
        } else if std::mem::take(&mut self.files.changed_meanwhile) {
            self.check_files(CheckPurpose::Compare);
        }
    }

    /// Reads files again that another program changed; edits that are not saved come before.
    fn follow_change(&mut self) {
        if self.session.as_ref().is_some_and(|session| session.editor.is_changed()) {
            self.notices
                .warn("the file has changed on disk; Ctrl+R reads it, without the edits that are not saved");
        } else {
            self.reload();
        }
    }
}
