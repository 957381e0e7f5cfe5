//! The pictures a model names, decoded within limits; what cannot be had is a note.

use std::collections::BTreeMap;
use std::io::Cursor;

use image::{ImageFormat, ImageReader, Limits};

use crate::draw::color::Srgba;
use crate::draw::material::TextureId;
use crate::draw::pixels::Pixels;
use crate::model::Companions;

/// The longest side of a texture in pixels: what every graphics adapter takes.
const MAX_SIDE: u32 = 8192;
/// The most pixels of all textures of one model: 64 million take 256 MiB.
const MAX_PIXELS: u64 = 64 << 20;

/// Collects the textures of a model, each file once.
pub(super) struct Textures<'a> {
    companions: &'a dyn Companions,
    by_name: BTreeMap<String, Option<TextureId>>,
    /// Textures made of two: the colors of the one, the holes of the other.
    masked: BTreeMap<(Option<TextureId>, TextureId), Option<TextureId>>,
    pixels: Vec<Pixels>,
    used: u64,
    notes: Vec<String>,
}

impl<'a> Textures<'a> {
    /// No textures yet.
    pub(super) fn new(companions: &'a dyn Companions) -> Self {
        Self {
            companions,
            by_name: BTreeMap::new(),
            masked: BTreeMap::new(),
            pixels: Vec::new(),
            used: 0,
            notes: Vec::new(),
        }
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

    /// The texture with the colors of `color`, white where there is none, and the opacity of `mask`: its alpha where it
    /// has any, else its brightness. One picture that is named for both and has no alpha stays as it is, since
    /// exporters name it so to say that alpha would count. `color`, with a note, where that would be too many pixels.
    pub(super) fn masked(&mut self, color: Option<TextureId>, mask: TextureId) -> Option<TextureId> {
        if color == Some(mask) {
            return color;
        }
        if let Some(&known) = self.masked.get(&(color, mask)) {
            return known;
        }
        let made = self.with_opacity(color, mask);
        self.masked.insert((color, mask), made);
        made
    }

    fn with_opacity(&mut self, color: Option<TextureId>, mask: TextureId) -> Option<TextureId> {
        let by_alpha = self.is_cut_out(mask);
        let mask = self.pixels.get(mask.0 as usize)?;
        let painted = color.and_then(|id| self.pixels.get(id.0 as usize));
        let size = painted.unwrap_or(mask);
        let (width, height) = (size.width(), size.height());
        let count = u64::from(width) * u64::from(height);
        if count > MAX_PIXELS - self.used {
            self.notes
                .push(format!("an opacity map of {width} × {height} pixels is one too many and not drawn"));
            return color;
        }
        let joined = Pixels::from_fn(width, height, |x, y| {
            let Srgba([red, green, blue, _]) = painted.map_or(Srgba::WHITE, |painted| painted.at(x, y));
            let place =
                |at: u32, side: u32, there: u32| (u64::from(at) * u64::from(there) / u64::from(side)) as u32;
            let seen = mask.at(place(x, width, mask.width()), place(y, height, mask.height()));
            Srgba([red, green, blue, if by_alpha { seen.0[3] } else { brightness(seen) }])
        });
        self.used += count;
        self.pixels.push(joined);
        Some(TextureId(self.pixels.len() as u32 - 1))
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

/// Rec. 601 luma in eighths.
fn brightness(pixel: Srgba) -> u8 {
    let [red, green, blue, _] = pixel.0.map(u16::from);
    ((red * 2 + green * 5 + blue) / 8) as u8
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
        let (pixels, _) = textures.finish();
        let at = |id: TextureId, x: u32| pixels[id.0 as usize].at(x, 0).0;
        assert_eq!([at(cut, 1), at(cut, 2)], [[10, 200, 30, 0], [10, 200, 30, 255]]);
        assert_eq!(by_alpha.map(|id| at(id, 0)), Some([10, 200, 30, 77]));
        assert_eq!(alone.map(|id| [at(id, 0), at(id, 1)]), Some([[255, 255, 255, 0], [255; 4]]));
    }

    #[test]
    fn a_texture_with_a_forged_size_is_not_allocated() {
        let mut bytes = png(1, 1);
        bytes[16..24].copy_from_slice(&[0, 0, 0x75, 0x30, 0, 0, 0x75, 0x30]);
        assert!(decode("big.png", &bytes, MAX_PIXELS).is_err());
    }
}
