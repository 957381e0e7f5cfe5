//! The renderer of a window: a scene that stays on the device, of which a frame sends only what changed.
//!
//! ```text
//! load(DrawList) ─► materials, ground map, solids ┐
//! update(GroundChanges) ─► patches, drapes        ├─► draw: sky ─ ground ─ drapes ─ solids ─ transparent solids
//! set_shadows(LiveShadows) ─► shadow maps         ┘
//!
//! loader() ─► another thread: prepare ─► show, show_shadows      as load and set_shadows, without a late frame
//! ```
//!
//! The ground and what lies on it come by patches ([`sandtable_draw::patches`]); everything else is drawn as in a picture, by
//! the same shaders and the same rules of depth.
//!
//! # Ground
//! One call draws all patches (`patch_calls`). With several samples a pixel their triangles are shaded as they are drawn.
//! With one, as where the processor draws, only their depths are, and what each pixel then shows is shaded once
//! (`ground_pixels.wgsl`): a driver that shades blocks of pixels does most of its work for nothing where triangles are as small
//! as pixels.
//!
//! # What stands
//! Hardware leaves out instances of many by itself (`instance_culling`). Where the processor draws, it leaves out groups of
//! neighbors before it draws: it would test each instance twice as a device, which takes longer than what is saved.
//!
//! # Shadows
//! Shadow maps of solids are made for a camera, in some ten milliseconds: too long for every frame. A map is therefore kept
//! while the camera moves. It stays right wherever it reaches, because shadows do not depend on the eye; only how fine its
//! texels are does. Beyond it nothing is shaded. Whoever moves the camera makes a new map, on another thread, when the eye
//! has moved a good part of its distance to the ground.
//!
//! The maps of a scene that is loaded are the processor's. Later ones are drawn by the adapter, to which what a map needs of
//! the scene is sent for it, unless the adapter is the processor itself
//! ([`LiveLoader::cast_shadows`](prepared::LiveLoader::cast_shadows)).

mod arena;
mod drapes;
mod encode;
mod ground_map;
mod moving;
mod patch_calls;
mod patches;
pub mod prepared;
mod targets;

use std::sync::Arc;

use crate::adapter::Gpu;
use crate::buffer_writes::{BufferWrites, StagingRing};
use crate::culling::CullingView;
use crate::error::GpuError;
use crate::frame::{FrameGroup, FrameTextures};
use crate::geometry::GpuGeometry;
use crate::instance_culling::{CulledInstances, InstanceCuller};
use crate::layouts::Layouts;
use crate::live::drapes::DrapeView;
use crate::live::encode::Encoder;
use crate::live::ground_map::EditedMap;
use crate::live::moving::MovingPipelines;
use crate::live::patches::{PatchStore, ShownCalls};
use crate::live::prepared::{
    LiveLoader, PreparedScene, PreparedShadows, PreparedWindows, SharedShadowDrawer,
};
use crate::live::targets::{LiveFormat, LiveTargets};
use crate::materials::GpuMaterials;
use crate::memory::Loader;
use crate::parts::ShaderParts;
use crate::pass_timer::PassTimer;
use crate::passes::{PassStage, PassViews, ScenePass};
use crate::pipeline_key::PipelineKey;
use crate::pipelines::{GpuPass, PassTarget, Pipelines, shader};
use crate::plan::Plan;
use crate::shadow::ShadowView;
use crate::uniforms::{FrameScene, FrameUniforms};
use crate::windows::WindowTexture;
use sandtable_draw::lighting::Lighting;
use sandtable_draw::list::DrawList;
use sandtable_draw::patches::{GroundChanges, PatchId};
use sandtable_render::shadow::Shadows;
use sandtable_view::camera::Camera;

/// The quality at which frames are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LiveQuality {
    /// Samples per pixel: 1, or 4 where the adapter can.
    pub samples: u32,
    /// The most readings of a texture along a pixel seen at a grazing angle, 1..=16.
    pub anisotropy: u16,
}

/// The options of a frame that its viewer chooses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LiveOptions {
    /// Whether the ground's triangles are outlined.
    pub wireframe: bool,
    /// How much of the shading it has.
    pub detail: LiveDetail,
}

/// The share of the shading that a frame has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LiveDetail {
    /// All of it.
    #[default]
    Whole,
    /// What is seen of a picture of few pixels that moves; all of it where hardware draws.
    Moving,
}

/// The bytes sent to the device for a change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UploadedBytes {
    /// Vertices of the ground.
    pub vertices: u64,
    /// Triangles of the ground.
    pub triangles: u64,
    /// Draped features.
    pub drapes: u64,
    /// Posts of the ground map.
    pub map: u64,
}

/// The statistics of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LiveStatistics {
    /// Patches of ground.
    pub patches: u32,
    /// Calls of the device.
    pub calls: u32,
    /// Triangles of the ground and its draped features.
    pub triangles: u64,
}

/// Shadow maps of solids.
#[derive(Clone, Debug, Default)]
pub struct LiveShadows(Shadows);

/// Draws a scene frame after frame.
#[derive(Debug)]
pub struct LiveRenderer {
    gpu: Gpu,
    format: LiveFormat,
    layouts: Arc<Layouts>,
    colors: Pipelines,
    /// What leaves out instances of the scenes that are loaded; `None` where the processor does.
    culler: Option<Arc<InstanceCuller>>,
    encoder: Option<Encoder>,
    moving: MovingPipelines,
    targets: Option<LiveTargets>,
    scene: Option<LoadedScene>,
    timer: Option<Arc<PassTimer>>,
    shadow_drawer: SharedShadowDrawer,
    /// What is written for the next frame.
    ring: StagingRing,
}

/// The treatment of the patches that are shown when another list is loaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeptPatches {
    /// They stay: the list is of the same walk, so that its materials of what lies on the ground have the same numbers.
    All,
    /// They go: the scene is another one.
    None,
}

/// A scene on the device.
#[derive(Debug)]
struct LoadedScene {
    map: EditedMap,
    lighting: Lighting,
    shadows: [ShadowView; 2],
    row_bits: u32,
    parts: ShaderParts,
    textures: FrameTextures,
    frame: FrameGroup,
    materials: GpuMaterials,
    geometry: GpuGeometry,
    culled: Option<CulledInstances>,
    plan: Plan,
    patches: PatchStore,
}

impl LiveQuality {
    /// The quality that an adapter draws fluently: one sample per pixel on a software adapter.
    pub fn of(gpu: &Gpu) -> Self {
        /// The most readings of a texture that a processor affords.
        const SOFTWARE_ANISOTROPY: u16 = 4;
        match gpu.is_software {
            true => Self { samples: 1, anisotropy: gpu.anisotropy.min(SOFTWARE_ANISOTROPY) },
            false => Self { samples: gpu.samples, anisotropy: gpu.anisotropy },
        }
    }
}

impl UploadedBytes {
    /// All together.
    pub fn total(&self) -> u64 {
        self.vertices + self.triangles + self.drapes + self.map
    }
}

impl LiveStatistics {
    fn add(&mut self, other: Self) {
        self.patches += other.patches;
        self.calls += other.calls;
        self.triangles += other.triangles;
    }
}

impl LiveShadows {
    /// The maps for what `camera` sees of a list with its ground; takes some ten milliseconds, on any thread.
    ///
    /// # Errors
    /// [`GpuError::List`] where the list is unsound, [`GpuError::Memory`] where there is not the memory for them.
    pub fn new(list: &DrawList, camera: &Camera) -> Result<Self, GpuError> {
        list.check()?;
        Ok(Self(Shadows::new(list, camera)?))
    }
}

impl LiveRenderer {
    /// A renderer for a window's texture of `format`, at the quality that the adapter affords.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Result<Self, GpuError> {
        Self::with_quality(gpu, format, LiveQuality::of(gpu))
    }

    /// A renderer of a chosen quality; what the adapter cannot do is lowered.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn with_quality(
        gpu: &Gpu,
        format: wgpu::TextureFormat,
        quality: LiveQuality,
    ) -> Result<Self, GpuError> {
        let samples = if quality.samples >= gpu.samples { gpu.samples } else { 1 };
        let anisotropy = quality.anisotropy.clamp(1, gpu.anisotropy);
        let gpu = gpu.with_anisotropy(anisotropy);
        let mut format = LiveFormat { window: format, samples, shade_pixels: false };
        let made = gpu.guarded("building its shaders", || {
            let layouts = Layouts::new(&gpu);
            let shader = shader(&gpu);
            let target = PassTarget { pass: GpuPass::Color, format: format.drawn(), samples };
            let colors = Pipelines::new(&gpu, &layouts, &shader, target);
            let encoder = (format.drawn() != format.window).then(|| Encoder::new(&gpu, format.window));
            Ok((Arc::new(layouts), colors, encoder))
        });
        let (layouts, colors, encoder) = made?;
        let culler = if gpu.is_software { None } else { InstanceCuller::open(&gpu) };
        format.shade_pixels = colors.shade_pixels(&gpu);
        let ring = StagingRing::new(&gpu);
        Ok(Self {
            gpu,
            format,
            layouts,
            colors,
            culler,
            encoder,
            moving: MovingPipelines::default(),
            targets: None,
            scene: None,
            timer: None,
            shadow_drawer: SharedShadowDrawer::default(),
            ring,
        })
    }

    /// Lets `timer`, which is of the same device, time the passes of the frames that follow.
    pub fn set_timer(&mut self, timer: Option<Arc<PassTimer>>) {
        self.timer = timer;
    }

    /// Lets the device leave out instances of the scenes that are loaded from now on, also where the processor draws, and returns
    /// whether it can; otherwise the processor leaves out groups of them.
    pub fn cull_on_device(&mut self) -> bool {
        self.culler = self.culler.take().or_else(|| InstanceCuller::open(&self.gpu));
        self.culler.is_some()
    }

    /// Lets the processor leave out groups of the instances of the scenes that are loaded from now on.
    pub fn cull_on_processor(&mut self) {
        self.culler = None;
    }

    /// How many pipelines it has made.
    pub fn pipelines(&self) -> usize {
        self.colors.count() + usize::from(self.encoder.is_some())
    }

    /// The device that it draws with.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Loads a scene: its materials, ground map and light, and all items except the ground and draped ones. The ground
    /// and what lies on it are those of the updates that follow.
    ///
    /// # Errors
    /// See [`GpuError`]; the scene loaded before stays.
    pub fn load(&mut self, list: &DrawList) -> Result<(), GpuError> {
        let prepared = self.loader().prepare(list, &LiveShadows::default())?;
        self.show(prepared, KeptPatches::None);
        Ok(())
    }

    /// A loader that prepares scenes for this renderer on other threads.
    pub fn loader(&self) -> LiveLoader {
        LiveLoader::new(self)
    }

    /// Shows a scene that a loader of this renderer has prepared.
    pub fn show(&mut self, prepared: PreparedScene, kept: KeptPatches) {
        let PreparedScene { mut scene, colors } = prepared;
        self.colors.adopt(colors);
        if let (KeptPatches::All, Some(before)) = (kept, self.scene.take()) {
            // Without them the ground is shown from the map alone.
            let _ = scene.take_windows(&self.gpu, &self.layouts, before.textures.windows().clone());
            let added = std::mem::replace(&mut scene.patches, before.patches);
            scene.patches.adopt_materials(added);
        }
        scene.make(&self.gpu, &mut self.colors);
        self.scene = Some(*scene);
    }

    /// Applies changes of the ground from the next frame that is drawn on, and returns the bytes sent for them. Does nothing
    /// before a scene is loaded.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn update(&mut self, changes: &GroundChanges) -> Result<UploadedBytes, GpuError> {
        let Some(scene) = &mut self.scene else { return Ok(UploadedBytes::default()) };
        self.gpu.guarded("sending what changed", || {
            let mut writes = BufferWrites::staged(&self.gpu, &mut self.ring);
            let mut sent = scene.patches.update(&mut writes, changes)?;
            for change in &changes.map {
                sent.map += scene.map.change(&self.gpu, scene.textures.ground(), change)?;
            }
            Ok(sent)
        })
    }

    /// Sets the light of the scene: sun, sky and haze, not the shadows.
    pub fn set_lighting(&mut self, lighting: Lighting) {
        if let Some(scene) = &mut self.scene {
            scene.lighting = lighting;
            let parts = scene.parts.with(ShaderParts::of_picture(None, &lighting, [false; 2]));
            if parts != scene.parts {
                scene.parts = parts;
                scene.make(&self.gpu, &mut self.colors);
            }
        }
    }

    /// Replaces the windows of finer ground by those that a loader of this renderer has prepared. Does nothing before a scene
    /// is loaded.
    ///
    /// # Errors
    /// See [`GpuError`]; the windows before stay.
    pub fn show_windows(&mut self, PreparedWindows(windows): PreparedWindows) -> Result<(), GpuError> {
        let Some(scene) = &mut self.scene else { return Ok(()) };
        self.gpu.guarded("showing finer ground", || {
            let parts = scene.parts;
            scene.take_windows(&self.gpu, &self.layouts, windows)?;
            if scene.parts != parts {
                scene.make(&self.gpu, &mut self.colors);
            }
            Ok(())
        })
    }

    /// Replaces the shadows of solids.
    ///
    /// # Errors
    /// See [`GpuError`]; the shadows before stay.
    pub fn set_shadows(&mut self, shadows: &LiveShadows) -> Result<(), GpuError> {
        let prepared = self.loader().prepare_shadows(shadows)?;
        self.show_shadows(prepared)
    }

    /// Replaces the shadows of solids by those that a loader of this renderer has prepared.
    ///
    /// # Errors
    /// See [`GpuError`]; the shadows before stay.
    pub fn show_shadows(&mut self, prepared: PreparedShadows) -> Result<(), GpuError> {
        let Some(scene) = &mut self.scene else { return Ok(()) };
        self.gpu.guarded("showing the shadows", || {
            let PreparedShadows { textures, views, has_shadows } = prepared;
            scene.textures.replace_shadows(textures);
            scene.frame = FrameGroup::new(&Loader::new(&self.gpu), &self.layouts, &scene.textures)?;
            scene.shadows = views;
            let parts = scene.parts.with(ShaderParts::of_picture(None, &scene.lighting, has_shadows));
            if parts != scene.parts {
                scene.parts = parts;
                scene.make(&self.gpu, &mut self.colors);
            }
            Ok(())
        })
    }

    /// Records a frame to `target`, a texture of the renderer's format and of `size` pixels, as `camera` sees it, whose
    /// picture should have that size, with the changes since the frame before: the commands are to be submitted, in the order in which
    /// frames are recorded. Nothing is drawn where a side is zero or no scene is loaded.
    ///
    /// # Errors
    /// See [`GpuError`]; after [`GpuError::Driver`] the device is to be opened anew.
    pub fn draw(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        size: (u32, u32),
        camera: &Camera,
        options: &LiveOptions,
    ) -> Result<LiveStatistics, GpuError> {
        let Some(scene) = &mut self.scene else { return Ok(LiveStatistics::default()) };
        if size.0 == 0 || size.1 == 0 {
            return Ok(LiveStatistics::default());
        }
        let (gpu, format) = (&self.gpu, self.format);
        let is_first = self.moving.is_first_frame();
        let moving = scene.parts_of(gpu, LiveDetail::Moving);
        let mut parts = scene.parts;
        if moving != scene.parts && (options.detail == LiveDetail::Moving || !is_first) {
            let keys = scene.keys(gpu, &self.colors, moving);
            let are_made = self.moving.are_made(gpu, &mut self.colors, keys)?;
            if are_made && options.detail == LiveDetail::Moving {
                parts = moving;
            }
        }
        let known = self.targets.take().filter(|targets| targets.size == size);
        let targets = gpu.guarded("resizing its textures", || {
            known.map_or_else(|| LiveTargets::new(&Loader::new(gpu), &self.layouts, format, size), Ok)
        })?;
        let drawn = gpu.guarded("drawing a frame", || {
            let mut writes = BufferWrites::staged(gpu, &mut self.ring);
            scene.frame.write(&mut writes, &scene.constants(camera, size));
            let patches = scene.patches.shown(camera);
            let leaves_narrow = options.detail == LiveDetail::Moving && gpu.is_software;
            let view = DrapeView { view: CullingView::new(camera), leaves_narrow };
            let calls = scene.patches.calls(&mut writes, &patches, &view)?;
            let lines: &[PatchId] = if options.wireframe { &patches } else { &[] };
            if options.wireframe {
                scene.patches.store_lines(&mut writes, lines)?;
                self.colors.make(gpu, [PipelineKey::PATCH_LINES]);
            }
            let shown = targets.linear.as_ref().unwrap_or(target);
            scene.culled.iter().for_each(|culled| culled.see(&mut writes, camera));
            self.ring.record(gpu, encoder);
            scene.culled.iter().for_each(|culled| culled.record(encoder, self.timer.as_deref()));
            let views = PassViews {
                stage: PassStage::Whole,
                label: "frame",
                color: targets.samples.as_ref().unwrap_or(shown),
                resolved: targets.samples.is_some().then_some(shown),
                depth: &targets.depth,
                timer: self.timer.as_deref(),
            };
            let colors = &self.colors;
            let mut drawn;
            let mut pass = match &targets.depths_read {
                Some(depths) => {
                    let stage = views.of(PassStage::Depths, "depths of the ground");
                    let mut pass = scene.begin(&stage, encoder, colors);
                    drawn = scene.patches.draw_ground(&mut pass, &calls, PipelineKey::PATCH_DEPTHS);
                    drop(pass);
                    let stage = views.of(PassStage::Pixels, "pixels of the ground");
                    let mut pass = scene.begin(&stage, encoder, colors);
                    pass.ground_pixels(ground_key(PipelineKey::GROUND_PIXELS, parts), depths);
                    pass.sky();
                    drop(pass);
                    scene.begin(&views.of(PassStage::Rest, "what stands and lies"), encoder, colors)
                }
                None => {
                    let mut pass = scene.begin(&views, encoder, colors);
                    pass.sky();
                    let key = ground_key(PipelineKey::PATCH, parts);
                    drawn = scene.patches.draw_ground(&mut pass, &calls, key);
                    pass
                }
            };
            drawn.add(scene.draw_rest(&mut pass, camera, parts, (&calls, lines)));
            drop(pass);
            if let (Some(encode), Some(linear)) = (&self.encoder, &targets.linear) {
                encode.record(gpu, encoder, (linear, target), self.timer.as_deref());
            }
            Ok(drawn)
        });
        self.targets = Some(targets);
        drawn
    }
}

impl LoadedScene {
    fn take_windows(&mut self, gpu: &Gpu, layouts: &Layouts, windows: WindowTexture) -> Result<(), GpuError> {
        if !windows.places().is_empty() {
            self.parts = self.parts.with(ShaderParts::WINDOWS);
        }
        self.textures.replace_windows(windows);
        self.frame = FrameGroup::new(&Loader::new(gpu), layouts, &self.textures)?;
        Ok(())
    }

    /// Makes the pipelines that frames at rest draw with and that are missing.
    fn make(&self, gpu: &Gpu, colors: &mut Pipelines) {
        let keys = self.keys(gpu, colors, self.parts);
        colors.make(gpu, keys);
    }

    /// The pipelines that it draws with where the shading has some parts.
    fn keys(&self, gpu: &Gpu, colors: &Pipelines, parts: ShaderParts) -> Vec<PipelineKey> {
        let [color_keys, _] = self.plan.keys(parts);
        let ground = match colors.shade_pixels(gpu) {
            true => vec![PipelineKey::PATCH_DEPTHS, ground_key(PipelineKey::GROUND_PIXELS, parts)],
            false => vec![ground_key(PipelineKey::PATCH, parts)],
        };
        let drapes = self.patches.keys(parts);
        color_keys.into_iter().chain([PipelineKey::SKY]).chain(ground).chain(drapes).collect()
    }

    /// The parts of the shading of frames of some detail.
    fn parts_of(&self, gpu: &Gpu, detail: LiveDetail) -> ShaderParts {
        match detail {
            LiveDetail::Moving if gpu.is_software => self.parts.while_moving(),
            LiveDetail::Moving | LiveDetail::Whole => self.parts,
        }
    }

    fn constants(&self, camera: &Camera, size: (u32, u32)) -> FrameUniforms {
        let Self { shadows, row_bits, .. } = *self;
        let (ground, windows) = (self.map.map(), self.textures.windows().places());
        let scene = FrameScene { ground, windows, lighting: &self.lighting, shadows, row_bits };
        FrameUniforms::new(scene, camera).with_size(size)
    }

    fn begin<'e, 'a>(
        &'a self,
        views: &PassViews<'_>,
        encoder: &'e mut wgpu::CommandEncoder,
        colors: &'a Pipelines,
    ) -> ScenePass<'e, 'a> {
        ScenePass::new(views.begin(encoder, &self.frame.group), colors, &self.materials)
    }

    /// Draws everything but the sky and the ground; `calls` are those of the patches shown, `lines` those whose edges are.
    fn draw_rest(
        &self,
        pass: &mut ScenePass<'_, '_>,
        camera: &Camera,
        parts: ShaderParts,
        (calls, lines): (&ShownCalls, &[PatchId]),
    ) -> LiveStatistics {
        let mut drawn = self.patches.draw_drapes(pass, calls, parts);
        if !lines.is_empty() {
            drawn.add(self.patches.draw_lines(pass, lines));
        }
        let calls = self.plan.seen(camera);
        drawn.calls += (calls.len() + self.plan.culled.len()) as u32;
        if let Some(culled) = &self.culled {
            pass.draw_seen(&self.geometry, (&self.plan.culled, culled), parts);
        }
        pass.draw(&self.geometry, &calls, parts);
        drawn
    }
}

/// What draws the ground's colors, of pixels or of patches.
fn ground_key(key: PipelineKey, picture: ShaderParts) -> PipelineKey {
    key.with_parts(ShaderParts::GROUND.in_picture(picture))
}
