//! The GPU adapters of this machine; a test without one is reported as skipped.

use std::sync::LazyLock;

use sandtable_gpu::adapter::{Gpu, GpuApi};

/// One device for each interface that offers one; opening takes a while, so all tests share them.
///
/// An interface without an adapter is reported as skipped; with `SANDTABLE_REQUIRE_GPU` set it fails the test.
pub fn gpus() -> &'static [Gpu] {
    static GPUS: LazyLock<Vec<Gpu>> =
        LazyLock::new(|| [GpuApi::Vulkan, GpuApi::Gl].into_iter().filter_map(open).collect());
    &GPUS
}

fn open(api: GpuApi) -> Option<Gpu> {
    match Gpu::open(&[api]) {
        Ok(gpu) => Some(gpu),
        Err(error) => {
            assert!(std::env::var_os("SANDTABLE_REQUIRE_GPU").is_none(), "{error}");
            crate::common::skip::skipped(&format!("no GPU adapter: {error}"));
            None
        }
    }
}
