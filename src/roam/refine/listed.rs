//! The patches that an update is asked for, against those of the update before.

use crate::roam::graph::Vertex;
use crate::roam::layout::PatchLayout;

const NOW: u8 = 1;
const BEFORE: u8 = 2;

/// The listed patches, with what came and went. Nothing is allocated once the lists have grown.
#[derive(Clone, Debug)]
pub(super) struct ListedPatches {
    marks: Vec<u8>,
    now: Vec<Vertex>,
    before: Vec<Vertex>,
    entered: Vec<Vertex>,
    left: Vec<Vertex>,
}

impl ListedPatches {
    /// No patch.
    pub(super) fn new(layout: &PatchLayout) -> Self {
        let none = Vec::new;
        Self {
            marks: vec![0; layout.patch_count()],
            now: none(),
            before: none(),
            entered: none(),
            left: none(),
        }
    }

    /// Takes a new list, south-west corners of patches of the layout; what is listed twice counts once.
    pub(super) fn renew(&mut self, layout: &PatchLayout, patches: &[Vertex]) {
        std::mem::swap(&mut self.now, &mut self.before);
        for list in [&mut self.now, &mut self.entered, &mut self.left] {
            list.clear();
        }
        for &corner in &self.before {
            self.marks[layout.patch_index(corner)] = BEFORE;
        }
        for &corner in patches {
            let mark = &mut self.marks[layout.patch_index(corner)];
            if *mark & NOW == 0 {
                self.now.push(corner);
                if *mark == 0 {
                    self.entered.push(corner);
                }
                *mark |= NOW;
            }
        }
        for &corner in &self.before {
            let mark = &mut self.marks[layout.patch_index(corner)];
            if *mark == BEFORE {
                self.left.push(corner);
            }
            *mark &= NOW;
        }
    }

    /// The listed patches, in the order in which they were listed.
    pub(super) fn now(&self) -> &[Vertex] {
        &self.now
    }

    /// Those that were not listed before.
    pub(super) fn entered(&self) -> &[Vertex] {
        &self.entered
    }

    /// Those that were listed before and are not now.
    pub(super) fn left(&self) -> &[Vertex] {
        &self.left
    }

    /// Whether the patch at place `patch` of the layout is listed.
    #[inline]
    pub(super) fn holds(&self, patch: usize) -> bool {
        self.marks[patch] == NOW
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_and_goes_is_told_once() {
        let layout = PatchLayout::new(33, 9, 8).expect("sound");
        let patches: Vec<Vertex> = layout.patches().collect();
        let mut listed = ListedPatches::new(&layout);
        listed.renew(&layout, &[patches[0], patches[1], patches[0]]);
        assert_eq!((listed.now(), listed.entered().len(), listed.left().len()), (&patches[..2], 2, 0));
        listed.renew(&layout, &patches[1..3]);
        assert_eq!((listed.entered(), listed.left()), (&patches[2..3], &patches[..1]));
        assert!(!listed.holds(0) && listed.holds(1) && listed.holds(2) && !listed.holds(3));
        listed.renew(&layout, &patches[1..3]);
        assert_eq!((listed.entered().len(), listed.left().len()), (0, 0));
    }
}
