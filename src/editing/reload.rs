//! Watches a scene file that other programs may change, and opens the scene again.

use std::path::PathBuf;

use crate::editor::SceneSource;
use sandtable_files::disk;
use sandtable_files::fingerprint::fingerprint;
use sandtable_scene::planned_pictures::ElevationNeed;
use sandtable_scene::scene_file::{OpenSceneError, open_scene_for};
use sandtable_scene::scene_model::SceneModel;

/// A scene file that is shown, with the files that it was made of.
#[derive(Clone, Debug)]
pub struct WatchedScene {
    path: PathBuf,
    allowed: Vec<PathBuf>,
    phase: Option<String>,
    files: Vec<PathBuf>,
    /// That of the content that was opened last, sound or wrong; `None` where it could not be read.
    fingerprint: Option<String>,
}

/// The outcome of reloading a scene file.
pub enum ReloadedScene {
    /// The content is unchanged.
    Unchanged,
    /// The file holds another scene.
    Scene(Box<SceneModel>),
    /// It cannot be opened; what is shown stays. The message names file, line and column where they are known.
    Wrong(OpenSceneError),
}

impl WatchedScene {
    /// The file of a scene that was just opened.
    pub fn new(source: &SceneSource, scene: &SceneModel) -> Self {
        let SceneSource { path, allowed, phase, .. } = source.clone();
        let mut watched = Self { path, allowed, phase, files: scene.files.clone(), fingerprint: None };
        watched.acknowledge();
        watched
    }

    /// The files whose changes matter: the scene file and those that it was made of when it was sound last.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        std::iter::once(&self.path).chain(&self.files)
    }

    /// Records that the files, as they are now, are those of the shown scene: after a save.
    pub fn acknowledge(&mut self) {
        self.fingerprint = fingerprint(&self.path, &self.files).ok();
    }

    /// Opens the scene again where a file has changed. The same error is reported once.
    pub fn reload(&mut self, progress: &dyn Fn(&'static str)) -> ReloadedScene {
        let now = match fingerprint(&self.path, &self.files) {
            Ok(now) if self.fingerprint.as_deref() == Some(now.as_str()) => return ReloadedScene::Unchanged,
            now => now.ok(),
        };
        // A file that is missing while another program writes it: reported once, tried again each time.
        if now.is_none() && self.fingerprint.is_none() && disk::read(&self.path).is_err() {
            return ReloadedScene::Unchanged;
        }
        self.fingerprint = now;
        let need = ElevationNeed::AllThatFit;
        let opened = open_scene_for(&self.path, &self.allowed, self.phase.as_deref(), need, progress);
        match opened {
            Ok(scene) => {
                self.files.clone_from(&scene.files);
                self.acknowledge();
                ReloadedScene::Scene(Box::new(scene))
            }
            Err(error) => ReloadedScene::Wrong(error),
        }
    }
}
