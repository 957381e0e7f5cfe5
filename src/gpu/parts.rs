//! The parts of the shader that a draw call needs.
//!
//! A pipeline is made without the parts that nothing it draws can show: a picture without snow has no code for snow. That
//! halves the time of software drivers, which run both sides of every branch, and costs a pipeline for each combination
//! that occurs.

use rayon::prelude::*;

use sandtable_draw::ground::GroundMap;
use sandtable_draw::lighting::Lighting;
use sandtable_draw::material::{Albedo, Material, NormalSource};

/// A set of parts; the shader's constants `…_PART` are its bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct ShaderParts(pub u32);

impl ShaderParts {
    pub const NONE: Self = Self(0);
    /// Color from the ground map.
    const GROUND_COLOR: Self = Self(1);
    /// Light on the ground's normals.
    const GROUND_LIGHT: Self = Self(2);
    /// Light on the mesh's normals.
    const OWN_LIGHT: Self = Self(4);
    const HATCHING: Self = Self(8);
    const WATER: Self = Self(16);
    const NATURAL: Self = Self(32);
    const IMAGERY: Self = Self(64);
    const COVER: Self = Self(128);
    const GRAIN: Self = Self(256);
    const CONTOURS: Self = Self(512);
    const SUN_SHADOWS: Self = Self(1024);
    const SKY_SHADOWS: Self = Self(2048);
    const HAZE: Self = Self(4096);
    /// Water on the ground map.
    const MAP_WATER: Self = Self(8192);
    /// The edges of triangles.
    const EDGES: Self = Self(16_384);
    /// The covers of areas.
    const AREA: Self = Self(65_536);
    /// Relief in water.
    pub const WATER_RELIEF: Self = Self(131_072);
    /// Shadows of the sun by one reading of their map, with hard borders.
    const PLAIN_SHADOWS: Self = Self(262_144);
    /// Ground without plots of fields, read at few places of a pixel.
    const PLAIN_GROUND: Self = Self(524_288);
    /// Windows of finer posts.
    pub const WINDOWS: Self = Self(32_768);

    /// The parts of bare ground.
    pub const GROUND: Self = Self(Self::GROUND_COLOR.0 | Self::GROUND_LIGHT.0);

    pub fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// These with less in them where that is hardly seen in a picture of few pixels that moves: a software driver takes the
    /// steps of a mirrored ray, and reads all texels of a shadow's border and all posts of a pixel's ground, at every pixel that is
    /// drawn with a shader that can.
    pub fn while_moving(self) -> Self {
        let plain = Self::PLAIN_GROUND.with(Self::PLAIN_SHADOWS.when(self.has(Self::SUN_SHADOWS)));
        self.without(Self::WATER_RELIEF.with(Self::SKY_SHADOWS).with(Self::GRAIN)).with(plain)
    }

    fn has(self, part: Self) -> bool {
        self.0 & part.0 != 0
    }

    fn when(self, is_there: bool) -> Self {
        if is_there { self } else { Self::NONE }
    }

    /// Those that alpha depends on: all that the buffer of features needs.
    pub fn of_alpha(self) -> Self {
        Self(self.0 & Self::AREA.0)
    }

    /// The parts for a `material`.
    pub fn of_material(material: &Material) -> Self {
        let light = match (material.normals, material.albedo) {
            (NormalSource::Ground, _) => Self::GROUND_LIGHT,
            (NormalSource::Vertex, Albedo::Hatching) => Self::NONE,
            (NormalSource::Vertex, _) => Self::OWN_LIGHT,
        };
        let color = match material.albedo {
            Albedo::GroundMap => Self::GROUND_COLOR,
            Albedo::Hatching => Self::HATCHING,
            Albedo::Surface => Self::NONE,
        };
        light
            .with(color)
            .with(Self::WATER.when(material.is_water))
            .with(Self::NATURAL.when(material.is_natural))
            .with(Self::EDGES.when(material.shows_edges))
            .with(Self::AREA.when(material.area.is_some()))
    }

    /// The parts for a picture of a checked map and a light, with these shadow maps of the sun and of the sky.
    pub fn of_picture(map: Option<&GroundMap>, lighting: &Lighting, has_shadows: [bool; 2]) -> Self {
        let [sun, sky] = has_shadows;
        let light = Self::HAZE
            .when(lighting.haze.distance_m.is_finite())
            .with(Self::SUN_SHADOWS.when(sun))
            .with(Self::SKY_SHADOWS.when(sky));
        let Some(map) = map else { return light };
        let has_water = || map.posts.par_iter().with_min_len(1024).any(|post| post.water != 0.0);
        light
            .with(Self::IMAGERY.when(map.imagery.is_some()))
            .with(Self::COVER.when(map.cover.is_some()))
            .with(Self::GRAIN.when(map.has_grain))
            .with(Self::CONTOURS.when(map.contours.is_some()))
            .with(Self::MAP_WATER.when(has_water()))
            .with(Self::WATER_RELIEF)
    }

    /// The parts for what shows these of materials, in a picture that has the parts `picture`.
    pub fn in_picture(self, picture: Self) -> Self {
        let map = [Self::IMAGERY, Self::COVER, Self::CONTOURS, Self::MAP_WATER];
        let shadows = [Self::SUN_SHADOWS, Self::SKY_SHADOWS, Self::PLAIN_SHADOWS];
        let colored = self.has(Self::GROUND_COLOR);
        let lit = self.has(Self::GROUND_LIGHT.with(Self::OWN_LIGHT));
        let mirrors = self.has(Self::WATER) || (colored && picture.has(Self::MAP_WATER));
        let mirrored = [Self::WATER_RELIEF, Self::IMAGERY, Self::COVER, Self::MAP_WATER];
        let all = |parts: &[Self]| parts.iter().fold(Self::NONE, |all, &part| all.with(part));
        let wanted = self
            .with(Self::HAZE)
            .with(all(&map).when(colored))
            .with(all(&mirrored).when(mirrors && picture.has(Self::WATER_RELIEF)))
            .with(Self::GRAIN.when(colored || self.has(Self::NATURAL)))
            .with(Self::WINDOWS.with(Self::PLAIN_GROUND).when(self.has(Self::GROUND)))
            .with(all(&shadows).when(lit));
        let of_material = all(&[
            Self::GROUND,
            Self::OWN_LIGHT,
            Self::HATCHING,
            Self::WATER,
            Self::NATURAL,
            Self::EDGES,
            Self::AREA,
        ]);
        Self(wanted.0 & picture.with(of_material).0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_has_the_parts_that_its_materials_can_show_of_the_picture() {
        let picture = ShaderParts::SUN_SHADOWS.with(ShaderParts::COVER).with(ShaderParts::GRAIN);
        let house = ShaderParts::of_material(&Material::default());
        assert_eq!(house.in_picture(picture), ShaderParts::OWN_LIGHT.with(ShaderParts::SUN_SHADOWS));
        assert_eq!(ShaderParts::GROUND.in_picture(picture), ShaderParts::GROUND.with(picture));
        assert_eq!(ShaderParts::GROUND.in_picture(ShaderParts::NONE), ShaderParts::GROUND);
    }

    #[test]
    fn what_moves_adds_to_a_picture_at_rest_plain_shadows_and_plain_ground_alone() {
        let map = ShaderParts::COVER.with(ShaderParts::MAP_WATER);
        let whole = map.with(ShaderParts::WATER_RELIEF).with(ShaderParts::GRAIN);
        let plain = map.with(ShaderParts::PLAIN_GROUND);
        assert_eq!(whole.while_moving(), plain);
        let shaded = map.with(ShaderParts::SUN_SHADOWS).with(ShaderParts::SKY_SHADOWS);
        let moving = plain.with(ShaderParts::SUN_SHADOWS).with(ShaderParts::PLAIN_SHADOWS);
        assert_eq!(shaded.while_moving(), moving);
        let ribbon = ShaderParts::GROUND_LIGHT.with(ShaderParts::WATER);
        let lit = ribbon.with(moving.without(map));
        assert_eq!(ribbon.in_picture(moving), lit, "water that mirrors the sky alone needs no ground");
    }

    #[test]
    fn clear_air_has_no_haze() {
        let parts = |lighting: &Lighting| ShaderParts::of_picture(None, lighting, [false, true]);
        let mut lighting = Lighting::default();
        assert_eq!(parts(&lighting), ShaderParts::SKY_SHADOWS);
        lighting.haze.distance_m = 5000.0;
        assert_eq!(parts(&lighting), ShaderParts::SKY_SHADOWS.with(ShaderParts::HAZE));
    }
}
