//! Procedural textures for draped features; the same pixels on every machine.

pub mod area;
mod boundary;
pub mod cover;
mod road;
mod shade;
mod water;

use crate::texture::road::{Center, RoadMarkings};
use crate::texture::shade::{grain, shade};
use sandtable_description::words::Cover;
use sandtable_draw::color::Srgba;
use sandtable_draw::pixels::Pixels;
use sandtable_draw::water::WaterColor;

/// The surface of a ribbon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RibbonSurface {
    /// A paved road: dark carriageway, light edge lines and a dashed center line.
    Asphalt,
    /// A paved road with a solid center line.
    AsphaltSolid,
    /// A paved road with edge lines only.
    AsphaltEdges,
    /// A paved road without lines.
    AsphaltPlain,
    /// A gravel road.
    Gravel,
    /// Two wheel tracks with grass between.
    Track,
    /// The unpaved strip beside a carriageway.
    Shoulder,
    /// Where paved roads meet: the carriageway without lines.
    AsphaltJunction,
    /// Where gravel roads meet.
    GravelJunction,
    /// Where tracks meet.
    TrackJunction,
    /// Running water: light in the stream, dark along the banks.
    River,
    /// Where running waters meet: the stream without its sides.
    Confluence,
    /// Water white with falling over stones.
    Rapids,
    /// Water that drops.
    Falls,
    /// A bar of sand and gravel in a river's bend.
    Bar,
    /// The banks on either side of running water.
    Bank,
    /// Still water.
    Lake,
    /// The line along the shore of still water.
    ShoreLine,
    /// The floor of a trench.
    Trench,
    /// The dashes of a boundary.
    Boundary,
    /// What covers an area.
    Cover(Cover),
    /// The strip along an area's outline in which its cover fades.
    CoverEdge(Cover),
    /// The line along an area's outline: white, to be tinted.
    Border,
}

impl RibbonSurface {
    /// Whether it joins roads or rivers rather than being one.
    pub fn is_junction(self) -> bool {
        matches!(self, Self::AsphaltJunction | Self::GravelJunction | Self::TrackJunction | Self::Confluence)
    }

    /// The rank of the pavement: a road continues through the lesser ones that it meets.
    pub fn rank(self) -> u8 {
        match self {
            Self::Track | Self::Shoulder => 0,
            Self::Gravel => 1,
            _ => 2,
        }
    }

    /// This pavement without lines.
    pub fn unmarked(self) -> Self {
        match self {
            Self::Asphalt | Self::AsphaltSolid | Self::AsphaltEdges => Self::AsphaltPlain,
            other => other,
        }
    }

    /// Whether it is open water.
    pub fn is_water(self) -> bool {
        matches!(self, Self::River | Self::Confluence | Self::Rapids | Self::Lake)
    }

    /// Whether it lies between the banks of running water.
    pub fn is_channel(self) -> bool {
        matches!(self, Self::River | Self::Confluence | Self::Rapids | Self::Falls | Self::Bar)
    }

    /// Whether it grows or lies by nature, so that the ground's grain goes through it.
    pub fn is_natural(self) -> bool {
        matches!(self, Self::Cover(cover) | Self::CoverEdge(cover) if cover::is_natural(cover))
    }

    /// Whether the ground shows through it.
    pub fn lets_through(self) -> bool {
        matches!(self, Self::Cover(_) | Self::CoverEdge(_) | Self::Border | Self::Bank)
    }
}

const SIZE: u32 = 128;

/// The texture of `surface`: U across (0 left edge, 1 right edge), V along.
pub fn texture(surface: RibbonSurface) -> Pixels {
    Pixels::from_fn(SIZE, SIZE, |x, y| {
        let (u, v) = ((x as f32 + 0.5) / SIZE as f32, (y as f32 + 0.5) / SIZE as f32);
        let grain = grain(x, y);
        match surface {
            RibbonSurface::Asphalt => {
                road::asphalt(u, RoadMarkings::Edges { center: Some(Center::Dashed(v)) }, grain)
            }
            RibbonSurface::AsphaltSolid => {
                road::asphalt(u, RoadMarkings::Edges { center: Some(Center::Solid) }, grain)
            }
            RibbonSurface::AsphaltEdges => road::asphalt(u, RoadMarkings::Edges { center: None }, grain),
            RibbonSurface::AsphaltPlain => road::asphalt(u, RoadMarkings::None, grain),
            RibbonSurface::Shoulder => shade(road::SHOULDER, (grain - 0.5) * 34.0),
            RibbonSurface::Gravel => road::gravel(u, grain),
            RibbonSurface::Track => road::track(u, grain),
            RibbonSurface::AsphaltJunction => shade(road::ASPHALT, (grain - 0.5) * 14.0),
            RibbonSurface::GravelJunction => shade(road::GRAVEL, (grain - 0.5) * 34.0),
            RibbonSurface::TrackJunction => shade(road::WORN, (grain - 0.5) * 30.0),
            RibbonSurface::River => water::river(u, grain),
            RibbonSurface::Trench => boundary::trench(u, grain),
            RibbonSurface::Boundary => boundary::boundary(u, grain),
            RibbonSurface::Confluence => water::stream(grain),
            RibbonSurface::Rapids => water::rapids(u, self::grain(x, y / water::STREAK)),
            RibbonSurface::Falls => water::falls(u, self::grain(x, y / water::STREAK)),
            RibbonSurface::Bar => water::bar(u, grain),
            RibbonSurface::Bank => water::bank(u, grain),
            RibbonSurface::Cover(cover) => cover::texel(cover, u, v, grain),
            RibbonSurface::CoverEdge(cover) => cover::edge_texel(cover, u, v, grain),
            RibbonSurface::Border => Srgba::WHITE,
            RibbonSurface::Lake => water::lake(grain),
            RibbonSurface::ShoreLine => WaterColor::SHORE_LINE,
        }
    })
}

/// The markings of `surface` on a transparent ground: over the texture of [`RibbonSurface::unmarked`] they make that of
/// the surface. `None` where nothing is.
pub fn markings(surface: RibbonSurface) -> Option<Pixels> {
    let plain = (surface != surface.unmarked()).then(|| texture(surface.unmarked()))?;
    let marked = texture(surface);
    Some(Pixels::from_fn(SIZE, SIZE, |x, y| {
        let texel = marked.at(x, y);
        if texel == plain.at(x, y) { Srgba([texel.0[0], texel.0[1], texel.0[2], 0]) } else { texel }
    }))
}

/// Meters along a ribbon of `width_m` in one repeat of its texture.
///
/// A line of a road is a twentieth of the road's width, and a dash with its gap two and a half widths: what is painted
/// keeps its proportion to the road, as on a sand table, where roads are drawn wider than they are to be seen at all. A
/// line of the 15 cm that is painted on real roads would be lost in any picture of more than a street.
pub fn texture_length_m(surface: RibbonSurface, width_m: f64) -> f64 {
    match surface {
        RibbonSurface::Asphalt
        | RibbonSurface::AsphaltSolid
        | RibbonSurface::AsphaltEdges
        | RibbonSurface::AsphaltPlain => width_m * 2.5,
        _ => width_m * 2.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markings_are_where_their_names_say() {
        let light = |surface, x: u32, y: u32| texture(surface).at(x, y).0[0] > 230;
        let (edge, center, in_dash, in_gap) = (SIZE / 12, SIZE / 2, 4, SIZE - 4);
        for (surface, expected) in [
            (RibbonSurface::Asphalt, [true, true, false]),
            (RibbonSurface::AsphaltSolid, [true, true, true]),
            (RibbonSurface::AsphaltEdges, [true, false, false]),
            (RibbonSurface::AsphaltPlain, [false; 3]),
            (RibbonSurface::AsphaltJunction, [false; 3]),
        ] {
            let found =
                [(edge, in_gap), (center, in_dash), (center, in_gap)].map(|(x, y)| light(surface, x, y));
            assert_eq!(found, expected, "{surface:?}");
        }
    }

    #[test]
    fn markings_over_a_plain_road_make_the_marked_one() {
        for surface in [RibbonSurface::Asphalt, RibbonSurface::AsphaltSolid, RibbonSurface::AsphaltEdges] {
            let (whole, plain) = (texture(surface), texture(surface.unmarked()));
            let painted = markings(surface).expect("a marked road");
            for (x, y) in (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y))) {
                let over = painted.at(x, y);
                let shown = if over.0[3] == 255 { over } else { plain.at(x, y) };
                assert_eq!(shown, whole.at(x, y), "{surface:?} {x} {y}");
            }
        }
        assert!(markings(RibbonSurface::Gravel).is_none());
    }

    #[test]
    fn a_road_has_light_edge_lines_and_water_none() {
        let road = texture(RibbonSurface::Asphalt);
        let light = |pixels: &Pixels| (0..SIZE).filter(|&x| pixels.at(x, SIZE - 4).0[0] > 230).count();
        assert!(light(&road) > 8);
        assert_eq!(light(&texture(RibbonSurface::Lake)), 0);
    }
}
