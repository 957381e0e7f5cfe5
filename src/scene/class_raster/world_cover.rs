//! The classes of ESA WorldCover and the covers that they are drawn with.
//!
//! Source: Van De Kerchove and others, ESA WorldCover 10 m 2021 v200, Product User Manual v2.0, 2022, table of the land cover
//! classes. Bare or sparse vegetation is drawn as scree, which is what it mostly is where relief is of interest; moss and lichen as
//! heath.

use super::legend::LandClass;
use sandtable_description::words::Cover;

const fn class(code: u16, name: &'static str, cover: Cover) -> LandClass {
    LandClass { code, name, cover: Some(cover) }
}

/// The 11 classes in the order of their values.
pub(super) static CLASSES: [LandClass; 11] = [
    class(10, "Tree cover", Cover::Forest),
    class(20, "Shrubland", Cover::Scrub),
    class(30, "Grassland", Cover::Meadow),
    class(40, "Cropland", Cover::Field),
    class(50, "Built-up", Cover::BuiltUp),
    class(60, "Bare / sparse vegetation", Cover::Scree),
    class(70, "Snow and ice", Cover::Glacier),
    LandClass { code: 80, name: "Permanent water bodies", cover: None },
    class(90, "Herbaceous wetland", Cover::Wetland),
    class(95, "Mangroves", Cover::Wetland),
    class(100, "Moss and lichen", Cover::Heath),
];
