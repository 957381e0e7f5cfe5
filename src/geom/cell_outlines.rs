//! The outlines of cells of a grid, exact along their edges: rasters of classes as polygons with holes.
//!
//! ```text
//!  ██░░      the boundary of cells runs with them on its left; where two cells touch at a corner alone, it turns
//!  ░░██      so that no outline crosses or touches itself
//! ```

use std::collections::BTreeMap;

use glam::IVec2;

/// A connected part of the cells: its outline counter-clockwise, and its holes clockwise, in corners of cells, X right and Y up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellOutline {
    /// The outer ring, not closed.
    pub exterior: Vec<IVec2>,
    /// The holes, not closed.
    pub holes: Vec<Vec<IVec2>>,
}

/// The parts of the cells for which `is_inside` holds, of a grid of so many columns and rows, in the order of their first cell; cells
/// that share an edge are of one part.
pub fn cell_outlines(
    columns: usize,
    rows: usize,
    is_inside: impl Fn(usize, usize) -> bool,
) -> Vec<CellOutline> {
    let labels = labels(columns, rows, &is_inside);
    let label = |x: i32, y: i32| {
        let (x, y) = (usize::try_from(x).ok()?, usize::try_from(y).ok()?);
        (x < columns && y < rows).then(|| labels[y * columns + x]).filter(|label| *label > 0)
    };
    // Edges by their start, each with the cell's part on its left.
    let mut edges: BTreeMap<(i32, i32), Vec<(IVec2, usize)>> = BTreeMap::new();
    for y in 0..rows as i32 {
        for x in 0..columns as i32 {
            let Some(part) = label(x, y) else { continue };
            let sides = [
                (IVec2::new(x, y), IVec2::X, label(x, y - 1)),
                (IVec2::new(x + 1, y), IVec2::Y, label(x + 1, y)),
                (IVec2::new(x + 1, y + 1), IVec2::NEG_X, label(x, y + 1)),
                (IVec2::new(x, y + 1), IVec2::NEG_Y, label(x - 1, y)),
            ];
            for (from, along, other) in sides {
                if other.is_none() {
                    edges.entry((from.y, from.x)).or_default().push((along, part));
                }
            }
        }
    }
    let mut parts: BTreeMap<usize, CellOutline> = BTreeMap::new();
    while let Some(ring) = next_ring(&mut edges) {
        let (corners, part) = ring;
        let outline =
            parts.entry(part).or_insert_with(|| CellOutline { exterior: Vec::new(), holes: Vec::new() });
        if doubled_area(&corners) > 0 {
            outline.exterior = corners;
        } else {
            outline.holes.push(corners);
        }
    }
    parts.into_values().collect()
}

/// Takes a ring off the edges; `None` where none is left.
fn next_ring(edges: &mut BTreeMap<(i32, i32), Vec<(IVec2, usize)>>) -> Option<(Vec<IVec2>, usize)> {
    let (&(y, x), leaving) = edges.iter().next()?;
    let start = IVec2::new(x, y);
    let (_, part) = *leaving.first()?;
    let mut at = start;
    let mut corners: Vec<IVec2> = Vec::new();
    let mut before = IVec2::ZERO;
    loop {
        let key = (at.y, at.x);
        let leaving = edges.get_mut(&key)?;
        // At a corner where a part touches itself, the turn to the right parts an outline from a hole.
        let turn = |direction: IVec2| before.perp_dot(direction);
        let index = (0..leaving.len())
            .filter(|&index| leaving[index].1 == part)
            .min_by_key(|&index| if before == IVec2::ZERO { 0 } else { turn(leaving[index].0) })?;
        let (along, _) = leaving.swap_remove(index);
        if leaving.is_empty() {
            edges.remove(&key);
        }
        if along != before {
            corners.push(at);
        }
        before = along;
        at += along;
        if at == start {
            // The start is a corner unless the ring goes straight through it.
            if corners.len() > 1
                && corners[1] - corners[0] != IVec2::ZERO
                && direction(corners[0], corners[1]) == along
            {
                corners.remove(0);
            }
            return Some((corners, part));
        }
    }
}

fn direction(from: IVec2, to: IVec2) -> IVec2 {
    (to - from).signum()
}

fn doubled_area(ring: &[IVec2]) -> i64 {
    let cross = |a: IVec2, b: IVec2| i64::from(a.x) * i64::from(b.y) - i64::from(b.x) * i64::from(a.y);
    (0..ring.len()).map(|index| cross(ring[index], ring[(index + 1) % ring.len()])).sum()
}

/// Numbers from 1 of the parts of the cells inside, 0 for those outside.
fn labels(columns: usize, rows: usize, is_inside: &impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let mut labels = vec![0; columns * rows];
    let inside: Vec<bool> =
        (0..columns * rows).map(|cell| is_inside(cell % columns, cell / columns)).collect();
    let (mut parts, mut open) = (0, Vec::new());
    for first in 0..inside.len() {
        if !inside[first] || labels[first] > 0 {
            continue;
        }
        parts += 1;
        labels[first] = parts;
        open.push(first);
        while let Some(cell) = open.pop() {
            let (x, y) = (cell % columns, cell / columns);
            let neighbors = [
                (x > 0).then(|| cell - 1),
                (x + 1 < columns).then_some(cell + 1),
                (y > 0).then(|| cell - columns),
                (y + 1 < rows).then_some(cell + columns),
            ];
            for next in neighbors.into_iter().flatten() {
                if inside[next] && labels[next] == 0 {
                    labels[next] = parts;
                    open.push(next);
                }
            }
        }
    }
    labels
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows from the top.
    fn outlines(rows: &[&str]) -> Vec<CellOutline> {
        let (columns, count) = (rows[0].len(), rows.len());
        cell_outlines(columns, count, |x, y| rows[count - 1 - y].as_bytes()[x] == b'#')
    }

    fn area(outline: &CellOutline) -> i64 {
        let rings = std::iter::once(&outline.exterior).chain(&outline.holes);
        rings.map(|ring| doubled_area(ring)).sum::<i64>() / 2
    }

    #[test]
    fn a_block_is_its_four_corners() {
        let [block] = &outlines(&["....", ".##.", ".##.", "...."])[..] else { panic!("one part") };
        assert_eq!(block.exterior.len(), 4);
        assert_eq!(area(block), 4);
    }

    #[test]
    fn holes_and_islands_in_them_are_told_apart() {
        let parts = outlines(&["#####", "#...#", "#.#.#", "#...#", "#####"]);
        let areas: Vec<i64> = parts.iter().map(area).collect();
        assert_eq!(areas, [16, 1]);
        assert_eq!(
            parts[0].holes,
            [vec![IVec2::new(1, 1), IVec2::new(1, 4), IVec2::new(4, 4), IVec2::new(4, 1)]]
        );
    }

    #[test]
    fn cells_that_touch_at_a_corner_are_parts_of_their_own_and_never_cross() {
        let parts = outlines(&["#.", ".#"]);
        assert_eq!(parts.len(), 2);
        let ring = &outlines(&["###", "#.#", "##."])[0];
        assert_eq!(area(ring), 7);
        let joined = &outlines(&["###", "#.#", ".##"])[0];
        assert_eq!((joined.holes.len(), area(joined)), (1, 7));
    }

    #[test]
    fn areas_add_up_to_the_cells_of_any_raster() {
        let mut state = 1u64;
        for _ in 0..40 {
            let cells: Vec<bool> = (0..17 * 13)
                .map(|_| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                    state >> 62 != 0
                })
                .collect();
            let parts = cell_outlines(17, 13, |x, y| cells[y * 17 + x]);
            assert_eq!(
                parts.iter().map(area).sum::<i64>(),
                cells.iter().filter(|cell| **cell).count() as i64
            );
            assert!(parts.iter().all(|part| doubled_area(&part.exterior) > 0));
            for ring in parts.iter().flat_map(|part| std::iter::once(&part.exterior).chain(&part.holes)) {
                let mut corners: Vec<[i32; 2]> = ring.iter().map(IVec2::to_array).collect();
                corners.sort_unstable();
                assert!(corners.windows(2).all(|pair| pair[0] != pair[1]), "{ring:?}");
            }
        }
    }
}
