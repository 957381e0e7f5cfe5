//! The classes of CORINE Land Cover and the covers that they are drawn with.
//!
//! Source: Kosztra, Büttner, Hazeu and Arnold, Updated CLC illustrated nomenclature guidelines, European Environment Agency 2019.
//! Rasters hold the code of three digits, or its number in that list from 1 on.

use super::legend::LandClass;
use sandtable_description::words::Cover;

const fn class(code: u16, name: &'static str, cover: Cover) -> LandClass {
    LandClass { code, name, cover: Some(cover) }
}

const fn water(code: u16, name: &'static str) -> LandClass {
    LandClass { code, name, cover: None }
}

/// The 44 classes in the order of their codes.
pub(super) static CLASSES: [LandClass; 44] = [
    class(111, "Continuous urban fabric", Cover::DenseBuiltUp),
    class(112, "Discontinuous urban fabric", Cover::BuiltUp),
    class(121, "Industrial or commercial units", Cover::Industry),
    class(122, "Road and rail networks and associated land", Cover::Paved),
    class(123, "Port areas", Cover::Industry),
    class(124, "Airports", Cover::Paved),
    class(131, "Mineral extraction sites", Cover::Quarry),
    class(132, "Dump sites", Cover::Quarry),
    class(133, "Construction sites", Cover::Quarry),
    class(141, "Green urban areas", Cover::Meadow),
    class(142, "Sport and leisure facilities", Cover::Meadow),
    class(211, "Non-irrigated arable land", Cover::Field),
    class(212, "Permanently irrigated land", Cover::Field),
    class(213, "Rice fields", Cover::Field),
    class(221, "Vineyards", Cover::Vineyard),
    class(222, "Fruit trees and berry plantations", Cover::Orchard),
    class(223, "Olive groves", Cover::Orchard),
    class(231, "Pastures", Cover::Meadow),
    class(241, "Annual crops associated with permanent crops", Cover::Field),
    class(242, "Complex cultivation patterns", Cover::Field),
    class(
        243,
        "Land principally occupied by agriculture, with significant areas of natural vegetation",
        Cover::Field,
    ),
    class(244, "Agro-forestry areas", Cover::Orchard),
    class(311, "Broad-leaved forest", Cover::Forest),
    class(312, "Coniferous forest", Cover::Forest),
    class(313, "Mixed forest", Cover::Forest),
    class(321, "Natural grasslands", Cover::Meadow),
    class(322, "Moors and heathland", Cover::Heath),
    class(323, "Sclerophyllous vegetation", Cover::Scrub),
    class(324, "Transitional woodland-shrub", Cover::Scrub),
    class(331, "Beaches, dunes, sands", Cover::Sand),
    class(332, "Bare rocks", Cover::Rock),
    class(333, "Sparsely vegetated areas", Cover::Scree),
    class(334, "Burnt areas", Cover::Scrub),
    class(335, "Glaciers and perpetual snow", Cover::Glacier),
    class(411, "Inland marshes", Cover::Wetland),
    class(412, "Peat bogs", Cover::Wetland),
    class(421, "Salt marshes", Cover::Wetland),
    class(422, "Salines", Cover::Wetland),
    class(423, "Intertidal flats", Cover::Sand),
    water(511, "Water courses"),
    water(512, "Water bodies"),
    water(521, "Coastal lagoons"),
    water(522, "Estuaries"),
    water(523, "Sea and ocean"),
];
