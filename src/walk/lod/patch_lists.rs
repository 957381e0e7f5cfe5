//! Index lists kept from frame to frame: only the lists of patches that changed or came into view are written.

use sandtable_roam::graph::Vertex;
use sandtable_roam::layout::PatchLayout;
use sandtable_roam::shown::PatchList;

/// The lists that are out of date.
#[derive(Clone, Copy, Debug)]
pub enum Stale<'a> {
    /// All: what changed is not known.
    All,
    /// Those of the patches with these indices in the layout.
    Patches(&'a [usize]),
}

/// The lists of all patches; `L` is what a method keeps for one.
#[derive(Debug)]
pub struct PatchLists<L> {
    layout: PatchLayout,
    slots: Vec<PatchSlot<L>>,
    view: Vec<Vertex>,
    frame: u64,
    written: usize,
}

#[derive(Debug, Default)]
struct PatchSlot<L> {
    list: L,
    indices: usize,
    /// The frame in which it was last in view.
    seen: u64,
    stale: bool,
    shown: Option<PatchList>,
}

impl<L: Default> PatchLists<L> {
    /// No patch is in view.
    pub fn new(layout: PatchLayout) -> Self {
        let slots = (0..layout.patch_count()).map(|_| PatchSlot::default()).collect();
        // Frames count from 1; 0 is never.
        Self { layout, slots, view: Vec::new(), frame: 1, written: 0 }
    }

    /// Calls `write` for the patches of `view` whose lists are stale or were not in view in the last frame. `write`
    /// fills the list and returns the number of indices that are sent.
    pub fn update(
        &mut self,
        view: &[Vertex],
        stale: Stale<'_>,
        mut write: impl FnMut(Vertex, &mut L) -> usize,
    ) {
        if let Stale::Patches(patches) = stale {
            patches.iter().for_each(|&patch| self.slots[patch].stale = true);
        }
        let last = self.frame;
        self.frame += 1;
        self.written = 0;
        for &corner in view {
            let slot = &mut self.slots[self.layout.patch_index(corner)];
            let holds = slot.seen == last && !slot.stale && matches!(stale, Stale::Patches(_));
            slot.seen = self.frame;
            if !holds {
                slot.stale = false;
                slot.shown = None;
                slot.indices = write(corner, &mut slot.list);
                self.written += slot.indices;
            }
        }
        self.view.clear();
        self.view.extend_from_slice(view);
    }

    /// Bytes of the lists that the last update wrote.
    pub fn written_bytes(&self) -> usize {
        2 * self.written
    }

    /// The lists in view. `triangles` makes the triangles of a list, once after it was written.
    pub fn shown(&mut self, triangles: impl Fn(Vertex, &L) -> PatchList) -> Vec<PatchList> {
        let (layout, slots) = (&self.layout, &mut self.slots);
        let list = |&corner: &Vertex| {
            let PatchSlot { list, indices, shown, .. } = &mut slots[layout.patch_index(corner)];
            let shown =
                shown.get_or_insert_with(|| PatchList { indices: *indices, ..triangles(corner, list) });
            shown.clone()
        };
        self.view.iter().map(list).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn a_list_is_written_when_its_patch_comes_into_view_or_is_stale_and_not_again() {
        let layout = PatchLayout::new(9, 5, 4).expect("sound");
        let mut kept: PatchLists<usize> = PatchLists::new(layout);
        let [west, east] = [Vertex::new(0, 0), Vertex::new(4, 0)];
        let mut frame = 0;
        let mut written = |view: &[Vertex], stale: Stale<'_>| {
            frame += 1;
            let mut written = Vec::new();
            kept.update(view, stale, |corner, list| {
                written.push(corner);
                *list = frame;
                6
            });
            assert_eq!(kept.written_bytes(), 12 * written.len());
            let shown =
                kept.shown(|corner, &list| PatchList::of_triangles(corner, Arc::new(vec![[list as u16; 3]])));
            assert_eq!(shown.iter().map(|list| list.corner).collect::<Vec<_>>(), view);
            assert!(shown.iter().all(|list| list.indices == 6));
            (written, shown.iter().map(|list| list.triangles[0][0]).collect::<Vec<_>>())
        };
        let none = Stale::Patches(&[]);
        assert_eq!(written(&[west, east], none), (vec![west, east], vec![1, 1]));
        assert_eq!(written(&[west, east], none), (vec![], vec![1, 1]));
        assert_eq!(written(&[west, east], Stale::Patches(&[1])), (vec![east], vec![1, 3]));
        assert_eq!(written(&[west], Stale::Patches(&[1])), (vec![], vec![1]));
        assert_eq!(written(&[west, east], none), (vec![east], vec![1, 5]));
        assert_eq!(written(&[west, east], Stale::All), (vec![west, east], vec![6, 6]));
    }
}
