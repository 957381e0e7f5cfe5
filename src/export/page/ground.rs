//! The ground of a page: the posts that answer heights, the map that colors it, and its triangles.

use glam::Vec3;
use serde_json::{Value, json};

use crate::page::container::PageSections;
use sandtable_draw::color::srgb_from_linear;
use sandtable_draw::ground::{ColorRamp, Contours, GroundMap, GroundPost};
use sandtable_draw::ground_cover::CoverColor;
use sandtable_draw::ground_levels::{GroundLevel, PostCount, level};
use sandtable_terrain::lattice::{Lattice, Post};

/// The most posts whose heights a page holds: 32 MB before packing. Of larger ground it holds every second post, or
/// fourth, and says so.
const MOST_POSTS: u64 = 8_000_000;

/// The most posts of the map that colors the ground; they take 16 bytes each of the graphics memory.
const MOST_MAP_POSTS: u64 = 4_000_000;

/// The longest side of that map: what every WebGL 2 browser on a desk can take as a texture.
const LONGEST_MAP: u32 = 4096;

/// Steps of a slope in a page, per meter per meter: finer ones are not seen, and 8 m/m, which is the most they hold, is
/// steeper than any shading tells apart.
const SLOPE_STEPS: f32 = 4096.0;

/// The heights of `lattice`, from which the page answers as [`sandtable_terrain::query`] does.
pub fn heights(sections: &mut PageSections, lattice: &Lattice) -> Value {
    let (columns, rows) = (lattice.columns(), lattice.rows());
    let mut step = 1;
    while u64::from((columns - 1) / step + 1) * u64::from((rows - 1) / step + 1) > MOST_POSTS {
        step *= 2;
    }
    let kept = |last: u32| (0..=last / step).map(move |index| index * step);
    let posts = kept(rows - 1).flat_map(|row| kept(columns - 1).map(move |column| Post { column, row }));
    let heights: Vec<f32> = posts.map(|post| lattice.height(post)).collect();
    let (origin, cell) = (lattice.origin(), lattice.cell());
    json!({
        "columns": (columns - 1) / step + 1,
        "rows": (rows - 1) / step + 1,
        "step": step,
        "origin": [origin.x, origin.y],
        "cell": [cell.x * f64::from(step), cell.y * f64::from(step)],
        "heights": sections.add_floats(&heights, 1),
    })
}

/// The ground map, at the finest level that a page holds.
pub fn map(sections: &mut PageSections, map: &GroundMap) -> Value {
    let all = PostCount::from_map(map);
    let mut number = 0;
    let mut size = all;
    while u64::from(size.columns) * u64::from(size.rows) > MOST_MAP_POSTS
        || size.columns.max(size.rows) > LONGEST_MAP
    {
        let Some(next) = size.halved() else { break };
        (size, number) = (next, number + 1);
    }
    let columns = all.columns as usize;
    let GroundLevel { size, posts } =
        level(all, number, |row| map.posts[row * columns..][..columns].to_vec());
    let scale = (1u32 << number) as f32;
    let slope = |of: fn(&GroundPost) -> f32| -> Vec<u32> {
        let steps = |post: &GroundPost| (of(post) * SLOPE_STEPS).clamp(-32_767.0, 32_767.0).round() as i32;
        posts.iter().map(|post| (steps(post) + 32_768) as u32).collect()
    };
    let share = |of: fn(&GroundPost) -> f32| -> Vec<u8> {
        posts.iter().map(|post| (of(post).clamp(0.0, 1.0) * 255.0).round() as u8).collect()
    };
    // Half as many steps where crests are lighter than level ground.
    let is_textured = posts.iter().any(|post| post.sky_visibility > 1.0);
    let sky_most = if is_textured { GroundPost::MOST_SKY } else { 1.0 };
    let sky: Vec<u8> = posts
        .iter()
        .map(|post| (post.sky_visibility.clamp(0.0, sky_most) * (255.0 / sky_most)).round() as u8)
        .collect();
    // 0 is all woods, 127 dry and open, 254 open water.
    let water: Vec<u8> =
        posts.iter().map(|post| (post.water.clamp(-1.0, 1.0) * 127.0 + 127.0).round() as u8).collect();
    let heights: Vec<f32> = posts.iter().map(|post| post.height_m).collect();
    json!({
        "columns": size.columns,
        "rows": size.rows,
        "origin": map.origin.to_array(),
        "cell": (map.cell * scale).to_array(),
        "slopeSteps": SLOPE_STEPS,
        "heights": sections.add_floats(&heights, 1),
        "slopeEast": sections.add_words(&slope(|post| post.slope_east), 1),
        "slopeNorth": sections.add_words(&slope(|post| post.slope_north), 1),
        "sun": sections.add_bytes(&share(|post| post.sun_visibility), 1),
        "sky": sections.add_bytes(&sky, 1),
        "water": sections.add_bytes(&water, 1),
        "ramp": ramp(&map.ramp),
        "contours": map.contours.map(|contours| json!({
            "interval": contours.interval_m,
            "every": contours.major_every,
            "width": contours.width_px,
            "color": contours.color.0,
            "lit": contours.lit.map(|lit| lit.0),
            "turn": [Contours::LIT_WIDTH[0], Contours::LIT_WIDTH[1], Contours::LIT_TURN],
        })),
        "cover": map.cover.map(|cover| json!({
            "tree": cover.tree_m,
            "snow": cover.snow_m,
            "trueRise": cover.true_rise,
            "shadyNorth": cover.shady_north,
            "moisture": cover.moisture,
            "hasForms": cover.has_forms,
            "cell": map.model_cell_m(),
            "colors": cover.colors.map(|CoverColor { hue, light }| [hue.x, hue.y, hue.z, light]).concat(),
        })),
        "formLevel": map.form_level.saturating_sub(number),
        "zFactor": map.z_factor,
        "shadeGain": map.shade_gain,
        "detail": map.detail,
        "skyMost": sky_most,
        "hasGrain": map.has_grain,
        "curvedRise": if map.is_curved && number == 0 { map.z_per_m } else { 0.0 },
    })
}

/// Heights, and colors in linear light.
fn ramp(ramp: &ColorRamp) -> Value {
    ramp.stops().iter().map(|(height, color)| json!([height, color.x, color.y, color.z])).collect()
}

/// Linear light as sRGB bytes, for colors that a style sheet has too.
pub fn srgb(linear: Vec3) -> Value {
    json!(linear.to_array().map(srgb_from_linear))
}
