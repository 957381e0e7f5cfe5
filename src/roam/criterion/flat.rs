//! The object-space error, without a view.

use crate::criterion::Criterion;
use crate::errors::ErrorMap;
use crate::graph::Vertex;
use crate::layout::PatchLayout;

/// The error over a tolerance in meters, for meshes without a camera.
#[derive(Clone, Copy, Debug)]
pub struct Flat<'a> {
    layout: &'a PatchLayout,
    errors: &'a ErrorMap,
    tolerance_m: f32,
}

impl<'a> Flat<'a> {
    /// Errors above `tolerance_m`, 0 or more, are refined.
    pub fn new(layout: &'a PatchLayout, errors: &'a ErrorMap, tolerance_m: f32) -> Self {
        Self { layout, errors, tolerance_m }
    }
}

impl Criterion for Flat<'_> {
    #[inline]
    fn excess(&self, vertex: Vertex) -> f32 {
        let error = self.errors.at(self.layout, vertex);
        if error > self.tolerance_m { error / self.tolerance_m } else { 0.0 }
    }

    #[inline]
    fn wants(&self, vertex: Vertex) -> bool {
        self.errors.at(self.layout, vertex) > self.tolerance_m
    }
}
