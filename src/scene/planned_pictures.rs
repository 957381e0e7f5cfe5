//! The pictures that a scene is built for, which decide how many samples of its elevation are read.

use sandtable_description::document::{CameraTable, Document};
use sandtable_description::words::{CameraProjection, RangeExtent};

/// The samples of the elevation that a scene needs.
#[derive(Clone, Copy, Debug)]
pub enum ElevationNeed<'a> {
    /// All samples, because height queries use them.
    All,
    /// All that fit into the memory, for pictures and meshes that are not known yet.
    AllThatFit,
    /// As many as pictures show, for these and for nothing else.
    Pictures(&'a PlannedPictures),
    /// Means of `step` × `step` of them within the extent of the scene file: a nested ground of a picture.
    Nested {
        /// A power of two.
        step: u32,
    },
}

/// The pictures that a scene is built for.
#[derive(Clone, Debug, Default)]
pub struct PlannedPictures {
    /// What they are seen by.
    pub cameras: PlannedCameras,
    /// Their greatest size, pixels; `None` for that of each camera's paper, of a screen, or of a page in the shape of what is shown.
    pub size: Option<(u32, u32)>,
    /// How they show ground near the eye.
    pub near: NearGround,
}

/// The ground that pictures show near the eye where its samples are too many to be read everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NearGround {
    /// A nested ground, of more samples, in the part of the scene's that needs more samples.
    #[default]
    Nested,
    /// The scene's, which has all samples that fit.
    Whole,
}

/// The cameras of planned pictures.
#[derive(Clone, Debug, Default)]
pub enum PlannedCameras {
    /// The first of the scene.
    #[default]
    First,
    /// The one of this name.
    Named(String),
    /// All.
    All,
    /// None of the scene: plans of any part of the ground whose pixels are so many meters wide.
    Plans(f64),
}

/// Whether one of the pictures is a panorama.
pub(super) fn show_panorama(pictures: &PlannedPictures, document: &Document) -> bool {
    let mut tables = document.cameras.iter();
    let is_panorama = |table: &CameraTable| table.projection == CameraProjection::Panorama;
    match &pictures.cameras {
        PlannedCameras::First => tables.next().is_some_and(is_panorama),
        PlannedCameras::Named(name) => tables.any(|table| *table.name == *name && is_panorama(table)),
        PlannedCameras::All => tables.any(is_panorama),
        PlannedCameras::Plans(_) => false,
    }
}

/// Whether pictures of a scene show heights of places in numbers, or what is seen from a place, which depend on single samples.
pub(super) fn depends_on_samples(document: &Document) -> bool {
    let prints_heights = document.labels.iter().any(|label| label.text.contains("{height}"));
    prints_heights || document.style.spot_heights > 0 || shows_sight(document)
}

/// Whether what is seen from a place shows.
fn shows_sight(document: &Document) -> bool {
    let is_seen = document.ranges.iter().any(|range| range.fill == RangeExtent::Seen);
    is_seen || !document.viewsheds.is_empty() || !document.sights.is_empty()
}
