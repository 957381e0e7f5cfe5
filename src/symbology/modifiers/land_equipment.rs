//! Sector 1 and sector 2 modifiers of land equipment.

use crate::entities::entity::{SymbolEntity, entity};

/// Above the icon.
pub(super) const SECTOR_1: &[SymbolEntity] = &[
    entity(1, "biological", "text 28 100,68.5 B"),
    entity(2, "chemical", "text 28 100,68.5 C"),
    entity(3, "early warning radar", "text 25 100,69 EWR"),
    entity(4, "intrusion", "text 28 100,68.5 I"),
    entity(5, "nuclear", "text 28 100,68.5 N"),
    entity(6, "radiological", "text 25 100,69 RAD"),
    entity(7, "upgraded early warning radar", "text 25 100,69 UEW"),
    entity(8, "hijacking/hijacked", "text 28 100,68.5 H"),
    entity(9, "civilian", "text 25 100,69 CIV"),
    entity(10, "tilt-rotor", "text 28 100,68.5 TR"),
    entity(12, "multi-purpose blade", "M80,65 L100,55 L120,65 M100,80 L100,55"),
    entity(
        13,
        "tank-width mine plow",
        "M80,65 L85,62.5 M90,60 L95,57.5 M105,57.5 L110,60 M115,62.5 L120,65 M100,80 L100,60",
    ),
    entity(14, "bridge", "@bridging-above"),
    entity(15, "cyberspace", "text 25 100,69 CYB"),
    entity(16, "armored", "@armored-above"),
    entity(17, "attack", "text 28 100,68.5 A"),
    entity(18, "cargo", "M100,60 L100,75 L85,75 L85,60 L115,60 L115,75 L100,75"),
    entity(19, "maintenance", "@maintenance-above"),
    entity(20, "medevac", "@medevac-above"),
    entity(21, "petroleum, oil, and lubricants (POL)", "@m1-petroleum"),
    entity(22, "utility", "text 28 100,68.5 U"),
    entity(23, "water", "@water-above"),
    entity(
        24,
        "robotic",
        "fill M100,52.8 L115,67.6 L116.4,67.2 L117.6,67.4 L118.6,68.4 L119,69.8 L117.6,72.2 L115.2,72.2 L113.8,70.8 \
         L113.8,68.8 L103.4,63.6 L101,72.2 L102.4,73.4 L102.6,75.6 L101.6,77 L100,77.4 L98.4,76.8 L97.4,75.4 \
         L97.6,73.4 L99.2,72.2 L96.6,63.6 L86.2,68.8 L86.2,70.8 L84.8,72.2 L82.4,72.2 L81.4,71.2 L81,69.8 \
         L81.4,68.4 L82.4,67.4 L83.6,67 L85,67.4 Z",
    ),
];

/// Below it.
pub(super) const SECTOR_2: &[SymbolEntity] = &[
    entity(1, "cyberspace", "text 25 100,132 CYB"),
    entity(2, "light", "text 28 100,131.5 L"),
    entity(3, "medium", "text 28 100,131.5 M"),
    entity(4, "railway", "@railroad-below"),
    entity(5, "tracked", "@tracked-below"),
    entity(6, "tractor trailer", "M60,120 L140,120; circle 65,125 5; circle 75,125 5; circle 135,125 5"),
    entity(7, "wheeled, limited cross-country", "@wheeled-limited-below"),
    entity(8, "wheeled, cross-country", "@wheeled-below"),
    entity(
        9,
        "robotic",
        "fill M100,121.6 L114.8,136.4 L116.6,136 L118.2,136.8 L119,138.8 L118.2,140.6 L116.6,141.4 L115,141 \
         L113.8,139.8 L113.8,137.8 L103.4,132.6 L100.8,141.2 L102.2,142.2 L102.6,144.2 L102.2,145.4 L101,146.2 \
         L99,146.2 L97.4,144.6 L97.6,142.6 L99.2,141.2 L96.6,132.6 L86.2,137.8 L86.2,139.8 L85,141 L83.4,141.4 \
         L81.8,140.6 L81,138.8 L81.8,136.8 L83.4,136 L85,136.4 Z",
    ),
];
