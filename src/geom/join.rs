//! Lines joined end to end where they share an end.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::polyline::{VertexKey, vertex_key};

/// `lines` joined wherever exactly two of them end at one vertex, in either direction; rings stay as they are. The first
/// of joined lines decides the direction. Lines of fewer than two vertices are dropped.
pub fn joined(lines: Vec<Vec<DVec2>>) -> Vec<Vec<DVec2>> {
    let lines: Vec<Vec<DVec2>> = lines.into_iter().filter(|line| line.len() >= 2).collect();
    let ends = |line: &[DVec2]| [line[0], line[line.len() - 1]].map(vertex_key);
    let mut at: BTreeMap<VertexKey, Vec<usize>> = BTreeMap::new();
    for (index, line) in lines.iter().enumerate() {
        ends(line).into_iter().for_each(|end| at.entry(end).or_default().push(index));
    }
    let mut used = vec![false; lines.len()];
    let mut chains = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        if std::mem::replace(&mut used[index], true) {
            continue;
        }
        let mut chain = line.clone();
        // Onward from its end, then, turned round, from its start, and back.
        for _ in 0..2 {
            let mut last = index;
            while let Some(next) = next_at(&at, vertex_key(chain[chain.len() - 1]), last, &used) {
                used[next] = true;
                let mut points = lines[next].clone();
                if vertex_key(points[0]) != vertex_key(chain[chain.len() - 1]) {
                    points.reverse();
                }
                chain.extend_from_slice(&points[1..]);
                last = next;
            }
            chain.reverse();
        }
        chains.push(chain);
    }
    chains
}

/// The line that meets `line` at a vertex, where no third one does.
fn next_at(
    at: &BTreeMap<VertexKey, Vec<usize>>,
    end: VertexKey,
    line: usize,
    used: &[bool],
) -> Option<usize> {
    match at.get(&end)?.as_slice() {
        [a, b] => [*a, *b].into_iter().find(|&other| other != line && !used[other]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(points: &[(f64, f64)]) -> Vec<DVec2> {
        points.iter().map(|&(x, y)| DVec2::new(x, y)).collect()
    }

    #[test]
    fn pieces_of_a_river_become_one_line_in_whatever_order_and_direction() {
        let pieces = vec![
            line(&[(2.0, 0.0), (3.0, 0.0)]),
            line(&[(1.0, 0.0), (0.0, 0.0)]),
            line(&[(1.0, 0.0), (2.0, 0.0)]),
            line(&[(9.0, 9.0)]),
        ];
        let joined = joined(pieces);
        assert_eq!(joined, [line(&[(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (3.0, 0.0)])]);
    }

    #[test]
    fn a_fork_and_a_ring_stay() {
        let fork = vec![
            line(&[(0.0, 0.0), (1.0, 0.0)]),
            line(&[(1.0, 0.0), (2.0, 1.0)]),
            line(&[(1.0, 0.0), (2.0, -1.0)]),
        ];
        assert_eq!(joined(fork.clone()), fork);
        let ring = vec![line(&[(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, 0.0)])];
        assert_eq!(joined(ring.clone()), ring);
    }
}
