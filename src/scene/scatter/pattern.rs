//! A point pattern for scattered models: places over the whole plane, as dense as stated and no nearer to each other
//! than stated.
//!
//! The plane is cut into squares aligned with the map. Each square holds its own few candidates, by the seed and the
//! square's coordinates alone; each candidate has a rank, and stands where no candidate within the spacing ranks higher
//! (Matérn's second hard-core process: Matérn 1960; Stoyan and Stoyan 1994). So whether one stands depends on what is
//! nearer than the spacing and on nothing else: the same tree stands in the same place when the area around it, the
//! elevation model or the order of the tables changes.
//!
//! Of λ candidates a square meter at random, `(1 − exp(−λπs²)) / πs²` stand at a spacing of s; λ is chosen so that this
//! is the density asked for. The formula has an upper bound, 1 / πs²: where the spacing leaves no room for the density,
//! fewer stand.

use std::f64::consts::PI;

use glam::DVec2;

use crate::scatter::chance::Chance;

/// The greatest part of the bound `1 / πs²` that is asked for: nearer to it, most candidates would be made in vain.
const MOST: f64 = 0.95;
/// The most candidates of a square. With one to a square in the mean, of more there are fewer than one in a million.
const MOST_OF_A_SQUARE: usize = 9;

/// A pattern of places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointPattern {
    seed: u64,
    spacing_m: f64,
    side_m: f64,
    density: f64,
    is_crowded: bool,
}

/// A place where something may stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatternPoint {
    /// Map coordinates.
    pub at: DVec2,
    /// Who gives way.
    rank: u64,
    /// From which its looks are drawn.
    pub fate: u64,
}

impl PointPattern {
    /// A pattern of `density` places to the square meter, no two nearer than `spacing_m`; as many as that leaves room
    /// for.
    pub fn new(seed: u64, density: f64, spacing_m: f64) -> Self {
        let disc = PI * spacing_m * spacing_m;
        let (asked, density) = (density, density.min(MOST / disc));
        // For spacings that take hardly anything the logarithm is its argument.
        let candidates = if disc * density < 1e-9 { density } else { -libm::log1p(-disc * density) / disc };
        Self { seed, spacing_m, side_m: 1.0 / candidates.sqrt(), density, is_crowded: density < asked }
    }

    /// The number of places to the square meter.
    pub fn density(&self) -> f64 {
        self.density
    }

    /// Whether the spacing leaves no room for the stated density.
    pub fn is_crowded(&self) -> bool {
        self.is_crowded
    }

    /// The side of a square in meters; never less than the spacing.
    pub fn side_m(&self) -> f64 {
        self.side_m
    }

    /// The places in a square, by its column and row.
    pub fn places(&self, square: (i64, i64)) -> impl Iterator<Item = PatternPoint> + '_ {
        self.candidates(square).filter(move |candidate| self.stands(candidate, square))
    }

    fn stands(&self, candidate: &PatternPoint, (column, row): (i64, i64)) -> bool {
        let around = (-1..=1).flat_map(move |north| (-1..=1).map(move |east| (column + east, row + north)));
        self.spacing_m == 0.0
            || around.flat_map(|square| self.candidates(square)).all(|other| {
                other.rank <= candidate.rank || other.at.distance(candidate.at) >= self.spacing_m
            })
    }

    /// One in the mean, as many as chance has it: a Poisson number, by the inverse of its distribution.
    fn candidates(&self, (column, row): (i64, i64)) -> impl Iterator<Item = PatternPoint> + use<> {
        let mut chance = Chance::of(self.seed, (column, row));
        let (drawn, mut below, mut each, mut count) = (chance.part(), 0.0, libm::exp(-1.0), 0);
        while count < MOST_OF_A_SQUARE {
            below += each;
            if drawn < below {
                break;
            }
            count += 1;
            each /= count as f64;
        }
        let (corner, side_m) = (DVec2::new(column as f64, row as f64), self.side_m);
        (0..count).map(move |_| PatternPoint {
            at: (corner + DVec2::new(chance.part(), chance.part())) * side_m,
            rank: chance.number(),
            fate: chance.number(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(pattern: &PointPattern, side: i64) -> Vec<DVec2> {
        let squares = (0..side).flat_map(|row| (0..side).map(move |column| (column, row)));
        squares.flat_map(|square| pattern.places(square).map(|place| place.at).collect::<Vec<_>>()).collect()
    }

    #[test]
    fn it_is_as_dense_as_asked_and_keeps_its_distance() {
        for (density, spacing_m) in [(0.01, 5.0), (0.01, 0.0), (0.01, 9.0), (4.0, 0.25), (1e-6, 300.0)] {
            let pattern = PointPattern::new(3, density, spacing_m);
            let side = 150;
            let found = places(&pattern, side);
            let area = (side as f64 * pattern.side_m()).powi(2);
            let there = found.len() as f64 / area;
            assert!((there / pattern.density() - 1.0).abs() < 0.03, "{there} of {density} at {spacing_m}");
            assert!(spacing_m == 9.0 || pattern.density() == density);
            assert!(pattern.side_m() >= spacing_m);
            // Neighbors come in the order of their squares, so a window of two rows holds them all.
            for (index, a) in found.iter().enumerate() {
                let next = &found[index + 1..(index + 3 * side as usize).min(found.len())];
                assert!(next.iter().all(|b| a.distance(*b) >= spacing_m));
            }
        }
    }

    #[test]
    fn spacing_that_leaves_no_room_takes_from_the_density() {
        let pattern = PointPattern::new(0, 0.01, 20.0);
        assert!((pattern.density() - 0.95 / (PI * 400.0)).abs() < 1e-12 && pattern.is_crowded());
    }

    #[test]
    fn another_seed_is_another_pattern() {
        let [a, b] = [1, 2].map(|seed| places(&PointPattern::new(seed, 0.01, 5.0), 20));
        assert!(a.iter().all(|place| !b.contains(place)));
    }
}
