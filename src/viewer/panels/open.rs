//! The list of files to open: a field for a path, the files opened last, and the folders of this machine.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use egui::{Key, RichText, ScrollArea, TextEdit, Ui};

use crate::recent::RecentFiles;
use sandtable_dem::formats::FORMATS;
use sandtable_scene::scene_file::is_scene_file;

/// The most names of a folder that are listed: a longer list is not read to its end.
const MOST_NAMES: usize = 2_000;

/// The content of the list.
#[derive(Debug, Default)]
pub struct OpenPanel {
    /// The path in the field.
    pub typed: String,
    folder: PathBuf,
    entries: Vec<FolderEntry>,
    problem: Option<String>,
}

/// A folder, a scene or an elevation file.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct FolderEntry {
    is_file: bool,
    name: String,
}

impl OpenPanel {
    /// A panel that lists `folder`.
    pub fn at(folder: &Path) -> Self {
        let mut panel = Self::default();
        panel.list(folder);
        panel
    }

    fn list(&mut self, folder: &Path) {
        self.folder = fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned());
        self.entries.clear();
        match fs::read_dir(&self.folder) {
            Ok(names) => {
                let entry = |entry: fs::DirEntry| {
                    let name = entry.file_name().into_string().ok().filter(|name| !name.starts_with('.'))?;
                    let is_file = !entry.path().is_dir();
                    (!is_file || can_be_opened(&entry.path())).then_some(FolderEntry { is_file, name })
                };
                let entries = names.take(MOST_NAMES).filter_map(|name| entry(name.ok()?));
                self.entries.extend(entries);
                self.entries.sort();
                self.problem = None;
            }
            Err(error) => self.problem = Some(format!("{} cannot be listed: {error}", self.folder.display())),
        }
    }
}

/// Whether a file is a scene, or has the name of elevations.
fn can_be_opened(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).map(str::to_lowercase);
    let Some(extension) = extension else { return false };
    if is_scene_file(path) {
        return has_terrain(path);
    }
    let is_known = |known: &[&str]| known.contains(&extension.as_str());
    extension == "toml"
        || FORMATS.iter().any(|format| is_known(format.extensions) || is_known(format.shared_extensions))
}

/// Whether a file in TOML has ground, as every scene has and no settings of a program do.
fn has_terrain(path: &Path) -> bool {
    /// Scenes name their ground among their first keys.
    const LOOKED_AT: u64 = 64 << 10;
    let mut head = Vec::new();
    let is_read = File::open(path).and_then(|file| file.take(LOOKED_AT).read_to_end(&mut head)).is_ok();
    is_read && head.windows(7).any(|bytes| bytes == b"terrain")
}

/// Draws the list; returns the file that was chosen.
pub fn open_panel(ui: &mut Ui, panel: &mut OpenPanel, recent: &RecentFiles) -> Option<PathBuf> {
    let mut chosen = None;
    ui.horizontal(|ui| {
        let label = ui.label("Path");
        let width = ui.available_width() - 70.0;
        let hint = "a scene (.toml) or an elevation file";
        let field = ui.add(TextEdit::singleline(&mut panel.typed).hint_text(hint).desired_width(width));
        let field = field.labelled_by(label.id);
        let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if (ui.button("Open").clicked() || is_entered) && !panel.typed.trim().is_empty() {
            let path = panel.folder.join(panel.typed.trim());
            if path.is_dir() { panel.list(&path) } else { chosen = Some(path) }
        }
    });
    if !recent.paths.is_empty() {
        ui.add_space(6.0);
        ui.label(RichText::new("Opened last").strong());
        for path in &recent.paths {
            let folder = path.parent().map(|folder| folder.display().to_string()).unwrap_or_default();
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if ui.button(format!("{name}   {folder}")).clicked() {
                chosen = Some(path.clone());
            }
        }
    }
    ui.add_space(6.0);
    ui.label(RichText::new(panel.folder.display().to_string()).strong());
    if let Some(problem) = &panel.problem {
        ui.colored_label(ui.visuals().error_fg_color, problem);
    }
    let mut entered = None;
    ScrollArea::vertical().auto_shrink([false, true]).show(ui, |ui| {
        if let Some(parent) = panel.folder.parent()
            && ui.button("Folder above").clicked()
        {
            entered = Some(parent.to_owned());
        }
        for entry in &panel.entries {
            let path = panel.folder.join(&entry.name);
            if entry.is_file {
                if ui.button(&entry.name).clicked() {
                    chosen = Some(path);
                }
            } else if ui.button(format!("{}/", entry.name)).clicked() {
                entered = Some(path);
            }
        }
        if panel.entries.is_empty() && panel.problem.is_none() {
            ui.weak("There is no scene and no elevation file in this folder.");
        }
    });
    if let Some(folder) = entered {
        panel.list(&folder);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    struct OpenTest {
        panel: OpenPanel,
        recent: RecentFiles,
        chosen: Option<PathBuf>,
    }

    fn harness(recent: RecentFiles) -> Harness<'static, OpenTest> {
        let state = OpenTest {
            panel: OpenPanel::at(Path::new(concat!(env!("SANDTABLE_ROOT"), "scenes"))),
            recent,
            chosen: None,
        };
        let draw = |ui: &mut Ui, state: &mut OpenTest| {
            let chosen = open_panel(ui, &mut state.panel, &state.recent);
            state.chosen = chosen.or(state.chosen.take());
        };
        Harness::builder().with_size([700.0, 2_000.0]).build_ui_state(draw, state)
    }

    #[test]
    fn scenes_and_folders_are_listed_and_a_click_opens_one() {
        let mut harness = harness(RecentFiles::default());
        assert!(harness.query_by_label("README.md").is_none());
        harness.get_by_label("road.toml").click();
        harness.run();
        let chosen = harness.state().chosen.clone().expect("chosen");
        assert!(chosen.ends_with("scenes/road.toml"), "{}", chosen.display());
    }

    #[test]
    fn a_click_on_a_folder_lists_it() {
        let mut harness = harness(RecentFiles::default());
        harness.get_by_label("Folder above").click();
        harness.run();
        harness.get_by_label("assets/").click();
        harness.run();
        harness.get_by_label("jacksboro/").click();
        harness.run();
        harness.get_by_label("dem.tif");
        assert_eq!(harness.state().chosen, None);
    }

    #[test]
    fn a_typed_path_and_a_file_opened_last_are_chosen() {
        let mut recent = RecentFiles::default();
        recent.add(Path::new("/maps/valley.toml"));
        let mut harness = harness(recent);
        harness.get_by_label("Path").focus();
        harness.run();
        harness.get_by_label("Path").type_text("road.toml");
        harness.run();
        harness.get_by_label("Open").click();
        harness.run();
        assert!(harness.state().chosen.as_ref().is_some_and(|path| path.ends_with("scenes/road.toml")));
        harness.get_by_label("valley.toml   /maps").click();
        harness.run();
        assert_eq!(harness.state().chosen, Some(PathBuf::from("/maps/valley.toml")));
    }
}
