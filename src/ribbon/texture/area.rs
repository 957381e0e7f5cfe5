//! The textures of covers in the world, by the formula of [`AreaTexture`].
//!
//! Figures have the size of what they stand for: crowns of six meters, roofs of twelve, fields of a few hectares in strips of
//! sixty meters. From afar each has the mean color of the cover's tile, so that overviews, legends and models agree.

use std::sync::OnceLock;

use glam::{Vec2, Vec3, Vec4};

use crate::texture::{RibbonSurface, texture};
use sandtable_base::message::choice::Choice;
use sandtable_description::words::Cover;
use sandtable_draw::area_texture::AreaTexture;
use sandtable_draw::color::Srgba;

/// The texture of a surface in the world; `None` of what has none: roads, water, closed ground.
pub fn area_texture(surface: RibbonSurface) -> Option<AreaTexture> {
    let (cover, fades) = match surface {
        RibbonSurface::Cover(cover) => (cover, 0.0),
        RibbonSurface::CoverEdge(cover) => (cover, 1.0),
        _ => return None,
    };
    Some(AreaTexture { fades, ..whole(cover)? })
}

/// The texture of a cover within its outline: the same for every picture, and made for the first that shows it.
fn whole(cover: Cover) -> Option<AreaTexture> {
    static WHOLE: [OnceLock<Option<AreaTexture>>; Cover::CHOICES.len()] =
        [const { OnceLock::new() }; Cover::CHOICES.len()];
    let made = || Some(with_mean(drawn(cover)?.measured(), tile_mean(cover)));
    *WHOLE[cover as usize].get_or_init(made)
}

/// The texture with the colors scaled so that its mean is this.
fn with_mean(area: AreaTexture, mean: Vec4) -> AreaTexture {
    let factor = mean / area.mean().max(Vec4::splat(1e-3));
    let scaled = |color: Vec4| (color * factor).min(Vec4::ONE);
    AreaTexture {
        ground: scaled(area.ground),
        figure: scaled(area.figure),
        border: scaled(area.border),
        ..area
    }
}

/// The mean of a cover's tile in linear light, weighted by alpha, and its mean alpha.
fn tile_mean(cover: Cover) -> Vec4 {
    let pixels = texture(RibbonSurface::Cover(cover));
    let sum: Vec4 =
        pixels.data().iter().map(|texel| (texel.linear() * texel.alpha()).extend(texel.alpha())).sum();
    (sum.truncate() / sum.w.max(1e-3)).extend(sum.w / pixels.data().len().max(1) as f32)
}

/// A color of sRGB with an alpha.
fn color(rgb: [u8; 3], alpha: f32) -> Vec4 {
    Srgba::opaque(rgb[0], rgb[1], rgb[2]).linear().extend(alpha)
}

/// What is drawn of a cover.
fn drawn(cover: Cover) -> Option<AreaTexture> {
    let none = AreaTexture::default();
    Some(match cover {
        Cover::Forest => AreaTexture {
            ground: color([54, 88, 54], 0.82),
            figure: color([90, 130, 74], 0.82),
            tone: Vec3::new(0.016, 0.012, -0.006),
            uneven: 0.22,
            noise_m: 160.0,
            light: 0.24,
            figure_m: Vec2::splat(7.0),
            jitter: 0.28,
            radius: [0.42, 0.64],
            ragged: 0.12,
            ..none
        },
        Cover::Scrub => AreaTexture {
            ground: color([186, 188, 132], 0.6),
            figure: color([118, 138, 82], 0.72),
            tone: Vec3::new(0.05, 0.025, 0.0),
            uneven: 0.13,
            noise_m: 120.0,
            light: 0.15,
            figure_m: Vec2::splat(8.0),
            jitter: 0.34,
            radius: [0.12, 0.42],
            ragged: 0.3,
            ..none
        },
        Cover::Heath => AreaTexture {
            ground: color([184, 170, 128], 0.7),
            figure: color([160, 132, 128], 0.74),
            tone: Vec3::new(0.03, -0.02, 0.03),
            uneven: 0.1,
            noise_m: 210.0,
            light: 0.1,
            figure_m: Vec2::splat(4.5),
            jitter: 0.34,
            radius: [0.2, 0.6],
            ragged: 0.5,
            ..none
        },
        Cover::Meadow => AreaTexture {
            ground: color([168, 196, 122], 0.6),
            tone: Vec3::new(0.05, 0.02, -0.02),
            uneven: 0.09,
            noise_m: 150.0,
            ..none
        },
        Cover::Field => AreaTexture {
            ground: color([214, 196, 132], 0.68),
            border: color([150, 156, 98], 0.74),
            tone: Vec3::new(-0.15, -0.035, -0.07),
            uneven: 0.04,
            noise_m: 200.0,
            parcel_m: 560.0,
            border_m: 5.0,
            strip_m: 62.0,
            rows_m: 5.0,
            rows: 0.05,
            warp_m: 20.0,
            ..none
        },
        Cover::Orchard => AreaTexture {
            ground: color([216, 204, 150], 0.64),
            figure: color([84, 126, 80], 0.78),
            border: color([150, 160, 104], 0.7),
            tone: Vec3::new(-0.06, 0.01, -0.05),
            uneven: 0.05,
            noise_m: 150.0,
            parcel_m: 170.0,
            border_m: 4.0,
            light: 0.25,
            figure_m: Vec2::new(6.0, 7.0),
            jitter: 0.05,
            radius: [0.27, 0.37],
            ..none
        },
        Cover::Vineyard => AreaTexture {
            ground: color([184, 180, 114], 0.74),
            border: color([198, 190, 138], 0.7),
            tone: Vec3::new(-0.06, 0.0, -0.03),
            uneven: 0.05,
            noise_m: 150.0,
            parcel_m: 190.0,
            border_m: 3.0,
            strip_m: 38.0,
            rows_m: 3.0,
            rows: 0.26,
            warp_m: 3.0,
            ..none
        },
        Cover::Wetland => AreaTexture {
            ground: color([168, 194, 146], 0.64),
            figure: color([124, 170, 168], 0.76),
            tone: Vec3::new(0.06, 0.03, 0.0),
            uneven: 0.08,
            noise_m: 110.0,
            figure_m: Vec2::new(58.0, 24.0),
            warp_m: 14.0,
            jitter: 0.42,
            radius: [0.1, 0.46],
            ragged: 0.8,
            ..none
        },
        Cover::Sand => AreaTexture {
            ground: color([230, 212, 162], 0.72),
            tone: Vec3::new(0.02, 0.0, -0.03),
            uneven: 0.05,
            noise_m: 160.0,
            rows_m: 9.0,
            rows: 0.05,
            warp_m: 26.0,
            ..none
        },
        Cover::Rock => AreaTexture {
            ground: color([176, 168, 160], 0.68),
            figure: color([152, 146, 140], 0.7),
            tone: Vec3::new(0.03, 0.015, 0.0),
            uneven: 0.16,
            noise_m: 90.0,
            rows_m: 21.0,
            rows: 0.09,
            warp_m: 46.0,
            light: 0.16,
            figure_m: Vec2::new(9.0, 6.0),
            jitter: 0.35,
            radius: [0.15, 0.5],
            ragged: 0.6,
            ..none
        },
        Cover::Scree => AreaTexture {
            ground: color([196, 188, 176], 0.7),
            figure: color([170, 164, 156], 0.74),
            tone: Vec3::new(0.03, 0.02, 0.01),
            uneven: 0.13,
            noise_m: 70.0,
            light: 0.24,
            figure_m: Vec2::splat(2.8),
            jitter: 0.36,
            radius: [0.14, 0.55],
            ragged: 0.2,
            ..none
        },
        Cover::Glacier => AreaTexture {
            ground: color([226, 238, 246], 0.88),
            tone: Vec3::new(-0.05, -0.015, 0.01),
            uneven: 0.03,
            noise_m: 320.0,
            rows_m: 24.0,
            rows: 0.045,
            warp_m: 90.0,
            ..none
        },
        Cover::Quarry => AreaTexture {
            ground: color([208, 194, 168], 0.8),
            tone: Vec3::new(0.04, 0.01, -0.02),
            uneven: 0.09,
            noise_m: 130.0,
            rows_m: 17.0,
            rows: 0.13,
            warp_m: 75.0,
            ..none
        },
        Cover::Paved => AreaTexture {
            ground: color([198, 194, 188], 0.8),
            tone: Vec3::new(0.012, 0.008, 0.0),
            uneven: 0.03,
            noise_m: 60.0,
            ..none
        },
        Cover::BuiltUp => AreaTexture {
            ground: color([224, 208, 186], 0.68),
            figure: color([210, 180, 160], 0.74),
            border: color([228, 216, 196], 0.69),
            tone: Vec3::new(-0.11, -0.01, -0.07),
            uneven: 0.03,
            noise_m: 300.0,
            parcel_m: 150.0,
            border_m: 3.5,
            strip_m: 24.0,
            warp_m: 3.0,
            light: 0.05,
            figure_m: Vec2::new(15.0, 24.0),
            jitter: 0.1,
            radius: [0.2, 0.36],
            square: 1.0,
            ..none
        },
        Cover::DenseBuiltUp => AreaTexture {
            ground: color([206, 188, 170], 0.7),
            figure: color([184, 142, 120], 0.8),
            border: color([226, 214, 196], 0.72),
            tone: Vec3::new(-0.08, -0.01, -0.05),
            uneven: 0.03,
            noise_m: 300.0,
            parcel_m: 90.0,
            border_m: 8.0,
            warp_m: 4.0,
            light: 0.05,
            figure_m: Vec2::new(20.0, 26.0),
            jitter: 0.06,
            radius: [0.36, 0.47],
            square: 1.0,
            ..none
        },
        Cover::Industry => AreaTexture {
            ground: color([214, 206, 212], 0.66),
            figure: color([176, 168, 182], 0.8),
            border: color([224, 217, 218], 0.67),
            tone: Vec3::new(-0.04, -0.02, -0.05),
            uneven: 0.03,
            noise_m: 300.0,
            parcel_m: 260.0,
            border_m: 10.0,
            light: 0.05,
            figure_m: Vec2::new(74.0, 52.0),
            jitter: 0.1,
            radius: [0.2, 0.4],
            square: 1.0,
            ..none
        },
        Cover::Restricted => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    use sandtable_draw::area_texture::AreaPixel;

    #[test]
    fn from_afar_a_cover_has_the_color_of_its_tile() {
        for cover in Cover::CHOICES.iter().map(|choice| choice.value) {
            let Some(area) = area_texture(RibbonSurface::Cover(cover)) else {
                assert_eq!(cover, Cover::Restricted);
                continue;
            };
            let pixel = AreaPixel { at: Vec2::new(17.0, 250.0), mean_m: 1e4, longest_m: 1e4, inward: 1.0 };
            let apart = (area.color(&pixel) - tile_mean(cover)).abs().max_element();
            assert!(apart < 0.01, "{cover:?}: {apart}");
        }
    }

    #[test]
    fn figures_stay_within_the_four_cells_that_are_searched() {
        for cover in Cover::CHOICES.iter().map(|choice| choice.value) {
            let Some(area) = drawn(cover) else { continue };
            assert!(area.jitter + area.radius[1] <= 1.0 && area.radius[0] <= area.radius[1], "{cover:?}");
            assert!(area.figure_m.y == 0.0 || area.radius[0] > 0.05, "{cover:?}");
        }
    }

    #[test]
    fn a_cover_is_seen_near_by_and_keeps_its_lightness() {
        let places =
            || (0..4096).map(|index| Vec2::new((index % 64) as f32 * 2.3, (index / 64) as f32 * 2.1));
        for cover in Cover::CHOICES.iter().map(|choice| choice.value) {
            let Some(area) = area_texture(RibbonSurface::Cover(cover)) else { continue };
            let colors =
                places().map(|at| area.color(&AreaPixel { at, mean_m: 0.5, longest_m: 0.5, inward: 1.0 }));
            let light: Vec<f32> = colors.map(|color| color.y).collect();
            let mean = light.iter().sum::<f32>() / light.len() as f32;
            let spread =
                (light.iter().map(|own| (own - mean).powi(2)).sum::<f32>() / light.len() as f32).sqrt();
            assert!(spread > 0.008 * mean && spread < 0.4 * mean, "{cover:?}: {spread} of {mean}");
        }
    }
}
