//! Changes of a scene that a user makes: applied, undone and saved into the scene file.
//!
//! ```text
//!  clicks ─► tool ─┐
//!                  ▼
//!  SceneEdit ─► editor: places in the systems of the file ─► scene_text: bytes of the file ─► decoded as any scene file
//!                                                                                            │ wrong: nothing changes
//!  window ◄── EditEffect: ground mended, a model moved, or the scene built anew ◄── effect ◄─┘
//!             save: beside the file, then renamed over it
//! ```
//!
//! The text of the file is what is edited, so that all that its author wrote stays as it is, and undoing all edits gives
//! the same bytes. A scene that is built on a thread is that of the text at its start: where
//! [`source`](editor::SceneEditor::source) has changed meanwhile, it is built once more.

pub mod analysis_draft;
pub mod edit;
pub mod editor;
pub mod effect;
mod scene_text;
mod text_change;
pub mod tool;
pub mod view_snapshot;
pub mod viewed_camera;
pub mod viewing;
