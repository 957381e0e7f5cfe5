//! The constants that shaders read, laid out as `shader.wgsl` declares them.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use crate::ground::{MOST_LEVELS, levels, top_levels};
use crate::merged_vertex::SurfaceOwner;
use crate::shadow::ShadowView;
use crate::tiles::TileProjection;
use crate::windows::{MOST_WINDOWS, WindowPlace};
use sandtable_draw::backdrop::Backdrop;
use sandtable_draw::bathymetry::{STOP_COUNT, bathymetry};
use sandtable_draw::ground::{Contours, GroundMap};
use sandtable_draw::ground_levels::PostCount;
use sandtable_draw::lighting::{Lighting, ReliefShading};
use sandtable_draw::list::DrawItem;
use sandtable_draw::material::{Albedo, AlphaMode, Material, NormalSource};
use sandtable_draw::undergrowth::Undergrowth;
use sandtable_draw::water::WaterColor;
use sandtable_render::picture::LEAST_VISIBLE_ALPHA;
use sandtable_view::camera::{Camera, ViewProjection};

/// Ramp stops in one row of their texture; any number below the smallest texture limit works.
pub const RAMP_COLUMNS: u32 = 1024;

const FROM_GROUND_NORMAL: u32 = 1;
const FROM_GROUND_ALBEDO: u32 = 2;
const MASK: u32 = 4;
const BLEND: u32 = 8;
const WATER: u32 = 16;
const IN_ALL_LIGHT: u32 = 32;
const HATCHING: u32 = 64;
const NATURAL: u32 = 128;
const TEXTURED: u32 = 256;
const EDGES: u32 = 512;
const AREA: u32 = 1024;
const TWO_SIDED: u32 = 2048;

/// The constants of a picture: `Frame` in the shader.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct FrameUniforms {
    eye: [f32; 4],
    right: [f32; 4],
    up: [f32; 4],
    forward: [f32; 4],
    depth: [f32; 4],
    tile: [f32; 4],
    tile_first: [f32; 4],
    to_sun: [f32; 4],
    sun: [f32; 4],
    sky: [f32; 4],
    bounce: [f32; 4],
    haze: [f32; 4],
    zenith: [f32; 4],
    studio_top: [f32; 4],
    studio_bottom: [f32; 4],
    sides: [[f32; 4]; 4],
    bathymetry: [[f32; 4]; STOP_COUNT],
    undergrowth: [f32; 4],
    shallow: [f32; 4],
    open: [f32; 4],
    ground: [f32; 4],
    ground_size: [u32; 4],
    imagery: [f32; 4],
    imagery_size: [f32; 4],
    cover: [f32; 4],
    cover_more: [f32; 4],
    cover_colors: [[f32; 4]; 7],
    contour: [f32; 4],
    contour_shape: [f32; 4],
    contour_lit: [f32; 4],
    contour_turn: [f32; 4],
    ground_levels: [[u32; 4]; MOST_LEVELS],
    ground_windows: [[u32; 4]; MOST_WINDOWS],
    window_size: [u32; 4],
    ground_tops: [[u32; 4]; MOST_LEVELS],
    relief: [f32; 4],
    shadows: [ShadowView; 2],
}

/// The constants of a material: `Surface` in the shader.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct SurfaceConstants {
    base_color: [f32; 4],
    flags: [u32; 4],
    cutoff: [f32; 4],
    /// Of an [`AreaTexture`](sandtable_draw::area_texture::AreaTexture), read one by one where a material has one.
    area: [[f32; 4]; 9],
}

/// The constants of an item: `Owner` and `Place` in the shader.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Instance {
    owner: SurfaceOwner,
    world_from_mesh: [[f32; 4]; 4],
}

/// The inputs for the constants of a picture, besides the camera.
#[derive(Clone, Copy, Debug)]
pub struct FrameScene<'a> {
    pub ground: Option<&'a GroundMap>,
    /// Where windows of finer posts lie.
    pub windows: &'a [WindowPlace],
    pub lighting: &'a Lighting,
    pub shadows: [ShadowView; 2],
    /// [`row_bits`](crate::ground::row_bits) of the adapter.
    pub row_bits: u32,
}

fn with(vector: Vec3, w: f32) -> [f32; 4] {
    vector.extend(w).to_array()
}

impl FrameUniforms {
    pub fn new(scene: FrameScene<'_>, camera: &Camera) -> Self {
        let (near, far) = camera.planes();
        let (half, is_parallel, depth) = match camera.projection() {
            // near · far may exceed f32; the ratio cannot.
            ViewProjection::Perspective { .. } => {
                (camera.tan_half_fov(), 0.0, [near / (1.0 - near / far), near / (far - near)])
            }
            ViewProjection::Parallel(frame) => {
                (frame.half_m, 1.0, [1.0 / (1.0 - near / far), 1.0 / (far - near)])
            }
        };
        let (width, height) = camera.size();
        let light = scene.lighting;
        let relief = ReliefShading::new(light.to_sun);
        Self {
            eye: with(camera.eye(), is_parallel),
            right: with(camera.right(), 1.0 / half.x),
            up: with(camera.up(), 1.0 / half.y),
            forward: with(camera.forward(), 0.0),
            depth: [depth[0], depth[1], width as f32, height as f32],
            tile: TileProjection::WHOLE.scale_and_offset,
            tile_first: [0.0; 4],
            to_sun: with(light.to_sun, scene.ground.map_or(1.0, |map| map.z_factor)),
            sun: with(light.sun, scene.ground.map_or(ReliefShading::GAIN, |map| map.shade_gain)),
            sky: with(light.sky, 0.0),
            bounce: with(light.bounce, 0.0),
            haze: with(light.haze.color, 1.0 / light.haze.distance_m),
            zenith: with(light.zenith, light.haze.near_m),
            studio_top: with(
                Backdrop::STUDIO_TOP.linear(),
                if light.backdrop == Backdrop::Studio { 1.0 } else { 0.0 },
            ),
            studio_bottom: with(Backdrop::STUDIO_BOTTOM.linear(), Backdrop::HORIZON),
            sides: std::array::from_fn(|side| with(relief.sides[side], ReliefShading::SIDE_SHARES[side])),
            bathymetry: std::array::from_fn(|stop| {
                let (height_m, color) = bathymetry().stops()[stop];
                with(color, height_m)
            }),
            undergrowth: with(Undergrowth::COLOR.linear(), Undergrowth::MOST),
            shallow: with(WaterColor::SHALLOW.linear(), WaterColor::OFF_SHORE),
            open: with(WaterColor::OPEN.linear(), 1.0),
            ground_windows: std::array::from_fn(|window| {
                scene
                    .windows
                    .get(window)
                    .map_or([0; 4], |WindowPlace { first, size, .. }| [first[0], first[1], size[0], size[1]])
            }),
            window_size: [
                scene.windows.len() as u32,
                scene.windows.first().map_or(0, |window| window.rows_apart),
                0,
                0,
            ],
            shadows: scene.shadows,
            ..Self::ground(scene.ground, scene.row_bits)
        }
    }

    /// These constants for a picture of another size.
    pub fn with_size(mut self, (width, height): (u32, u32)) -> Self {
        [self.depth[2], self.depth[3]] = [width as f32, height as f32];
        self
    }

    /// These constants for a tile of the picture.
    pub fn in_tile(self, TileProjection { scale_and_offset, first: [x, y] }: TileProjection) -> Self {
        Self { tile: scale_and_offset, tile_first: [x, y, 0.0, 0.0], ..self }
    }

    /// The constants of the ground map; all others are zero.
    fn ground(map: Option<&GroundMap>, row_bits: u32) -> Self {
        let mut frame = Self::zeroed();
        let Some(map) = map else { return frame };
        let levels = levels(PostCount::from_map(map));
        for (slot, level) in frame.ground_levels.iter_mut().zip(&levels) {
            *slot = [level.size.columns, level.size.rows, level.first, row_bits];
        }
        let tops = top_levels(PostCount::from_map(map));
        for (slot, level) in frame.ground_tops.iter_mut().zip(&tops) {
            *slot = [level.size.columns, level.size.rows, level.first, tops.len() as u32];
        }
        frame.relief = [map.z_per_m, map.detail, 0.0, 0.0];
        frame.ground = [map.origin.x, map.origin.y, map.cell.x, map.cell.y];
        let coarsest = levels.len() as u32 - 1;
        frame.ground_size =
            [map.ramp.stops().len() as u32, RAMP_COLUMNS, levels.len() as u32, map.form_level.min(coarsest)];
        frame.contour_shape[3] = f32::from(u8::from(map.has_grain));
        if let Some(cover) = map.cover {
            frame.cover = [cover.tree_m, cover.snow_m, cover.true_rise, cover.shady_north];
            let forms = f32::from(u8::from(cover.has_forms));
            frame.cover_more = [cover.moisture, map.model_cell_m(), forms, 1.0];
            frame.cover_colors = cover.colors.map(|color| with(color.hue, color.light));
        }
        if let Some(imagery) = &map.imagery {
            let (per_m, [width, height]) = (
                imagery.size.recip(),
                [imagery.pixels.width(), imagery.pixels.height()].map(|side| side as f32),
            );
            frame.imagery = [imagery.origin.x, imagery.origin.y, per_m.x, per_m.y];
            frame.imagery_size = [width, height, 1.0, f32::from(u8::from(imagery.is_shaded))];
        }
        if let Some(contours) = map.contours {
            let every = contours.major_every.max(1) as f32;
            frame.contour = with(contours.color.linear(), contours.color.alpha());
            frame.contour_shape[..3].copy_from_slice(&[contours.interval_m, contours.width_px, every]);
            if let Some(lit) = contours.lit {
                let [along, across] = Contours::LIT_WIDTH;
                frame.contour_lit = with(lit.linear(), 1.0);
                frame.contour_turn = [along, across, Contours::LIT_TURN, 0.0];
            }
        }
        frame
    }
}

impl Instance {
    pub fn new(item: &DrawItem) -> Self {
        let owner = SurfaceOwner { feature: item.feature, material: item.material.into() };
        Self { owner, world_from_mesh: item.world_from_mesh.to_cols_array_2d() }
    }
}

impl SurfaceConstants {
    /// The constants of a material whose texture, if it shows any, lies in `layer` of its array.
    pub fn new(material: &Material, layer: Option<u32>) -> Self {
        let normal = if material.normals == NormalSource::Ground { FROM_GROUND_NORMAL } else { 0 };
        let albedo = match material.albedo {
            Albedo::Surface => 0,
            Albedo::GroundMap => FROM_GROUND_ALBEDO,
            Albedo::Hatching => HATCHING,
        };
        let water = if material.is_water { WATER } else { 0 };
        let light = if material.receives_shadows { 0 } else { IN_ALL_LIGHT };
        let textured = if layer.is_some() { TEXTURED } else { 0 };
        let natural = if material.is_natural { NATURAL } else { 0 };
        let edges = if material.shows_edges { EDGES } else { 0 };
        let area = if material.area.is_some() { AREA } else { 0 };
        let sides = if material.two_sided { TWO_SIDED } else { 0 };
        let (alpha, cutoff) = match material.alpha {
            AlphaMode::Opaque => (0, 0.0),
            AlphaMode::Mask(cutoff) => (MASK, cutoff),
            AlphaMode::Blend => (BLEND, LEAST_VISIBLE_ALPHA),
        };
        Self {
            base_color: with(material.base_color.linear(), material.base_color.alpha()),
            flags: [
                normal | albedo | alpha | water | light | natural | textured | edges | area | sides,
                layer.unwrap_or(0),
                0,
                0,
            ],
            cutoff: [cutoff, 0.0, 0.0, 0.0],
            area: material.area.map_or([[0.0; 4]; 9], |area| area.uniform()),
        }
    }
}
