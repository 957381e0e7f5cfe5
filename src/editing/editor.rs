//! The editor of a scene file: edits, undo, redo, save.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec2;

use crate::edit::{EditPlace, EditValue, NewTable, SceneEdit};
use crate::effect::{self, EditEffect, EditPreview, EffectOfEdit};
use crate::scene_text::{self, SceneTextError};
use crate::text_change::TextChange;
use sandtable_description::diagnostic::{Diagnostic, Diagnostics};
use sandtable_description::document::Document;
use sandtable_description::parse::parse_in_phase;
use sandtable_files::disk::{self, ReadFileError, SystemError, WriteFileError};
use sandtable_geom::crs::{Crs, CrsError};
use sandtable_raster::raster::Raster;
use sandtable_scene::assets::{AssetError, Assets};
use sandtable_scene::build::{SceneGround, build, build_ground};
use sandtable_scene::feature::SceneFeature;
use sandtable_scene::scene_file::{OpenSceneError, check_phase};
use sandtable_scene::scene_model::SceneModel;
use sandtable_terrain::lattice::Lattice;

/// Decimals of coordinates that are written in degrees: a millimeter.
const DEGREE_DECIMALS: i32 = 8;
/// Decimals of coordinates and sizes that are written in meters: a millimeter.
const METER_DECIMALS: i32 = 3;

/// An edit that cannot be made; the scene stays as it was.
#[derive(Debug, thiserror::Error)]
pub enum EditError {
    /// The text has no such place, or is written in a way that is not edited.
    #[error(transparent)]
    Text(#[from] SceneTextError),
    /// The scene would be wrong; its place is in the text after the edit.
    #[error("the scene would be wrong after this")]
    Wrong(#[from] Diagnostics),
    /// What was added does not fit the scene.
    #[error("this does not fit the scene")]
    Misfit(#[from] Diagnostic),
    /// A place cannot be written in the system that the scene file states.
    #[error(transparent)]
    Place(#[from] CrsError),
    /// A number is not finite.
    #[error("{0} is not a number that a scene file holds")]
    NotFinite(f64),
    /// The scene's folder cannot be read.
    #[error(transparent)]
    Assets(#[from] AssetError),
}

/// A scene that cannot be saved; the file is as it was.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum SaveError {
    #[error("{}: another program has changed this file since it was opened; save anyway, or open it again", .0.display())]
    ChangedOnDisk(PathBuf),
    #[error("{}: this file exists already; save under another name", .0.display())]
    Exists(PathBuf),
    #[error("{}: this file is protected against writing", .0.display())]
    Protected(PathBuf),
    #[error(transparent)]
    Read(#[from] ReadFileError),
    #[error(transparent)]
    Write(#[from] WriteFileError),
}

/// The treatment of changes that another program made to the file, when a scene is saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnConflict {
    /// The scene is not saved.
    Refuse,
    /// They are lost.
    Overwrite,
}

/// The text of a scene file with its history.
pub struct SceneEditor {
    source: SceneSource,
    document: Document,
    /// The file's content as it was read or saved last; `None` where there is no file yet.
    saved: Option<String>,
    done: Vec<DoneEdit>,
    undone: Vec<DoneEdit>,
}

/// The inputs of a scene: they can be sent to a thread that builds it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneSource {
    /// Where the scene file is, or will be; names of files are relative to it.
    pub path: PathBuf,
    /// Folders that the scene may read besides the parent of its own.
    pub allowed: Vec<PathBuf>,
    /// The phase that is shown; `None` for the first.
    pub phase: Option<String>,
    /// The text.
    pub text: String,
}

struct DoneEdit {
    change: TextChange,
    effect: EffectOfEdit,
}

impl SceneSource {
    /// Builds the scene. `progress` is called with the name of each step as it begins.
    ///
    /// # Errors
    /// See [`OpenSceneError`].
    pub fn build(&self, progress: &dyn Fn(&'static str)) -> Result<SceneModel, OpenSceneError> {
        self.build_of(Assets::new(&self.path, &self.allowed)?, progress)
    }

    /// [`SceneSource::build`] on `elevation` in place of the elevation file.
    ///
    /// # Errors
    /// See [`OpenSceneError`].
    pub fn build_on(
        &self,
        elevation: Arc<Raster>,
        progress: &dyn Fn(&'static str),
    ) -> Result<SceneModel, OpenSceneError> {
        self.build_of(Assets::new(&self.path, &self.allowed)?.with_elevation(elevation), progress)
    }

    /// Builds the scene with heights true to scale and without its analyses, for the land of one.
    ///
    /// # Errors
    /// See [`OpenSceneError`].
    pub fn build_land(&self) -> Result<SceneModel, OpenSceneError> {
        let assets = Assets::new(&self.path, &self.allowed)?;
        let mut document = self.decode(&self.text, &assets)?;
        document.terrain.vertical_exaggeration = 1.0;
        document.analyses.clear();
        Ok(build(&document, &assets, &|_| ())?)
    }

    /// The ground of the text as it is, saved or not, in the phase called `phase`.
    ///
    /// # Errors
    /// See [`OpenSceneError`].
    pub fn ground_in_phase(&self, phase: &str) -> Result<SceneGround, OpenSceneError> {
        let assets = Assets::new(&self.path, &self.allowed)?;
        let source = Self { phase: Some(phase.to_owned()), ..self.clone() };
        let document = source.decode(&source.text, &assets)?;
        check_phase(&document, Some(phase))?;
        Ok(build_ground(&document, &assets)?)
    }

    fn build_of(
        &self,
        assets: Assets,
        progress: &dyn Fn(&'static str),
    ) -> Result<SceneModel, OpenSceneError> {
        Ok(build(&self.decode(&self.text, &assets)?, &assets, progress)?)
    }

    fn decode(&self, text: &str, assets: &Assets) -> Result<Document, Diagnostics> {
        let load = |name: &str| assets.read(name).map_err(Into::into);
        parse_in_phase(&self.path.to_string_lossy(), text.as_bytes(), &load, self.phase.as_deref())
    }
}

impl SceneEditor {
    /// Opens the scene file at `path`, shown in a phase. It reads files under the parent of its folder and under `allowed`.
    ///
    /// # Errors
    /// The file cannot be read or is wrong.
    pub fn open(path: &Path, allowed: &[PathBuf], phase: Option<&str>) -> Result<Self, OpenSceneError> {
        let text = disk::read_text(path)?;
        let (allowed, phase) = (allowed.to_vec(), phase.map(str::to_owned));
        let source = SceneSource { path: path.to_owned(), allowed, phase, text };
        let saved = Some(source.text.clone());
        Self::of(source, saved)
    }

    /// The editor of a scene that has no file yet, which [`SceneEditor::save`] makes.
    ///
    /// # Errors
    /// The text is wrong.
    pub fn unsaved(source: SceneSource) -> Result<Self, OpenSceneError> {
        Self::of(source, None)
    }

    /// The editor of a new scene of the elevation file `dem` alone, with a scene file beside it: the same scene as a window
    /// shows of that file.
    ///
    /// # Errors
    /// The folder cannot be read.
    pub fn of_elevation(dem: &Path, allowed: &[PathBuf]) -> Result<Self, OpenSceneError> {
        let path = free_name(dem);
        let title = toml_edit::Value::from(disk::file_stem(dem));
        let name = toml_edit::Value::from(disk::file_name(dem));
        let text = format!("title = {title}\n\n[terrain]\ndem = {name}\n");
        Self::unsaved(SceneSource { path, allowed: allowed.to_vec(), phase: None, text })
    }

    fn of(source: SceneSource, saved: Option<String>) -> Result<Self, OpenSceneError> {
        let assets = Assets::new(&source.path, &source.allowed)?;
        let document = source.decode(&source.text, &assets)?;
        Ok(Self { source, document, saved, done: Vec::new(), undone: Vec::new() })
    }

    /// Shows the phase called `name` from now on; the text stays as it is.
    ///
    /// # Errors
    /// The scene has no such phase; the one from before is shown.
    pub fn show_phase(&mut self, name: &str) -> Result<(), OpenSceneError> {
        let source = SceneSource { phase: Some(name.to_owned()), ..self.source.clone() };
        let assets = Assets::new(&source.path, &source.allowed)?;
        let document = source.decode(&source.text, &assets)?;
        check_phase(&document, Some(name))?;
        (self.source, self.document) = (source, document);
        Ok(())
    }

    /// The inputs of the scene, with all edits.
    pub fn source(&self) -> &SceneSource {
        &self.source
    }

    /// The text as it is now.
    pub fn text(&self) -> &str {
        &self.source.text
    }

    /// The scene file as it is decoded now.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// Whether there is something to save.
    pub fn is_changed(&self) -> bool {
        self.saved.as_deref().is_some_and(|saved| saved != self.text())
            || (self.saved.is_none() && !self.done.is_empty())
    }

    /// Whether there is an edit to undo.
    pub fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    /// Whether there is an edit to redo.
    pub fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }

    /// Applies an edit and returns its effect on `scene`, which was built of the text before it.
    ///
    /// # Errors
    /// See [`EditError`].
    pub fn apply(&mut self, edit: &SceneEdit, scene: &SceneModel) -> Result<EditEffect, EditError> {
        let text = self.edited(edit, scene)?;
        let assets = Assets::new(&self.source.path, &self.source.allowed)?;
        let document = self.source.decode(&text, &assets)?;
        let effect = effect::effect(edit, [&self.document, &document], &assets, scene)?;
        let change = TextChange::between(self.text(), &text);
        self.document = document;
        self.source.text = text;
        let forward = effect.forward.clone();
        self.done.push(DoneEdit { change, effect });
        self.undone.clear();
        Ok(forward)
    }

    /// The earth that an edit would move; the edit is not made. `ground` holds the elevations as they are now, true to
    /// scale.
    ///
    /// # Errors
    /// See [`EditError`].
    pub fn preview(
        &self,
        edit: &SceneEdit,
        scene: &SceneModel,
        ground: &Lattice,
    ) -> Result<EditPreview, EditError> {
        let text = self.edited(edit, scene)?;
        let assets = Assets::new(&self.source.path, &self.source.allowed)?;
        let document = self.source.decode(&text, &assets)?;
        Ok(effect::preview(edit, [&self.document, &document], &assets, scene, ground)?)
    }

    /// The table that places a model of `scene` alone, by the model's number among the placements; `None` where the text
    /// has none that can be edited.
    pub fn place_of_model(&self, placement: usize, scene: &SceneModel) -> Option<EditPlace> {
        effect::place_of_model(&self.document, self.text(), placement, scene)
    }

    /// The table that states a label of `scene` at one place, by the label's number; `None` where the text has none that
    /// can be edited.
    pub fn place_of_label(&self, label: usize, scene: &SceneModel) -> Option<EditPlace> {
        effect::place_of_label(&self.document, self.text(), label, scene)
    }

    /// The table that states a feature of a scene that was built of the text `built_of`; `None` for what an included file
    /// states. Since then tables were added after those of their lists alone.
    pub fn place_of_feature(&self, built_of: &str, feature: &SceneFeature) -> Option<EditPlace> {
        let span = &feature.origin.span;
        let is_stated = !span.is_empty() && span.end <= built_of.len();
        is_stated.then(|| scene_text::table_at(built_of, span.start)).flatten()
    }

    /// The number that a table states for a key; `None` where it states none, or an expression.
    pub fn stated_number(&self, place: &EditPlace, key: &str) -> Option<f64> {
        scene_text::stated_number(self.text(), place, key)
    }

    /// The text that a table states for a key; `None` where it states none.
    pub fn stated_text(&self, place: &EditPlace, key: &str) -> Option<String> {
        scene_text::stated_text(self.text(), place, key)
    }

    /// Undoes the last edit; `None` where there is none.
    pub fn undo(&mut self) -> Option<EditEffect> {
        let last = self.done.pop()?;
        last.change.revert(&mut self.source.text);
        let back = last.effect.back.clone();
        self.undone.push(last);
        Some(self.decoded_again(back))
    }

    /// Makes the edit again that was undone last; `None` where there is none.
    pub fn redo(&mut self) -> Option<EditEffect> {
        let next = self.undone.pop()?;
        next.change.apply(&mut self.source.text);
        let forward = next.effect.forward.clone();
        self.done.push(next);
        Some(self.decoded_again(forward))
    }

    /// Decodes a text that was sound before. Where an included file has changed since, the last sound document stays, and
    /// building the scene reports the error.
    fn decoded_again(&mut self, effect: EditEffect) -> EditEffect {
        let assets = Assets::new(&self.source.path, &self.source.allowed).ok();
        match assets.and_then(|assets| self.source.decode(self.text(), &assets).ok()) {
            Some(document) => {
                self.document = document;
                effect
            }
            None => EditEffect::Rebuild,
        }
    }

    /// Writes the scene file: beside it, then renamed over it.
    ///
    /// # Errors
    /// See [`SaveError`].
    pub fn save(&mut self, on_conflict: OnConflict) -> Result<(), SaveError> {
        // A link stays a link.
        let path = self.source.path.canonicalize().unwrap_or_else(|_| self.source.path.clone());
        if on_conflict == OnConflict::Refuse {
            self.check_conflict(&path)?;
        }
        let permissions = fs::metadata(&path).ok().map(|metadata| metadata.permissions());
        if permissions.as_ref().is_some_and(fs::Permissions::readonly) {
            return Err(SaveError::Protected(path));
        }
        disk::write(&path, self.text().as_bytes())?;
        if let Some(permissions) = permissions {
            let failed = |error| WriteFileError::new(&path, SystemError::from(error));
            fs::set_permissions(&path, permissions).map_err(failed)?;
        }
        self.saved = Some(self.text().to_owned());
        Ok(())
    }

    fn check_conflict(&self, path: &Path) -> Result<(), SaveError> {
        match (&self.saved, path.exists()) {
            (None, true) => Err(SaveError::Exists(path.to_owned())),
            (Some(saved), true) if disk::read(path)? != saved.as_bytes() => {
                Err(SaveError::ChangedOnDisk(path.to_owned()))
            }
            _ => Ok(()),
        }
    }

    /// The text after an edit whose places are in the system of `scene`.
    fn edited(&self, edit: &SceneEdit, scene: &SceneModel) -> Result<String, EditError> {
        self.edited_text(self.text(), edit, scene)
    }

    fn edited_text(&self, text: &str, edit: &SceneEdit, scene: &SceneModel) -> Result<String, EditError> {
        match edit {
            SceneEdit::Add(table) => {
                let crs = self.points_crs(scene);
                let keys = table
                    .keys
                    .iter()
                    .map(|(key, value)| Ok::<_, EditError>((key.clone(), placed(value, &scene.crs, crs)?)));
                let keys = keys.collect::<Result<_, _>>()?;
                Ok(scene_text::with_table(text, &NewTable { name: table.name.clone(), keys })?)
            }
            SceneEdit::Set { place, keys, value } => {
                let stated = match place {
                    EditPlace::Table { .. } => scene_text::stated_text(text, place, "crs"),
                    EditPlace::Root => None,
                };
                let own = stated.map(|stated| Crs::parse(&stated)).transpose()?;
                let crs = own.as_ref().unwrap_or_else(|| self.points_crs(scene));
                Ok(scene_text::with_value(text, place, keys, &placed(value, &scene.crs, crs)?)?)
            }
            SceneEdit::Remove(place) => Ok(scene_text::without_table(text, place)?),
            SceneEdit::Together(edits) => {
                edits.iter().try_fold(text.to_owned(), |text, edit| self.edited_text(&text, edit, scene))
            }
        }
    }

    /// The system of inline points of tables that state none.
    fn points_crs<'a>(&'a self, scene: &'a SceneModel) -> &'a Crs {
        self.document.points_crs.as_ref().unwrap_or(&scene.stated_crs)
    }
}

/// The value with its places brought from one system to another, and its numbers rounded to millimeters.
fn placed(value: &EditValue, from: &Crs, to: &Crs) -> Result<EditValue, EditError> {
    let decimals = if to.is_geographic() { DEGREE_DECIMALS } else { METER_DECIMALS };
    let point = |&at: &[f64; 2]| -> Result<[f64; 2], EditError> {
        let at = from.transform(to, DVec2::from(at))?;
        Ok([rounded(at.x, decimals)?, rounded(at.y, decimals)?])
    };
    Ok(match value {
        EditValue::Number(number) => EditValue::Number(rounded(*number, DEGREE_DECIMALS)?),
        EditValue::Numbers(numbers) => {
            let all = numbers.iter().map(|number| rounded(*number, DEGREE_DECIMALS));
            EditValue::Numbers(all.collect::<Result<_, _>>()?)
        }
        EditValue::Point(at) => EditValue::Point(point(at)?),
        EditValue::Points(points) => EditValue::Points(points.iter().map(point).collect::<Result<_, _>>()?),
        EditValue::Text(_) => value.clone(),
    })
}

fn rounded(number: f64, decimals: i32) -> Result<f64, EditError> {
    if !number.is_finite() {
        return Err(EditError::NotFinite(number));
    }
    // By way of text, which rounds the decimal and not a multiple of it.
    let places = decimals.max(0) as usize;
    Ok(format!("{number:.places$}").parse().unwrap_or(number))
}

/// The name of a scene file beside an elevation file that no file has.
fn free_name(dem: &Path) -> PathBuf {
    let stem = disk::file_stem(dem);
    let numbered = (2..).map(|number| format!("{stem}-{number}.toml"));
    let mut names =
        std::iter::once(format!("{stem}.toml")).chain(numbered).map(|name| dem.with_file_name(name));
    names.find(|path| path.symlink_metadata().is_err()).unwrap_or_else(|| dem.with_extension("toml"))
}
