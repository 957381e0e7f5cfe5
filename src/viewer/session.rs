//! The edits of an open scene: in its file's text, and in the ground that is shown.
//!
//! An edit that moves earth is seen in the next frame: it is done in the walk's own ground, and the scene is not built anew.
//! What else changes the scene builds it anew, on a thread.

use crate::loading::opening_error;
use crate::opened::OpenedScene;
use sandtable_earthworks::earthwork::dig;
use sandtable_editing::edit::SceneEdit;
use sandtable_editing::editor::SceneEditor;
use sandtable_editing::effect::{EditEffect, MovedModel};
use sandtable_editing::tool::ToolSettings;
use sandtable_picture::models::PlacementMove;
use sandtable_terrain::volumes::Volumes;
use sandtable_walk::edit::WalkEdit;

/// The work that an edit leaves to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EditOutcome {
    /// It is shown.
    Shown,
    /// The scene is to be built anew.
    Rebuild,
}

/// The edits of an open scene.
pub struct EditingSession {
    /// The scene's text with its history.
    pub editor: SceneEditor,
    /// The sizes that tools draw with.
    pub settings: ToolSettings,
    /// The text that the scene was built of: the places of its features are in it.
    pub built_of: String,
    /// The earth that the last edit moved; `None` where it moved none.
    pub moved: Option<Volumes>,
    /// What was dug since the scene was built, the last at the end; `None` for a digging that changed nothing.
    dug: Vec<Option<WalkEdit>>,
}

impl EditingSession {
    /// The edits of a scene that was just opened.
    pub fn new(editor: SceneEditor, opened: &OpenedScene) -> Self {
        let cell_m = opened.walk.lattice().cell().max_element();
        let built_of = editor.text().to_owned();
        Self { editor, settings: ToolSettings::for_cell(cell_m), built_of, moved: None, dug: Vec::new() }
    }

    /// Records that the scene was built of `text`.
    pub fn rebuilt(&mut self, text: String) {
        self.built_of = text;
        self.dug.clear();
    }

    /// Makes an edit.
    ///
    /// # Errors
    /// Why it cannot be made, for the user; the scene stays as it was.
    pub fn apply(&mut self, edit: &SceneEdit, opened: &mut OpenedScene) -> Result<EditOutcome, String> {
        let effect = self.editor.apply(edit, &opened.scene).map_err(|error| opening_error(&error))?;
        Ok(self.show(effect, opened))
    }

    /// Takes back the last edit; `None` where there is none.
    pub fn undo(&mut self, opened: &mut OpenedScene) -> Option<EditOutcome> {
        let effect = self.editor.undo()?;
        Some(self.show(effect, opened))
    }

    /// Makes the edit again that was taken back last; `None` where there is none.
    pub fn redo(&mut self, opened: &mut OpenedScene) -> Option<EditOutcome> {
        let effect = self.editor.redo()?;
        Some(self.show(effect, opened))
    }

    fn show(&mut self, effect: EditEffect, opened: &mut OpenedScene) -> EditOutcome {
        self.moved = None;
        match effect {
            // The list of cameras, and the texts of pictures.
            EditEffect::Views => EditOutcome::Rebuild,
            EditEffect::Dig(works) => {
                let held = std::sync::Arc::clone(&opened.scene.held);
                opened.leave_one_ground();
                let made = opened.walk.edit(|lattice| dig(&works, lattice, &held));
                let Ok(made) = made else { return EditOutcome::Rebuild };
                self.moved = made.as_ref().map(|made| made.volumes);
                let made = made.map(|made| self.shown(made, opened));
                self.dug.push(made);
                EditOutcome::Shown
            }
            EditEffect::TakeBack => {
                let Some(last) = self.dug.pop() else { return EditOutcome::Rebuild };
                let Some(last) = last else { return EditOutcome::Shown };
                opened.leave_one_ground();
                match opened.walk.take_back(&last.pieces) {
                    Ok(Some(made)) => {
                        self.shown(made, opened);
                        EditOutcome::Shown
                    }
                    Ok(None) => EditOutcome::Shown,
                    Err(_) => EditOutcome::Rebuild,
                }
            }
            EditEffect::Move(MovedModel { placement, at, heading_rad }) => {
                opened.walk.move_model(placement, PlacementMove { at, heading_rad });
                opened.relist();
                EditOutcome::Shown
            }
            EditEffect::Rebuild => EditOutcome::Rebuild,
        }
    }

    /// Lets what stands on the ground follow an edit.
    fn shown(&self, made: WalkEdit, opened: &mut OpenedScene) -> WalkEdit {
        match made.moves_standing {
            true => opened.relist(),
            false => opened.shadows.forget(),
        }
        made
    }
}
