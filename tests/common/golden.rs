//! Pictures that are held to pictures in the repository.
//!
//! Equality is exact: the renderer and the annotations use no mathematics of the platform, so the same scene is
//! the same bytes everywhere, and a tolerance would only hide a change. Where pictures differ, the new one and
//! their difference are written beside the golden one, for the eye.

use std::fs;
use std::io::BufWriter;
use std::path::PathBuf;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ImageEncoder, RgbImage};
use sandtable::draw::pixels::Pixels;

/// Set to make what is rendered the golden pictures.
const BLESS: &str = "SANDTABLE_BLESS";

/// Where the golden pictures are.
pub fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden"))
}

/// The golden pictures there are, in order of their names.
pub fn files() -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder()) else {
        return Vec::new();
    };
    let is_golden = |path: &PathBuf| {
        let name = path.to_string_lossy();
        name.ends_with(".png") && !name.ends_with(".new.png") && !name.ends_with(".diff.png")
    };
    let mut files: Vec<PathBuf> =
        entries.map(|entry| entry.expect("readable").path()).filter(is_golden).collect();
    files.sort();
    files
}

/// Whether pictures are to be blessed, not compared.
pub fn is_blessing() -> bool {
    std::env::var_os(BLESS).is_some()
}

/// Compares `pixels` with the golden picture `name`, or makes them that.
///
/// # Errors
/// A sentence that says how they differ.
pub fn compare(name: &str, pixels: &Pixels) -> Result<(), String> {
    let file = |kind: &str| folder().join(format!("{name}{kind}.png"));
    let found = rgb(pixels);
    for left_over in [file(".new"), file(".diff")] {
        let _ = fs::remove_file(left_over);
    }
    if is_blessing() {
        return write(file(""), &found);
    }
    let expected = match image::open(file("")) {
        Ok(expected) => expected.into_rgb8(),
        Err(error) => {
            write(file(".new"), &found)?;
            return Err(format!("{}: {error}", file("").display()));
        }
    };
    if expected == found {
        return Ok(());
    }
    write(file(".new"), &found)?;
    if expected.dimensions() != found.dimensions() {
        return Err(format!("{name}: {:?} pixels, not {:?}", found.dimensions(), expected.dimensions()));
    }
    write(file(".diff"), &difference(&expected, &found))?;
    Err(format!("{name}: {}", in_numbers(&expected, &found)))
}

fn rgb(pixels: &Pixels) -> RgbImage {
    let data = pixels.data().iter().flat_map(|color| [color.0[0], color.0[1], color.0[2]]).collect();
    RgbImage::from_raw(pixels.width(), pixels.height(), data).expect("three bytes a pixel")
}

/// Written as small as the encoder can, since goldens stay in the repository.
fn write(path: PathBuf, picture: &RgbImage) -> Result<(), String> {
    let wrong = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    fs::create_dir_all(folder()).map_err(|error| wrong(&error))?;
    let file = fs::File::create(&path).map_err(|error| wrong(&error))?;
    PngEncoder::new_with_quality(BufWriter::new(file), CompressionType::Best, FilterType::Adaptive)
        .write_image(picture.as_raw(), picture.width(), picture.height(), image::ExtendedColorType::Rgb8)
        .map_err(|error| wrong(&error))
}

/// How far two pixels are apart in the channel where they differ most.
fn distance(a: &image::Rgb<u8>, b: &image::Rgb<u8>) -> u8 {
    a.0.iter().zip(b.0).map(|(&a, b)| a.abs_diff(b)).max().unwrap_or(0)
}

/// The golden picture pale and gray, and what differs in red, even the least difference plain to see.
fn difference(expected: &RgbImage, found: &RgbImage) -> RgbImage {
    RgbImage::from_fn(expected.width(), expected.height(), |x, y| {
        let (was, is) = (expected.get_pixel(x, y), found.get_pixel(x, y));
        let gray = was.0.map(u16::from).iter().sum::<u16>() / 3;
        let pale = (160 + gray / 3) as u8;
        match distance(was, is) {
            0 => image::Rgb([pale; 3]),
            far => image::Rgb([255, 120u8.saturating_sub(far), 120u8.saturating_sub(far)]),
        }
    })
}

fn in_numbers(expected: &RgbImage, found: &RgbImage) -> String {
    let apart: Vec<u8> = expected.pixels().zip(found.pixels()).map(|(was, is)| distance(was, is)).collect();
    let differing = apart.iter().filter(|&&apart| apart > 0).count();
    let most = apart.iter().max().unwrap_or(&0);
    format!("{differing} of {} pixels differ, by up to {most} of 255", apart.len())
}
