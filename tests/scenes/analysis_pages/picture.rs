//! The pictures of the pages: a map of what an analysis gives with its legend, kept in few colors.

use std::fs;
use std::io::{BufReader, BufWriter};
use std::path::Path;

use image::RgbImage;
use sandtable_analysis::outcome::Outcome;
use sandtable_annotate::paint::annotate;
use sandtable_catalog::kind::AnalysisKind;
use sandtable_draw::pixels::Pixels;
use sandtable_picture::build_draw_list;
use sandtable_render::{RenderBackend, render};
use sandtable_scene::scene_file::build_scene_text;
use sandtable_sheet::labels::{AnnotatedGround, annotations};
use sandtable_sheet::legend_overlay::overlay_entries;
use sandtable_sheet::look::apply_look;
use sandtable_sheet::picture::{PictureSize, framed_camera};

use crate::analysis_pages::examples::Example;
use crate::analysis_pages::page::analysis_table;
use crate::analysis_pages::palette::{Palette, PictureColors};

/// Small enough for a page and for the repository, large enough for a legend.
pub const SIZE: PictureSize = PictureSize { width: 560, height: 360 };

/// The size of the picture that it is cut from: lines are as wide as on a large map, not as on a small one.
const DRAWN: PictureSize = PictureSize { width: SIZE.width, height: 2 * SIZE.height };

/// The colors of a picture.
const COLORS: usize = 60;

/// How far apart a pixel's channels may be on average before the picture is another one.
const MOST_APART: f64 = 3.0;

/// A pixel that is farther from the kept one has changed.
const CHANGED: u8 = 48;

/// The share of pixels that may have.
const MOST_CHANGED: f64 = 0.004;

/// The scene of an example.
fn scene_text(kind: &'static AnalysisKind, example: &Example) -> String {
    let [x, y, scale] = example.shows;
    format!(
        "{}{}\n[[camera]]\nname = \"map\"\nprojection = \"plan\"\nscale = {scale}\nshows = [[{}, {}], [{}, {}]]\n\
         [furniture]\ngrid = \"none\"\nlegend = false\nnorth_arrow = false\ntitle = false\n",
        example.land.tables(),
        analysis_table(kind, example),
        x - 1.0,
        y - 1.0,
        x + 1.0,
        y + 1.0,
    )
}

/// What an example gives, and its picture.
pub fn made(kind: &'static AnalysisKind, example: &Example) -> (Outcome, RgbImage) {
    let name = kind.name;
    let path = Path::new(env!("SANDTABLE_ROOT")).join("scenes").join(format!("{name}.toml"));
    let scene = build_scene_text(&path, &scene_text(kind, example), &[], &|_| ());
    let scene = scene.unwrap_or_else(|error| panic!("{name}: {error}\n{:?}", error.findings()));
    let view = scene.cameras.iter().find(|view| view.name == "map").expect("the map's camera");
    let camera = |size| framed_camera(&scene, view, size).expect("it sees the land").0;
    let drawn = build_draw_list(&scene, &camera(DRAWN), &|_| ());
    let camera = camera(SIZE);
    let mut picture = render(&drawn.list, &camera, RenderBackend::Cpu, &|_| ()).expect("a sound list");
    apply_look(&scene, Some((&drawn.list, &camera)), &mut picture);
    let shown =
        AnnotatedGround { graphics: &drawn.graphic_texts, nested: &drawn.nested, list: Some(&drawn.list) };
    let mut notes = annotations(&scene, &camera, &picture, None, &shown);
    // The legend is that of the analysis alone: what a map has besides tells itself.
    notes.classes = overlay_entries(&scene, &picture);
    annotate(&mut picture.pixels, &notes);
    (scene.analyses[0].outcome.clone(), rgb(&picture.pixels))
}

fn rgb(pixels: &Pixels) -> RgbImage {
    let data = pixels.data().iter().flat_map(|color| [color.0[0], color.0[1], color.0[2]]).collect();
    RgbImage::from_raw(pixels.width(), pixels.height(), data).expect("three bytes a pixel")
}

/// Writes a picture in few colors.
pub fn write(picture: &RgbImage, path: &Path) {
    let file = fs::File::create(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let colors = PictureColors::of(picture, COLORS);
    let mut encoder = png::Encoder::new(BufWriter::new(file), picture.width(), picture.height());
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(colors.palette.bytes());
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    let mut writer = encoder.write_header().expect("writable");
    writer.write_image_data(&colors.indices).expect("writable");
}

/// A picture as it is kept.
fn read(path: &Path) -> Result<RgbImage, String> {
    let wrong = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let file = fs::File::open(path).map_err(|error| wrong(&error))?;
    let mut reader = png::Decoder::new(BufReader::new(file)).read_info().map_err(|error| wrong(&error))?;
    let (width, height) = reader.info().size();
    let palette =
        reader.info().palette.as_deref().map(Palette::from_bytes).ok_or_else(|| wrong(&"no palette"))?;
    let mut indices = vec![0; width as usize * height as usize];
    reader.next_frame(&mut indices).map_err(|error| wrong(&error))?;
    let data = indices.into_iter().flat_map(|index| palette.color(index)).collect();
    RgbImage::from_raw(width, height, data).ok_or_else(|| wrong(&"no picture"))
}

/// What differs between a picture and the one that is kept at `path`, which then is written to `fresh`; `None` where they show
/// the same.
pub fn difference(picture: &RgbImage, path: &Path, fresh: &Path) -> Option<String> {
    let fault = match read(path) {
        Err(error) => error,
        Ok(kept) if kept.dimensions() != picture.dimensions() => {
            format!("{} has another size", path.display())
        }
        Ok(kept) => {
            let picture = PictureColors::of(picture, COLORS).picture(SIZE.width);
            let apart = |(a, b): (&image::Rgb<u8>, &image::Rgb<u8>)| {
                a.0.iter().zip(b.0).map(|(&a, b)| a.abs_diff(b)).max().unwrap_or(0)
            };
            let apart: Vec<u8> = kept.pixels().zip(picture.pixels()).map(apart).collect();
            let pixels = apart.len() as f64;
            let mean = apart.iter().map(|&apart| f64::from(apart)).sum::<f64>() / pixels;
            let changed = apart.iter().filter(|&&apart| apart > CHANGED).count() as f64 / pixels;
            if mean <= MOST_APART && changed <= MOST_CHANGED {
                return None;
            }
            format!(
                "{}: {:.2} % of the pixels are others, and the mean difference is {mean:.2} of 255",
                path.display(),
                changed * 100.0
            )
        }
    };
    write(picture, fresh);
    Some(format!("{fault}; the new picture is {}", fresh.display()))
}
