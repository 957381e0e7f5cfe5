//! How the ground suits what lands, drops or stays on it: 0 not, 1 with caution, 2 well; and what their surface is like.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::arguments::AnalysisArguments;
use crate::error::AnalysisError;
use crate::land::{Land, LandCover, WaterKind};
use crate::outcome::{Figure, Hatching, OutcomeRaster, PostValues, PropertyValue, ValueClass};
use sandtable_terrain::lattice::Lattice;

/// The greatest height in meters of what may stand on open ground that is used: 18 inches.
pub(crate) const LOW_M: f32 = 0.45;

/// Slopes as tangents: up to `free` without caution, up to `greatest` with it.
#[derive(Clone, Copy)]
pub(crate) struct SuitedSlopes {
    pub free: f32,
    pub greatest: f32,
}

impl SuitedSlopes {
    /// By the arguments `free_slope` and `greatest_slope`.
    ///
    /// # Errors
    /// They are out of order.
    pub fn of(arguments: &AnalysisArguments) -> Result<Self, AnalysisError> {
        let (free, greatest) = (arguments.number("free_slope"), arguments.number("greatest_slope"));
        if free > greatest {
            return Err(AnalysisError::argument(
                "free_slope",
                "is above `greatest_slope`; state a lower one",
            ));
        }
        Ok(Self { free: tangent(free), greatest: tangent(greatest) })
    }
}

/// The tangent of degrees.
pub(crate) fn tangent(degrees: f64) -> f32 {
    libm::tan(degrees.to_radians()) as f32
}

/// The tangent of the slope at each post; raised just above the limit without caution where the post suits with caution by
/// `code`, infinite where it does not or the ground has no data.
pub(crate) fn hindrances(ground: &Lattice, free: f32, code: impl Fn(usize) -> u8 + Sync) -> Vec<f32> {
    let columns = ground.columns() as usize;
    let mut values = vec![f32::INFINITY; ground.heights().len()];
    values.par_chunks_mut(columns).enumerate().for_each(|(row, values)| {
        for (column, (value, slopes)) in values.iter_mut().zip(ground.slopes_of_row(row as u32)).enumerate() {
            let index = row * columns + column;
            if ground.heights()[index].is_nan() {
                continue;
            }
            let slope = slopes.length();
            *value = match code(index) {
                2 => slope,
                1 => slope.max(free.next_up()),
                _ => continue,
            };
        }
    });
    values
}

/// What covers a post.
pub(crate) fn cover_at(land: &Land, index: usize) -> LandCover {
    land.cover.as_ref().map_or(LandCover::Unknown, |cover| cover[index])
}

/// Whether, as far as is known, nothing above [`LOW_M`] stands at a post and no water is there.
pub(crate) fn is_low_and_dry(land: &Land, index: usize) -> bool {
    land.obstacles_m.as_ref().is_none_or(|heights| heights[index] <= LOW_M)
        && land.water.as_ref().is_none_or(|water| water[index].kind == WaterKind::None)
}

/// Whether a post is one of suited ground, with caution or without.
pub(crate) fn is_suited(code: u8) -> bool {
    matches!(code, 1 | 2)
}

/// What the ground of a site is like.
pub(crate) struct SiteSurface {
    /// The steepest slope of its posts, degrees.
    pub slope_deg: f64,
    /// What covers most of it; of equal ones the first in the order of covers.
    pub cover: LandCover,
}

impl SiteSurface {
    /// The surface of these posts.
    pub fn of(land: &Land, posts: impl Iterator<Item = usize>) -> Self {
        let ground = &*land.ground;
        let (mut steepest, mut counts) = (0.0_f32, BTreeMap::<LandCover, usize>::new());
        for index in posts.filter(|&index| !ground.heights()[index].is_nan()) {
            steepest = steepest.max(ground.slopes(ground.post_at(index)).length());
            *counts.entry(cover_at(land, index)).or_default() += 1;
        }
        let most = counts.values().max();
        let cover = counts.iter().find(|(_, count)| Some(*count) == most).map(|(&cover, _)| cover);
        Self { slope_deg: libm::atan(f64::from(steepest)).to_degrees(), cover: cover.unwrap_or_default() }
    }

    /// The noun of its cover as a value.
    pub fn cover_noun(&self) -> PropertyValue {
        PropertyValue::Text(self.cover.noun().to_owned())
    }
}

/// The area of so many posts of suited ground.
pub(crate) fn suited_ground(ground: &Lattice, posts: usize) -> Figure {
    Figure::new("suited ground", posts as f64 * ground.cell_m2() / 1e4, "ha")
}

/// The raster of the codes.
pub(crate) fn code_raster(name: &'static str, codes: Vec<u8>) -> OutcomeRaster {
    let classes = ValueClass::of_rows([
        (0.0, "unsuited", [0, 0, 0, 0], Hatching::None),
        (1.0, CAUTION, [254, 217, 118, 110], Hatching::Dots),
        (2.0, SUITED, [90, 180, 90, 120], Hatching::Single),
    ]);
    OutcomeRaster { name, unit: "", values: PostValues::Codes(codes), classes }
}

const CAUTION: &str = "with caution";
const SUITED: &str = "suited";

/// The name of the class of suited ground.
pub(crate) fn class_name(code: u8) -> &'static str {
    if code == 2 { SUITED } else { CAUTION }
}
