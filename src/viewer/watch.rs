//! Watches the files of a scene, so that it is read again when one of them changes on disk.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use notify::event::EventKind;
use notify::{RecommendedWatcher, RecursiveMode, Watcher};

/// How long files must rest before they are read: an editor writes one in several steps.
const REST: Duration = Duration::from_millis(100);

/// The watched files of one scene. Folders are watched, since editors replace a file by another of its name.
pub struct FileWatch {
    changed: Receiver<()>,
    last: Option<Instant>,
    /// Watches as long as it lives.
    _watcher: RecommendedWatcher,
}

impl FileWatch {
    /// Watches `files`; `wake` is called on another thread when one changes, and should have [`FileWatch::poll`] called
    /// soon and again after the time that it returns. `None` where the system cannot watch.
    pub fn start(files: &[PathBuf], wake: impl Fn() + Send + 'static) -> Option<Self> {
        let absolute = |path: &PathBuf| std::path::absolute(path).ok();
        let watched: Vec<PathBuf> = files.iter().filter_map(absolute).collect();
        let mut folders: Vec<PathBuf> =
            watched.iter().filter_map(|path| path.parent()).map(Path::to_owned).collect();
        folders.sort();
        folders.dedup();
        let (sender, changed) = channel();
        let on_event = move |event: notify::Result<notify::Event>| {
            let Ok(event) = event else { return };
            // Reading a file is an event, too.
            let is_change =
                matches!(event.kind, EventKind::Create(_) | EventKind::Modify(_) | EventKind::Remove(_));
            if is_change && event.paths.iter().any(|path| watched.contains(path)) && sender.send(()).is_ok() {
                wake();
            }
        };
        let mut watcher = notify::recommended_watcher(on_event).ok()?;
        let mut count = 0;
        for folder in &folders {
            count += usize::from(watcher.watch(folder, RecursiveMode::NonRecursive).is_ok());
        }
        (count > 0).then_some(Self { changed, last: None, _watcher: watcher })
    }

    /// Whether files changed and have settled, at `now`; else how long until the next poll.
    pub fn poll(&mut self, now: Instant) -> WatchState {
        if self.changed.try_iter().count() > 0 {
            self.last = Some(now);
        }
        match self.last.map(|last| now.saturating_duration_since(last)) {
            None => WatchState::Unchanged,
            Some(rested) if rested < REST => WatchState::Changing(REST - rested),
            Some(_) => {
                self.last = None;
                WatchState::Changed
            }
        }
    }
}

/// The state of watched files since the last poll.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WatchState {
    /// Nothing.
    Unchanged,
    /// They are being written; ask again after this time.
    Changing(Duration),
    /// They changed, and rest.
    Changed,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::{env, fs, thread};

    fn state_after(watch: &mut FileWatch, wanted: WatchState) -> bool {
        let end = Instant::now() + Duration::from_secs(10);
        while Instant::now() < end {
            if watch.poll(Instant::now()) == wanted {
                return true;
            }
            thread::sleep(Duration::from_millis(5));
        }
        false
    }

    #[test]
    fn a_file_that_is_written_or_replaced_is_reported_once_and_its_neighbors_are_not() {
        let folder = env::temp_dir().join(format!("sandtable-watch-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let file = folder.join("scene.toml");
        fs::write(&file, "a").expect("written");
        let mut watch = FileWatch::start(std::slice::from_ref(&file), || ()).expect("watched");
        fs::write(folder.join("other.toml"), "b").expect("written");
        fs::read(&file).expect("there");
        thread::sleep(Duration::from_millis(300));
        assert_eq!(watch.poll(Instant::now()), WatchState::Unchanged);
        fs::write(&file, "c").expect("written");
        assert!(state_after(&mut watch, WatchState::Changed), "written");
        fs::write(folder.join("new"), "d").expect("written");
        fs::rename(folder.join("new"), &file).expect("renamed");
        assert!(state_after(&mut watch, WatchState::Changed), "replaced");
        thread::sleep(Duration::from_millis(200));
        let rests = watch.poll(Instant::now());
        fs::remove_dir_all(folder).ok();
        assert_eq!(rests, WatchState::Unchanged);
    }
}
