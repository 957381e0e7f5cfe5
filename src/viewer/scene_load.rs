//! Lists that the renderer takes over, prepared on the threads that open and change scenes.

use std::sync::{Arc, Mutex, PoisonError};

use crate::shadow_state::ShadowedView;
use sandtable_draw::list::DrawList;
use sandtable_draw::patches::GroundChanges;
use sandtable_gpu::error::GpuError;
use sandtable_gpu::live::KeptPatches;
use sandtable_gpu::live::prepared::{LiveLoader, PreparedScene};

/// A list that the renderer is to show.
pub struct SceneLoad {
    /// The list.
    pub list: Arc<DrawList>,
    /// The list on the device; `None` where it is not there yet.
    pub prepared: Option<PreparedScene>,
    /// What becomes of the ground that is shown.
    pub kept: KeptPatches,
}

/// The loader of the window's renderer; empty until there is one.
#[derive(Clone, Debug, Default)]
pub struct LoaderSlot(Arc<Mutex<Option<LiveLoader>>>);

impl SceneLoad {
    /// A list that is not on the device, of another scene.
    pub fn unprepared(list: &Arc<DrawList>) -> Self {
        Self { list: Arc::clone(list), prepared: None, kept: KeptPatches::None }
    }
}

impl LoaderSlot {
    /// Registers the loader of the renderer, and again when the renderer has made more pipelines.
    pub fn fill(&self, loader: LiveLoader) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(loader);
    }

    /// Brings a list, its shadows and its first ground to the device; `None` where there is no renderer yet.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn prepare(
        &self,
        list: &DrawList,
        view: &ShadowedView,
        first: &GroundChanges,
    ) -> Result<Option<PreparedScene>, GpuError> {
        let Some(loader) = self.loader() else { return Ok(None) };
        let mut prepared = loader.prepare(list, &view.shadows(list)?)?;
        loader.update(&mut prepared, first)?;
        Ok(Some(prepared))
    }

    /// Readies a prepared scene for windows of finer ground.
    ///
    /// # Errors
    /// See [`GpuError`].
    pub fn expect_windows(&self, prepared: &mut Option<PreparedScene>) -> Result<(), GpuError> {
        let both = self.loader().zip(prepared.as_mut());
        both.map_or(Ok(()), |(loader, prepared)| loader.expect_windows(prepared))
    }

    /// Whether there is a renderer.
    pub fn is_filled(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// The renderer's loader; `None` where there is no renderer yet.
    pub fn loader(&self) -> Option<LiveLoader> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}
