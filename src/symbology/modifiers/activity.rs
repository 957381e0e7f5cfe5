//! Sector 1 and sector 2 modifiers of activities.

use crate::entities::entity::{SymbolEntity, entity};

/// Above the icon.
pub(super) const SECTOR_1: &[SymbolEntity] = &[
    entity(1, "assassination", "text 28 100,68.5 AS"),
    entity(2, "execution (wrongful killing)", "text 28 100,68.5 EX"),
    entity(3, "hijacking/hijacked", "text 28 100,68.5 H"),
    entity(4, "house-to-house", "pale M110,65 L90,65 L90,80 L110,80 Z M100,55 L90,65 L110,65 Z"),
    entity(5, "kidnapping", "text 28 100,68.5 K"),
    entity(6, "murder", "text 28 100,68.5 MU"),
    entity(7, "piracy", "text 28 100,68.5 PI"),
    entity(8, "rape", "text 28 100,68.5 RA"),
    entity(9, "written military information support operations", "text 28 100,68.5 W"),
    entity(
        10,
        "pirate",
        "circle 100,60 7; M82.5,75 L117.5,60 M117.5,75 L82.5,60 M85.5,67 L90.5,77 M117.5,67 L107.5,77",
    ),
    entity(11, "false", "text 25 100,69 FAL"),
    entity(12, "find", "text 25 100,69 FND"),
    entity(13, "found and cleared", "text 25 100,69 CLR"),
    entity(
        14,
        "hoax (decoy)",
        "solid M90,75 L80,67.5 L90,60 Z M105,75 L95,67.5 L105,60 Z M120,75 L110,67.5 L120,60 Z",
    ),
    entity(15, "attempted", "text 25 100,69 ATT"),
    entity(16, "accident", "text 25 100,69 ACC"),
    entity(17, "incident", "text 25 100,69 INC"),
    entity(18, "theft", "text 25 100,69 THF"),
    entity(19, "hijacker", "text 28 100,68.5 HJ"),
    entity(20, "cyberspace", "text 25 100,69 CYB"),
    entity(21, "eviction", "text 28 100,68.5 EV"),
    entity(22, "raid", "text 22 100,69 RAID"),
];

/// Below it.
pub(super) const SECTOR_2: &[SymbolEntity] = &[
    entity(1, "cyberspace", "text 25 100,132 CYB"),
    entity(2, "security force assistance", "text 25 100,132 SFA"),
];
