//! Features on the ground, and the vector files that they come from.

#[path = "../common/mod.rs"]
mod common;

mod analysis_land;
mod areas;
mod bridges;
mod building_tags;
mod buildings;
mod check_built;
mod check_data;
mod check_walk;
mod city_buildings;
mod coast;
mod conform;
mod earthworks;
mod fences;
mod land_cover;
mod left_out;
mod left_out_models;
mod left_out_rasters;
mod level_ground;
mod overlay_files;
mod roads;
mod vector_files;
mod water;
