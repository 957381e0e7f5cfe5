//! Fits a camera to the ground that it shows, before and after its heights are known.

pub mod fit;
pub mod fitted_view;
pub mod main_part;
pub mod panorama_frame;
pub mod parallel_view;
pub mod shaped_page;
pub mod shown_step;
