//! Pictures on a device that stays open: what one picture needs and the next does too is made once.
//!
//! A picture that is larger than a texture may be is drawn in tiles (`tiles`): while the adapter draws one, the processor reads the
//! one before.
//!
//! The device, the shaders and their pipelines stay, the textures that are drawn to, and the ground map as long as its scene
//! has it. Materials, items and shadow maps are those of each picture, and are sent anew.

use std::sync::{Arc, Weak};

use glam::Vec3;

use crate::adapter::Gpu;
use crate::buffer_writes::BufferWrites;
use crate::culling::seen_items;
use crate::error::{DriverError, GpuError};
use crate::formats::{COLOR, FEATURE};
use crate::frame::{FrameGroup, FrameTextures};
use crate::geometry::GpuGeometry;
use crate::ground::row_bits;
use crate::layouts::Layouts;
use crate::materials::{GpuMaterials, TexturePlaces, TextureScope};
use crate::memory::{Loader, view};
use crate::parts::ShaderParts;
use crate::passes::{PassStage, PassViews, ScenePass};
use crate::pipeline_key::PipelineKey;
use crate::pipelines::{GpuPass, PassTarget, Pipelines, shader};
use crate::plan::Plan;
use crate::readback::{DrawnTile, Targets};
use crate::shadow::ShadowView;
use crate::shadow_maps::ShadowMaker;
use crate::shadow_maps::drawer::ShadowDrawer;
use crate::shadow_maps::maker::{CastShadows, LoadedList, draw_planned};
use crate::tiled_picture::TiledPicture;
use crate::tiles::{PictureTile, PictureTiles};
use crate::uniforms::{FrameScene, FrameUniforms};
use sandtable_draw::ground::GroundMap;
use sandtable_draw::list::DrawList;
use sandtable_draw::water_relief::STEEP;
use sandtable_render::picture::Rendering;
use sandtable_view::camera::{Camera, ViewProjection};

/// Draws pictures on one device.
#[derive(Debug)]
pub struct PictureRenderer {
    gpu: Gpu,
    layouts: Layouts,
    colors: Pipelines,
    features: Pipelines,
    targets: Option<KeptTargets>,
    ground: Option<KeptGround>,
    shadow_maker: ShadowMaker,
    shadow_drawer: Option<ShadowDrawer>,
    grounds_sent: usize,
    /// The longest side of a tile in pixels.
    longest_tile: u32,
}

/// The textures that the picture before was drawn to.
#[derive(Debug)]
struct KeptTargets {
    textures: Targets,
    bytes: u64,
}

/// The textures of the ground map of the picture before.
#[derive(Debug)]
struct KeptGround {
    /// `None` where that had no ground.
    map: Option<Weak<GroundMap>>,
    textures: FrameTextures,
    /// What they took with the shadows of their first picture.
    bytes: u64,
}

impl PictureRenderer {
    /// A renderer on an open device.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Self::with_shadow_maker(gpu, ShadowMaker::of(gpu))
    }

    /// A renderer on an open device whose shadow maps `shadow_maker` draws.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn with_shadow_maker(gpu: &Gpu, shadow_maker: ShadowMaker) -> Result<Self, GpuError> {
        gpu.guarded("building its shaders", || {
            let layouts = Layouts::new(gpu);
            let shader = shader(gpu);
            let pipelines = |pass, format, samples| {
                Pipelines::new(gpu, &layouts, &shader, PassTarget { pass, format, samples })
            };
            let colors = pipelines(GpuPass::Color, COLOR, gpu.samples);
            let features = pipelines(GpuPass::Feature, FEATURE, 1);
            let (gpu, longest_tile) = (gpu.clone(), gpu.longest_side());
            Ok(Self {
                gpu,
                layouts,
                colors,
                features,
                targets: None,
                ground: None,
                shadow_maker,
                shadow_drawer: None,
                grounds_sent: 0,
                longest_tile,
            })
        })
    }

    /// Lets tiles of pictures be no larger than `longest_px` pixels a side, where the adapter allows for more.
    pub fn limit_tiles(&mut self, longest_px: u32) {
        self.longest_tile = longest_px.clamp(1, self.gpu.longest_side());
    }

    /// The number of pipelines that are made.
    pub fn pipelines(&self) -> usize {
        self.colors.count() + self.features.count()
    }

    /// How often a ground map was sent, one of no ground among them.
    pub fn grounds_sent(&self) -> usize {
        self.grounds_sent
    }

    /// The picture of `list` as `camera` sees it. `progress` is called with the name of each step as it begins.
    ///
    /// # Errors
    /// See [`GpuError`]; after one of a driver the device is to be opened anew.
    pub fn render(
        &mut self,
        list: &DrawList,
        camera: &Camera,
        progress: &dyn Fn(&'static str),
    ) -> Result<Rendering, GpuError> {
        list.check()?;
        let gpu = self.gpu.clone();
        let places = TexturePlaces::new(list, TextureScope::Items, &gpu.limits);
        let is_seen = seen_items(list, camera);
        let plan = Plan::new(list, &places, |item| is_seen[item]);
        progress("casting shadows");
        let shadows = CastShadows::new(&gpu, self.shadow_maker, list, camera)?;
        let has_shadows = shadows.maps().map(|map| map.is_some());
        let parts = ShaderParts::of_picture(list.ground.as_deref(), &list.lighting, has_shadows);
        let parts = if is_from_above(camera) { parts.without(ShaderParts::WATER_RELIEF) } else { parts };
        progress("making pipelines");
        gpu.guarded("building its shaders", || {
            let [colors, features] = plan.keys(parts);
            self.colors.make(&gpu, colors.into_iter().chain([PipelineKey::SKY]));
            self.features.make(&gpu, features);
            Ok(())
        })?;
        progress("sending the scene");
        let ground = self.ground.take().filter(|ground| ground.is_of(list.ground.as_ref()));
        let tiles = PictureTiles::new(camera.size(), self.longest_tile);
        let targets = self.targets.take().filter(|targets| targets.textures.size() == tiles.tile_size());
        let loaded = gpu.guarded("loading the scene", || {
            let loader = Loader::new(&gpu);
            let targets = match targets {
                Some(targets) => {
                    loader.keep("the pixels of the picture", targets.bytes)?;
                    targets
                }
                None => {
                    let textures = Targets::new(&loader, tiles.tile_size())?;
                    KeptTargets { textures, bytes: loader.taken() }
                }
            };
            let sent = usize::from(ground.is_none());
            let ground = match ground {
                Some(mut ground) => {
                    loader.keep("the ground map", ground.bytes)?;
                    ground.textures.replace_shadows(shadows.textures(&loader)?);
                    ground
                }
                None => {
                    let before = loader.taken();
                    let shadow_textures = shadows.textures(&loader)?;
                    let textures = FrameTextures::upload(&loader, list.ground.as_deref(), shadow_textures)?;
                    let map = list.ground.as_ref().map(Arc::downgrade);
                    KeptGround { map, textures, bytes: loader.taken() - before }
                }
            };
            let frame = FrameGroup::new(&loader, &self.layouts, &ground.textures)?;
            let views = ShadowView::both(shadows.maps());
            let row_bits = row_bits(gpu.limits.max_texture_dimension_2d);
            let map = list.ground.as_deref();
            let scene =
                FrameScene { ground: map, windows: &[], lighting: &list.lighting, shadows: views, row_bits };
            let constants = FrameUniforms::new(scene, camera);
            let materials = GpuMaterials::upload(&loader, &self.layouts, list, &places)?;
            let geometry = GpuGeometry::upload(&loader, list, &plan, Some(camera))?;
            if let CastShadows::Planned(planned) = &shadows {
                gpu.finish_sending()?;
                progress("casting shadows");
                let loaded = LoadedList {
                    list,
                    places: &places,
                    plan: &plan,
                    geometry: &geometry,
                    materials: &materials,
                };
                let (drawer, to) = (&mut self.shadow_drawer, ground.textures.shadows());
                draw_planned(&loader, &self.layouts, drawer, loaded, (planned, to))?;
            }
            Ok((targets, ground, frame, constants, materials, geometry, sent))
        });
        let (targets, ground, frame, constants, materials, geometry, sent) = loaded?;
        self.grounds_sent += sent;
        progress("drawing on the adapter");
        let scene = PictureScene { frame, constants, materials, geometry, plan, parts };
        let picture = gpu.guarded("drawing the picture", || {
            let mut picture = TiledPicture::new(camera.size());
            let mut before: Option<(PictureTile, DrawnTile)> = None;
            for tile in tiles.tiles() {
                let drawn = self.draw_tile(&scene, &targets.textures, camera, tile)?;
                if let Some((tile, drawn)) = before.replace((tile, drawn)) {
                    picture.add(tile, drawn.read(&gpu, progress)?);
                }
            }
            if let Some((tile, drawn)) = before {
                picture.add(tile, drawn.read(&gpu, progress)?);
            }
            picture
                .whole()
                .ok_or_else(|| gpu.driver_error("reading the picture back", DriverError::TooFewPixels))
        })?;
        (self.targets, self.ground) = (Some(targets), Some(ground));
        Ok(picture)
    }

    /// Submits the drawing of a tile to textures of its size.
    fn draw_tile(
        &self,
        scene: &PictureScene,
        targets: &Targets,
        camera: &Camera,
        tile: PictureTile,
    ) -> Result<DrawnTile, GpuError> {
        let (gpu, PictureScene { frame, materials, geometry, plan, parts, .. }) = (&self.gpu, scene);
        let constants = scene.constants.in_tile(tile.projection(camera.size()));
        frame.write(&mut BufferWrites::by_queue(gpu), &constants);
        let mut encoder = gpu.encoder("picture");
        let is_multisampled = gpu.samples > 1;
        let [samples, resolved, sample_depth, seen, depth] = targets.all().map(view);
        let colors = PassViews {
            stage: PassStage::Whole,
            label: "colors",
            color: if is_multisampled { &samples } else { &resolved },
            resolved: is_multisampled.then_some(&resolved),
            depth: &sample_depth,
            timer: None,
        };
        let mut pass = ScenePass::new(colors.begin(&mut encoder, &frame.group), &self.colors, materials);
        pass.sky();
        pass.draw(geometry, plan.color.iter().chain(plan.transparent(camera)), *parts);
        drop(pass);
        let features = PassViews { label: "features", color: &seen, resolved: None, depth: &depth, ..colors };
        let mut pass = ScenePass::new(features.begin(&mut encoder, &frame.group), &self.features, materials);
        pass.draw(geometry, &plan.features, *parts);
        drop(pass);
        targets.submit(gpu, encoder)
    }
}

/// A scene on the device, for one picture.
struct PictureScene {
    frame: FrameGroup,
    constants: FrameUniforms,
    materials: GpuMaterials,
    geometry: GpuGeometry,
    plan: Plan,
    parts: ShaderParts,
}

impl KeptGround {
    /// Whether these are the textures of a map.
    fn is_of(&self, map: Option<&Arc<GroundMap>>) -> bool {
        match (&self.map, map) {
            (Some(kept), Some(map)) => std::ptr::eq(kept.as_ptr(), Arc::as_ptr(map)),
            (None, None) => true,
            _ => false,
        }
    }
}

/// Whether a picture's rays all fall so steeply that water shows no relief in it.
fn is_from_above(camera: &Camera) -> bool {
    let falls = |ray: Vec3| -ray.normalize_or_zero().z > STEEP;
    match camera.projection() {
        ViewProjection::Parallel(_) => falls(camera.forward()),
        ViewProjection::Perspective { .. } => {
            let half = camera.tan_half_fov();
            let (right, up) = (camera.right() * half.x, camera.up() * half.y);
            [-1.0, 1.0]
                .iter()
                .all(|x| [-1.0, 1.0].iter().all(|y| falls(camera.forward() + right * *x + up * *y)))
        }
    }
}
