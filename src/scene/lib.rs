//! Builds a scene from a scene file: the ground, the features on it, labels and cameras.
//!
//! `build` turns a document and its assets into a [`SceneGround`](build::SceneGround) or a
//! [`SceneModel`](scene_model::SceneModel), one pass a file: the ground (`ground`), ribbons (`areas`, `water`, `roads`),
//! solids (`buildings`, `fences`, `bridges`), models (`models`, `scatter`; `footprint` and `placement` set them on the
//! ground), labels (`labels`) and cameras (`views`). The passes add to `builder`; what they add (`feature`,
//! `feature_meshes`, `placed_model`, `scene_graphic`, `scene_label`, `scene_view`) knows none of them.
//! `picture` turns a scene and a camera into a draw list.

mod all_samples;
pub mod analyses;
mod analysis_letters;
pub mod analysis_map;
pub mod areas;
pub mod assets;
pub mod attributes;
pub mod bridges;
pub mod build;
pub mod build_errors;
pub mod builder;
pub mod building_colors;
mod building_parts;
mod building_tags;
pub mod buildings;
mod cause_code;
mod city_buildings;
mod city_paint;
pub mod crossed_shapes;
pub mod earthworks;
mod elevation;
mod exact_ground;
pub mod facade;
pub mod feature;
pub mod feature_labels;
pub mod feature_meshes;
pub mod feature_origin;
pub mod fences;
pub mod finer_elevation;
pub mod flights;
mod font;
pub mod footprint;
pub mod framing;
pub mod graphics;
pub mod ground;
pub mod ground_map;
pub mod ground_map_cache;
pub mod ground_window;
pub mod imagery;
pub mod label_course;
mod labels;
pub mod land;
pub mod land_cover;
mod meant_number;
pub mod military;
pub mod misplacement;
pub mod model_file;
pub mod models;
pub mod near;
mod overlays;
pub mod overridden_crs;
pub mod paper_sheet;
pub mod placed_model;
mod placed_sight;
pub mod placement;
pub mod planned_pictures;
pub mod plinth;
pub mod ramps;
mod reduced_elevation;
mod relief_strength;
pub mod report;
pub mod roads;
pub mod scatter;
pub mod scene_file;
pub mod scene_findings;
pub mod scene_graphic;
pub mod scene_label;
pub mod scene_model;
pub mod scene_view;
pub mod seen_ground;
mod shape_place;
mod shaped_ground;
pub mod sight_layers;
pub mod source_reach;
pub mod sources;
mod spot_heights;
pub mod style;
pub mod sunlight;
pub mod symbols;
pub mod table_shadow;
pub mod tag_notes;
pub mod texture_shading;
mod told_tally;
pub mod undergrowth;
pub mod vertical_scale;
pub mod views;
pub mod water;
pub mod wood;
pub mod world_frame;
