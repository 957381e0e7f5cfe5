//! Scenes that are brought to the device on another thread, so that no frame waits for them.
//!
//! A [`LiveLoader`] has what a scene needs of its renderer: the device and its bindings. What it makes, buffers, textures and
//! pipelines, is shown by [`LiveRenderer::show`](super::LiveRenderer::show), which only swaps them in.

use std::sync::Arc;

use crate::adapter::Gpu;
use crate::error::GpuError;
use crate::frame::{FrameGroup, FrameTextures};
use crate::geometry::GpuGeometry;
use crate::ground::row_bits;
use crate::instance_culling::{InstanceCuller, InstanceCulling};
use crate::layouts::Layouts;
use crate::live::ground_map::EditedMap;
use crate::live::patches::PatchStore;
use crate::live::{LiveRenderer, LiveShadows, LoadedScene};
use crate::materials::{GpuMaterials, TexturePlaces, TextureScope};
use crate::memory::Loader;
use crate::parts::ShaderParts;
use crate::pipelines::Pipelines;
use crate::plan::Plan;
use crate::shadow::{ShadowTextures, ShadowView};
use crate::windows::WindowTexture;
use sandtable_draw::ground_window::GroundWindow;
use sandtable_draw::list::DrawList;
use sandtable_draw::patches::GroundChanges;

/// Prepares scenes for a renderer, on any thread.
#[derive(Clone, Debug)]
pub struct LiveLoader {
    gpu: Gpu,
    layouts: Arc<Layouts>,
    colors: Pipelines,
    culler: Option<Arc<InstanceCuller>>,
}

/// A scene on the device that is not shown yet.
#[derive(Debug)]
pub struct PreparedScene {
    pub(super) scene: Box<LoadedScene>,
    pub(super) colors: Pipelines,
}

/// Shadow maps on the device that are not shown yet.
#[derive(Debug)]
pub struct PreparedShadows {
    pub(super) textures: ShadowTextures,
    /// Of the sun and of the sky.
    pub(super) views: [ShadowView; 2],
    pub(super) has_shadows: [bool; 2],
}

/// Windows of finer ground on the device that are not shown yet.
#[derive(Debug)]
pub struct PreparedWindows(pub(super) WindowTexture);

impl LiveLoader {
    pub(super) fn new(renderer: &LiveRenderer) -> Self {
        let LiveRenderer { gpu, layouts, colors, culler, .. } = renderer;
        Self {
            gpu: gpu.clone(),
            layouts: Arc::clone(layouts),
            colors: colors.clone(),
            culler: culler.clone(),
        }
    }

    /// Brings a list to the device as [`LiveRenderer::load`](super::LiveRenderer::load) does, and waits until it is there.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn prepare(&self, list: &DrawList, shadows: &LiveShadows) -> Result<PreparedScene, GpuError> {
        list.check()?;
        let Self { gpu, layouts, colors, culler } = self;
        gpu.guarded("loading the scene", || {
            let places = TexturePlaces::new(list, TextureScope::All, &gpu.limits);
            let culling = match culler {
                Some(_) => InstanceCulling::of(gpu, list.items.len()),
                None => InstanceCulling::Processor,
            };
            let plan = Plan::of_solids(list, &places, culling);
            let patches = PatchStore::new(list, &places);
            let loader = Loader::new(gpu);
            let LiveShadows(shadows) = shadows;
            let textures = FrameTextures::upload(&loader, list.ground.as_deref(), shadows)?;
            let has_shadows = [&shadows.sun, &shadows.sky].map(Option::is_some);
            let geometry = GpuGeometry::upload(&loader, list, &plan, None)?;
            let culled = culler.as_ref().map(|culler| culler.load(&loader, &plan, geometry.instances()));
            let scene = LoadedScene {
                map: EditedMap::new(list.ground.clone()),
                lighting: list.lighting,
                parts: ShaderParts::of_picture(list.ground.as_deref(), &list.lighting, has_shadows),
                shadows: ShadowView::both(shadows),
                row_bits: row_bits(gpu.limits.max_texture_dimension_2d),
                frame: FrameGroup::new(&loader, layouts, &textures)?,
                textures,
                materials: GpuMaterials::upload(&loader, layouts, list, &places)?,
                geometry,
                culled: culled.transpose()?.flatten(),
                plan,
                patches,
            };
            let mut colors = colors.clone();
            scene.make(gpu, &mut colors);
            gpu.finish_sending()?;
            Ok(PreparedScene { scene: Box::new(scene), colors })
        })
    }

    /// Brings shadow maps to the device, and waits until they are there.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn prepare_shadows(&self, LiveShadows(shadows): &LiveShadows) -> Result<PreparedShadows, GpuError> {
        self.gpu.guarded("sending the shadows", || {
            let textures = ShadowTextures::upload(&Loader::new(&self.gpu), shadows)?;
            self.gpu.finish_sending()?;
            let has_shadows = [&shadows.sun, &shadows.sky].map(Option::is_some);
            Ok(PreparedShadows { textures, views: ShadowView::both(shadows), has_shadows })
        })
    }

    /// Makes the pipelines that a prepared scene needs for windows of finer ground, so that no frame waits for them.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn expect_windows(&self, prepared: &mut PreparedScene) -> Result<(), GpuError> {
        self.gpu.guarded("building its shaders", || {
            let PreparedScene { scene, colors } = prepared;
            scene.parts = scene.parts.with(ShaderParts::WINDOWS);
            scene.make(&self.gpu, colors);
            Ok(())
        })
    }

    /// Brings windows of finer posts than the ground map has to the device, the coarsest first, each with half the distance
    /// between the posts of the one before; waits until they are there.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn prepare_windows(&self, windows: &[Arc<GroundWindow>]) -> Result<PreparedWindows, GpuError> {
        self.gpu.guarded("sending finer ground", || {
            let windows = WindowTexture::upload(&Loader::new(&self.gpu), windows)?;
            self.gpu.finish_sending()?;
            Ok(PreparedWindows(windows))
        })
    }

    /// Brings the first ground of a prepared scene to the device.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn update(&self, prepared: &mut PreparedScene, changes: &GroundChanges) -> Result<(), GpuError> {
        self.gpu.guarded("sending the ground", || {
            prepared.scene.patches.update(&self.gpu, changes)?;
            self.gpu.finish_sending()
        })
    }
}
