//! Disjoint sets of numbered things: the union-find forest (Galler and Fisher 1964; halved paths, van Leeuwen and van der Weide).
//!
//! A forest is a list with the parent of each thing; a root is its own parent. Two sets are joined by making one's root the
//! parent of the other's.

/// A number of a thing.
pub trait SetNumber: Copy + PartialEq {
    /// The number as an index of the list.
    fn index(self) -> usize;
}

impl SetNumber for u32 {
    fn index(self) -> usize {
        self as usize
    }
}

impl SetNumber for usize {
    fn index(self) -> usize {
        self
    }
}

/// The root of the set of a thing; halves the path to it.
pub fn root<N: SetNumber>(parents: &mut [N], mut thing: N) -> N {
    while parents[thing.index()] != thing {
        parents[thing.index()] = parents[parents[thing.index()].index()];
        thing = parents[thing.index()];
    }
    thing
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_of_a_chain_have_its_end_as_root_and_paths_become_shorter() {
        let mut parents = [0_u32, 0, 1, 2, 3, 5];
        assert_eq!(root(&mut parents, 4), 0);
        assert_eq!(root(&mut parents, 5), 5);
        assert_eq!(parents, [0, 0, 0, 2, 2, 5]);
    }
}
