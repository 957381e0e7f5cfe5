//! What changed from one frame to the next.

use std::collections::BTreeMap;
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
                let last = before.as_ref().map_or(0, |before| before.len());
                let kept = before.map_or(0, |before| in_both(&before, &list.triangles));
                change.appeared += list.triangles.len() - kept;
                change.vanished += last - kept;
                change.list_bytes += list.bytes();
            }
            self.last.insert(list.corner, Arc::clone(&list.triangles));
        }
        change.vanished += last.values().map(|list| list.len()).sum::<usize>();
        change
    }
}

/// How many triangles are in both lists; none is twice in one.
fn in_both(one: &[LocalTriangle], other: &[LocalTriangle]) -> usize {
    let (one, other) = (in_order(one), in_order(other));
    let mut other = other.iter().peekable();
    let found = one.iter().filter(|triangle| {
        while other.next_if(|next| next < triangle).is_some() {}
        other.next_if_eq(triangle).is_some()
    });
    found.count()
}

/// The triangles, each from its lowest corner on, as numbers in rising order.
fn in_order(triangles: &[LocalTriangle]) -> Vec<u64> {
    let number = |[a, b, c]: LocalTriangle| u64::from(a) << 32 | u64::from(b) << 16 | u64::from(c);
    let from_lowest =
        |&[a, b, c]: &LocalTriangle| number([a, b, c]).min(number([b, c, a])).min(number([c, a, b]));
    let mut numbers: Vec<u64> = triangles.iter().map(from_lowest).collect();
    numbers.sort_unstable();
    numbers
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
