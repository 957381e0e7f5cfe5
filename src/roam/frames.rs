//! What changed from one frame to the next.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::roam::graph::Vertex;
use crate::roam::shown::{LocalTriangle, PatchList};

/// Remembers the last frame, to compare the next with it.
#[derive(Clone, Debug, Default)]
pub struct LastFrame {
    last: BTreeMap<Vertex, Arc<Vec<LocalTriangle>>>,
}

/// How a frame differs from the one before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameChange {
    /// Triangles that are shown now and were not shown before: split, merged, or come into view with their patch.
    pub appeared: usize,
    /// Triangles that were shown before and are not shown now.
    pub vanished: usize,
    /// Bytes of the index lists that are not what they were, those of patches come into view among them.
    pub list_bytes: usize,
}

impl LastFrame {
    /// Compares a frame with the last one given, or with an empty one, and remembers it.
    ///
    /// The order of triangles in a list, and where a triangle starts, make no difference to the triangles; they do
    /// to the bytes.
    pub fn compare(&mut self, shown: &[PatchList]) -> FrameChange {
        let mut last = std::mem::take(&mut self.last);
        let mut change = FrameChange::default();
        for list in shown {
            let before = last.remove(&list.corner);
            let same = before
                .as_ref()
                .is_some_and(|before| Arc::ptr_eq(before, &list.triangles) || *before == list.triangles);
            if !same {
                let (appeared, vanished) = before.map_or((list.triangles.len(), 0), |before| {
                    let (before, now) = (set(&before), set(&list.triangles));
                    (now.difference(&before).count(), before.difference(&now).count())
                });
                change.appeared += appeared;
                change.vanished += vanished;
                change.list_bytes += list.bytes();
            }
            self.last.insert(list.corner, Arc::clone(&list.triangles));
        }
        change.vanished += last.values().map(|list| list.len()).sum::<usize>();
        change
    }
}

/// The triangles, each from its lowest corner on.
fn set(triangles: &[LocalTriangle]) -> BTreeSet<LocalTriangle> {
    let from_lowest = |&[a, b, c]: &LocalTriangle| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
    triangles.iter().filter_map(from_lowest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(x: i32, triangles: &[LocalTriangle]) -> PatchList {
        PatchList::of_triangles(Vertex::new(x, 0), Arc::new(triangles.to_vec()))
    }

    #[test]
    fn what_appears_what_vanishes_and_what_must_be_sent_are_counted() {
        let mut last = LastFrame::default();
        let first = [list(0, &[[0, 1, 2], [2, 1, 3]]), list(8, &[[0, 1, 2]])];
        assert_eq!(last.compare(&first), FrameChange { appeared: 3, vanished: 0, list_bytes: 18 });
        assert_eq!(last.compare(&first), FrameChange::default(), "the same frame again");
        let copied = [list(0, &[[0, 1, 2], [2, 1, 3]]), list(8, &[[0, 1, 2]])];
        assert_eq!(last.compare(&copied), FrameChange::default(), "equal lists");
        let split = [list(0, &[[0, 1, 2], [4, 2, 1], [4, 3, 2]]), list(8, &[[0, 1, 2]])];
        assert_eq!(last.compare(&split), FrameChange { appeared: 2, vanished: 1, list_bytes: 18 });
        let turned = [list(0, &[[1, 2, 0], [4, 2, 1], [4, 3, 2]])];
        assert_eq!(last.compare(&turned), FrameChange { appeared: 0, vanished: 1, list_bytes: 18 });
        assert_eq!(last.compare(&[]), FrameChange { appeared: 0, vanished: 3, list_bytes: 0 });
    }
}
