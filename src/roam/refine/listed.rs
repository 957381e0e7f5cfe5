//! The patches of an update, compared with those of the update before.

use crate::graph::Vertex;
use crate::layout::PatchLayout;

const NOW: u8 = 1;
const BEFORE: u8 = 2;

/// The listed patches by their south-west corners. Nothing is allocated once the lists have grown.
#[derive(Clone, Debug)]
pub(super) struct ListedPatches {
    marks: Vec<u8>,
    before: Vec<Vertex>,
    /// In the order in which they were listed.
    pub(super) now: Vec<Vertex>,
    /// Listed now and not before.
    pub(super) entered: Vec<Vertex>,
    /// Listed before and not now.
    pub(super) left: Vec<Vertex>,
}

impl ListedPatches {
    /// No patch.
    pub(super) fn new(layout: &PatchLayout) -> Self {
        let [before, now, entered, left] = [const { Vec::new() }; 4];
        Self { marks: vec![0; layout.patch_count()], before, now, entered, left }
    }

    /// Replaces the list by `patches`; a patch that is listed twice counts once.
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

    /// Whether the patch at place `patch` of the layout is listed.
    #[inline]
    pub(super) fn contains(&self, patch: usize) -> bool {
        self.marks[patch] == NOW
    }

    /// The right-angled corners of the triangles that `vertex` splits in listed patches.
    #[inline]
    pub(super) fn apexes(&self, layout: &PatchLayout, vertex: Vertex) -> impl Iterator<Item = Vertex> {
        layout.parents(vertex).filter(move |&apex| self.contains(layout.patch_holding(vertex, apex)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_patch_enters_once_and_leaves_once() {
        let layout = PatchLayout::new(33, 9, 8).expect("sound");
        let patches: Vec<Vertex> = layout.patches().collect();
        let mut listed = ListedPatches::new(&layout);
        listed.renew(&layout, &[patches[0], patches[1], patches[0]]);
        assert_eq!((&*listed.now, listed.entered.len(), listed.left.len()), (&patches[..2], 2, 0));
        listed.renew(&layout, &patches[1..3]);
        assert_eq!((&*listed.entered, &*listed.left), (&patches[2..3], &patches[..1]));
        assert!(!listed.contains(0) && listed.contains(1) && listed.contains(2) && !listed.contains(3));
        listed.renew(&layout, &patches[1..3]);
        assert_eq!((listed.entered.len(), listed.left.len()), (0, 0));
    }
}
