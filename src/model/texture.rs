//! The pictures a model names, decoded within limits; what cannot be had is a note.

use std::collections::BTreeMap;
use std::io::Cursor;

use image::{ImageFormat, ImageReader, Limits};

use crate::draw::color::Srgba;
use crate::draw::material::TextureId;
use crate::draw::pixels::Pixels;
use crate::model::kind::Companions;

/// The longest side of a texture in pixels: what every graphics adapter takes.
const MAX_SIDE: u32 = 8192;
/// The most pixels of all textures of one model: 64 million take 256 MiB.
const MAX_PIXELS: u64 = 64 << 20;

/// Collects the textures of a model, each file once.
pub(super) struct Textures<'a> {
    companions: &'a dyn Companions,
    by_name: BTreeMap<String, Option<TextureId>>,
    pixels: Vec<Pixels>,
    used: u64,
    notes: Vec<String>,
}

impl<'a> Textures<'a> {
    /// No textures yet.
    pub(super) fn new(companions: &'a dyn Companions) -> Self {
        Self { companions, by_name: BTreeMap::new(), pixels: Vec::new(), used: 0, notes: Vec::new() }
    }

    /// The texture in the file that the model calls `name`; `None`, with a note, where it cannot be had.
    pub(super) fn by_name(&mut self, name: &str) -> Option<TextureId> {
        if let Some(&known) = self.by_name.get(name) {
            return known;
        }
        let id = match load_any(self.companions, name) {
            Ok(bytes) => self.decode(name, &bytes),
            Err(reason) => {
                self.notes.push(format!("texture '{name}' is missing: {reason}"));
                None
            }
        };
        self.by_name.insert(name.into(), id);
        id
    }

    /// The texture in `bytes`, called `name` in notes; `None`, with a note, where they are no picture.
    pub(super) fn decode(&mut self, name: &str, bytes: &[u8]) -> Option<TextureId> {
        match decode(name, bytes, MAX_PIXELS - self.used) {
            Ok(pixels) => {
                self.used += pixels.data().len() as u64;
                self.pixels.push(pixels);
                Some(TextureId(self.pixels.len() as u32 - 1))
            }
            Err(reason) => self.miss(name, &reason),
        }
    }

    /// Notes that the texture `name` cannot be had; `None`.
    pub(super) fn miss(&mut self, name: &str, reason: &str) -> Option<TextureId> {
        self.notes.push(format!("texture '{name}' cannot be used: {reason}"));
        None
    }

    /// Whether a texture has pixels that are not opaque.
    pub(super) fn is_cut_out(&self, id: TextureId) -> bool {
        self.pixels
            .get(id.0 as usize)
            .is_some_and(|pixels| pixels.data().iter().any(|pixel| pixel.0[3] < 255))
    }

    /// The textures and what went wrong.
    pub(super) fn finish(self) -> (Vec<Pixels>, Vec<String>) {
        (self.pixels, self.notes)
    }
}

/// The companion called `name`, also tried without its folders and in the letter cases that files take when
/// they leave the systems that wrote 3DS and OBJ files.
///
/// # Errors
/// What `companions` says about the first try.
pub(super) fn load_any(companions: &dyn Companions, name: &str) -> Result<Vec<u8>, String> {
    let name = name.trim().replace('\\', "/");
    let file = name.rsplit('/').next().unwrap_or(&name);
    let tries = [file.into(), file.to_ascii_lowercase(), lower_extension(file), file.to_ascii_uppercase()];
    companions
        .load(&name)
        .or_else(|reason| tries.iter().find_map(|file| companions.load(file).ok()).ok_or(reason))
}

fn lower_extension(file: &str) -> String {
    match file.rsplit_once('.') {
        Some((stem, extension)) => format!("{stem}.{}", extension.to_ascii_lowercase()),
        None => file.into(),
    }
}

fn decode(name: &str, bytes: &[u8], pixels_left: u64) -> Result<Pixels, String> {
    let format = image::guess_format(bytes)
        .ok()
        .or_else(|| ImageFormat::from_path(name).ok().filter(|&format| format == ImageFormat::Tga))
        .ok_or("it is no PNG, JPEG, BMP or TGA")?;
    let reader = || {
        let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
        let mut limits = Limits::default();
        limits.max_image_width = Some(MAX_SIDE);
        limits.max_image_height = Some(MAX_SIDE);
        reader.limits(limits);
        reader
    };
    let (width, height) = reader().into_dimensions().map_err(|error| error.to_string())?;
    if width == 0 || height == 0 || width > MAX_SIDE || height > MAX_SIDE {
        return Err(format!("it has {width} × {height} pixels, 1 to {MAX_SIDE} a side can be used"));
    }
    if u64::from(width) * u64::from(height) > pixels_left {
        return Err(format!("with it the model's textures would have more than {MAX_PIXELS} pixels"));
    }
    let picture = reader().decode().map_err(|error| error.to_string())?.into_rgba8();
    let data = picture.pixels().map(|pixel| Srgba(pixel.0)).collect();
    Pixels::from_data(width, height, data).ok_or_else(|| "its size and its data disagree".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Folder(&'static str, Vec<u8>);

    impl Companions for Folder {
        fn load(&self, name: &str) -> Result<Vec<u8>, String> {
            if name == self.0 { Ok(self.1.clone()) } else { Err(format!("no file {name}")) }
        }
    }

    fn png(width: u32, height: u32) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image::RgbImage::from_pixel(width, height, image::Rgb([9, 8, 7]))
            .write_to(&mut bytes, ImageFormat::Png)
            .expect("memory takes all");
        bytes.into_inner()
    }

    #[test]
    fn folders_and_letter_case_of_other_systems_are_forgiven() {
        let folder = Folder("brick.png", png(2, 2));
        let mut textures = Textures::new(&folder);
        assert_eq!(textures.by_name("C:\\MAPS\\BRICK.PNG"), Some(TextureId(0)));
        assert_eq!(textures.by_name("C:\\MAPS\\BRICK.PNG"), Some(TextureId(0)));
        let (pixels, notes) = textures.finish();
        assert_eq!((pixels.len(), notes.len()), (1, 0));
        assert_eq!(pixels[0].at(1, 1), Srgba::opaque(9, 8, 7));
    }

    #[test]
    fn missing_and_broken_pictures_are_notes() {
        let mut bytes = png(4, 4);
        bytes.truncate(50);
        let folder = Folder("broken.png", bytes);
        let mut textures = Textures::new(&folder);
        assert_eq!(textures.by_name("broken.png"), None);
        assert_eq!(textures.by_name("absent.png"), None);
        let (_, notes) = textures.finish();
        assert!(
            notes[0].contains("'broken.png' cannot be used") && notes[1].contains("'absent.png' is missing")
        );
    }

    #[test]
    fn a_texture_with_a_forged_size_is_not_allocated() {
        let mut bytes = png(1, 1);
        bytes[16..24].copy_from_slice(&[0, 0, 0x75, 0x30, 0, 0, 0x75, 0x30]);
        assert!(decode("big.png", &bytes, MAX_PIXELS).is_err());
    }
}
