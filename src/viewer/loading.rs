//! Opens a file on a thread, so that the window stays responsive.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;
use std::time::Instant;

use crate::finer_ground::FinerGround;
use crate::opened::{OpenedScene, OpeningView};
use crate::paging::PagedTerrain;
use crate::scene_load::LoaderSlot;
use crate::worker::run_apart;
use sandtable_base::limits::VIEWED_SAMPLES;
use sandtable_base::message::chain::error_text;
use sandtable_description::diagnostic::{Diagnostic, Diagnostics};
use sandtable_editing::editor::{SceneEditor, SceneSource};
use sandtable_editing::viewing::open_to_view;
use sandtable_files::fingerprint::fingerprint;
use sandtable_scene::scene_file::is_scene_file;
use sandtable_walk::paged_elevation::PagedElevation;

/// A file that is being opened.
pub struct SceneLoading {
    /// The file.
    pub path: PathBuf,
    /// The step that it is at.
    pub step: &'static str,
    /// When it began.
    pub since: Instant,
    /// The edited text that it may replace: that of the scene shown when it began. `None` of a scene as it is edited, and
    /// where none was shown.
    pub replaces: Option<String>,
    news: Receiver<LoadingNews>,
}

/// The task of opening a file.
pub enum LoadingTask {
    /// A file, with the folders that it may read, and the phase to show where it has it; `None` for the first.
    File(PathBuf, Vec<PathBuf>, Option<String>),
    /// The scene of the file at a path as it was edited.
    Edited(PathBuf, SceneSource),
}

/// A scene that was opened.
pub struct LoadedFile {
    /// The scene.
    pub opened: Box<OpenedScene>,
    /// What edits its file; `None` where it was edited already, and of terrain on disk.
    pub editor: Option<SceneEditor>,
    /// What it was built of.
    pub source: SceneSource,
    /// What its files held; `None` where one of them cannot be read any more.
    pub fingerprint: Option<String>,
}

enum LoadingNews {
    Step(&'static str),
    Done(Box<Result<LoadedFile, String>>),
}

impl SceneLoading {
    /// Begins to open a scene, first seen as `view` says, for the renderer of `slot`. `wake` is called whenever
    /// [`SceneLoading::poll`] has news.
    pub fn start(
        task: LoadingTask,
        view: OpeningView,
        slot: LoaderSlot,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> Self {
        let (sender, news) = channel();
        let wake = Arc::new(wake);
        let (LoadingTask::File(path, ..) | LoadingTask::Edited(path, _)) = &task;
        let path = path.clone();
        thread::spawn(move || {
            let tell = |news| {
                // Nobody listens any more where another file was opened meanwhile.
                let _ = sender.send(news);
                wake();
            };
            let waker = Arc::clone(&wake);
            let loaded = run_apart(|| {
                load(task, (&view, &slot), move || waker(), &|step| tell(LoadingNews::Step(step)))
            });
            tell(LoadingNews::Done(Box::new(loaded)));
        });
        Self { path, step: "starting", since: Instant::now(), replaces: None, news }
    }

    /// The scene, or why there is none; `None` while it is being opened.
    pub fn poll(&mut self) -> Option<Result<LoadedFile, String>> {
        loop {
            match self.news.try_recv() {
                Ok(LoadingNews::Step(step)) => self.step = step,
                Ok(LoadingNews::Done(loaded)) => return Some(*loaded),
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => {
                    return Some(Err("opening it failed without a reason; please report this".to_owned()));
                }
            }
        }
    }
}

fn load(
    task: LoadingTask,
    shown: (&OpeningView, &LoaderSlot),
    wake: impl Fn() + Send + 'static,
    progress: &dyn Fn(&'static str),
) -> Result<LoadedFile, String> {
    progress("reading the scene file");
    if let LoadingTask::File(path, allowed, _) = &task
        && let Some(elevation) = large_elevation(path, progress)?
    {
        return load_paged((path, allowed), elevation, shown, wake, progress);
    }
    let (path, source, editor) = match task {
        LoadingTask::File(path, allowed, phase) => {
            let mut editor = open_to_view(&path, &allowed).map_err(|error| opening_error(&error))?;
            // A phase that the file does not have any more gives way to the first.
            let _ = phase.map(|phase| editor.show_phase(&phase));
            (path, editor.source().clone(), Some(editor))
        }
        LoadingTask::Edited(path, source) => (path, source, None),
    };
    let scene = source.build(progress).map_err(|error| opening_error(&error))?;
    let fingerprint = fingerprint(&source.path, &scene.files).ok();
    let opened =
        OpenedScene::new(path, scene, None, shown, progress).map_err(|error| opening_error(&error))?;
    Ok(LoadedFile { opened: Box::new(opened), editor, source, fingerprint })
}

/// An elevation file that is too large for a scene in memory; `None` of others.
fn large_elevation(path: &Path, progress: &dyn Fn(&'static str)) -> Result<Option<PagedElevation>, String> {
    if is_scene_file(path) {
        return Ok(None);
    }
    progress("reading elevation");
    PagedElevation::open(path, VIEWED_SAMPLES.get()).map_err(|error| opening_error(&error))
}

/// A large elevation file: its overview is the scene, and the terrain is shown in pages as soon as it is measured.
pub(super) fn load_paged(
    (path, allowed): (&Path, &[PathBuf]),
    elevation: PagedElevation,
    shown: (&OpeningView, &LoaderSlot),
    wake: impl Fn() + Send + 'static,
    progress: &dyn Fn(&'static str),
) -> Result<LoadedFile, String> {
    let editor = open_to_view(path, allowed).map_err(|error| opening_error(&error))?;
    let source = editor.source().clone();
    let scene = source.build_on(Arc::clone(&elevation.overview), progress);
    let scene = scene.map_err(|error| opening_error(&error))?;
    let PagedElevation { terrain, questions, near, .. } = elevation;
    let paged = PagedTerrain::start(terrain, questions, wake).map_err(|error| opening_error(&error))?;
    let finer = FinerGround::new(near).map_err(|error| opening_error(&error))?;
    let mut opened = OpenedScene::new(path.to_owned(), scene, Some(paged), shown, progress)
        .map_err(|error| opening_error(&error))?;
    opened.finer = Some(finer);
    Ok(LoadedFile { opened: Box::new(opened), editor: None, source, fingerprint: None })
}

/// The text of an error, beginning with the place in the scene file, if it has one.
pub fn opening_error(error: &(dyn std::error::Error + 'static)) -> String {
    let mut causes = std::iter::successors(Some(error), |&error| error.source());
    match causes.find(|cause| cause.is::<Diagnostic>() || cause.is::<Diagnostics>()) {
        Some(diagnostic) => diagnostic.to_string(),
        None => error_text(error),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn opened(path: &str) -> Result<LoadedFile, String> {
        let mut loading = SceneLoading::start(
            LoadingTask::File(path.into(), Vec::new(), None),
            OpeningView::default(),
            LoaderSlot::default(),
            || (),
        );
        loop {
            match loading.poll() {
                Some(result) => return result,
                None => thread::sleep(Duration::from_millis(2)),
            }
        }
    }

    #[test]
    fn a_scene_arrives_from_its_thread() {
        assert_eq!(
            opened(concat!(env!("SANDTABLE_ROOT"), "scenes/road.toml"))
                .expect("sound")
                .opened
                .scene
                .title
                .as_deref(),
            Some("Two roads")
        );
    }

    #[test]
    fn a_file_that_is_not_there_is_named() {
        let error =
            opened(concat!(env!("SANDTABLE_ROOT"), "scenes/no-such.toml")).err().expect("it is not there");
        assert!(error.contains("no-such.toml"), "{error}");
    }
}
