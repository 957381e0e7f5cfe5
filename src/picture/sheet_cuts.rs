//! Cutting what lies on the ground of a walk on another thread, to triangles that the walk will show.

use std::array;

use crate::recut::GroundSheets;
use sandtable_ribbon::patches::{CutDrapes, DrapeParts};
use sandtable_terrain::triangle_surface::TriangleSurface;

/// What lies on the ground as it is planned now, by sheet.
#[derive(Clone, Debug)]
pub struct SheetParts([DrapeParts; 5]);

/// What was cut of some patches.
#[derive(Clone, Debug)]
pub struct SheetCuts {
    patches: Vec<usize>,
    sheets: [CutDrapes; 5],
}

impl SheetParts {
    /// Cuts what lies in `patches` to what is displayed there.
    ///
    /// # Panics
    /// Where a number is not that of a patch.
    pub fn cut(&self, patches: Vec<usize>, ground: &dyn TriangleSurface) -> SheetCuts {
        let sheets = self.0.each_ref().map(|parts| parts.cut(&patches, ground));
        SheetCuts { patches, sheets }
    }
}

impl SheetCuts {
    /// The patches.
    pub fn patches(&self) -> &[usize] {
        &self.patches
    }
}

impl GroundSheets {
    /// What lies on the ground, to be cut on another thread.
    pub fn parts(&self) -> SheetParts {
        let sheets = self.sheets();
        SheetParts(array::from_fn(|sheet| sheets[sheet].drapes.parts().clone()))
    }

    /// Exchanges what was cut of patches; returns those of them in which something else was planned meanwhile, to be cut
    /// again.
    pub fn exchange_cuts(&mut self, cuts: &mut SheetCuts) -> Vec<usize> {
        let SheetCuts { patches, sheets } = cuts;
        let mut planned = Vec::new();
        for (sheet, cut) in self.sheets_mut().into_iter().zip(sheets) {
            if !sheet.drapes.exchange(cut) {
                planned.extend(patches.iter().filter(|&&patch| sheet.drapes.is_occupied(patch)));
            }
        }
        planned
    }
}
