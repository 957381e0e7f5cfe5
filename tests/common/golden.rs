//! Pictures that are held to golden ones in the repository.
//!
//! Equality is exact: the renderer and the annotations use no mathematics of the platform, so the same scene is
//! the same bytes everywhere, and a tolerance would only hide a change. A golden picture is a preview, half as wide
//! and in 5 bits a channel, with the checksum of the full picture in its text: the checksum decides, the preview is for
//! the eye. Where they differ, the new full picture and the difference of the previews are written beside the golden one.

use std::fs;
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};

use flate2::Crc;
use image::RgbImage;
use sandtable_draw::pixels::Pixels;

/// Set to make what is rendered the golden pictures.
const BLESS: &str = "SANDTABLE_BLESS";

/// The PNG text that holds the checksum of the full picture.
const CHECKSUM: &str = "Checksum";

/// Pixels of the full picture along a preview's pixel.
const SCALE: u32 = 2;

/// Where the golden pictures are.
pub fn folder() -> PathBuf {
    PathBuf::from(concat!(env!("SANDTABLE_ROOT"), "tests/golden"))
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

/// A picture as it is kept.
#[derive(PartialEq)]
struct Golden {
    preview: RgbImage,
    checksum: String,
}

impl Golden {
    fn new(picture: &RgbImage) -> Self {
        let mut crc = Crc::new();
        crc.update(picture.as_raw());
        let checksum = format!("{}x{} crc32 {:08x}", picture.width(), picture.height(), crc.sum());
        let preview = RgbImage::from_fn(picture.width() / SCALE, picture.height() / SCALE, |x, y| {
            let block =
                (0..SCALE * SCALE).map(|index| (x * SCALE + index % SCALE, y * SCALE + index / SCALE));
            let mut sum = [0; 3];
            for (x, y) in block {
                picture
                    .get_pixel(x, y)
                    .0
                    .iter()
                    .zip(&mut sum)
                    .for_each(|(&value, sum)| *sum += u32::from(value));
            }
            image::Rgb(sum.map(|sum| (sum / (SCALE * SCALE)) as u8 & 0b1111_1000))
        });
        Self { preview, checksum }
    }

    fn read(path: &Path) -> Result<Self, String> {
        let wrong = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let file = fs::File::open(path).map_err(|error| wrong(&error))?;
        let mut reader =
            png::Decoder::new(BufReader::new(file)).read_info().map_err(|error| wrong(&error))?;
        let (width, height) = reader.info().size();
        let mut bytes = vec![0; 3 * (width * height) as usize];
        reader.next_frame(&mut bytes).map_err(|error| wrong(&error))?;
        let texts = &reader.info().uncompressed_latin1_text;
        let checksum = texts.iter().find(|text| text.keyword == CHECKSUM).map(|text| text.text.clone());
        Ok(Self {
            preview: RgbImage::from_raw(width, height, bytes)
                .ok_or_else(|| wrong(&"it is no RGB picture"))?,
            checksum: checksum.ok_or_else(|| wrong(&"it has no checksum"))?,
        })
    }

    /// Writes as few bytes as the encoder can, since golden pictures stay in the repository.
    fn write(&self, path: &Path) -> Result<(), String> {
        let wrong = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        fs::create_dir_all(folder()).map_err(|error| wrong(&error))?;
        let file = fs::File::create(path).map_err(|error| wrong(&error))?;
        let mut encoder =
            png::Encoder::new(BufWriter::new(file), self.preview.width(), self.preview.height());
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::High);
        encoder.set_filter(png::Filter::Adaptive);
        let texted = encoder.add_text_chunk(CHECKSUM.into(), self.checksum.clone());
        texted.map_err(|error| wrong(&error))?;
        let mut writer = encoder.write_header().map_err(|error| wrong(&error))?;
        writer.write_image_data(self.preview.as_raw()).map_err(|error| wrong(&error))
    }
}

/// Compares `pixels` with the golden picture `name`, or makes them that.
///
/// # Errors
/// A sentence that says how they differ.
pub fn compare(name: &str, pixels: &Pixels) -> Result<(), String> {
    let file = |kind: &str| folder().join(format!("{name}{kind}.png"));
    let picture = rgb(pixels);
    let found = Golden::new(&picture);
    for left_over in [file(".new"), file(".diff")] {
        let _ = fs::remove_file(left_over);
    }
    if is_blessing() {
        return found.write(&file(""));
    }
    let keep_new = || picture.save(file(".new")).map_err(|error| format!("{name}: {error}"));
    let expected = match Golden::read(&file("")) {
        Ok(expected) => expected,
        Err(error) => return keep_new().and(Err(error)),
    };
    if expected == found {
        return Ok(());
    }
    keep_new()?;
    if expected.preview.dimensions() == found.preview.dimensions() {
        let difference = difference(&expected.preview, &found.preview);
        difference.save(file(".diff")).map_err(|error| format!("{name}: {error}"))?;
    }
    let previews = in_numbers(&expected.preview, &found.preview);
    Err(format!("{name}: {}, not {}; of the previews, {previews}", found.checksum, expected.checksum))
}

fn rgb(pixels: &Pixels) -> RgbImage {
    let data = pixels.data().iter().flat_map(|color| [color.0[0], color.0[1], color.0[2]]).collect();
    RgbImage::from_raw(pixels.width(), pixels.height(), data).expect("three bytes a pixel")
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
