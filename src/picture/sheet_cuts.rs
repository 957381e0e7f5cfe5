//! Cuts the draped features of a walk on another thread, to triangles that the walk will show.

use std::array;

use crate::recut::{GroundSheets, SHEETS};
use sandtable_ribbon::patches::{CutDrapes, DrapeParts};
use sandtable_terrain::triangle_surface::TriangleSurface;

/// The draped features as they are planned now, by sheet.
#[derive(Clone, Debug)]
pub struct SheetParts([DrapeParts; SHEETS]);

/// The cut features of some patches.
#[derive(Clone, Debug)]
pub struct SheetCuts {
    patches: Vec<usize>,
    sheets: [CutDrapes; SHEETS],
}

impl SheetParts {
    /// Cuts the draped features of `patches` to the triangles displayed there.
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

    /// Keeps the patches that are meant: what was cut of the others is of no use.
    pub fn retain(&mut self, is_meant: impl Fn(usize) -> bool) {
        self.patches.retain(|&patch| is_meant(patch));
    }
}

impl GroundSheets {
    /// The draped features, to be cut on another thread.
    pub fn parts(&self) -> SheetParts {
        let sheets = self.sheets();
        SheetParts(array::from_fn(|sheet| sheets[sheet].drapes.parts().clone()))
    }

    /// Exchanges the cut features of patches; returns the patches whose plan changed meanwhile, to be cut again.
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
