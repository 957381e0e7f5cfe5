//! The word for the renderer that draws.

use std::error::Error;

use crate::picture::Rendering;
use crate::{OtherRenderer, RenderBackend};
use sandtable_base::message::choice::{Choice, ChoiceWord, word};
use sandtable_draw::list::DrawList;
use sandtable_view::camera::Camera;

/// A renderer by its word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BackendName {
    /// The processor.
    #[default]
    Cpu,
    /// A graphics adapter.
    Gpu,
}

impl Choice for BackendName {
    const CHOICES: &'static [ChoiceWord<Self>] = &[
        word(Self::Cpu, "cpu", "The processor"),
        word(Self::Gpu, "gpu", "A graphics adapter; needs the Cargo feature `gpu`"),
    ];
}

impl BackendName {
    /// The renderer; without `gpu`, one for adapters that says how to build it in.
    pub fn renderer(self, gpu: Option<OtherRenderer>) -> RenderBackend {
        match self {
            Self::Cpu => RenderBackend::Cpu,
            Self::Gpu => RenderBackend::Gpu(gpu.unwrap_or(not_built_in)),
        }
    }
}

/// The renderer for adapters is not built in.
#[derive(Debug, thiserror::Error)]
#[error(
    "this program is built without the Cargo feature `gpu`; run `cargo run --features gpu -- …`, or draw with \
     --backend cpu, the default"
)]
struct NoGpuRenderer;

fn not_built_in(
    _: &DrawList,
    _: &Camera,
    _: &dyn Fn(&'static str),
) -> Result<Rendering, Box<dyn Error + Send + Sync>> {
    Err(NoGpuRenderer.into())
}
