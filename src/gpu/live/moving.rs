//! Pipelines of frames that move, where those have less of the shading.
//!
//! They are made on another thread when the first such frame is drawn: a scene that is only looked at has none, its first picture
//! does not wait for them, and no frame does. Until they are there, frames that move are shaded as those at rest.

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
    making: Option<JoinHandle<Result<Pipelines, GpuError>>>,
}

impl MovingPipelines {
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
