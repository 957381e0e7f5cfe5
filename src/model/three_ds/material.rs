//! Materials: colors, transparency, sides, color and opacity maps.

use glam::Vec2;

use crate::error::ModelError;
use crate::material::{MapFile, ValueRange};
use sandtable_draw::color::Srgba;
use sandtable_draw::material::TextureWrap;

use super::chunk::Chunk;

#[derive(Clone, Debug)]
pub(super) struct MaterialChunk {
    pub name: String,
    pub diffuse: Srgba,
    /// 0 is opaque, 1 lets all light pass.
    pub transparency: f32,
    pub two_sided: bool,
    pub map: Option<MapChunk>,
    /// A picture that is dark where the surface has holes.
    pub opacity_map: Option<MapChunk>,
}

#[derive(Clone, Debug)]
pub(super) struct MapChunk {
    pub file: MapFile,
    /// Whether the material shows its own color beyond the picture's borders.
    pub is_decal: bool,
    pub scale: Vec2,
    pub offset: Vec2,
    /// The rotation of the picture about the middle of the unit square, counter-clockwise.
    pub rotation_rad: f32,
}

pub(super) fn parse(chunk: &Chunk<'_>) -> Result<MaterialChunk, ModelError> {
    const NAME: u16 = 0xA000;
    const DIFFUSE: u16 = 0xA020;
    const TRANSPARENCY: u16 = 0xA050;
    const TWO_SIDED: u16 = 0xA081;
    const TEXTURE_MAP: u16 = 0xA200;
    const OPACITY_MAP: u16 = 0xA210;
    /// 3D Studio's default.
    const GRAY: Srgba = Srgba::opaque(150, 150, 150);
    let mut material = MaterialChunk {
        name: String::new(),
        diffuse: GRAY,
        transparency: 0.0,
        two_sided: false,
        map: None,
        opacity_map: None,
    };
    for part in chunk.children() {
        let part = part?;
        match part.id {
            NAME => material.name = part.read().text()?,
            DIFFUSE => material.diffuse = color(&part)?.unwrap_or(GRAY),
            TRANSPARENCY => material.transparency = percentage(&part)?.unwrap_or(0.0),
            TWO_SIDED => material.two_sided = true,
            TEXTURE_MAP => material.map = map(&part)?,
            OPACITY_MAP => material.opacity_map = map(&part)?,
            _ => {}
        }
    }
    Ok(material)
}

/// The first color in a chunk, in bytes or fractions; the gamma-corrected kinds are read alike.
fn color(chunk: &Chunk<'_>) -> Result<Option<Srgba>, ModelError> {
    const FRACTIONS: [u16; 2] = [0x0010, 0x0013];
    const BYTES: [u16; 2] = [0x0011, 0x0012];
    for part in chunk.children() {
        let part = part?;
        let mut cursor = part.read();
        if FRACTIONS.contains(&part.id) {
            let [red, green, blue] = cursor.vec3()?.to_array().map(|channel| (channel * 255.0 + 0.5) as u8);
            return Ok(Some(Srgba::opaque(red, green, blue)));
        }
        if BYTES.contains(&part.id) {
            return Ok(Some(Srgba::opaque(cursor.u8()?, cursor.u8()?, cursor.u8()?)));
        }
    }
    Ok(None)
}

/// The first percentage in a chunk as a fraction in 0..=1.
fn percentage(chunk: &Chunk<'_>) -> Result<Option<f32>, ModelError> {
    const INTEGER: u16 = 0x0030;
    const FLOAT: u16 = 0x0031;
    for part in chunk.children() {
        let part = part?;
        let fraction = match part.id {
            INTEGER => f32::from(part.read().u16()?) / 100.0,
            FLOAT => part.read().f32()?,
            _ => continue,
        };
        return Ok(Some(if fraction.is_finite() { fraction.clamp(0.0, 1.0) } else { 0.0 }));
    }
    Ok(None)
}

/// A map; `None` where it names no file.
fn map(chunk: &Chunk<'_>) -> Result<Option<MapChunk>, ModelError> {
    const FILE: u16 = 0xA300;
    const TILING: u16 = 0xA351;
    const V_SCALE: u16 = 0xA354;
    const U_SCALE: u16 = 0xA356;
    const U_OFFSET: u16 = 0xA358;
    const V_OFFSET: u16 = 0xA35A;
    const ROTATION_DEG: u16 = 0xA35C;
    let mut map = MapChunk {
        file: MapFile::default(),
        is_decal: false,
        scale: Vec2::ONE,
        offset: Vec2::ZERO,
        rotation_rad: 0.0,
    };
    for part in chunk.children() {
        let part = part?;
        let target = match part.id {
            FILE => {
                map.file.name = part.read().text()?;
                continue;
            }
            TILING => {
                map.set_tiling(part.read().u16().unwrap_or(0));
                continue;
            }
            U_SCALE => &mut map.scale.x,
            V_SCALE => &mut map.scale.y,
            U_OFFSET => &mut map.offset.x,
            V_OFFSET => &mut map.offset.y,
            ROTATION_DEG => &mut map.rotation_rad,
            _ => continue,
        };
        let value = part.read().f32()?;
        if value.is_finite() {
            *target = if part.id == ROTATION_DEG { value.to_radians() } else { value };
        }
    }
    Ok((!map.file.name.trim().is_empty()).then_some(map))
}

impl MapChunk {
    /// Reads the flags of a map.
    fn set_tiling(&mut self, flags: u16) {
        const MIRROR: u16 = 0x0002;
        const NEGATIVE: u16 = 0x0004;
        const NO_TILES: u16 = 0x0010;
        if flags & NEGATIVE != 0 {
            self.file.range = ValueRange::NEGATIVE;
        }
        self.is_decal = flags & NO_TILES != 0 && flags & MIRROR == 0;
        self.file.wrap = match flags {
            _ if flags & MIRROR != 0 => [TextureWrap::Mirror; 2],
            _ if self.is_decal => [TextureWrap::Clamp; 2],
            _ => [TextureWrap::Repeat; 2],
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chunk(id: u16, body: &[u8]) -> Vec<u8> {
        [&id.to_le_bytes()[..], &(body.len() as u32 + 6).to_le_bytes(), body].concat()
    }

    #[test]
    fn a_material_has_its_color_transparency_sides_and_maps() {
        let map = |file: &str, more: Vec<u8>| [chunk(0xA300, format!("{file}\0").as_bytes()), more].concat();
        let number = |id: u16, value: f32| chunk(id, &value.to_le_bytes());
        let turned = [number(0xA354, 2.0), number(0xA358, 0.25), number(0xA35C, 90.0)].concat();
        let body = [
            chunk(0xA000, b"leaf\0"),
            chunk(0xA010, &chunk(0x0011, &[1, 2, 3])),
            chunk(0xA020, &chunk(0x0011, &[10, 20, 30])),
            chunk(0xA030, &chunk(0x0011, &[4, 5, 6])),
            chunk(0xA050, &chunk(0x0030, &[25, 0])),
            chunk(0xA081, &[]),
            chunk(0xA200, &map("LEAF.TGA", turned)),
            chunk(0xA210, &map("LEAF_O.TGA", Vec::new())),
        ]
        .concat();
        let bytes = chunk(0xAFFF, &body);
        let leaf = parse(&Chunk::first(&bytes).expect("a chunk")).expect("sound");
        assert_eq!(
            (leaf.name.as_str(), leaf.diffuse, leaf.transparency),
            ("leaf", Srgba::opaque(10, 20, 30), 0.25)
        );
        assert!(leaf.two_sided);
        let map = leaf.map.expect("a map");
        assert_eq!(
            (map.file.name.as_str(), map.scale, map.offset),
            ("LEAF.TGA", Vec2::new(1.0, 2.0), Vec2::new(0.25, 0.0))
        );
        assert_eq!(map.rotation_rad, std::f32::consts::FRAC_PI_2);
        assert_eq!(leaf.opacity_map.map(|map| map.file.name).as_deref(), Some("LEAF_O.TGA"));
    }

    #[test]
    fn the_flags_of_a_map_say_how_it_goes_on_and_whether_it_is_a_negative() {
        for (flags, wrap, is_decal, range) in [
            (0, TextureWrap::Repeat, false, ValueRange::IDENTITY),
            (2, TextureWrap::Mirror, false, ValueRange::IDENTITY),
            (0x11, TextureWrap::Clamp, true, ValueRange::IDENTITY),
            (0x06, TextureWrap::Mirror, false, ValueRange::NEGATIVE),
        ] {
            let tiling = chunk(0xA351, &u16::to_le_bytes(flags));
            let body = chunk(0xA200, &[chunk(0xA300, b"A.TGA\0"), tiling].concat());
            let bytes = chunk(0xAFFF, &body);
            let map = parse(&Chunk::first(&bytes).expect("a chunk")).expect("sound").map.expect("a map");
            assert_eq!(
                (map.file.wrap, map.is_decal, map.file.range),
                ([wrap; 2], is_decal, range),
                "{flags:#x}"
            );
        }
    }
}
