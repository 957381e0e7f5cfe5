//! Scenes that are brought to the device on another thread, so that no frame waits for them.
//!
//! A [`LiveLoader`] has what a scene needs of its renderer: the device and its bindings. What it makes, buffers, textures and
//! pipelines, is shown by [`LiveRenderer::show`](super::LiveRenderer::show), which only swaps them in.

use std::sync::{Arc, Mutex, PoisonError};

use crate::adapter::Gpu;
use crate::buffer_writes::BufferWrites;
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
use crate::shadow_maps::ShadowMaker;
use crate::shadow_maps::drawer::ShadowDrawer;
use crate::shadow_maps::maker::{CastShadows, draw_alone};
use crate::windows::WindowTexture;
use sandtable_draw::ground_window::GroundWindow;
use sandtable_draw::list::DrawList;
use sandtable_draw::patches::GroundChanges;
use sandtable_view::camera::Camera;

/// Prepares scenes for a renderer, on any thread.
#[derive(Clone, Debug)]
pub struct LiveLoader {
    gpu: Gpu,
    layouts: Arc<Layouts>,
    colors: Pipelines,
    shadow_drawer: SharedShadowDrawer,
    culler: Option<Arc<InstanceCuller>>,
}

/// What draws shadow maps, made at first use; the renderer and its loaders share it.
pub(super) type SharedShadowDrawer = Arc<Mutex<Option<ShadowDrawer>>>;

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
        let LiveRenderer { gpu, layouts, colors, culler, shadow_drawer, .. } = renderer;
        Self {
            gpu: gpu.clone(),
            layouts: Arc::clone(layouts),
            colors: colors.clone(),
            shadow_drawer: Arc::clone(shadow_drawer),
            culler: culler.clone(),
        }
    }

    /// Brings a list to the device as [`LiveRenderer::load`](super::LiveRenderer::load) does, and waits until it is there.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn prepare(&self, list: &DrawList, shadows: &LiveShadows) -> Result<PreparedScene, GpuError> {
        list.check()?;
        let Self { gpu, layouts, colors, culler, .. } = self;
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
            let shadow_textures = ShadowTextures::upload(&loader, shadows)?;
            let textures = FrameTextures::upload(&loader, list.ground.as_deref(), shadow_textures)?;
            let has_shadows = shadows.maps().map(|map| map.is_some());
            let geometry = GpuGeometry::upload(&loader, list, &plan, None)?;
            let culled = culler.as_ref().map(|culler| culler.load(&loader, &plan, geometry.instances()));
            let scene = LoadedScene {
                map: EditedMap::new(list.ground.clone()),
                lighting: list.lighting,
                parts: ShaderParts::of_picture(list.ground.as_deref(), &list.lighting, has_shadows),
                shadows: ShadowView::both(shadows.maps()),
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
            let has_shadows = shadows.maps().map(|map| map.is_some());
            Ok(PreparedShadows { textures, views: ShadowView::both(shadows.maps()), has_shadows })
        })
    }

    /// The shadow maps for what `camera` sees of a list with its ground, on the device: drawn by the adapter, unless that is
    /// the processor itself.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn cast_shadows(&self, list: &DrawList, camera: &Camera) -> Result<PreparedShadows, GpuError> {
        self.cast_shadows_by(ShadowMaker::of(&self.gpu), list, camera)
    }

    /// [`LiveLoader::cast_shadows`], drawn by `maker`.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn cast_shadows_by(
        &self,
        maker: ShadowMaker,
        list: &DrawList,
        camera: &Camera,
    ) -> Result<PreparedShadows, GpuError> {
        list.check()?;
        let Self { gpu, layouts, shadow_drawer, .. } = self;
        match CastShadows::new(gpu, maker, list, camera)? {
            CastShadows::Drawn(shadows) => self.prepare_shadows(&LiveShadows(shadows)),
            CastShadows::Planned(plan) => gpu.guarded("casting shadows", || {
                let mut drawer = shadow_drawer.lock().unwrap_or_else(PoisonError::into_inner);
                let textures = draw_alone(&Loader::new(gpu), layouts, &mut drawer, list, &plan)?;
                let maps = plan.maps().map(|planned| planned.map(|planned| &planned.map));
                let has_shadows = maps.map(|map| map.is_some());
                Ok(PreparedShadows { textures, views: ShadowView::both(maps), has_shadows })
            }),
        }
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
            prepared.scene.patches.update(&mut BufferWrites::by_queue(&self.gpu), changes)?;
            self.gpu.finish_sending()
        })
    }
}
