//! Index lists kept from frame to frame: only those of patches that changed or came into view are written.

use crate::roam::graph::Vertex;
use crate::roam::layout::PatchLayout;
use crate::roam::shown::PatchList;

/// Which lists no longer hold.
#[derive(Clone, Copy, Debug)]
pub enum Stale<'a> {
    /// All: nothing is known to be what it was.
    All,
    /// Those of the patches at these places in the layout's order.
    Patches(&'a [usize]),
}

/// The lists of all patches; `L` is what a method keeps of one.
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
    /// The frame it was last in view.
    seen: u64,
    stale: bool,
    shown: Option<PatchList>,
}

impl<L: Default> PatchLists<L> {
    /// No patch is in view.
    pub fn new(layout: PatchLayout) -> Self {
        let slots = (0..layout.patch_count()).map(|_| PatchSlot::default()).collect();
        // A patch that was never seen was last seen in frame 0, which is none.
        Self { layout, slots, view: Vec::new(), frame: 1, written: 0 }
    }

    /// Calls `write` for the patches of `view` whose lists are stale or were not in view the last time; it writes the
    /// list anew and returns how many indices are sent.
    pub fn renew(
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

    /// Bytes of the lists that were written last.
    pub fn written_bytes(&self) -> usize {
        2 * self.written
    }

    /// What is in view. `draw` makes a patch's triangles of its list, where that has not been done since it was
    /// written.
    pub fn shown(&mut self, draw: impl Fn(Vertex, &L) -> PatchList) -> Vec<PatchList> {
        let (layout, slots) = (&self.layout, &mut self.slots);
        let list = |&corner: &Vertex| {
            let PatchSlot { list, indices, shown, .. } = &mut slots[layout.patch_index(corner)];
            let drawn = shown.get_or_insert_with(|| PatchList { indices: *indices, ..draw(corner, list) });
            drawn.clone()
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
            kept.renew(view, stale, |corner, list| {
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
