#![doc = include_str!("ARCHITECTURE.md")]

pub mod annotate;
pub mod app;
pub mod dem;
pub mod description;
pub mod draw;
pub mod geom;
pub mod mesh;
pub mod model;
pub mod render;
pub mod ribbon;
pub mod roam;
pub mod scene;
pub mod structure;
pub mod terrain;
pub mod vector;
pub mod view;
