//! The renderer of all sheets of an atlas.

use glam::Vec3;

use crate::atlas::arguments::AtlasArguments;
use crate::error::{PlanError, PlanFault, ShardError};
use crate::plan::ShardPlan;
use sandtable_draw::list::DrawList;
use sandtable_render::{OtherRenderer, RenderBackend, RenderError, render};
use sandtable_view::camera::Camera;

/// The renderer that a plan states; `gpu` is that of an adapter, `None` where it is not built in. An adapter draws a picture of
/// nothing first: what is missing is said once and before the scene is read, rather than of each sheet.
///
/// # Errors
/// The plan states an adapter, and there is none here, or it cannot draw.
pub fn renderer(
    plan: &ShardPlan,
    arguments: &AtlasArguments,
    gpu: Option<OtherRenderer>,
) -> Result<RenderBackend, ShardError> {
    let backend = arguments.backend.0.renderer(gpu);
    if let RenderBackend::Gpu(_) = backend {
        draw_nothing(backend).map_err(|error| {
            PlanError::new(&plan.folder.join("plan.json"), PlanFault::Backend(Box::new(error)))
        })?;
    }
    Ok(backend)
}

fn draw_nothing(backend: RenderBackend) -> Result<(), RenderError> {
    let camera = Camera::new(Vec3::ZERO, Vec3::Y, 1.0, (16, 16), (1.0, 10.0));
    let camera = camera.expect("a camera of these numbers sees something");
    render(&DrawList::default(), &camera, backend, &|_| ()).map(|_| ())
}
