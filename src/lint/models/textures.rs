//! Textures that are stretched over a model: smeared into streaks, or of a few pixels for many meters.
//!
//! The measure is that of Sander, Snyder, Gortler and Hoppe (2001): the singular values of the linear map between a triangle
//! and its part of the picture, here as pixels a meter along the direction in which the picture is densest, and across it.
//!
//! ```text
//!     picture        wall                      a projection from above: the wall takes
//!     ▒░▓▒░▓   ─►   ▒░▓▒░▓   many px a meter   one row of pixels, drawn down as streaks
//!                   ▒░▓▒░▓
//!                   ▒░▓▒░▓   0 px a meter
//! ```
//!
//! Triangles within one pixel have one color, as those of palettes do, and those along a gradient mean to show it: only where
//! the picture goes up and down along the dense direction are streaks seen.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use crate::context::LintContext;
use crate::models::standing::StandingModel;
use crate::sink::FindingSink;
use crate::worst::WorstOfTables;
use sandtable_description::finding_code::FindingCode;
use sandtable_draw::material::TextureWrap;
use sandtable_draw::pixels::Pixels;
use sandtable_model::Model;

/// Pixels are smeared where one is so many times as long as wide: unwrapped models have up to 4.
const SMEARED: f32 = 10.0;

/// Pixels wider than this are seen as blots, meters: a window is narrower.
const COARSE_M: f32 = 0.5;

/// And only where the model's largest side has fewer of them than this: pictures of whole landscapes are coarse as well.
const LEAST_PX: f32 = 32.0;

/// The share of the textured faces, by area, that has to be stretched: the edges of slabs are smeared on good models.
const LEAST_SHARE: f32 = 0.25;

/// The least difference of brightness, of 255, that shows.
const LEAST_CONTRAST: f32 = 24.0;

/// Brightness goes up and down where its steps add up to so many times its range; along a gradient they add up to it.
const UPS_AND_DOWNS: f32 = 2.0;

/// The most places along a triangle at which the picture is read.
const MOST_SAMPLES: usize = 64;

/// The most triangles of a model that are looked at.
const MOST_TRIANGLES: usize = 200_000;

/// Finds stretched textures among `standing`: each model once, where it is drawn largest.
pub fn check(context: &LintContext<'_>, standing: &[StandingModel<'_>], sink: &mut FindingSink) {
    let mut largest: BTreeMap<usize, &StandingModel<'_>> = BTreeMap::new();
    for model in standing {
        let known = largest.entry(model.placement.model).or_insert(model);
        if model.placement.scale > known.placement.scale {
            *known = model;
        }
    }
    let mut worst = WorstOfTables::default();
    for (index, standing) in largest {
        let file = &context.scene.models[index];
        let Some(stretch) = stretch(file, standing.placement.scale, standing.size_m().max_element()) else {
            continue;
        };
        let feature = standing.placement.feature;
        worst.add(context.origin(feature), f64::from(stretch.share), || {
            let TextureStretch { share, pixel_m: [short, long], part } = &stretch;
            let of_part = if part.is_empty() { String::new() } else { format!(" of its part '{part}'") };
            format!(
                "{} has stretched pictures on {:.0} % of its textured faces: on a face{of_part} a pixel is {} long and {} wide",
                context.name(feature),
                share * 100.0,
                length(*long),
                length(*short)
            )
        });
    }
    let help = "mend the texture coordinates where the model is made, or use a picture of more pixels";
    worst.report(context, FindingCode::TextureStretched, help, sink);
}

/// How much of a model's pictures is stretched.
struct TextureStretch {
    /// The share of its textured faces, by area.
    share: f32,
    /// Width and length of a pixel in meters on the largest of these; the length may be infinite.
    pixel_m: [f32; 2],
    /// The name of the part that has it.
    part: String,
}

/// The stretch of a model with so many meters in a unit and a largest side of `side_m`; `None` where little is stretched.
fn stretch(model: &Model, scale: f32, side_m: f32) -> Option<TextureStretch> {
    let (mut textured, mut stretched, mut largest) = (0.0f32, 0.0f32, (0.0f32, [0.0f32; 2], ""));
    let mut left = MOST_TRIANGLES;
    for part in &model.parts {
        let Some(material) = model.materials.get(part.material.0 as usize) else { continue };
        let texture = material.texture.and_then(|id| model.textures.get(id.0 as usize));
        let Some(pixels) = texture else { continue };
        let picture = WrappedPicture { pixels, wrap: material.texture_wrap };
        let count = part.mesh.triangles.len().min(left);
        left -= count;
        for corners in &part.mesh.triangles[..count] {
            let corners = corners.map(|id| part.mesh.vertices[id.index()]);
            let places = corners.map(|corner| Vec3::from(corner.position) * scale);
            let size = Vec2::new(pixels.width() as f32, pixels.height() as f32);
            let Some(face) = TexturedFace::new(places, corners.map(|corner| Vec2::from(corner.uv) * size))
            else {
                continue;
            };
            textured += face.area_m2;
            if face.is_stretched(picture, side_m) {
                stretched += face.area_m2;
                if face.area_m2 > largest.0 {
                    largest = (face.area_m2, face.px_per_m.map(f32::recip), part.name.as_str());
                }
            }
        }
    }
    let share = stretched / textured;
    let (_, pixel_m, part) = largest;
    (share > LEAST_SHARE).then(|| TextureStretch { share, pixel_m, part: part.to_owned() })
}

/// A picture, and what it shows beyond its borders.
#[derive(Clone, Copy)]
struct WrappedPicture<'a> {
    pixels: &'a Pixels,
    wrap: [TextureWrap; 2],
}

impl WrappedPicture<'_> {
    /// The brightness at a place in pixels, 0 to 255.
    fn brightness(&self, at: Vec2) -> f32 {
        let sides = [self.pixels.width(), self.pixels.height()];
        let [x, y] =
            std::array::from_fn(|axis| self.wrap[axis].texel(at[axis] / sides[axis] as f32, sides[axis]));
        let [red, green, blue, _] = self.pixels.at(x, y).0.map(f32::from);
        (red + green + blue) / 3.0
    }
}

/// A triangle that shows more than one pixel of a picture.
struct TexturedFace {
    area_m2: f32,
    /// Pixels a meter along the direction in which the picture is densest, and across it.
    px_per_m: [f32; 2],
    /// The two corners that are farthest apart along that direction, in pixels, and the middle of all three.
    along_px: [Vec2; 2],
    middle_px: Vec2,
}

impl TexturedFace {
    /// The face with corners at `places` in meters and `px` in the picture; `None` without area, and within a pixel.
    fn new(places: [Vec3; 3], px: [Vec2; 3]) -> Option<Self> {
        let (one, other) = (places[1] - places[0], places[2] - places[0]);
        let x_axis = one.try_normalize()?;
        let normal = one.cross(other);
        let area_m2 = normal.length() / 2.0;
        let y_axis = normal.try_normalize()?.cross(x_axis);
        // In the plane of the face the sides are (a, 0) and (b, c).
        let (a, b, c) = (one.length(), other.dot(x_axis), other.dot(y_axis));
        let (u, v) = (px[1] - px[0], px[2] - px[0]);
        let (per_x, per_y) = (u / a, (v - u * (b / a)) / c);
        let squares = per_x.length_squared() + per_y.length_squared();
        let area_scale = per_x.perp_dot(per_y).abs();
        let root = (squares * squares - 4.0 * area_scale * area_scale).max(0.0).sqrt();
        let dense = ((squares + root) / 2.0).sqrt();
        // The direction in the picture: the first axis of the ellipse that a circle on the face becomes.
        let twice = libm::atan2f(
            2.0 * (per_x.x * per_x.y + per_y.x * per_y.y),
            per_x.x * per_x.x + per_y.x * per_y.x - per_x.y * per_x.y - per_y.y * per_y.y,
        );
        let direction = Vec2::new(libm::cosf(twice / 2.0), libm::sinf(twice / 2.0));
        let mut along = px;
        along.sort_by(|a, b| a.dot(direction).total_cmp(&b.dot(direction)));
        let is_within_a_pixel = (along[2] - along[0]).dot(direction) < 1.0;
        (area_m2.is_finite() && dense.is_finite() && !is_within_a_pixel).then(|| Self {
            area_m2,
            px_per_m: [dense, area_scale / dense],
            along_px: [along[0], along[2]],
            middle_px: (px[0] + px[1] + px[2]) / 3.0,
        })
    }

    /// Whether it shows streaks or blots of `picture`, on a model whose largest side is `side_m`.
    fn is_stretched(&self, picture: WrappedPicture<'_>, side_m: f32) -> bool {
        let [dense, sparse] = self.px_per_m;
        let brightness = || self.brightness(picture);
        if dense > SMEARED * sparse {
            let (range, steps) = contrast(&brightness());
            return range >= LEAST_CONTRAST && steps >= UPS_AND_DOWNS * range;
        }
        let is_coarse = dense * COARSE_M < 1.0 && dense * side_m < LEAST_PX;
        is_coarse && contrast(&brightness()).0 >= LEAST_CONTRAST
    }

    /// The brightness of the picture from one end of the face to the other, 0 to 255.
    fn brightness(&self, picture: WrappedPicture<'_>) -> Vec<f32> {
        let [from, to] = self.along_px.map(|corner| corner.lerp(self.middle_px, 0.1));
        let count = (from.distance(to).ceil() as usize).clamp(2, MOST_SAMPLES);
        let place = |index: usize| from.lerp(to, index as f32 / (count - 1) as f32);
        (0..count).map(|index| picture.brightness(place(index))).collect()
    }
}

/// The range of some values, and the sum of the steps from each to the next.
fn contrast(values: &[f32]) -> (f32, f32) {
    let (low, high) =
        values.iter().fold((f32::MAX, f32::MIN), |(low, high), &value| (low.min(value), high.max(value)));
    (high - low, values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum())
}

/// A length as a message states it.
fn length(meters: f32) -> String {
    match meters {
        _ if meters > 1000.0 => "over 1 km".to_owned(),
        _ if meters < 0.1 => format!("{:.1} mm", meters * 1000.0),
        _ => format!("{meters:.1} m"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_draw::color::Srgba;

    /// A wall 10 m wide and 5 m high, whose corners have these places in a picture of 64 × 64 pixels.
    fn face(px: [[f32; 2]; 3]) -> Option<TexturedFace> {
        let places = [Vec3::ZERO, Vec3::X * 10.0, Vec3::new(10.0, 0.0, 5.0)];
        TexturedFace::new(places, px.map(Vec2::from))
    }

    fn striped() -> Pixels {
        let stripe = |x: u32| if x.is_multiple_of(4) { 220 } else { 90 };
        Pixels::from_fn(64, 64, |x, _| Srgba([stripe(x), stripe(x), stripe(x), 255]))
    }

    #[test]
    fn the_densities_of_a_picture_are_those_along_and_across_a_face() {
        let even = face([[0.0, 0.0], [60.0, 0.0], [60.0, 30.0]]).expect("many pixels");
        assert!((even.px_per_m[0] - 6.0).abs() < 1e-3 && (even.px_per_m[1] - 6.0).abs() < 1e-3);
        let sheared = face([[0.0, 0.0], [0.0, 40.0], [5.0, 40.0]]).expect("many pixels");
        assert!((sheared.px_per_m[0] - 4.0).abs() < 1e-3 && (sheared.px_per_m[1] - 1.0).abs() < 1e-3);
        assert!(face([[3.2, 3.2], [3.4, 3.2], [3.2, 3.4]]).is_none(), "within a pixel");
    }

    #[test]
    fn streaks_and_blots_are_stretched_and_gradients_and_even_pictures_are_not() {
        let stretched = |px, pixels: &Pixels| {
            let picture = WrappedPicture { pixels, wrap: [TextureWrap::Repeat; 2] };
            face(px).expect("many pixels").is_stretched(picture, 10.0)
        };
        let from_above = [[0.0, 7.0], [60.0, 7.0], [60.0, 7.0]];
        assert!(stretched(from_above, &striped()));
        let gradient = Pixels::from_fn(64, 64, |x, _| Srgba([x as u8 * 4, x as u8 * 4, x as u8 * 4, 255]));
        assert!(!stretched(from_above, &gradient));
        assert!(!stretched(from_above, &Pixels::filled(64, 64, Srgba([90, 120, 80, 255]))));
        assert!(!stretched([[0.0, 0.0], [60.0, 0.0], [60.0, 30.0]], &striped()));
        assert!(stretched([[0.0, 0.0], [10.0, 0.0], [10.0, 5.0]], &striped()), "a pixel a meter");
    }
}
