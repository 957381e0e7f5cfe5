//! How the ground looks: ramp, contours, light and haze.

use std::f32::consts::FRAC_PI_2;

use glam::{Vec2, Vec3};

use crate::description::color::{Color, RampChoice};
use crate::description::diagnostic::Diagnostic;
use crate::description::document::Document;
use crate::description::words::RampName;
use crate::draw::color::Srgba;
use crate::draw::ground::{ColorRamp, Contours, GroundMap, GroundPost};
use crate::draw::ground_levels::{GroundLevel, PostCount, level};
use crate::draw::lighting::Lighting;
use crate::scene::SceneModel;
use crate::terrain::lattice::Lattice;
use crate::terrain::light::TerrainLight;

/// The tints of an atlas, from the lowest ground to the highest. Their lightness rises steadily (L* 61 to 94), so that
/// tint never works against shade.
const ATLAS: [(f32, [u8; 3]); 7] = [
    (0.0, [122, 156, 116]),
    (0.18, [154, 180, 128]),
    (0.38, [192, 200, 146]),
    (0.56, [216, 208, 162]),
    (0.74, [226, 212, 180]),
    (0.90, [234, 225, 206]),
    (1.0, [243, 239, 231]),
];

/// The tints of a desert: sand, ochre, red rock, pale heights.
const DESERT: [(f32, [u8; 3]); 5] = [
    (0.0, [196, 178, 138]),
    (0.3, [222, 196, 146]),
    (0.6, [206, 150, 104]),
    (0.85, [170, 110, 84]),
    (1.0, [232, 214, 196]),
];

/// Neutral tints for overlays.
const GRAY: [(f32, [u8; 3]); 2] = [(0.0, [168, 168, 168]), (1.0, [236, 236, 236])];

/// The document's ramp over the ground's range of heights.
///
/// # Errors
/// Stops that do not rise.
pub fn ramp(document: &Document, range: (f32, f32)) -> Result<ColorRamp, Diagnostic> {
    let choice = &document.style.ramp;
    match &**choice {
        RampChoice::Named(RampName::Atlas) => Ok(stretched(&ATLAS, range)),
        RampChoice::Named(RampName::Desert) => Ok(stretched(&DESERT, range)),
        RampChoice::Named(RampName::Gray) => Ok(stretched(&GRAY, range)),
        RampChoice::Stops(stops) => {
            let stops =
                stops.iter().map(|&(height, Color(channels))| (height as f32, Srgba(channels))).collect();
            ColorRamp::new(stops).ok_or_else(|| document.error(choice, "the ramp's heights do not rise"))
        }
    }
}

/// The ramp of an atlas over a range of heights: the default.
pub fn atlas(range: (f32, f32)) -> ColorRamp {
    stretched(&ATLAS, range)
}

fn stretched(stops: &[(f32, [u8; 3])], (low, high): (f32, f32)) -> ColorRamp {
    // Level ground far from 0 still needs stops that an f32 can tell apart.
    let span = (high - low).max(1.0).max(low.abs() * 1e-4);
    let stops = stops.iter().map(|&(part, [r, g, b])| (low + span * part, Srgba::opaque(r, g, b))).collect();
    ColorRamp::new(stops).expect("the parts rise, and the span is wide enough for an f32 to tell them apart")
}

/// The document's contour lines.
pub fn contours(document: &Document) -> Option<Contours> {
    document.style.contours.as_ref().map(|contours| Contours {
        interval_m: contours.interval as f32,
        major_every: contours.major_every,
        color: contours.color.map_or(Srgba([112, 74, 40, 150]), |color| Srgba(color.0)),
        width_px: 1.0,
    })
}

/// The document's light.
pub fn lighting(document: &Document) -> Lighting {
    let light = &document.style.light;
    let (azimuth, altitude) = ((light.azimuth as f32).to_radians(), (light.altitude as f32).to_radians());
    let level = libm::sinf(FRAC_PI_2 - altitude);
    let to_sun = Vec3::new(libm::sinf(azimuth) * level, libm::cosf(azimuth) * level, libm::sinf(altitude));
    Lighting { to_sun: to_sun.normalize_or(Vec3::Z), ..Lighting::default() }
}

/// The height, slope and light at a level of the posts; 0 is all of them, each further level every second post of the one
/// before, smoothed.
pub fn ground_map(scene: &SceneModel, number: u32) -> GroundMap {
    let lattice = &scene.lattice;
    let (light, water) = rayon::join(
        || TerrainLight::new(scene.ground().lattice(), scene.lighting.to_sun),
        || &scene.water().is_water,
    );
    let columns = lattice.columns() as usize;
    let row = |row: usize| {
        let first = row * columns;
        let heights = filled_heights(&lattice.heights()[first..][..columns], scene.height_range_m.0);
        let slopes = lattice.slopes_of_row(row as u32);
        let light = light.sun(row).into_iter().zip(light.sky(row));
        let posts = heights.into_iter().zip(slopes).zip(light).map(
            |((height_m, slopes), (sun_visibility, sky_visibility))| GroundPost {
                height_m,
                slope_east: scene.scale.world_z(slopes.x),
                slope_north: scene.scale.world_z(slopes.y),
                sun_visibility,
                sky_visibility,
                water: 0.0,
            },
        );
        let mut posts: Vec<GroundPost> = posts.collect();
        for (post, &is_water) in posts.iter_mut().zip(water.get(first..).unwrap_or_default()) {
            post.water = if is_water { 1.0 } else { 0.0 };
        }
        posts
    };
    let all = PostCount { columns: lattice.columns(), rows: lattice.rows() };
    let GroundLevel { size, posts } = level(all, number, row);
    GroundMap {
        origin: Vec2::ZERO,
        cell: lattice.cell().as_vec2() * (1u32 << number) as f32,
        columns: size.columns,
        rows: size.rows,
        posts,
        ramp: scene.ramp.clone(),
        contours: scene.contours,
        form_level: form_level(lattice).saturating_sub(number),
    }
}

/// The generalized ground keeps forms wider than this share of the extent: about as many as a map of the whole names.
const FORM_SHARE: f64 = 1.0 / 100.0;

/// How often the cells of the lattice are doubled until they are as wide as the forms of the generalized ground.
fn form_level(lattice: &Lattice) -> u32 {
    let form_m = lattice.extent().size().max_element() * FORM_SHARE;
    libm::log2((form_m / lattice.cell().max_element()).max(1.0)).round() as u32
}

/// The heights of a row, where posts without data take the nearest height of the row, or the lowest: they only color
/// pixels within half a cell of the edge of data.
fn filled_heights(row: &[f32], lowest: f32) -> Vec<f32> {
    let mut heights = row.to_vec();
    if row.iter().any(|height| height.is_nan()) {
        spread(heights.iter_mut());
        spread(heights.iter_mut().rev());
        heights.iter_mut().filter(|height| height.is_nan()).for_each(|height| *height = lowest);
    }
    heights
}

/// Sets heights that are NaN to the one before.
fn spread<'a>(row: impl Iterator<Item = &'a mut f32>) {
    let mut last = f32::NAN;
    for height in row {
        if height.is_nan() {
            *height = last;
        } else {
            last = *height;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_named_ramp_fits_any_ground_that_a_lattice_takes() {
        for height in [0.0, -0.3, 8848.0, 9.99e6, -1e7] {
            for stops in [ATLAS.as_slice(), DESERT.as_slice(), GRAY.as_slice()] {
                stretched(stops, (height, height));
            }
        }
    }
}
