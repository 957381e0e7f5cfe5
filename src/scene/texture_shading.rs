//! Texture shading of a ground map: its crests are lighter and its drainage darker, from whatever side the light comes.
//!
//! It is a factor of brightness, `1 + strength · v · (LIGHTER or DARKER)` with `v` the texture of the drawn ground bent to
//! −1..1. The map keeps it in the share of the sky, `mix(CLOSED, 1, sky)` of [`ReliefShading`] being a factor of brightness
//! too: every renderer draws it, and a map without texture is as it was. The shading by light is eased as texture grows: beside
//! all of it, texture would be lost on the slopes that are white or black already.

use glam::Vec2;
use rayon::prelude::*;

use sandtable_draw::ground::GroundPost;
use sandtable_draw::ground_levels::PostCount;
use sandtable_draw::lighting::ReliefShading;
use sandtable_terrain::light::texture::{ORDER, texture};

/// How much lighter the sharpest crests are at full strength: more burns pale tints.
const LIGHTER: f32 = 0.15;

/// How much darker the deepest drainage is: no more fits into the share of the sky.
const DARKER: f32 = 0.5;

/// The part of the slopes' shading by light that full strength takes.
const EASED: f32 = 0.66;

/// By what texture is multiplied before it is bent: at 1.5, most drainage of hills is nearly as dark as it gets, and a plain has
/// a middle gray.
const GAIN: f32 = 1.5;

/// Brightness where no sky is seen, in shares of the sky.
const UNSEEN: f32 = ReliefShading::CLOSED / (1.0 - ReliefShading::CLOSED);

/// How texture is shown on a ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TextureShading {
    /// From 0, which shows none, to 1.
    pub strength: f32,
    /// Meters of drawn height per meter of elevation, times the z-factor of the shading.
    pub steepness: f32,
    /// The length of forms in meters whose texture is their slope.
    pub form_m: f32,
}

impl TextureShading {
    /// Adds the texture to the sky visibility of a map of `size` posts, `cell` meters apart. Water keeps its own.
    pub fn apply(&self, posts: &mut [GroundPost], size: PostCount, cell: Vec2) {
        let heights = posts.par_iter().map(|post| post.height_m).collect();
        let values = texture(heights, size.columns as usize, cell);
        let per_value = GAIN * self.steepness * libm::powf(self.form_m, ORDER - 1.0);
        let [lighter, darker] = [LIGHTER, DARKER].map(|most| self.strength * most);
        posts.par_iter_mut().zip(values).filter(|(post, _)| post.water < 0.5).for_each(|(post, value)| {
            let bent = bent(value * per_value);
            let change = bent * if bent > 0.0 { lighter } else { darker };
            post.sky_visibility = (post.sky_visibility + change * (UNSEEN + post.sky_visibility))
                .clamp(0.0, GroundPost::MOST_SKY);
        });
    }

    /// How strongly forms show in the shade beside texture of a strength, which draws them there itself.
    pub fn eased_detail(strength: f32) -> f32 {
        ReliefShading::DETAIL * (1.0 - strength)
    }

    /// The z-factor of the shading by light beside texture of a strength, where it would be `z_factor` alone.
    pub fn eased(strength: f32, z_factor: f32) -> f32 {
        z_factor * (1.0 - EASED * strength)
    }
}

/// The share of the sky at a post of a finer map of a part of the ground that has `own` without the ground around it, which
/// lets `around` pass. Where the ground around is textured, its texture goes on: that of a part lacks forms longer than the part,
/// and would end at its border.
pub fn sky_in_part(strength: f32, own: f32, around: f32) -> f32 {
    if strength > 0.0 { around } else { own.min(around) }
}

/// A texture bent to −1..1.
fn bent(texture: f32) -> f32 {
    texture / (1.0 + texture * texture).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use sandtable_draw::lighting::ReliefPoint;

    const SIDE: u32 = 129;

    /// Ridges and valleys from west to east, under water south of the middle.
    fn posts() -> Vec<GroundPost> {
        let post = |index: u32| GroundPost {
            height_m: 100.0 * libm::sinf((index % SIDE) as f32 * 0.2),
            sun_visibility: 1.0,
            sky_visibility: 0.9,
            water: if index / SIDE < SIDE / 2 { 0.8 } else { 0.0 },
            ..GroundPost::default()
        };
        (0..SIDE * SIDE).map(post).collect()
    }

    fn shaded(strength: f32) -> Vec<GroundPost> {
        let mut posts = posts();
        let shading = TextureShading { strength, steepness: 1.0, form_m: 100.0 };
        shading.apply(&mut posts, PostCount { columns: SIDE, rows: SIDE }, Vec2::splat(10.0));
        posts
    }

    #[test]
    fn crests_are_lighter_and_valleys_darker_by_at_most_the_strength() {
        let shading = ReliefShading::new(Vec3::new(-0.5, 0.5, 0.7).normalize());
        let brightness = |post: &GroundPost| {
            let point = ReliefPoint {
                normal: Vec3::Z,
                form: Vec3::Z,
                sun_visibility: 1.0,
                sky_visibility: post.sky_visibility,
                elevation: 1.0,
            };
            shading.shade(Vec3::ONE, &point).x
        };
        for strength in [0.25, 0.5, 1.0] {
            let pairs: Vec<(GroundPost, f32)> = posts()
                .iter()
                .zip(shaded(strength))
                .map(|(plain, textured)| (*plain, brightness(&textured) / brightness(plain) - 1.0))
                .collect();
            let dry = || pairs.iter().filter(|(post, _)| post.water < 0.5 && post.height_m.abs() > 60.0);
            assert!(dry().all(|(post, change)| post.height_m * change > 0.0), "{strength}");
            for (most, sign) in [(LIGHTER, 1.0), (DARKER, -1.0)] {
                let greatest = dry().fold(0.0f32, |most, (_, change)| most.max(change * sign));
                assert!((0.5..=1.001).contains(&(greatest / (strength * most))), "{strength}: {greatest}");
            }
            assert!(pairs.iter().all(|(post, change)| post.water < 0.5 || *change == 0.0));
        }
    }
}
