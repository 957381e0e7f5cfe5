//! The look of a finished picture for print in black and for red light.
//!
//! *Print*: the relief as light gray with black contours, classes as black patterns, roads white between black edges, water
//! and buildings with black outlines: a photocopier keeps black and white and loses what lies between.
//!
//! *Night*: light of one color, by luminance, as the eye adapted to the dark keeps its sight in red light.

use rayon::prelude::*;

use crate::legend::feature_inks;
use crate::print_ink::PrintInk;
use sandtable_description::words::StylePreset;
use sandtable_draw::color::{Srgba, luminance, srgb_from_linear};
use sandtable_draw::list::{DrawList, FeatureId};
use sandtable_draw::pixels::Pixels;
use sandtable_draw::print_pattern::PrintPattern;
use sandtable_render::cpu::contour_cover::contour_cover;
use sandtable_render::picture::Rendering;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_model::SceneModel;
use sandtable_view::camera::Camera;

/// The darkest gray of the relief, 0..=1: lighter than what a copier turns black.
const DARKEST: f32 = 0.66;
/// The luminance below which what an analysis shows is one of its lines, which are black, and not its tint.
const MARK: f32 = 0.12;
/// Gray of the walls of the block.
const WALL: u8 = 225;
/// The brightest red of the scene in the night look, and of letters and lines on it, of full red: the scene must not
/// outshine what is written on it.
const BRIGHTEST: f32 = 0.3;
const BRIGHTEST_INK: f32 = 0.9;

/// Gives a picture the look of the scene's preset; most have none of their own. `seen` is what it shows and through which camera;
/// without it a printed picture has no contours.
pub fn apply_look(scene: &SceneModel, seen: Option<(&DrawList, &Camera)>, picture: &mut Rendering) {
    match scene.preset {
        Some(StylePreset::Print) => {
            let seen = seen.filter(|_| scene.contours.is_some());
            let contours =
                seen.map(|(list, camera)| contour_cover(list, camera, picture)).unwrap_or_default();
            print(scene, &contours, picture);
        }
        Some(StylePreset::Night) => {
            let pixels = picture.pixels.data_mut().par_iter_mut().zip(&picture.features);
            pixels.for_each(|(pixel, feature)| {
                *pixel = if *feature == FeatureId::NONE { BLACK } else { red_light(*pixel) };
            });
        }
        _ => {}
    }
}

/// A color of the annotations in the night look: dark letters are bright, and their paper is dark.
pub fn night_ink(color: Srgba) -> Srgba {
    let dark = 1.0 - luminance(color.linear());
    Srgba([srgb_from_linear(dark * dark * BRIGHTEST_INK), 0, 0, color.0[3]])
}

/// A color in red light.
fn red_light(color: Srgba) -> Srgba {
    let light = luminance(color.linear());
    Srgba([srgb_from_linear(light * BRIGHTEST), 0, 0, color.0[3]])
}

/// `contours` is how much of each pixel a contour line covers, or empty.
fn print(scene: &SceneModel, contours: &[f32], picture: &mut Rendering) {
    let inks = feature_inks(scene);
    let (width, height) = (picture.pixels.width(), picture.pixels.height());
    let unit = PrintPattern::unit_px(height);
    let features = &picture.features;
    let ink_at = |column: u32, row: u32| {
        let index = features[row as usize * width as usize + column as usize].index()?;
        inks.get(index).copied().flatten()
    };
    let is_analysis = |feature: FeatureId| {
        let feature = feature.index().and_then(|index| scene.features.get(index));
        feature.is_some_and(|feature| feature.kind == FeatureKind::Analysis)
    };
    let is_mark = |feature: FeatureId, pixel: Srgba| luminance(pixel.linear()) < MARK && is_analysis(feature);
    let before = &picture.pixels;
    let data: Vec<Srgba> = (0..height)
        .into_par_iter()
        .flat_map_iter(|row| {
            (0..width).map(move |column| {
                let gray = lifted(before.at(column, row));
                let Some(ink) = ink_at(column, row) else {
                    let index = row as usize * width as usize + column as usize;
                    return match features[index] {
                        FeatureId::NONE => Srgba::WHITE,
                        FeatureId::PLINTH => Srgba::opaque(WALL, WALL, WALL),
                        feature if is_mark(feature, before.at(column, row)) => BLACK,
                        _ => inked(gray, contours.get(index).copied().unwrap_or_default()),
                    };
                };
                let beside = [
                    (column.saturating_sub(unit), row),
                    ((column + unit).min(width - 1), row),
                    (column, row.saturating_sub(unit)),
                    (column, (row + unit).min(height - 1)),
                ];
                let is_edge = || beside.iter().any(|&(column, row)| ink_at(column, row) != Some(ink));
                printed(ink, gray, is_edge, |pattern| pattern.is_black(column, row, unit))
            })
        })
        .collect();
    if let Some(pixels) = Pixels::from_data(width, height, data) {
        picture.pixels = pixels;
    }
}

/// A gray with so much of it covered with black.
fn inked(gray: Srgba, share: f32) -> Srgba {
    let channel = |channel: u8| (f32::from(channel) * (1.0 - share) + 0.5) as u8;
    Srgba::opaque(channel(gray.0[0]), channel(gray.0[1]), channel(gray.0[2]))
}

const BLACK: Srgba = Srgba::opaque(0, 0, 0);

fn printed(
    ink: PrintInk,
    gray: Srgba,
    is_edge: impl Fn() -> bool,
    is_marked: impl Fn(PrintPattern) -> bool,
) -> Srgba {
    match ink {
        PrintInk::Pattern(pattern) if is_marked(pattern) => BLACK,
        PrintInk::Pattern(_) => gray,
        PrintInk::Black => BLACK,
        _ if is_edge() => BLACK,
        PrintInk::Outlined(pattern) if is_marked(pattern) => BLACK,
        PrintInk::Outlined(_) | PrintInk::Cased => Srgba::WHITE,
        PrintInk::Solid => Srgba::opaque(120, 120, 120),
    }
}

/// A color as a light gray.
fn lifted(color: Srgba) -> Srgba {
    let gray = f32::from(srgb_from_linear(luminance(color.linear()))) / 255.0;
    let gray = ((DARKEST + (1.0 - DARKEST) * gray) * 255.0 + 0.5) as u8;
    Srgba::opaque(gray, gray, gray)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_relief_is_lighter_than_what_a_copier_makes_black() {
        for channel in [0, 128, 255] {
            assert!(lifted(Srgba::opaque(channel, channel, channel)).0[0] >= 168);
        }
        assert_eq!(lifted(Srgba::WHITE), Srgba::WHITE);
    }

    #[test]
    fn red_light_has_no_green_and_no_blue_and_keeps_the_order_of_lightness() {
        let reds = [Srgba::opaque(10, 60, 10), Srgba::opaque(90, 140, 200), Srgba::WHITE].map(red_light);
        assert!(reds.windows(2).all(|pair| pair[0].0[0] < pair[1].0[0]));
        assert!(reds.iter().all(|red| red.0[1] == 0 && red.0[2] == 0 && red.0[3] == 255));
    }

    #[test]
    fn at_night_letters_are_brighter_than_paper_and_paper_than_nothing() {
        let [ink, halo, paper] =
            [Srgba::opaque(30, 35, 39), Srgba::opaque(180, 180, 170), Srgba::WHITE].map(night_ink);
        assert!(
            ink.0[0] > 230 && ink.0[0] - 80 > halo.0[0] && halo.0[0] > paper.0[0],
            "{ink:?} {halo:?} {paper:?}"
        );
        assert_eq!((paper, ink.0[1]), (BLACK, 0));
    }

    #[test]
    fn a_road_is_white_between_black_edges_and_water_lined() {
        let at = |ink, edge: bool, mark: bool| printed(ink, Srgba::opaque(200, 200, 200), || edge, |_| mark);
        assert_eq!(
            [at(PrintInk::Cased, true, false), at(PrintInk::Cased, false, true)],
            [BLACK, Srgba::WHITE]
        );
        let water = PrintInk::Outlined(PrintPattern::Lines);
        assert_eq!([at(water, false, true), at(water, false, false)], [BLACK, Srgba::WHITE]);
    }
}
