//! Pipelines of frames that move, where those have less of the shading.
//!
//! They are made on another thread once a scene was drawn twice, or when the first frame that moves is: neither its first picture
//! waits for them nor any frame, and a picture that is drawn once has none. Until they are there, frames that move are shaded as
//! those at rest.

use std::thread::{self, JoinHandle};

use crate::adapter::Gpu;
use crate::error::{DriverError, GpuError};
use crate::pipeline_key::PipelineKey;
use crate::pipelines::Pipelines;

/// The words for what fails.
const DOING: &str = "building its shaders";

/// Makes the pipelines of frames that move.
#[derive(Debug, Default)]
pub struct MovingPipelines {
    /// Whether a frame was drawn.
    has_drawn: bool,
    making: Option<JoinHandle<Result<Pipelines, GpuError>>>,
}

impl MovingPipelines {
    /// Notes that a frame is drawn; returns whether it is the first.
    pub fn is_first_frame(&mut self) -> bool {
        !std::mem::replace(&mut self.has_drawn, true)
    }

    /// Whether `colors` has the pipelines of `keys`; where it lacks some, they are made for a later call.
    ///
    /// # Errors
    /// See [`GpuError`]: they could not be made.
    pub fn are_made(
        &mut self,
        gpu: &Gpu,
        colors: &mut Pipelines,
        keys: Vec<PipelineKey>,
    ) -> Result<bool, GpuError> {
        if colors.has_all(&keys) {
            return Ok(true);
        }
        match self.making.take() {
            Some(making) if making.is_finished() => {
                let crashed = |_| Err(gpu.driver_error(DOING, DriverError::Crash));
                colors.adopt(making.join().unwrap_or_else(crashed)?);
            }
            Some(making) => self.making = Some(making),
            None => {
                let (gpu, mut made) = (gpu.clone(), colors.clone());
                let make = move || {
                    gpu.guarded(DOING, || {
                        made.make(&gpu, keys);
                        Ok(made)
                    })
                };
                self.making = Some(thread::spawn(make));
                return Ok(false);
            }
        }
        Ok(colors.has_all(&keys))
    }
}
