//! What the ground of real places looks like in what `new` makes of them, measured on its colors.

use glam::{Vec2, Vec3, Vec3Swizzles};
use sandtable_draw::color::{Srgba, lightness};
use sandtable_draw::list::FeatureId;
use sandtable_new::{self as new_scene, NewSceneOptions};
use sandtable_render::RenderBackend;
use sandtable_render::picture::Rendering;
use sandtable_scene::scene_file::open_scene;
use sandtable_sheet::picture::{PictureSize, draw_view};

use crate::common::data::data;
use crate::common::scratch::Scratch;

const SIZE: PictureSize = PictureSize { width: 320, height: 200 };
/// Large enough that near views show texture.
const NEAR_SIZE: PictureSize = PictureSize { width: 1280, height: 800 };

/// A color as L*, a* and b* (CIE 1976, D65).
fn lab(color: Srgba) -> Vec3 {
    let linear = color.linear();
    let xyz = Vec3::new(
        linear.dot(Vec3::new(0.4124, 0.3576, 0.1805)) / 0.9505,
        linear.dot(Vec3::new(0.2126, 0.7152, 0.0722)),
        linear.dot(Vec3::new(0.0193, 0.1192, 0.9505)) / 1.089,
    );
    let [x, y, z] = xyz.to_array().map(|part| {
        if part > 216.0 / 24_389.0 { part.cbrt() } else { (part * 24_389.0 / 27.0 + 16.0) / 116.0 }
    });
    Vec3::new(lightness(linear), 500.0 * (x - y), 200.0 * (y - z))
}

/// The ground's pixels of a picture as L*, a* and b*; `None` where something else shows.
fn ground(picture: &Rendering, size: PictureSize) -> Vec<Option<Vec3>> {
    let features = picture.features.iter().enumerate();
    let color = |index: usize| {
        let (x, y) = (index as u32 % size.width, index as u32 / size.width);
        lab(picture.pixels.at(x, y))
    };
    features.map(|(index, feature)| (*feature == FeatureId::GROUND).then(|| color(index))).collect()
}

/// What `new` makes of an elevation file, through one of its cameras; `land_cover` is what the scene file is to say of it.
fn drawn(dem: &str, camera: &str, size: PictureSize, land_cover: &str) -> Option<Vec<Option<Vec3>>> {
    let dem = data(dem)?;
    let folder = Scratch::new();
    let allowed = vec![dem.parent().expect("in a folder").to_path_buf()];
    let options =
        NewSceneOptions { folder: folder.at("scene"), dem: vec![dem], ..NewSceneOptions::default() };
    let written = new_scene::write(&options, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let text = std::fs::read_to_string(&written.path).expect("it was written");
    assert!(text.contains("land_cover = true\n"), "{text}");
    let text = text.replace("land_cover = true\n", &format!("land_cover = {land_cover}\n"));
    std::fs::write(&written.path, text).expect("its folder is ours");
    let scene = open_scene(&written.path, &allowed, &|_| ()).unwrap_or_else(|error| panic!("{error}"));
    let view = scene.view(Some(camera)).expect("`new` writes it");
    let drawn = draw_view(&scene, view, size, RenderBackend::Cpu, &|_| ()).expect("sound");
    Some(ground(&drawn.picture, size))
}

fn mean(colors: impl Iterator<Item = Vec3>) -> Vec3 {
    let (count, sum) = colors.fold((0.0, Vec3::ZERO), |(count, sum), color| (count + 1.0, sum + color));
    sum / f32::max(count, 1.0)
}

const PLACES: [(&str, &str); 5] = [
    ("Utah", "dem/zion_srtm_u16_deflate.tif"),
    ("Cape", "scenes/swellendam_za/dem_srtm_utm33s_i16.tif"),
    ("Carolina", "scenes/wake_nc_us/elev_ned_30m.tif"),
    ("Oregon", "scenes/crater_lake_bt/crater.bt"),
    ("California", "dem/bigtujunga_utm11_i16_tiled.tif"),
];

#[test]
fn places_of_several_climates_have_ground_of_several_hues_lit_warm_and_shaded_cool() {
    let mut means: Vec<(&str, Vec2)> = Vec::new();
    for (place, dem) in PLACES {
        let Some(colors) = drawn(dem, "overview", SIZE, "true") else { return };
        let mut colors: Vec<Vec3> = colors.into_iter().flatten().collect();
        colors.sort_by(|a, b| a.x.total_cmp(&b.x));
        let fifth = colors.len() / 5;
        let [dark, light] =
            [&colors[..fifth], &colors[colors.len() - fifth..]].map(|part| mean(part.iter().copied()));
        let all = mean(colors.iter().copied());
        println!("{place}: {all:.1}, dark fifth {dark:.1}, light fifth {light:.1}");
        let warmer = light.z - dark.z;
        assert!(warmer > 9.0, "{place}: b* of the light fifth is {warmer:.1} above that of the dark fifth");
        let chroma = dark.yz().length();
        assert!(chroma > 8.0, "{place}: the dark fifth is gray, {chroma:.1} of a* b*");
        assert!(dark.x > 25.0, "{place}: the dark fifth has L* {:.1}", dark.x);
        means.push((place, Vec2::new(all.y, all.z)));
    }
    let apart = |one: Vec2, other: Vec2| one.distance(other);
    let farthest =
        means.iter().flat_map(|one| means.iter().map(move |other| apart(one.1, other.1))).fold(0.0, f32::max);
    assert!(farthest > 12.0, "hues spread over {farthest:.1} of a* b*: {means:?}");
}

/// How much the ground's texture tells: the entropy in bits of the lightness of pixels less the mean of the pixels around, in
/// steps of 1 of L*.
fn texture_bits(ground: &[Option<Vec3>]) -> f64 {
    /// How far pixels around reach: forms of the relief are wider.
    const NEAR: usize = 2;
    let (width, height) = (NEAR_SIZE.width as usize, NEAR_SIZE.height as usize);
    let mut counts = std::collections::BTreeMap::new();
    for y in NEAR..height - NEAR {
        for x in NEAR..width - NEAR {
            let around =
                (y - NEAR..=y + NEAR).flat_map(|y| (x - NEAR..=x + NEAR).map(move |x| ground[y * width + x]));
            let around: Option<Vec<f32>> = around.map(|color| color.map(|lab| lab.x)).collect();
            if let Some(around) = around {
                let rest = around[around.len() / 2] - around.iter().sum::<f32>() / around.len() as f32;
                *counts.entry(rest.round() as i32).or_insert(0u32) += 1;
            }
        }
    }
    let all: f64 = counts.values().copied().map(f64::from).sum();
    counts.values().map(|&count| f64::from(count) / all).map(|share| -share * share.log2()).sum()
}

#[test]
fn near_views_have_more_texture_with_land_cover_than_without() {
    for (place, dem) in PLACES {
        let bits = ["true", "false"]
            .map(|cover| drawn(dem, "relief", NEAR_SIZE, cover).map(|ground| texture_bits(&ground)));
        let [Some(with), Some(without)] = bits else { return };
        println!("{place}: {with:.2} bits of texture, {without:.2} without land cover");
        assert!(with > without, "{place}: {with:.2} bits, {without:.2} without land cover");
    }
}
