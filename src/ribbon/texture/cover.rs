//! Textures of land cover: quiet patterns in the manner of a topographic atlas, that tile and let the ground through.
//!
//! Every texture holds a whole number of its figures (crowns, rows, houses) to a side, and looks for figures across its
//! edges, so no seam shows. Colors stay near their mean: from afar, where a texture is a pixel, an area is an even tint.

use glam::FloatExt;

use crate::texture::shade::{grain, shade};
use sandtable_description::words::Cover;
use sandtable_draw::color::Srgba;

/// Meters in one repeat of a cover's texture. Figures have the size of what they stand for: crowns of five meters, rows
/// of two and a half, houses of twelve.
pub fn cover_length_m(cover: Cover) -> f64 {
    match cover {
        Cover::Forest | Cover::Orchard | Cover::Vineyard => 50.0,
        Cover::Scrub | Cover::Heath | Cover::Sand | Cover::Scree => 40.0,
        Cover::Meadow | Cover::Field => 60.0,
        Cover::Wetland | Cover::Rock | Cover::Glacier | Cover::Quarry | Cover::Paved => 80.0,
        Cover::BuiltUp | Cover::DenseBuiltUp => 120.0,
        Cover::Industry => 240.0,
        Cover::Restricted => 48.0,
    }
}

/// The line along an area that is to have one: its color.
pub fn border_color(cover: Cover) -> Srgba {
    let [red, green, blue] = match cover {
        Cover::Forest => [52, 88, 50],
        Cover::Scrub | Cover::Orchard => [104, 124, 70],
        Cover::Vineyard => [128, 116, 72],
        Cover::Heath => [124, 100, 98],
        Cover::Meadow => [116, 150, 88],
        Cover::Field => [156, 134, 76],
        Cover::Wetland => [66, 122, 142],
        Cover::Sand => [186, 160, 104],
        Cover::Rock | Cover::Scree => [116, 110, 104],
        Cover::Glacier => [120, 156, 178],
        Cover::Quarry => [138, 122, 100],
        Cover::Paved => [150, 146, 142],
        Cover::BuiltUp => [142, 98, 82],
        Cover::DenseBuiltUp => [126, 82, 70],
        Cover::Industry => [112, 102, 122],
        Cover::Restricted => [186, 44, 40],
    };
    Srgba([red, green, blue, 235])
}

/// The greatest width of the strip along an outline in which a cover fades, meters: about the distance from the first
/// trees to a closed wood.
pub const EDGE_M: f64 = 12.0;

/// Whether a cover grows or lies by nature; what is built, tilled or forbidden ends at a line.
pub fn is_natural(cover: Cover) -> bool {
    use Cover::{BuiltUp, DenseBuiltUp, Field, Industry, Orchard, Paved, Quarry, Restricted, Vineyard};
    !matches!(
        cover,
        BuiltUp | DenseBuiltUp | Industry | Restricted | Paved | Quarry | Field | Orchard | Vineyard
    )
}

/// A texel of the strip in which a cover fades: nothing at `u` 0.5, where the outline is, all of the cover at 0 and 1.
pub(super) fn edge_texel(cover: Cover, u: f32, v: f32, grain: f32) -> Srgba {
    let inward = (2.0 * u - 1.0).abs();
    let across = (u * (2.0 * EDGE_M / cover_length_m(cover)) as f32).fract();
    let Srgba([red, green, blue, alpha]) = texel(cover, across, v, grain);
    let share = inward.smoothstep(0.0, 1.0);
    Srgba([red, green, blue, (f32::from(alpha) * share + 0.5) as u8])
}

/// A cover's texel at (`u`, `v`), each in 0..1.
pub(super) fn texel(cover: Cover, u: f32, v: f32, grain: f32) -> Srgba {
    match cover {
        Cover::Forest => forest(u, v, grain),
        Cover::Scrub => scrub(u, v, grain),
        Cover::Meadow => meadow(u, v, grain),
        Cover::Field => field(u, v, grain),
        Cover::Orchard => orchard(u, v, grain),
        Cover::Vineyard => vineyard(v, grain),
        Cover::Heath => heath(u, v, grain),
        Cover::Wetland => wetland(u, v, grain),
        Cover::Sand => sand(u, v, grain),
        Cover::Rock => rock(u, v, grain),
        Cover::Scree => scree(u, v, grain),
        Cover::Glacier => translucent([226, 238, 246], (noise(u, v, 6, 97) - 0.5) * 14.0, 0.88),
        Cover::Quarry => quarry(u, v, grain),
        Cover::Paved => translucent([198, 194, 188], (grain - 0.5) * 8.0, 0.8),
        Cover::BuiltUp => houses(u, v, grain, &TOWN),
        Cover::DenseBuiltUp => houses(u, v, grain, &CENTER),
        Cover::Industry => houses(u, v, grain, &WORKS),
        Cover::Restricted => hatched(u, v),
    }
}

fn translucent(color: [u8; 3], by: f32, alpha: f32) -> Srgba {
    let Srgba([red, green, blue, _]) = shade(color, by);
    Srgba([red, green, blue, (alpha * 255.0 + 0.5) as u8])
}

/// Closed crowns, lit from the north-west, with dark gaps between.
fn forest(u: f32, v: f32, grain: f32) -> Srgba {
    match crown(u, v, 9, (0.46, 0.62), 11) {
        Some(crown) => translucent(
            [88, 128, 74],
            crown.light * 26.0 + crown.own * 18.0 - 9.0 + (grain - 0.5) * 8.0,
            0.82,
        ),
        None => translucent([54, 88, 54], (grain - 0.5) * 8.0, 0.82),
    }
}

/// Bushes apart on dry grass.
fn scrub(u: f32, v: f32, grain: f32) -> Srgba {
    match crown(u, v, 9, (0.16, 0.34), 23) {
        Some(crown) => translucent([118, 138, 82], crown.light * 22.0 + (grain - 0.5) * 10.0, 0.74),
        None => translucent([186, 188, 132], (grain - 0.5) * 12.0, 0.56),
    }
}

/// Grass, a little uneven.
fn meadow(u: f32, v: f32, grain: f32) -> Srgba {
    let uneven = noise(u, v, 6, 31) + 0.5 * noise(u, v, 14, 37);
    translucent([168, 196, 122], (uneven - 0.75) * 18.0 + (grain - 0.5) * 10.0, 0.6)
}

/// Rows from west to east.
fn field(u: f32, v: f32, grain: f32) -> Srgba {
    let row = libm::cosf(v * 24.0 * std::f32::consts::TAU);
    let uneven = noise(u, v, 5, 41) - 0.5;
    translucent([214, 196, 132], row * 13.0 + uneven * 12.0 + (grain - 0.5) * 8.0, 0.66)
}

/// Trees in rows on grass.
fn orchard(u: f32, v: f32, grain: f32) -> Srgba {
    const ROWS: f32 = 9.0;
    let at = [(u * ROWS).fract() - 0.5, (v * ROWS).fract() - 0.5];
    let away = libm::hypotf(at[0], at[1]);
    if away < 0.3 {
        translucent([80, 124, 80], -(at[0] + at[1]) * 40.0 + (grain - 0.5) * 8.0, 0.8)
    } else {
        translucent([232, 208, 156], (grain - 0.5) * 10.0, 0.6)
    }
}

/// Vines in rows from west to east.
fn vineyard(v: f32, grain: f32) -> Srgba {
    let row = libm::cosf(v * 20.0 * std::f32::consts::TAU);
    if row > 0.3 {
        translucent([134, 146, 78], (grain - 0.5) * 10.0, 0.78)
    } else {
        translucent([216, 198, 150], (grain - 0.5) * 8.0, 0.66)
    }
}

/// Heather in tufts on dry grass.
fn heath(u: f32, v: f32, grain: f32) -> Srgba {
    match crown(u, v, 11, (0.2, 0.44), 29) {
        Some(crown) => translucent([150, 118, 122], crown.light * 16.0 + (grain - 0.5) * 10.0, 0.74),
        None => translucent([184, 170, 128], (grain - 0.5) * 12.0, 0.66),
    }
}

/// Stones of many sizes.
fn scree(u: f32, v: f32, grain: f32) -> Srgba {
    match crown(u, v, 15, (0.2, 0.5), 67) {
        Some(crown) => translucent([172, 166, 158], crown.light * 20.0 + (crown.own - 0.5) * 20.0, 0.74),
        None => translucent([196, 188, 176], (grain - 0.5) * 10.0, 0.7),
    }
}

/// Benches of a pit.
fn quarry(u: f32, v: f32, grain: f32) -> Srgba {
    let bench = libm::cosf(v * 5.0 * std::f32::consts::TAU);
    translucent([208, 194, 168], bench * 14.0 + (noise(u, v, 7, 79) - 0.5) * 16.0 + (grain - 0.5) * 8.0, 0.8)
}

/// The map sign of a marsh: short strokes of water in staggered rows.
fn wetland(u: f32, v: f32, grain: f32) -> Srgba {
    const ROWS: f32 = 10.0;
    let row = (v * ROWS).floor();
    let stagger = (row % 2.0) * 0.5 + 0.12 * noise(0.0, v, 10, 53);
    let along = (u * 4.0 + stagger).fract();
    let across = ((v * ROWS).fract() - 0.5).abs();
    if across < 0.14 && along < 0.62 {
        translucent([82, 146, 176], (grain - 0.5) * 8.0, 0.85)
    } else {
        translucent([164, 196, 160], (grain - 0.5) * 10.0, 0.62)
    }
}

/// Dots, thrown without order.
fn sand(u: f32, v: f32, grain: f32) -> Srgba {
    match crown(u, v, 14, (0.1, 0.2), 61) {
        Some(_) => translucent([202, 174, 118], (grain - 0.5) * 8.0, 0.8),
        None => translucent([234, 218, 170], (grain - 0.5) * 10.0, 0.7),
    }
}

/// Bare rock: light faces and dark clefts.
fn rock(u: f32, v: f32, grain: f32) -> Srgba {
    let folded = |value: f32| 1.0 - (2.0 * value - 1.0).abs();
    let rough = 0.6 * folded(noise(u, v, 5, 71)) + 0.4 * folded(noise(u, v, 11, 73));
    let cleft = if rough > 0.82 { -30.0 } else { 0.0 };
    translucent([176, 168, 160], (0.5 - rough) * 34.0 + cleft + (grain - 0.5) * 12.0, 0.68)
}

/// How built-up ground looks.
struct Lots {
    /// To a side of the texture.
    count: u32,
    /// Every so many lots a street runs.
    street: u32,
    ground: [u8; 3],
    roof: [u8; 3],
    seed: u32,
}

const TOWN: Lots = Lots { count: 6, street: 3, ground: [226, 206, 186], roof: [198, 142, 118], seed: 83 };
const CENTER: Lots = Lots { count: 8, street: 4, ground: [200, 174, 156], roof: [172, 112, 90], seed: 79 };
const WORKS: Lots = Lots { count: 4, street: 2, ground: [214, 206, 214], roof: [168, 160, 176], seed: 89 };

/// Roofs on lots, with streets between blocks.
fn houses(u: f32, v: f32, grain: f32, lots: &Lots) -> Srgba {
    let [x, y] = [u, v].map(|at| at * lots.count as f32);
    let (column, row) = (x as u32, y as u32);
    let own = |salt: u32| hashed(column, row, lots.seed + salt);
    let (east, south) = (x.fract(), y.fract());
    let is_street = (column % lots.street == 0 && east < 0.14) || (row % lots.street == 0 && south < 0.14);
    if is_street {
        return translucent([238, 226, 210], (grain - 0.5) * 6.0, 0.68);
    }
    let half = [0.17 + 0.12 * own(1), 0.15 + 0.1 * own(2)];
    let away = [(east - 0.58).abs() - half[0], (south - 0.58).abs() - half[1]];
    if away[0] < 0.0 && away[1] < 0.0 {
        // A ridge from west to east: its northern side is lit.
        let side = if south < 0.58 { 12.0 } else { -12.0 };
        return translucent(lots.roof, side + (own(3) - 0.5) * 24.0, 0.86);
    }
    translucent(lots.ground, (grain - 0.5) * 8.0, 0.64)
}

/// Lines from south-west to north-east over a faint tint.
fn hatched(u: f32, v: f32) -> Srgba {
    let across = ((u + v) * 2.0).fract();
    if across < 0.24 { Srgba([200, 48, 44, 220]) } else { Srgba([226, 120, 104, 52]) }
}

/// A point within a round figure.
struct Crown {
    /// From -1 on its dark side to 1 on its lit one.
    light: f32,
    /// A number in 0..1 of its own.
    own: f32,
}

/// The figure at a point, of those thrown one into each of `count` × `count` squares, with radii between two numbers.
fn crown(u: f32, v: f32, count: u32, (least, most): (f32, f32), seed: u32) -> Option<Crown> {
    let [x, y] = [u, v].map(|at| at * count as f32);
    let (column, row) = (x as u32, y as u32);
    let mut nearest: Option<(f32, Crown)> = None;
    for (east, south) in (0..9).map(|index| (index % 3, index / 3)) {
        // One square back, with one whole turn added so that it stays above 0.
        let (square_x, square_y) = (column + east + count - 1, row + south + count - 1);
        let own = |salt: u32| hashed(square_x % count, square_y % count, seed + salt);
        let middle = [
            square_x as f32 - count as f32 + 0.5 + (own(0) - 0.5) * 0.7,
            square_y as f32 - count as f32 + 0.5 + (own(1) - 0.5) * 0.7,
        ];
        let radius = least + (most - least) * own(2);
        let away = [(x - middle[0]) / radius, (y - middle[1]) / radius];
        let distance = libm::hypotf(away[0], away[1]);
        if distance < 1.0 && nearest.as_ref().is_none_or(|(other, _)| distance < *other) {
            let light = -(away[0] + away[1]) * std::f32::consts::FRAC_1_SQRT_2;
            nearest = Some((distance, Crown { light, own: own(3) }));
        }
    }
    nearest.map(|(_, crown)| crown)
}

/// Smooth noise in 0..1 that repeats with the texture, `count` waves to a side.
fn noise(u: f32, v: f32, count: u32, seed: u32) -> f32 {
    let [x, y] = [u, v].map(|at| at * count as f32);
    let (column, row) = (x as u32, y as u32);
    let (s, t) = (x.fract().smoothstep(0.0, 1.0), y.fract().smoothstep(0.0, 1.0));
    let corner = |east: u32, south: u32| hashed((column + east) % count, (row + south) % count, seed);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    mix(mix(corner(0, 0), corner(1, 0), s), mix(corner(0, 1), corner(1, 1), s), t)
}

/// A fixed number in 0..1 for a square and a seed.
fn hashed(column: u32, row: u32, seed: u32) -> f32 {
    grain(column.wrapping_mul(131).wrapping_add(seed), row.wrapping_mul(197).wrapping_add(seed * 7))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::{RibbonSurface, texture};
    use sandtable_base::message::choice::Choice;

    fn covers() -> impl Iterator<Item = Cover> {
        Cover::CHOICES.iter().map(|choice| choice.value)
    }

    #[test]
    fn every_cover_lets_the_ground_through() {
        for cover in covers() {
            let pixels = texture(RibbonSurface::Cover(cover));
            let alphas = pixels.data().iter().map(|texel| texel.0[3]);
            assert!(alphas.clone().all(|alpha| alpha > 0 && alpha < 255), "{cover:?}");
        }
    }

    #[test]
    fn no_seam_shows_where_a_texture_repeats() {
        let differs =
            |a: Srgba, b: Srgba| -> f64 { a.0.iter().zip(b.0).map(|(&a, b)| f64::from(a.abs_diff(b))).sum() };
        for cover in covers() {
            let pixels = texture(RibbonSurface::Cover(cover));
            let (width, height) = (pixels.width(), pixels.height());
            let rows = |upper: u32, lower: u32| -> f64 {
                (0..width).map(|x| differs(pixels.at(x, upper), pixels.at(x, lower))).sum::<f64>()
                    / f64::from(width)
            };
            let columns = |left: u32, right: u32| -> f64 {
                (0..height).map(|y| differs(pixels.at(left, y), pixels.at(right, y))).sum::<f64>()
                    / f64::from(height)
            };
            let within = (0..height - 1).map(|y| rows(y, y + 1)).fold(0.0, f64::max);
            assert!(rows(height - 1, 0) <= within * 1.05, "{cover:?}: {} {within}", rows(height - 1, 0));
            let within = (0..width - 1).map(|x| columns(x, x + 1)).fold(0.0, f64::max);
            assert!(columns(width - 1, 0) <= within * 1.05, "{cover:?}");
        }
    }

    #[test]
    fn no_two_covers_look_alike_from_afar() {
        let mean = |cover: Cover| -> [f64; 3] {
            let pixels = texture(RibbonSurface::Cover(cover));
            let count = pixels.data().len() as f64;
            std::array::from_fn(|channel| {
                pixels.data().iter().map(|texel| f64::from(texel.0[channel])).sum::<f64>() / count
            })
        };
        let means: Vec<_> = covers().map(|cover| (cover, mean(cover))).collect();
        for (index, (cover, color)) in means.iter().enumerate() {
            for (other, other_color) in &means[..index] {
                let apart: f64 = color.iter().zip(other_color).map(|(a, b)| (a - b).abs()).sum();
                assert!(apart > 12.0, "{cover:?} and {other:?} are {apart} apart");
            }
        }
    }
}
