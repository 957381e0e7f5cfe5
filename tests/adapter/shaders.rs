//! The shaders of the GPU renderer are valid on every machine: this test needs no adapter.

use std::collections::BTreeSet;
use std::path::Path;

use naga::valid::{Capabilities, ValidationFlags, Validator};
use sandtable_draw::shader_constants::{ShaderLanguage, shader_constants};
use sandtable_render::shadow::filter;

/// The folder of the shaders.
const FOLDER: &str = concat!(env!("SANDTABLE_ROOT"), "src/gpu");

/// The modules, as files that are joined.
const MODULES: [&[&str]; 5] = [
    &[
        "items.wgsl",
        "shadow_pages.wgsl",
        "shader.wgsl",
        "area.wgsl",
        "ground_windows.wgsl",
        "ground_pixels.wgsl",
        "whole_picture.wgsl",
        "sky.wgsl",
    ],
    &["whole_picture.wgsl", "encode.wgsl"],
    &["items.wgsl", "shadow_pages.wgsl", "shadow_level.wgsl", "shadow_draw.wgsl"],
    &["shadow_pages.wgsl", "shadow_level.wgsl", "shadow_finish.wgsl"],
    &["instance_culling.wgsl"],
];

fn text_of(module: &[&str]) -> String {
    let read = |file: &&str| {
        let path = Path::new(FOLDER).join(file);
        std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    };
    let constants = [shader_constants(), filter::shader_constants()].concat();
    ShaderLanguage::Wgsl.declarations(&constants) + &module.iter().map(read).collect::<Vec<_>>().join("\n")
}

#[test]
fn every_shader_is_valid_without_any_gpu() {
    for module in MODULES {
        let text = text_of(module);
        let parsed = naga::front::wgsl::parse_str(&text)
            .unwrap_or_else(|error| panic!("{module:?}: {}", error.emit_to_string(&text)));
        Validator::new(ValidationFlags::all(), Capabilities::empty())
            .validate(&parsed)
            .unwrap_or_else(|error| panic!("{module:?}: {}", error.emit_to_string(&text)));
        assert!(!parsed.entry_points.is_empty(), "{module:?} draws nothing");
    }
}

#[test]
fn no_shader_is_left_out() {
    let files = std::fs::read_dir(FOLDER).unwrap_or_else(|error| panic!("{FOLDER}: {error}"));
    let names = files.map(|file| file.expect("a folder's entry").file_name().to_string_lossy().into_owned());
    let found: BTreeSet<String> = names.filter(|name| name.ends_with(".wgsl")).collect();
    let known: BTreeSet<String> = MODULES.concat().iter().map(|&name| name.to_owned()).collect();
    assert_eq!(found, known);
}
