//! What symbols have taken of a picture, and free places for more: near their place first, then anywhere, ring by ring.

use glam::{IVec2, Vec2};

use crate::occupied::{OccupiedShape, OccupiedSheet};
use crate::pixel_box::{PixelBox, PixelSegment};
use crate::symbol_stack::{PreparedStack, StackPosition, Standing};

/// Long leaders are kept in pieces of this many pixels, so that a query examines few of them.
const PIECE_PX: f32 = 64.0;
/// The least distance of positions that are tried, in pixels.
const LEAST_STEP_PX: f32 = 5.0;

/// What is taken on the picture.
pub(crate) struct SymbolField {
    bounds: PixelBox,
    taken: OccupiedSheet,
    cover: CoveredCells,
    /// Between symbols.
    gap: f32,
    /// Sizes for which no place was free by each rule: more is taken since.
    too_large: [Vec<Vec2>; 2],
    /// The square pixels that symbols cover.
    covered: f32,
}

/// Where leaders may lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LeaderRule {
    /// On free ground alone.
    Free,
    /// Also under symbols, where a place has no other way out.
    Under,
}

impl SymbolField {
    /// A picture of which `furniture` is taken; symbols keep `gap` pixels from it and from each other.
    pub fn new(bounds: PixelBox, furniture: &[PixelBox], gap: f32) -> Self {
        let mut taken = OccupiedSheet::new(&bounds);
        let mut cover = CoveredCells::new(&bounds);
        for area in furniture {
            taken.add(OccupiedShape::Box(*area), 0);
            cover.cover(area);
        }
        Self { bounds, taken, cover, gap, too_large: [Vec::new(), Vec::new()], covered: 0.0 }
    }

    /// The part of the picture that symbols cover, 0..=1.
    pub fn covered_share(&self) -> f32 {
        let size = self.bounds.size().max(Vec2::ONE);
        self.covered / (size.x * size.y)
    }

    /// Takes the boxes and lines.
    pub fn take(&mut self, boxes: &[PixelBox], lines: impl IntoIterator<Item = PixelSegment>) {
        for area in boxes {
            self.taken.add(OccupiedShape::Box(*area), 0);
            self.cover.cover(area);
            self.covered += area.size().x * area.size().y;
        }
        for piece in lines.into_iter().flat_map(pieces) {
            self.taken.add(OccupiedShape::Leader(piece), 0);
        }
    }

    /// The first free position near a stack's place, if there is one off its own arrows.
    pub fn near(&self, stack: &PreparedStack<'_>) -> Option<StackPosition> {
        let free = || stack.positions().filter(|position| self.is_free_at(stack, position));
        let is_clear = |position: &StackPosition| {
            stack.boxes(position).all(|area| !stack.arrows().any(|arrow| area.meets(&arrow)))
        };
        free().find(is_clear).or_else(|| free().next())
    }

    /// The free position nearest to the place, anywhere on the picture.
    ///
    /// `reach` is how far from its place it may stand, in pixels.
    pub fn anywhere(&mut self, standing: &Standing, leader: LeaderRule, reach: f32) -> Option<StackPosition> {
        let size = standing.bounds().size();
        if self.is_too_large(size, leader) {
            return None;
        }
        let step = (size.min_element() * 0.5).max(LEAST_STEP_PX);
        let longest = self.bounds.size().max_element();
        let rings = (longest.min(reach) / step).ceil() as i32 + 1;
        let around = standing.bounds();
        let feet = PixelBox { min: self.bounds.min - around.min, max: self.bounds.max - around.max };
        let mut has_room = false;
        let mut places = Vec::new();
        for ring in 0..=rings {
            fill_ring(ring, &mut places);
            for offset in &places {
                let foot = (standing.anchor + offset.as_vec2() * step).round();
                if !feet.contains(foot)
                    || !standing.boxes.iter().all(|area| self.is_free(area.moved(foot), leader))
                {
                    continue;
                }
                has_room = true;
                let passes = |position: &StackPosition| {
                    leader == LeaderRule::Under || position.staff.is_none_or(|staff| self.passes(staff))
                };
                if let Some(position) = standing.at(foot).filter(passes) {
                    return Some(position);
                }
            }
        }
        if !has_room && reach >= longest {
            self.too_large[leader as usize].push(size);
        }
        None
    }

    /// Whether a search by the same rule has shown that nothing of this size has room.
    pub fn is_too_large(&self, size: Vec2, leader: LeaderRule) -> bool {
        self.too_large[leader as usize].iter().any(|known| known.cmple(size).all())
    }

    fn is_free_at(&self, stack: &PreparedStack<'_>, position: &StackPosition) -> bool {
        stack.boxes(position).all(|area| self.is_free(area, LeaderRule::Free))
            && position.staff.is_none_or(|staff| self.passes(staff))
    }

    fn is_free(&self, area: PixelBox, leader: LeaderRule) -> bool {
        let spaced = area.grown(self.gap);
        self.bounds.holds(&area)
            && !self.cover.is_covered(area.center())
            && !self.taken.near(&spaced).any(|mark| match mark.shape {
                OccupiedShape::Box(taken) => taken.overlaps(&spaced),
                OccupiedShape::Leader(line) => leader == LeaderRule::Free && area.meets(&line),
            })
    }

    /// Whether a leader meets no box.
    fn passes(&self, leader: PixelSegment) -> bool {
        pieces(leader).all(|piece| {
            let around = PixelBox { min: piece.from.min(piece.to), max: piece.from.max(piece.to) };
            !self.taken.near(&around).any(|mark| match mark.shape {
                OccupiedShape::Box(taken) => taken.meets(&piece),
                OccupiedShape::Leader(_) => false,
            })
        })
    }
}

/// Fills `places` with the steps from the middle to the places of a square ring: the nearest first, those above before those below.
fn fill_ring(ring: i32, places: &mut Vec<IVec2>) {
    places.clear();
    if ring == 0 {
        places.push(IVec2::ZERO);
        return;
    }
    for along in 0..=ring {
        // Places on an axis and at a corner are on two sides.
        let (is_off_axis, is_corner) = (along > 0, along == ring);
        places.push(IVec2::new(along, -ring));
        if is_off_axis {
            places.push(IVec2::new(-along, -ring));
        }
        if !is_corner {
            places.push(IVec2::new(ring, -along));
            places.push(IVec2::new(-ring, -along));
            if is_off_axis {
                places.push(IVec2::new(ring, along));
                places.push(IVec2::new(-ring, along));
            }
        }
        places.push(IVec2::new(along, ring));
        if is_off_axis {
            places.push(IVec2::new(-along, ring));
        }
    }
}

/// Which small cells of a picture symbols cover: most places are known not to be free without a look at the boxes.
struct CoveredCells {
    corner: Vec2,
    columns: usize,
    cells: Vec<bool>,
}

impl CoveredCells {
    const SIDE_PX: f32 = 6.0;

    fn new(bounds: &PixelBox) -> Self {
        let size = (bounds.size().max(Vec2::ZERO) / Self::SIDE_PX).ceil();
        let (columns, rows) = (size.x as usize, size.y as usize);
        Self { corner: bounds.min, columns, cells: vec![false; columns * rows] }
    }

    /// Cells wholly in `area` are covered.
    fn cover(&mut self, area: &PixelBox) {
        let rows = self.cells.len().checked_div(self.columns).unwrap_or(0);
        let cell = |at: Vec2| (at - self.corner) / Self::SIDE_PX;
        let (low, high) = (cell(area.min).ceil().max(Vec2::ZERO), cell(area.max).floor().max(Vec2::ZERO));
        let (right, bottom) = ((high.x as usize).min(self.columns), (high.y as usize).min(rows));
        for row in low.y as usize..bottom {
            for column in low.x as usize..right {
                self.cells[row * self.columns + column] = true;
            }
        }
    }

    fn is_covered(&self, at: Vec2) -> bool {
        let cell = (at - self.corner) / Self::SIDE_PX;
        let (column, row) = (cell.x as usize, cell.y as usize);
        column < self.columns && self.cells.get(row * self.columns + column).is_some_and(|covered| *covered)
    }
}

fn pieces(line: PixelSegment) -> impl Iterator<Item = PixelSegment> {
    let reach = line.to - line.from;
    let length = reach.length();
    let count = if length.is_finite() { (length / PIECE_PX).ceil().max(1.0) } else { 0.0 };
    let at = move |share: f32| line.from + reach * share;
    (0..count as u32).map(move |piece| {
        let (from, to) = (piece as f32 / count, (piece + 1) as f32 / count);
        PixelSegment { from: at(from), to: if piece + 1 == count as u32 { line.to } else { at(to) } }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_holds_each_of_its_places_once_the_nearest_first() {
        for ring in 0..6 {
            let mut offsets = Vec::new();
            fill_ring(ring, &mut offsets);
            assert_eq!(offsets.len() as i32, (8 * ring).max(1));
            assert!(offsets.iter().all(|at| at.abs().max_element() == ring));
            assert!(offsets.is_sorted_by_key(|at| at.length_squared()));
            let mut unique: Vec<[i32; 2]> = offsets.iter().map(IVec2::to_array).collect();
            unique.sort_unstable();
            unique.dedup();
            assert_eq!(unique.len(), offsets.len());
        }
    }

    #[test]
    fn the_nearest_free_place_is_found_however_far_and_a_full_picture_has_none() {
        let bounds = PixelBox::at(Vec2::ZERO, Vec2::new(400.0, 300.0));
        let wall = PixelBox::at(Vec2::ZERO, Vec2::new(300.0, 300.0));
        let mut field = SymbolField::new(bounds, &[wall], 2.0);
        let standing = Standing {
            anchor: Vec2::new(20.0, 150.0),
            boxes: vec![PixelBox::around(Vec2::ZERO, Vec2::splat(10.0))],
            face: PixelBox::around(Vec2::ZERO, Vec2::splat(10.0)),
            ends_at_foot: false,
            may_cover_anchor: false,
        };
        assert!(
            field.anywhere(&standing, LeaderRule::Free, f32::INFINITY).is_none(),
            "the leader would pass under the wall"
        );
        let found = field.anywhere(&standing, LeaderRule::Under, f32::INFINITY).expect("a quarter is free");
        assert!((312.0..330.0).contains(&found.foot.x), "{found:?}");
        field.take(&[PixelBox::at(Vec2::new(300.0, 0.0), Vec2::new(100.0, 300.0))], []);
        assert!(field.anywhere(&standing, LeaderRule::Under, f32::INFINITY).is_none());
        let is_too_large = |side: f32| field.is_too_large(Vec2::splat(side), LeaderRule::Under);
        assert!(is_too_large(20.0) && !is_too_large(19.0));
    }
}
