//! The file and the options of a map in a material library.
//!
//! ```text
//! map_Kd  -o 0.5 0  -s 2 2 1  -mm 0 1.5  -clamp on  my wall.png
//!         offset    scale     values     borders    file, which may have spaces
//! ```
//!
//! Coordinates are multiplied with the scale before the offset is added, as in the programs that write these options.

use glam::Vec2;

use crate::material::{MapFile, ValueRange};
use sandtable_draw::material::TextureWrap;

use super::text::number;

/// A map statement without its keyword.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MtlMap {
    /// The file; its name is empty where there is none.
    pub file: MapFile,
    pub uv: MtlUvTransform,
    /// Options that change nothing here, as they are written.
    pub unused: Vec<String>,
}

/// What a map does to texture coordinates, V upward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MtlUvTransform {
    scale: Vec2,
    offset: Vec2,
}

impl MtlUvTransform {
    /// Coordinates as they are.
    pub(super) const IDENTITY: Self = Self { scale: Vec2::ONE, offset: Vec2::ZERO };

    /// The coordinates at which the map is read; V runs downward in both. Zero where one is not finite.
    pub(super) fn apply(self, uv: Vec2) -> Vec2 {
        if self == Self::IDENTITY {
            return uv;
        }
        let upward = Vec2::new(uv.x, 1.0 - uv.y) * self.scale + self.offset;
        if upward.is_finite() { Vec2::new(upward.x, 1.0 - upward.y) } else { Vec2::ZERO }
    }
}

impl Default for MtlUvTransform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl MtlMap {
    pub(super) fn parse(rest: &str) -> Self {
        let mut map = Self::default();
        let mut words = rest.trim();
        while let Some((option, after)) = split_option(words) {
            let (values, after) = take_values(option, after);
            map.set(option, &values);
            words = after;
        }
        map.file.name = words.trim().trim_matches('"').into();
        map
    }

    fn set(&mut self, option: &str, values: &[&str]) {
        let first = values.first().copied().unwrap_or_default();
        let numbers: Vec<f32> = values.iter().map(|value| number(value)).collect();
        // A value that is missing or not a number leaves the default.
        let at = |place: usize, default: f32| {
            numbers.get(place).copied().filter(|value| value.is_finite()).unwrap_or(default)
        };
        let is_on = first.eq_ignore_ascii_case("on");
        match option {
            "-clamp" if is_on => self.file.wrap = [TextureWrap::Clamp; 2],
            "-o" => self.uv.offset = Vec2::new(at(0, 0.0), at(1, 0.0)),
            "-s" => self.uv.scale = Vec2::new(at(0, 1.0), at(1, 1.0)),
            "-mm" => self.file.range = ValueRange { base: at(0, 0.0), gain: at(1, 1.0) },
            "-clamp" | "-cc" if !is_on => {}
            "-blendu" | "-blendv" if !first.eq_ignore_ascii_case("off") => {}
            "-t" if numbers.iter().all(|&value| value == 0.0) => {}
            "-colorspace" if first.eq_ignore_ascii_case("sRGB") => {}
            _ => self.unused.push([&[option], values].concat().join(" ")),
        }
    }
}

/// The option that `words` begin with, and what follows; `None` at the file. A lone dash or a dash before spaces begins a
/// name.
fn split_option(words: &str) -> Option<(&str, &str)> {
    let is_option =
        words.strip_prefix('-').is_some_and(|rest| rest.starts_with(|first: char| first.is_alphabetic()));
    let (option, after) = words.split_once(char::is_whitespace)?;
    is_option.then(|| (option, after.trim_start()))
}

/// The values of an option, and what follows. Offsets, scales and turbulence may have fewer than three numbers; the last word
/// is the file's.
fn take_values<'a>(option: &str, mut words: &'a str) -> (Vec<&'a str>, &'a str) {
    let most = match option {
        "-o" | "-s" | "-t" => 3,
        "-mm" => 2,
        _ => 1,
    };
    let mut values = Vec::new();
    while values.len() < most {
        let Some((value, after)) = words.split_once(char::is_whitespace) else { break };
        if !values.is_empty() && value.parse::<f32>().is_err() {
            break;
        }
        values.push(value);
        words = after.trim_start();
    }
    (values, words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_removed_and_spaces_kept() {
        for (rest, file) in [
            ("texture 01.png", "texture 01.png"),
            ("-o 0.1 diffuse.jpg", "diffuse.jpg"),
            ("-s 1 2 3 -mm 0 1 -clamp on my wall.png", "my wall.png"),
            ("-texres 512 input.jpg", "input.jpg"),
            ("-colorspace sRGB -o 0.1 diffuse.jpg", "diffuse.jpg"),
            ("maps\\brick.bmp", "maps\\brick.bmp"),
            ("-clamp on", "on"),
            ("-wall.png", "-wall.png"),
            ("\"a b.png\"", "a b.png"),
            ("", ""),
        ] {
            assert_eq!(MtlMap::parse(rest).file.name, file, "{rest}");
        }
    }

    #[test]
    fn what_is_drawn_of_the_options_is_kept_and_the_rest_is_named() {
        let map =
            MtlMap::parse("-s 2 3 1 -o 0.5 -mm 0.25 2 -clamp on -cc off -t 1 0 0 -boost 3 -imfchan l a.png");
        assert_eq!(map.file.wrap, [TextureWrap::Clamp; 2]);
        assert_eq!(map.file.range, ValueRange { base: 0.25, gain: 2.0 });
        assert_eq!(map.unused, ["-t 1 0 0", "-boost 3", "-imfchan l"]);
        // V upward: (0.25, 0.5) becomes (0.25 · 2 + 0.5, 0.5 · 3).
        assert_eq!(map.uv.apply(Vec2::new(0.25, 0.5)), Vec2::new(1.0, -0.5));
        let plain = MtlMap::parse("-clamp off -blendu on -t 0 0 0 -colorspace sRGB a.png");
        assert_eq!(
            plain,
            MtlMap { file: MapFile { name: "a.png".into(), ..MapFile::default() }, ..MtlMap::default() }
        );
        assert_eq!(plain.uv.apply(Vec2::new(0.1, 0.7)), Vec2::new(0.1, 0.7));
    }

    #[test]
    fn values_that_are_no_numbers_leave_the_defaults() {
        let map = MtlMap::parse("-s x 2 -mm nan a.png");
        assert_eq!(map.file.range, ValueRange::IDENTITY);
        assert_eq!(map.uv.scale.x, 1.0);
        assert_eq!(MtlMap::parse("-s 1e38 1e38 a.png").uv.apply(Vec2::splat(1e30)), Vec2::ZERO);
    }
}
