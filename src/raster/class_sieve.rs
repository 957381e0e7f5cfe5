//! Merges patches of a [`ClassGrid`] that are too small to be told into the neighbor with the longest shared border.
//!
//! A patch is a set of cells of one class that hang together by their sides. The smallest patches go first, so that specks
//! side by side grow together before a large neighbor takes them; a patch that joins another of its class is one with it.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use crate::class_grid::ClassGrid;

/// The patches of a grid.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClassPatches {
    /// The patch of each cell: patches are numbered in the order of their first cells.
    pub patch_of: Vec<u32>,
    /// The class of each patch.
    pub classes: Vec<u8>,
    /// The cells of each patch, at least 1.
    pub sizes: Vec<u32>,
}

impl ClassPatches {
    /// The patches of a grid.
    pub fn of(grid: &ClassGrid) -> Self {
        const NONE: u32 = u32::MAX;
        let cells = grid.cells();
        let mut found = Self { patch_of: vec![NONE; cells.len()], classes: Vec::new(), sizes: Vec::new() };
        let mut open = Vec::new();
        for first in 0..cells.len() {
            if found.patch_of[first] != NONE {
                continue;
            }
            let (patch, class) = (found.classes.len() as u32, cells[first]);
            let mut size = 0;
            found.patch_of[first] = patch;
            open.push(first);
            while let Some(cell) = open.pop() {
                size += 1;
                for beside in grid.beside(cell) {
                    if cells[beside] == class && found.patch_of[beside] == NONE {
                        found.patch_of[beside] = patch;
                        open.push(beside);
                    }
                }
            }
            found.classes.push(class);
            found.sizes.push(size);
        }
        found
    }
}

/// Merges patches of fewer than `least` cells into the neighbor with the longest shared border, until there is none or one
/// patch is all that is left. Of neighbors with equally long borders the larger takes it, then that of the lower number.
///
/// Time grows with the cells and the borders between patches.
pub fn sieve(grid: &mut ClassGrid, least: u32) {
    let patches = ClassPatches::of(grid);
    let mut merging = PatchMerging::new(grid, &patches);
    let small = (0..merging.size.len() as u32).filter(|patch| merging.size[*patch as usize] < least);
    let mut queue: BinaryHeap<Reverse<(u32, u32)>> =
        small.map(|patch| Reverse((merging.size[patch as usize], patch))).collect();
    while let Some(Reverse((size, patch))) = queue.pop() {
        let is_current = merging.root(patch) == patch && merging.size[patch as usize] == size;
        if !is_current {
            continue;
        }
        let Some(into) = merging.longest_neighbor(patch) else { break };
        let merged = merging.merge(patch, into);
        let size = merging.size[merged as usize];
        if size < least {
            queue.push(Reverse((size, merged)));
        }
    }
    for (cell, patch) in patches.patch_of.iter().enumerate() {
        let root = merging.root(*patch);
        grid.cells_mut()[cell] = merging.class[root as usize];
    }
}

/// Patches that become one.
struct PatchMerging {
    /// A patch that it was merged into, or itself.
    parent: Vec<u32>,
    class: Vec<u8>,
    size: Vec<u32>,
    /// Sides of cells shared with others; of a merged patch empty. A neighbor may have been merged since.
    borders: Vec<BTreeMap<u32, u32>>,
}

impl PatchMerging {
    fn new(grid: &ClassGrid, patches: &ClassPatches) -> Self {
        let count = patches.classes.len();
        let mut borders = vec![BTreeMap::new(); count];
        for (cell, &patch) in patches.patch_of.iter().enumerate() {
            for beside in grid.beside(cell) {
                let other = patches.patch_of[beside];
                if other != patch {
                    *borders[patch as usize].entry(other).or_default() += 1;
                }
            }
        }
        let parent = (0..count as u32).collect();
        Self { parent, class: patches.classes.clone(), size: patches.sizes.clone(), borders }
    }

    fn root(&mut self, patch: u32) -> u32 {
        let mut root = patch;
        while self.parent[root as usize] != root {
            let above = self.parent[self.parent[root as usize] as usize];
            self.parent[root as usize] = above;
            root = above;
        }
        root
    }

    /// The borders of a patch by its neighbors of now.
    fn current_borders(&mut self, patch: u32) -> BTreeMap<u32, u32> {
        let mut borders = BTreeMap::new();
        for (other, length) in std::mem::take(&mut self.borders[patch as usize]) {
            let other = self.root(other);
            if other != patch {
                *borders.entry(other).or_default() += length;
            }
        }
        borders
    }

    fn longest_neighbor(&mut self, patch: u32) -> Option<u32> {
        let borders = self.current_borders(patch);
        let longest = borders
            .iter()
            .max_by_key(|(other, length)| (**length, self.size[**other as usize], Reverse(**other)));
        let longest = longest.map(|(other, _)| *other);
        self.borders[patch as usize] = borders;
        longest
    }

    /// Merges a patch into its neighbor, which keeps its class, and with it those neighbors of the patch that have that class;
    /// returns what they are together.
    fn merge(&mut self, patch: u32, into: u32) -> u32 {
        let class = self.class[into as usize];
        let alike: Vec<u32> = self.borders[patch as usize]
            .keys()
            .copied()
            .filter(|other| *other != into && self.class[*other as usize] == class)
            .collect();
        self.class[patch as usize] = class;
        alike.into_iter().fold(self.joined(into, patch), |joined, other| self.joined(joined, other))
    }

    /// Makes two patches of one class one: the one with fewer neighbors goes into the other.
    fn joined(&mut self, one: u32, other: u32) -> u32 {
        let neighbors = |patch: u32| self.borders[patch as usize].len();
        let (from, into) = if neighbors(one) < neighbors(other) { (one, other) } else { (other, one) };
        self.parent[from as usize] = into;
        self.size[into as usize] += self.size[from as usize];
        let borders = std::mem::take(&mut self.borders[from as usize]);
        for (neighbor, length) in borders {
            if neighbor != into {
                *self.borders[into as usize].entry(neighbor).or_default() += length;
            }
        }
        into
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sieved(width: u32, cells: &[u8], least: u32) -> Vec<u8> {
        let mut grid = ClassGrid::new(width, cells.to_vec());
        sieve(&mut grid, least);
        grid.cells().to_vec()
    }

    #[test]
    fn a_speck_goes_to_the_neighbor_with_the_longest_border() {
        let cells = [1, 1, 1, 2, 1, 3, 3, 2, 1, 1, 1, 2];
        assert_eq!(sieved(4, &cells, 3), [1, 1, 1, 2, 1, 1, 1, 2, 1, 1, 1, 2]);
        assert_eq!(sieved(4, &cells, 2), cells, "two cells are as many as two");
    }

    #[test]
    fn a_speck_between_two_patches_of_a_class_joins_them() {
        // The two patches of 1 have four cells each, and ten with what parts them.
        let cells = [[1, 1, 2, 1, 1], [1, 1, 2, 1, 1], [5; 5], [5; 5]];
        let joined = [[1; 5], [1; 5], [5; 5], [5; 5]];
        assert_eq!(sieved(5, cells.as_flattened(), 6), joined.as_flattened());
    }

    proptest! {
        #[test]
        fn no_patch_is_smaller_than_asked_and_no_class_is_new(
            width in 1u32..14, cells in proptest::collection::vec(0..4u8, 14..170), least in 1u32..12,
        ) {
            let rows = cells.len() / width as usize;
            let cells = &cells[..rows * width as usize];
            let after = sieved(width, cells, least);
            let patches = ClassPatches::of(&ClassGrid::new(width, after.clone()));
            prop_assert!(patches.sizes.len() == 1 || patches.sizes.iter().all(|size| *size >= least));
            prop_assert!(after.iter().all(|class| cells.contains(class)));
            prop_assert_eq!(patches.sizes.iter().sum::<u32>() as usize, cells.len());
            prop_assert_eq!(sieved(width, &after, least), after);
        }
    }
}
