//! The changes from one frame to the next.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::graph::Vertex;
use crate::shown::{LocalTriangle, PatchList};

/// The last frame, for comparison with the next.
#[derive(Clone, Debug, Default)]
pub struct LastFrame {
    last: BTreeMap<Vertex, Arc<Vec<LocalTriangle>>>,
}

/// The difference between a frame and the one before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameChange {
    /// Triangles that are shown now and were not before: split, merged, or come into view with their patch.
    pub appeared: usize,
    /// Triangles that were shown before and are not now.
    pub vanished: usize,
    /// Bytes of the index lists that changed, including those of patches that came into view.
    pub list_bytes: usize,
}

impl LastFrame {
    /// Compares a frame with the last one, or with an empty one, and keeps it.
    ///
    /// The order of triangles in a list, and of the corners of a triangle, matters to the bytes but not to the triangles.
    pub fn compare(&mut self, shown: &[PatchList]) -> FrameChange {
        let mut last = std::mem::take(&mut self.last);
        let mut change = FrameChange::default();
        for list in shown {
            let before = last.remove(&list.corner).unwrap_or_default();
            if !Arc::ptr_eq(&before, &list.triangles) && before != list.triangles {
                let kept = common(&before, &list.triangles);
                change.appeared += list.triangles.len() - kept;
                change.vanished += before.len() - kept;
                change.list_bytes += list.bytes();
            }
            self.last.insert(list.corner, Arc::clone(&list.triangles));
        }
        change.vanished += last.values().map(|list| list.len()).sum::<usize>();
        change
    }
}

/// The number of triangles in both lists, each of which holds a triangle once.
fn common(one: &[LocalTriangle], other: &[LocalTriangle]) -> usize {
    let (one, other) = (sorted_keys(one), sorted_keys(other));
    let mut other = other.iter().peekable();
    let is_in_both = |key: &&u64| {
        while other.next_if(|next| next < key).is_some() {}
        other.next_if_eq(key).is_some()
    };
    one.iter().filter(is_in_both).count()
}

/// The triangles as numbers in ascending order, each from its lowest corner on.
fn sorted_keys(triangles: &[LocalTriangle]) -> Vec<u64> {
    let key = |[a, b, c]: LocalTriangle| u64::from(a) << 32 | u64::from(b) << 16 | u64::from(c);
    let from_lowest = |&[a, b, c]: &LocalTriangle| key([a, b, c]).min(key([b, c, a])).min(key([c, a, b]));
    let mut keys: Vec<u64> = triangles.iter().map(from_lowest).collect();
    keys.sort_unstable();
    keys
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
