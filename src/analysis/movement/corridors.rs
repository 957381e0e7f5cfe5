//! Mobility corridors: how wide the ground is on which movement is not restricted, by echelon (FM 34-130, ATP 2-01.3).
//!
//! A post belongs to a corridor of a width where a disk as wide holds it and no restricted ground: the opening of the
//! unrestricted ground, from two exact distance transforms (Felzenszwalb and Huttenlocher 2012).

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::Land;
use crate::measures::{area_km2, post_grid};
use crate::movement::going::{Going, RESTRICTED, UNRESTRICTED};
use crate::movement::vehicle::Vehicle;
use crate::outcome::{Figure, Hatching, Outcome, OutcomeRaster, PostValues, ValueClass};
use sandtable_base::limits::memory::check_memory;
use sandtable_geom::distance_field::{RegionGrid, distances_m};
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::stop_flag::StopFlag;

/// The most widths.
const MOST_WIDTHS: usize = 8;

/// The echelons of the default widths.
const ECHELONS: [(f64, &str); 3] = [(1500.0, "battalion"), (3000.0, "brigade"), (6000.0, "division")];

/// The tints of corridors, from narrow to wide.
const TINTS: [[u8; 4]; 4] =
    [[255, 237, 160, 90], [161, 218, 180, 100], [65, 182, 196, 110], [34, 94, 168, 110]];

/// The ground that counts as free in a corridor.
pub(crate) struct FreeGround {
    /// The distance from each post to the nearest that is not free, meters; infinite where there is none.
    free_m: Vec<f64>,
    grid: RegionGrid,
}

impl FreeGround {
    /// Posts of these codes that the argument `through` allows.
    pub fn new(ground: &Lattice, codes: &[u8], arguments: &AnalysisArguments) -> Result<Self, AnalysisError> {
        check_memory(codes.len() as u64 * 28, "the analysis", "name a smaller `extent`")?;
        let greatest = if arguments.word("through") == "restricted" { RESTRICTED } else { UNRESTRICTED };
        let is_free: Vec<bool> = codes.iter().map(|&code| code <= greatest).collect();
        let grid = post_grid(ground);
        Ok(Self { free_m: distances_m(&is_free, grid), grid })
    }

    /// Half a cell: what is not free begins half a cell before its post.
    fn half_cell_m(&self) -> f64 {
        self.grid.step_m[0].max(self.grid.step_m[1]) / 2.0
    }

    /// The width of the free ground around a post, meters: that of a free disk which holds it, found by climbing the
    /// distances from the post on for as long as the disk holds it. 0 where the post is not free, infinite where nothing
    /// limits it.
    pub fn width_at_m(&self, index: usize) -> f64 {
        let free_m = &self.free_m;
        let columns = self.grid.columns;
        let rows = free_m.len() / columns;
        let offset_m = |one: usize, other: usize| {
            let along = (one % columns).abs_diff(other % columns) as f64 * self.grid.step_m[0];
            libm::hypot(along, (one / columns).abs_diff(other / columns) as f64 * self.grid.step_m[1])
        };
        let mut center = index;
        loop {
            let (column, row) = (center % columns, center / columns);
            let mut next = center;
            for row in row.saturating_sub(1)..=(row + 1).min(rows - 1) {
                for column in column.saturating_sub(1)..=(column + 1).min(columns - 1) {
                    let other = row * columns + column;
                    if free_m[other] > free_m[next] && offset_m(other, index) < free_m[other] {
                        next = other;
                    }
                }
            }
            if next == center || free_m[index] == 0.0 {
                return (2.0 * (free_m[center] - self.half_cell_m())).max(0.0);
            }
            center = next;
        }
    }

    /// Which posts lie in a free disk of this width.
    fn opened(&self, width_m: f64) -> Vec<bool> {
        let radius_m = width_m / 2.0 + self.half_cell_m();
        // Rounding of distances must not close ground that is exactly as wide.
        let is_no_center: Vec<bool> =
            self.free_m.iter().map(|&free| free < radius_m * (1.0 - 1e-9)).collect();
        let to_center = distances_m(&is_no_center, self.grid);
        to_center.iter().map(|&distance| distance < radius_m * (1.0 - 1e-6)).collect()
    }
}

/// The widest corridor that holds each post: 0 none, 1 for the first width and on; no data where the ground has none.
///
/// # Errors
/// `vehicle`, `widths_m`, and memory.
pub(crate) fn corridors(
    land: &Land,
    arguments: &AnalysisArguments,
    stop: &StopFlag,
) -> Result<Outcome, AnalysisError> {
    let widths = arguments.rising_numbers("widths_m", MOST_WIDTHS)?;
    let vehicle = Vehicle::named(land, &arguments.word("vehicle"))?;
    let Going { mut codes, notes, .. } = Going::new(land, &vehicle)?;
    let free = FreeGround::new(&land.ground, &codes, arguments)?;
    codes.iter_mut().filter(|code| **code != PostValues::NO_CODE).for_each(|code| *code = 0);
    let mut figures = Vec::new();
    for (index, &width_m) in widths.iter().enumerate() {
        if stop.is_stopped() {
            return Err(AnalysisError::Stopped);
        }
        let mut posts = 0usize;
        for (code, is_open) in codes.iter_mut().zip(free.opened(width_m)) {
            if is_open && *code != PostValues::NO_CODE {
                *code = index as u8 + 1;
                posts += 1;
            }
        }
        figures.push(Figure::new(
            format!("corridors of {}", width_label(width_m)),
            area_km2(&land.ground, posts),
            "km²",
        ));
    }
    let raster = OutcomeRaster {
        name: "corridors",
        unit: "",
        values: PostValues::Codes(codes),
        classes: classes(&widths),
    };
    Ok(Outcome { raster: Some(raster), figures, notes, ..Outcome::default() })
}

/// `1500 m (battalion)`.
fn width_label(width_m: f64) -> String {
    match ECHELONS.iter().find(|&&(least_m, _)| least_m == width_m) {
        Some((_, echelon)) => format!("{width_m} m ({echelon})"),
        None => format!("{width_m} m"),
    }
}

/// The largest echelon for which a width is enough; empty where it is for none.
pub(crate) fn echelon(width_m: f64) -> &'static str {
    ECHELONS.iter().rev().find(|&&(least_m, _)| width_m >= least_m).map_or("", |&(_, echelon)| echelon)
}

fn classes(widths: &[f64]) -> Vec<ValueClass> {
    let none = ValueClass::new(0.0, "no corridor", [0; 4], Hatching::None);
    let hatchings = [Hatching::Dots, Hatching::Level, Hatching::Single, Hatching::Crossed];
    let class = |(index, &width_m): (usize, &f64)| {
        let label = format!("{} and wider", width_label(width_m));
        let (tint, hatching) = (TINTS[index % TINTS.len()], hatchings[index % hatchings.len()]);
        ValueClass::new((index + 1) as f32, label, tint, hatching)
    };
    std::iter::once(none).chain(widths.iter().enumerate().map(class)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arguments::ArgumentValue;
    use crate::land::LandCover;
    use crate::run::run;
    use crate::test_land::{codes_of, flat, swamp};

    fn codes(land: &Land, widths: &[f64]) -> Vec<u8> {
        let kind = sandtable_catalog::kind("corridors").expect("a kind");
        let arguments =
            AnalysisArguments::new(kind).with("widths_m", ArgumentValue::Numbers(widths.to_vec()));
        codes_of(run(land, &arguments, &StopFlag::default()).expect("sound"))
    }

    #[test]
    fn a_band_of_five_posts_is_a_corridor_of_five_cells_and_no_more() {
        let mut land = flat(9, 30, 100.0);
        swamp(&mut land, |column, _| !(2..7).contains(&column));
        for (width_m, code) in [(499.0, 1), (500.0, 1), (501.0, 0)] {
            let found = codes(&land, &[width_m]);
            let row = &found[15 * 9..16 * 9];
            assert_eq!(row, [0, 0, code, code, code, code, code, 0, 0], "{width_m}");
        }
    }

    #[test]
    fn every_post_of_a_corridor_lies_in_a_free_disk_of_its_width() {
        let mut land = flat(30, 30, 10.0);
        let cover: Vec<LandCover> = (0..900usize)
            .map(|index| {
                if (index * 7919 + index * index * 31) % 47 == 0 {
                    LandCover::Wetland
                } else {
                    LandCover::Open
                }
            })
            .collect();
        let at = |index: usize| [(index % 30) as f64 * 10.0, (index / 30) as f64 * 10.0];
        let distance =
            |one: usize, other: usize| libm::hypot(at(one)[0] - at(other)[0], at(one)[1] - at(other)[1]);
        land.cover = Some(cover.clone());
        let found = codes(&land, &[20.0, 50.0]);
        let is_in = |post: usize, radius: f64| {
            (0..900).any(|center| {
                distance(center, post) < radius - 1e-4
                    && (0..900).all(|other| {
                        cover[other] == LandCover::Open || distance(center, other) >= radius - 1e-6
                    })
            })
        };
        for (post, &found) in found.iter().enumerate() {
            let code = if is_in(post, 30.0) { 2 } else { u8::from(is_in(post, 15.0)) };
            assert_eq!(found, code, "{post}");
        }
        assert!([0, 1, 2].iter().all(|code| found.contains(code)));
    }
}
