//! Picking: draws the scene to a single pixel, and reads back what it shows.

use glam::Vec2;

use crate::adapter::Gpu;
use crate::error::GpuError;
use crate::memory::{Loader, view};
use crate::passes::{PassStage, PassViews};
use crate::readback::{Targets, TextureCopy, feature_and_depth, wait};
use sandtable_draw::list::FeatureId;

/// What a pixel shows at its center.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PickedPoint {
    /// The feature; [`FeatureId::GROUND`] for bare ground.
    pub feature: FeatureId,
    /// Meters from the eye along the viewing direction.
    pub depth_m: f32,
}

/// One pixel to draw to.
#[derive(Debug)]
pub(super) struct PickTarget {
    targets: Targets,
}

impl PickTarget {
    pub fn new(loader: &Loader<'_>) -> Result<Self, GpuError> {
        Ok(Self { targets: Targets::new(loader, (1, 1))? })
    }

    /// Begins a pass whose only pixel is the one that holds `pixel` of a picture of `size`.
    pub fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        frame: &wgpu::BindGroup,
        pixel: Vec2,
        size: (u32, u32),
    ) -> wgpu::RenderPass<'e> {
        let [color, depth] = [&self.targets.feature, &self.targets.depth].map(view);
        let stage = PassStage::Whole;
        let views = PassViews { stage, label: "pick", color: &color, resolved: None, depth: &depth };
        let mut pass = views.begin(encoder, frame);
        let corner = -pixel.floor();
        pass.set_viewport(corner.x, corner.y, size.0 as f32, size.1 as f32, 0.0, 1.0);
        pass
    }

    /// Waits for the result; `None` for the sky.
    pub fn read(
        &self,
        gpu: &Gpu,
        mut encoder: wgpu::CommandEncoder,
    ) -> Result<Option<PickedPoint>, GpuError> {
        let copy = TextureCopy::record(gpu, &mut encoder, &self.targets.feature)?;
        gpu.queue.submit([encoder.finish()]);
        let texels = wait(gpu, &[&copy]).and_then(|()| Ok(copy.texels::<8>()?));
        let texels = texels.map_err(|error| gpu.driver_error("reading a pixel back", error))?;
        let seen = texels.first().copied().map(feature_and_depth);
        let seen = seen.filter(|(feature, _)| *feature != FeatureId::NONE);
        Ok(seen.map(|(feature, depth_m)| PickedPoint { feature, depth_m }))
    }
}
