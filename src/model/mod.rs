//! Model files — 3DS, OBJ with MTL, glTF and GLB — to one [`kind::Model`], Z up, no file system.

pub mod kind;
