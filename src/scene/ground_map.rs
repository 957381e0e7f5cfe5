//! The ground map of a picture: heights, slopes and light at the level of the posts that the picture shows.

use std::ops::Range;
use std::sync::Arc;

use glam::Vec2;

use crate::ground_map_cache::GroundMapKey;
use crate::relief_strength::ReliefStrength;
use crate::scene_model::SceneModel;
use crate::texture_shading::TextureShading;
use crate::undergrowth::undergrowth;
use sandtable_draw::contour_ground::lift_level_ground;
use sandtable_draw::ground::{GroundMap, PostRow};
use sandtable_draw::ground_levels::{GroundLevel, PostCount, level_of_portions};
use sandtable_draw::lighting::ReliefShading;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::light::TerrainLight;
use sandtable_terrain::terraces::{rows_without_terraces, without_terraces};
use sandtable_terrain::water_shore::WaterShore;

impl SceneModel {
    /// The ground map, its light computed unless the last picture had the same; `making` is called before.
    pub fn map(&self, key: GroundMapKey, making: impl FnOnce()) -> Arc<GroundMap> {
        self.maps.get(key, || {
            making();
            ground_map(self, key)
        })
    }

    /// Whether [`SceneModel::map`] has the map of a key already.
    pub fn has_map(&self, key: GroundMapKey) -> bool {
        self.maps.has(key)
    }
}

/// The height, slope and light at a level of the posts; 0 is all of them, each further level every second post of the one
/// before, smoothed, and each level below 0 twice as many posts a side.
pub fn ground_map(scene: &SceneModel, GroundMapKey { level, to_sun }: GroundMapKey) -> GroundMap {
    let (number, halvings) = (level.max(0) as u32, level.min(0).unsigned_abs());
    let lattice = &scene.lattice;
    let beside_light =
        || (&scene.water().is_water, WaterShore::new(lattice, scene.water()), undergrowth(scene));
    let (light, (water, shore, woods)) =
        rayon::join(|| TerrainLight::new(scene.ground().lattice(), to_sun, number), beside_light);
    let columns = lattice.columns() as usize;
    let is_water = |index: usize| water.get(index).copied().unwrap_or_default();
    let is_rounded = scene.heights.snapshot().holds_whole_numbers();
    // Smooth ground is held whole where it must be, and portion by portion where a picture shows fewer posts.
    let is_held = number == 0 || lattice.doublings() > 0;
    let smooth = (is_rounded && is_held).then(|| without_terraces(lattice, 1.0, &is_water));
    let lowest_m = if is_rounded { lattice.height_range().0 } else { 0.0 };
    let posts_of = |shaded: &Lattice, first: usize, row: usize| {
        let row_in_part = (row - first) as u32;
        let posts = PostRow {
            heights_m: &shaded.filled_row(row_in_part, scene.height_range_m.0),
            slopes: &shaded.shaded_slopes_of_row(row_in_part),
            exaggeration: scene.scale.0,
            sun: &light.sun(row),
            sky: &light.sky(row),
            water: &shore.as_ref().map(|shore| shore.row(row)).unwrap_or_default(),
            woods: woods.get(row * columns..).unwrap_or_default(),
        };
        posts.posts()
    };
    let all = PostCount { columns: lattice.columns(), rows: lattice.rows() };
    let portion = |rows: Range<usize>| {
        // Slopes are those between the rows beside a row.
        let around = rows.start.saturating_sub(1)..(rows.end + 1).min(lattice.rows() as usize);
        let first = if is_rounded && !is_held { around.start } else { 0 };
        let part = (is_rounded && !is_held)
            .then(|| rows_without_terraces(lattice, lowest_m, around, 1.0, &is_water));
        let (smooth, posts_of) = (&smooth, &posts_of);
        move |row: usize| posts_of(part.as_ref().or(smooth.as_ref()).unwrap_or(lattice), first, row)
    };
    let GroundLevel { size, mut posts } = level_of_portions(all, number, portion);
    if let Some(contours) = &scene.contours {
        lift_level_ground(&mut posts, size, contours, if is_rounded { 1.0 } else { 0.0 });
    }
    let cell = lattice.cell().as_vec2() * (1u32 << number) as f32;
    let ramp = scene.ramp();
    let ReliefStrength { z_factor, shade_gain } =
        ReliefStrength::of(lattice, scene.scale, &ramp, to_sun, is_water);
    let shade_gain = if scene.is_lightly_shaded { ReliefShading::BASE_GAIN } else { shade_gain };
    if scene.texture > 0.0 {
        let texture = TextureShading {
            strength: scene.texture,
            steepness: scene.scale.world_z(z_factor),
            form_m: form_m(lattice) as f32,
        };
        texture.apply(&mut posts, size, cell);
    }
    let map = GroundMap {
        origin: Vec2::ZERO,
        cell,
        z_per_m: scene.scale.0,
        columns: size.columns,
        rows: size.rows,
        posts,
        ramp,
        contours: scene.contours,
        imagery: scene.imagery.clone(),
        cover: scene.cover(),
        form_level: form_level(lattice).saturating_sub(number),
        z_factor: TextureShading::eased(scene.texture, z_factor),
        shade_gain,
        detail: TextureShading::eased_detail(scene.texture),
        has_grain: true,
        halvings: 0,
        // Posts of a densified lattice lie on planes between those of the land.
        is_curved: lattice.doublings() == 0,
    };
    if halvings > 0 { map.with_halved_cells(halvings) } else { map }
}

/// The generalized ground keeps forms wider than this share of the extent: about as many as a map of the whole names.
const FORM_SHARE: f64 = 1.0 / 100.0;

/// The number of times that the cells of the lattice are doubled until they are as wide as the forms of the generalized
/// ground.
pub fn form_level(lattice: &Lattice) -> u32 {
    libm::log2((form_m(lattice) / lattice.cell().max_element()).max(1.0)).round() as u32
}

/// The width of the smallest forms of the generalized ground, meters.
fn form_m(lattice: &Lattice) -> f64 {
    lattice.extent().size().max_element() * FORM_SHARE
}
