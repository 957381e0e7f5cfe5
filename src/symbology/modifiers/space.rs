//! Sector 1 and sector 2 modifiers of spacecraft.

use crate::entities::entity::{SymbolEntity, entity};

/// Above the icon.
pub(super) const SECTOR_1: &[SymbolEntity] = &[
    entity(1, "low earth orbit (LEO)", "text 25 100,69 LEO"),
    entity(2, "medium earth orbit (MEO)", "text 25 100,69 MEO"),
    entity(3, "high earth orbit (HEO)", "text 25 100,69 HEO"),
    entity(4, "geosynchronous orbit (GSO)", "text 25 100,69 GSO"),
    entity(5, "geostationary orbit (GO)", "text 28 100,68.5 GO"),
    entity(6, "molniya orbit (MO)", "text 28 100,68.5 MO"),
    entity(7, "cyberspace", "text 25 100,69 CYB"),
];

/// Below it.
pub(super) const SECTOR_2: &[SymbolEntity] = &[
    entity(1, "optical", "text 28 100,131.5 O"),
    entity(2, "infrared", "text 28 100,131.5 IR"),
    entity(3, "radar", "text 28 100,131.5 R"),
    entity(4, "signals intelligence (SIGINT)", "text 28 100,131.5 SI"),
    entity(5, "cyberspace", "text 25 100,132 CYB"),
    entity(6, "electromagnetic warfare (anti-satellite)", "text 28 100,131.5 EW"),
    entity(7, "high power microwave", "text 25 100,132 HPM"),
    entity(
        8,
        "laser",
        "M130,129 L113,129 L110,136 L107,123 L103,136 L99.9,123 L96.5,129 L86.6,129 L83.3,136 L80,123 L76.7,136 \
         L73.4,123 L70.1,136 M123,123 L130,129 L123,136",
    ),
    entity(
        9,
        "mine",
        "solid M111,133 C111,137 106,139 100,139 C93.7,139 88.6,137 88.6,133 C88.6,131 93.7,128 100,128 C106,128 \
         111,131 111,133 Z M109,122 L91.5,145 M91.5,122 L109,145 M100,122 L100,145",
    ),
    entity(
        10,
        "maintenance",
        "M75,125 C83,125 83,141 75,141 M83,133 L118,133 M126,125 C118,125 118,141 126,141",
    ),
    entity(11, "refuel", "text 28 100,131.5 K"),
    entity(12, "tug", "text 25 100,132 TUG"),
];
