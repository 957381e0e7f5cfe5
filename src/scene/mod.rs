//! Scenes, from their description and the files it names.

pub mod assets;
