//! The textures of a model, decoded within limits. A texture that cannot be loaded is a note.

use std::collections::BTreeMap;
use std::io::Cursor;

use image::{ImageFormat, ImageReader, Limits};

use crate::error::CompanionError;
use crate::material::{MapValues, ValueRange};
use crate::webp;
use crate::{Companions, Model};
use sandtable_base::limits::TEXTURE_PIXELS;
use sandtable_base::limits::TEXTURE_SIDE;
use sandtable_base::limits::memory::{MemoryRefused, check_memory};
use sandtable_base::message::chain::error_text;
use sandtable_draw::color::Srgba;
use sandtable_draw::material::TextureId;
use sandtable_draw::pixels::Pixels;

/// Bytes of a pixel while a picture is decoded: as the file has it, at most four numbers of 16 bits; as eight bits; and as ours.
const BYTES_PER_PIXEL: u64 = 16;

/// Collects the textures of a model, each file once.
pub(super) struct Textures<'a> {
    companions: &'a dyn Companions,
    by_name: BTreeMap<String, Option<TextureId>>,
    /// Textures made of a color map and an opacity map.
    masked: BTreeMap<(Option<TextureId>, TextureId), Option<TextureId>>,
    /// Textures whose values were changed, by the texture and the bits of the range.
    ranged: BTreeMap<(TextureId, [u32; 2], MapValues), TextureId>,
    pixels: Vec<Pixels>,
    /// How many more pixels there may be.
    pixels_left: u64,
    notes: Vec<String>,
}

#[derive(Debug, thiserror::Error)]
enum TextureError {
    #[error("it is not PNG, JPEG, WebP, BMP or TGA")]
    UnknownFormat,
    #[error("it cannot be decoded")]
    Decode(#[from] image::ImageError),
    #[error(
        "it has {width} × {height} pixels; 1 to {TEXTURE_SIDE} a side are supported; shrink it: {TEXTURE_SIDE:#}"
    )]
    Size { width: u32, height: u32 },
    #[error("it has {} × {} pixels, but holds a picture of {} × {}; export it again", stated[0], stated[1], frame[0], frame[1])]
    WebpFrame { frame: [u32; 2], stated: [u32; 2] },
    #[error(
        "the model's textures would have more than {TEXTURE_PIXELS} pixels; shrink them, or {TEXTURE_PIXELS:#}"
    )]
    TooManyPixels,
    #[error(transparent)]
    Memory(#[from] MemoryRefused),
}

impl<'a> Textures<'a> {
    pub(super) fn new(companions: &'a dyn Companions) -> Self {
        Self {
            companions,
            by_name: BTreeMap::new(),
            masked: BTreeMap::new(),
            ranged: BTreeMap::new(),
            pixels: Vec::new(),
            pixels_left: TEXTURE_PIXELS.get(),
            notes: Vec::new(),
        }
    }

    /// The texture in the file that the model calls `name`; `None`, with a note, where it cannot be loaded.
    pub(super) fn load(&mut self, name: &str) -> Option<TextureId> {
        if let Some(&known) = self.by_name.get(name) {
            return known;
        }
        let id = match load_any(self.companions, name) {
            Ok(bytes) => self.decode(name, &bytes),
            Err(error) => {
                self.notes.push(format!("texture '{name}' is missing: {}", error_text(&*error)));
                None
            }
        };
        self.by_name.insert(name.into(), id);
        id
    }

    /// The texture in `bytes`, called `name` in notes; `None`, with a note, where it cannot be decoded.
    pub(super) fn decode(&mut self, name: &str, bytes: &[u8]) -> Option<TextureId> {
        match decode(name, bytes, self.pixels_left) {
            Ok(pixels) => Some(self.add(pixels)),
            Err(error) => self.unusable(name, &error),
        }
    }

    /// Notes that the texture `name` cannot be used; `None`.
    pub(super) fn unusable(
        &mut self,
        name: &str,
        error: &(dyn std::error::Error + 'static),
    ) -> Option<TextureId> {
        self.notes.push(format!("texture '{name}' cannot be used: {}", error_text(error)));
        None
    }

    /// Notes something about the model's materials.
    pub(super) fn note(&mut self, note: String) {
        self.notes.push(note);
    }

    fn add(&mut self, pixels: Pixels) -> TextureId {
        self.pixels_left -= pixels.data().len() as u64;
        self.pixels.push(pixels);
        TextureId(self.pixels.len() as u32 - 1)
    }

    /// The texture with these of its values changed; itself where nothing changes, and, with a note, where there would be too
    /// many pixels.
    pub(super) fn ranged(&mut self, id: TextureId, range: ValueRange, values: MapValues) -> TextureId {
        if range == ValueRange::IDENTITY {
            return id;
        }
        let key = (id, [range.base.to_bits(), range.gain.to_bits()], values);
        if let Some(&known) = self.ranged.get(&key) {
            return known;
        }
        let changed = self.with_range(id, range, values);
        self.ranged.insert(key, changed);
        changed
    }

    fn with_range(&mut self, id: TextureId, range: ValueRange, values: MapValues) -> TextureId {
        let changes_alpha = values == MapValues::Opacity && self.has_holes(id);
        let Some(pixels) = self.pixels.get(id.0 as usize) else { return id };
        let (width, height) = (pixels.width(), pixels.height());
        if let Err(error) = check_pixels(width, height, self.pixels_left) {
            self.notes
                .push(format!("the values of a map of {width} × {height} pixels stay as they are: {error}"));
            return id;
        }
        let changed = Pixels::from_fn(width, height, |x, y| {
            let Srgba([red, green, blue, alpha]) = pixels.at(x, y);
            if changes_alpha {
                return Srgba([red, green, blue, range.apply(alpha)]);
            }
            let [red, green, blue] = [red, green, blue].map(|value| range.apply(value));
            Srgba([red, green, blue, alpha])
        });
        self.add(changed)
    }

    /// The texture with the colors of `color`, white where there is none, and the opacity of `mask`: its alpha where it
    /// has any, else its brightness. One file without alpha named for both stays as it is: exporters name it so to say
    /// that alpha would count. `color`, with a note, where the result would have too many pixels.
    pub(super) fn masked(&mut self, color: Option<TextureId>, mask: TextureId) -> Option<TextureId> {
        if color == Some(mask) {
            return color;
        }
        if let Some(&known) = self.masked.get(&(color, mask)) {
            return known;
        }
        let masked = self.with_opacity(color, mask);
        self.masked.insert((color, mask), masked);
        masked
    }

    fn with_opacity(&mut self, color: Option<TextureId>, mask: TextureId) -> Option<TextureId> {
        let by_alpha = self.has_holes(mask);
        let mask = self.pixels.get(mask.0 as usize)?;
        let colors = color.and_then(|id| self.pixels.get(id.0 as usize));
        let size = colors.unwrap_or(mask);
        let (width, height) = (size.width(), size.height());
        if let Err(error) = check_pixels(width, height, self.pixels_left) {
            self.notes.push(format!("an opacity map of {width} × {height} pixels is not drawn: {error}"));
            return color;
        }
        let masked = Pixels::from_fn(width, height, |x, y| {
            let Srgba([red, green, blue, _]) = colors.map_or(Srgba::WHITE, |colors| colors.at(x, y));
            let scaled =
                |at: u32, side: u32, other: u32| (u64::from(at) * u64::from(other) / u64::from(side)) as u32;
            let pixel = mask.at(scaled(x, width, mask.width()), scaled(y, height, mask.height()));
            Srgba([red, green, blue, if by_alpha { pixel.0[3] } else { brightness(pixel) }])
        });
        Some(self.add(masked))
    }

    pub(super) fn has_holes(&self, id: TextureId) -> bool {
        let pixels = self.pixels.get(id.0 as usize);
        pixels.is_some_and(|pixels| pixels.data().iter().any(|pixel| pixel.0[3] < 255))
    }

    /// The textures in the order of their numbers, and the notes.
    pub(super) fn into_parts(self) -> (Vec<Pixels>, Vec<String>) {
        (self.pixels, self.notes)
    }

    pub(super) fn move_to(self, model: &mut Model) {
        model.textures = self.pixels;
        model.notes.extend(self.notes);
    }
}

/// Rec. 601 luma in eighths.
fn brightness(pixel: Srgba) -> u8 {
    let [red, green, blue, _] = pixel.0.map(u16::from);
    ((red * 2 + green * 5 + blue) / 8) as u8
}

/// The companion called `name`, also tried without its folders and in other letter cases: models leave the systems on
/// which 3DS and OBJ files were written.
pub(super) fn load_any(companions: &dyn Companions, name: &str) -> Result<Vec<u8>, CompanionError> {
    let name = name.trim().replace('\\', "/");
    let file = name.rsplit('/').next().unwrap_or(&name);
    let tries = [file.into(), file.to_ascii_lowercase(), lower_extension(file), file.to_ascii_uppercase()];
    companions
        .load(&name)
        .or_else(|error| tries.iter().find_map(|file| companions.load(file).ok()).ok_or(error))
}

fn lower_extension(file: &str) -> String {
    match file.rsplit_once('.') {
        Some((stem, extension)) => format!("{stem}.{}", extension.to_ascii_lowercase()),
        None => file.into(),
    }
}

/// Checks that a texture of this size may be made and can be held.
fn check_pixels(width: u32, height: u32, pixels_left: u64) -> Result<(), TextureError> {
    let pixels = u64::from(width) * u64::from(height);
    if pixels > pixels_left {
        return Err(TextureError::TooManyPixels);
    }
    Ok(check_memory(pixels * BYTES_PER_PIXEL, "the texture", "shrink it")?)
}

/// Checks that no picture in a WebP file is larger than the file says: the decoder makes room for it before it compares.
fn check_webp_frames(bytes: &[u8], stated: [u32; 2]) -> Result<(), TextureError> {
    match webp::frame_sizes(bytes).find(|frame| frame[0] > stated[0] || frame[1] > stated[1]) {
        Some(frame) => Err(TextureError::WebpFrame { frame, stated }),
        None => Ok(()),
    }
}

fn decode(name: &str, bytes: &[u8], pixels_left: u64) -> Result<Pixels, TextureError> {
    // A TGA file has no signature.
    let is_tga = || ImageFormat::from_path(name).is_ok_and(|format| format == ImageFormat::Tga);
    let format = match image::guess_format(bytes) {
        Ok(format) => format,
        Err(_) if is_tga() => ImageFormat::Tga,
        Err(_) => return Err(TextureError::UnknownFormat),
    };
    let side = TEXTURE_SIDE.get() as u32;
    let reader = || {
        let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
        let mut limits = Limits::default();
        limits.max_image_width = Some(side);
        limits.max_image_height = Some(side);
        reader.limits(limits);
        reader
    };
    let (width, height) = reader().into_dimensions()?;
    if !(1..=side).contains(&width) || !(1..=side).contains(&height) {
        return Err(TextureError::Size { width, height });
    }
    check_pixels(width, height, pixels_left)?;
    if format == ImageFormat::WebP {
        check_webp_frames(bytes, [width, height])?;
    }
    let data = reader().decode()?.into_rgba8().pixels().map(|pixel| Srgba(pixel.0)).collect();
    Pixels::from_data(width, height, data).ok_or(TextureError::Size { width, height })
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Folder(&'static str, Vec<u8>);

    impl Companions for Folder {
        fn load(&self, name: &str) -> Result<Vec<u8>, CompanionError> {
            if name == self.0 { Ok(self.1.clone()) } else { Err(format!("no file {name}").into()) }
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
    fn folders_and_letter_cases_of_other_systems_are_accepted() {
        let folder = Folder("brick.png", png(2, 2));
        let mut textures = Textures::new(&folder);
        assert_eq!(textures.load("C:\\MAPS\\BRICK.PNG"), Some(TextureId(0)));
        assert_eq!(textures.load("C:\\MAPS\\BRICK.PNG"), Some(TextureId(0)));
        let Textures { pixels, notes, .. } = textures;
        assert_eq!((pixels.len(), notes.len()), (1, 0));
        assert_eq!(pixels[0].at(1, 1), Srgba::opaque(9, 8, 7));
    }

    #[test]
    fn missing_and_broken_pictures_are_notes() {
        let mut bytes = png(4, 4);
        bytes.truncate(50);
        let folder = Folder("broken.png", bytes);
        let mut textures = Textures::new(&folder);
        assert_eq!(textures.load("broken.png"), None);
        assert_eq!(textures.load("absent.png"), None);
        let notes = textures.notes;
        assert!(
            notes[0].contains("'broken.png' cannot be used") && notes[1].contains("'absent.png' is missing")
        );
    }

    #[test]
    fn an_opacity_map_cuts_holes_by_its_brightness_or_its_alpha() {
        let folder = Folder("", Vec::new());
        let mut textures = Textures::new(&folder);
        let gray = |level: u8| Srgba::opaque(level, level, level);
        let halves = Pixels::from_fn(2, 1, |x, _| gray(if x == 0 { 0 } else { 255 }));
        let clear = Pixels::from_fn(1, 1, |_, _| Srgba([255, 255, 255, 77]));
        textures.pixels = vec![Pixels::filled(4, 2, Srgba::opaque(10, 200, 30)), halves, clear];
        let [leaf, halves, clear] = [0, 1, 2].map(TextureId);
        let cut = textures.masked(Some(leaf), halves).expect("made");
        assert_eq!(textures.masked(Some(leaf), halves), Some(cut), "made once");
        assert_eq!(textures.masked(Some(leaf), leaf), Some(leaf));
        let (by_alpha, alone) = (textures.masked(Some(leaf), clear), textures.masked(None, halves));
        let pixels = textures.pixels;
        let at = |id: TextureId, x: u32| pixels[id.0 as usize].at(x, 0).0;
        assert_eq!([at(cut, 1), at(cut, 2)], [[10, 200, 30, 0], [10, 200, 30, 255]]);
        assert_eq!(by_alpha.map(|id| at(id, 0)), Some([10, 200, 30, 77]));
        assert_eq!(alone.map(|id| [at(id, 0), at(id, 1)]), Some([[255, 255, 255, 0], [255; 4]]));
    }

    #[test]
    fn the_values_of_a_map_are_changed_once_and_alpha_only_where_it_is_the_mask() {
        let folder = Folder("", Vec::new());
        let mut textures = Textures::new(&folder);
        let clear = Pixels::from_fn(1, 1, |_, _| Srgba([200, 100, 0, 77]));
        textures.pixels = vec![Pixels::filled(1, 1, Srgba::opaque(200, 100, 0)), clear];
        let [plain, clear] = [0, 1].map(TextureId);
        let negative = ValueRange::NEGATIVE;
        assert_eq!(textures.ranged(plain, ValueRange::IDENTITY, MapValues::Colors), plain);
        let made = [
            textures.ranged(plain, negative, MapValues::Colors),
            textures.ranged(plain, negative, MapValues::Opacity),
            textures.ranged(clear, negative, MapValues::Colors),
            textures.ranged(clear, negative, MapValues::Opacity),
        ];
        assert_eq!(textures.ranged(plain, negative, MapValues::Colors), made[0], "made once");
        let found = made.map(|id| textures.pixels[id.0 as usize].at(0, 0).0);
        assert_eq!(found, [[55, 155, 255, 255], [55, 155, 255, 255], [55, 155, 255, 77], [200, 100, 0, 178]]);
        textures.pixels_left = 0;
        assert_eq!(textures.ranged(clear, ValueRange { base: 0.5, gain: 1.0 }, MapValues::Colors), clear);
        assert!(textures.notes[0].contains("stay as they are"), "{:?}", textures.notes);
    }

    #[test]
    fn a_webp_texture_is_read_and_one_that_hides_a_larger_picture_is_not() {
        let bytes = webp::tests::lossless(3, 2, [200, 100, 50]);
        let pixels = decode("wall.webp", &bytes, TEXTURE_PIXELS.get()).expect("sound");
        assert_eq!((pixels.width(), pixels.height(), pixels.at(2, 1)), (3, 2, Srgba::opaque(200, 100, 50)));
        let hidden = webp::tests::extended([3, 2], &webp::tests::lossy_header(16383, 16383));
        let error = decode("wall.webp", &hidden, TEXTURE_PIXELS.get()).expect_err("refused").to_string();
        assert!(error.contains("3 × 2 pixels, but holds a picture of 16383 × 16383"), "{error}");
        let huge = webp::tests::extended([1 << 20, 1 << 20], &webp::tests::lossy_header(2, 2));
        assert!(decode("wall.webp", &huge, TEXTURE_PIXELS.get()).is_err());
        for end in 0..bytes.len() {
            // What a cut file gives does not matter, only that it ends.
            let _ = decode("wall.webp", &bytes[..end], TEXTURE_PIXELS.get());
        }
    }

    #[test]
    fn a_texture_with_a_forged_size_is_not_allocated() {
        let mut bytes = png(1, 1);
        bytes[16..24].copy_from_slice(&[0, 0, 0x75, 0x30, 0, 0, 0x75, 0x30]);
        assert!(decode("big.png", &bytes, TEXTURE_PIXELS.get()).is_err());
    }
}
