//! Opening a file on a thread, so that the window goes on answering.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread;
use std::time::Instant;

use crate::description::diagnostic::{Diagnostic, Diagnostics};
use crate::message::chain::error_text;
use crate::pipeline::viewing::{ViewedHeights, open_to_view};
use crate::viewer::opened::OpenedScene;

/// A file that is being opened.
pub struct SceneLoading {
    /// The file.
    pub path: PathBuf,
    /// The step that it is at.
    pub step: &'static str,
    /// When it began.
    pub since: Instant,
    news: Receiver<LoadingNews>,
}

enum LoadingNews {
    Step(&'static str),
    Done(Result<Box<OpenedScene>, String>),
}

impl SceneLoading {
    /// Begins to open the file at `path`. `wake` is called whenever [`SceneLoading::poll`] has news.
    pub fn start(
        path: &Path,
        allowed: &[PathBuf],
        heights: ViewedHeights,
        wake: impl Fn() + Send + 'static,
    ) -> Self {
        let (sender, news) = channel();
        let (file, allowed) = (path.to_owned(), allowed.to_vec());
        thread::spawn(move || {
            let tell = |news| {
                // Nobody listens any more where another file was opened meanwhile.
                let _ = sender.send(news);
                wake();
            };
            let progress = |step| tell(LoadingNews::Step(step));
            let opened = open_to_view(&file, &allowed, heights, &progress);
            let opened = opened.map_err(|error| opening_error(&error)).and_then(|scene| {
                OpenedScene::new(file.clone(), scene, &progress).map_err(|error| opening_error(&error))
            });
            tell(LoadingNews::Done(opened.map(Box::new)));
        });
        Self { path: path.to_owned(), step: "starting", since: Instant::now(), news }
    }

    /// The scene, or why there is none; `None` while it is being opened.
    pub fn poll(&mut self) -> Option<Result<Box<OpenedScene>, String>> {
        loop {
            match self.news.try_recv() {
                Ok(LoadingNews::Step(step)) => self.step = step,
                Ok(LoadingNews::Done(scene)) => return Some(scene),
                Err(TryRecvError::Empty) => return None,
                Err(TryRecvError::Disconnected) => {
                    return Some(Err("opening it failed without a reason; please report this".to_owned()));
                }
            }
        }
    }
}

/// The text of an error, beginning with the place in the scene file where there is one.
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

    fn opened(path: &str) -> Result<Box<OpenedScene>, String> {
        let mut loading = SceneLoading::start(Path::new(path), &[], ViewedHeights::AsStated, || ());
        loop {
            match loading.poll() {
                Some(result) => return result,
                None => thread::sleep(Duration::from_millis(2)),
            }
        }
    }

    #[test]
    fn a_scene_arrives_from_its_thread() {
        assert_eq!(opened("scenes/road.toml").expect("sound").scene.title.as_deref(), Some("Two roads"));
    }

    #[test]
    fn a_file_that_is_not_there_is_named() {
        let error = opened("scenes/no-such.toml").err().expect("it is not there");
        assert!(error.contains("no-such.toml"), "{error}");
    }
}
