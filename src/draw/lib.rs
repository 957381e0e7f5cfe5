//! Draw lists: the contract between scenes and renderers. They state the content of a picture, not the method of
//! drawing.

pub mod area_texture;
pub mod backdrop;
pub mod bathymetry;
pub mod border;
pub mod box_blur;
pub mod color;
pub mod contour_ground;
pub mod cover_noise;
mod field_plots;
mod floor;
pub mod font;
pub mod ground;
pub mod ground_cover;
pub mod ground_grain;
pub mod ground_imagery;
pub mod ground_inset;
pub mod ground_levels;
pub mod ground_tops;
pub mod ground_window;
mod halved_cells;
pub mod hatching;
mod lanes;
pub mod lighting;
pub mod list;
pub mod lowbias;
pub mod material;
pub mod patches;
pub mod pixels;
pub mod print_pattern;
pub mod relief_lanes;
pub mod shader_constants;
mod shown;
pub mod undergrowth;
pub mod water;
pub mod water_relief;
pub mod wireframe;
