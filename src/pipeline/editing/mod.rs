//! Changes of a scene that a user makes: applied, undone and saved into the scene file.
