//! The window that walks through a scene.
//!
//! ```text
//! window ─► keys, pointer ─► app ─► panels ─► commands        egui; no adapter needed: tests run it without a window
//!   │                         │
//!   │                         ├─ loading ─► scene              on a thread, with progress; and on others:
//!   │                         ├─ opened scene: walk, camera       relisting: what stands, its light; shadowing; drawing:
//!   │                         │                                   pictures; reaching: nested spheres; paging: terrain on
//!   │                         │                                   disk; disk_answers: its heights; analyzing: what a user
//!   │                         │                                   tries; all of them: worker
//!   └─────► graphics ◄── changes of the ground, camera         wgpu: the surface, the scene, the panels over it, drawn on a
//!                                                              thread while the next frame is made
//! ```
//!
//! `app` is all of the window but its surface: `show` draws panels and takes input, `advance` moves the camera and asks the
//! walk what changed. `window` lends it a surface and the clock; `offscreen` lends it a texture, and the clock of a script.

mod active_tool;
mod analysis_listing;
mod analyzing;
#[cfg(test)]
mod analyzing_tests;
mod app;
#[cfg(test)]
mod app_tests;
mod awaited_answers;
mod commands;
mod disk_answers;
mod drawing_job;
mod drawn_size;
pub mod error;
mod finer_ground;
mod following;
mod frame_drawer;
mod frame_graphics;
mod frame_thread;
mod frame_times;
mod ghost;
mod graphics;
mod labels;
mod layout;
mod letter_run;
mod lettering;
mod line_names;
mod line_piece;
mod loading;
mod measuring;
mod moving;
mod name_lines;
mod notices;
mod offscreen;
mod opened;
mod paging;
#[cfg(test)]
mod paging_tests;
mod panels;
mod phases;
mod picked_part;
mod picture_paint;
mod place;
mod place_picking;
mod reaching;
mod recent;
mod relisting;
mod saving;
mod saving_question;
mod scene_graphics;
mod scene_jobs;
mod scene_load;
mod script;
mod script_run;
mod session;
mod shadow_state;
mod shadowing;
mod snapshots;
mod symbol_layer;
mod tool_use;
mod view_area;
mod viewsheds;
mod watch;
mod window;
mod window_point;
mod worker;

use crate::error::ViewerError;
use sandtable_editing::viewing::ViewerOptions;

/// Opens a window on what `options` name, or draws its frames without one; returns when it is closed.
///
/// # Errors
/// [`ViewerError`]: no window or no graphics adapter can be had here. A file that cannot be opened is not an error of a window,
/// which says so.
pub fn run(options: &ViewerOptions) -> Result<(), ViewerError> {
    match (options.offscreen, options.script.as_deref()) {
        (Some(size), Some(script)) => offscreen::run(options, size, script),
        _ => window::run(options),
    }
}
