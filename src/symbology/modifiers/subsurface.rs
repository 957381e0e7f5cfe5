//! Sector 1 and sector 2 modifiers of submarines.

use crate::entities::entity::{SymbolEntity, entity};

/// Above the icon.
pub(super) const SECTOR_1: &[SymbolEntity] = &[
    entity(1, "antisubmarine warfare", "text 25 100,69 ASW"),
    entity(2, "auxiliary", "text 25 100,69 AUX"),
    entity(3, "command and control", "text 28 100,68.5 C2"),
    entity(4, "intelligence, surveillance, reconnaissance", "text 25 100,69 ISR"),
    entity(5, "mine countermeasures", "text 25 100,69 MCM"),
    entity(6, "mine warfare", "text 25 100,69 MIW"),
    entity(7, "surface warfare", "text 25 100,69 SUW"),
    entity(8, "attack", "text 28 100,68.5 A"),
    entity(9, "ballistic missile", "text 28 100,68.5 B"),
    entity(10, "guided missile", "text 28 100,68.5 G"),
    entity(11, "other guided missile", "text 28 100,68.5 M"),
    entity(12, "special operations forces (SOF)", "text 25 100,69 SOF"),
    entity(13, "possible submarine low 1", "text 28 100,68.5 P1"),
    entity(14, "possible submarine low 2", "text 28 100,68.5 P2"),
    entity(15, "possible submarine high 3", "text 28 100,68.5 P3"),
    entity(16, "possible submarine high 4", "text 28 100,68.5 P4"),
    entity(17, "probable submarine", "text 28 100,68.5 PB"),
    entity(18, "certain submarine", "text 28 100,68.5 CT"),
    entity(19, "anti-torpedo torpedo", "text 25 100,69 ATT"),
    entity(20, "hijacking/hijacked", "text 28 100,68.5 H"),
    entity(21, "hijacker", "text 28 100,68.5 HJ"),
    entity(22, "cyberspace", "text 25 100,69 CYB"),
];

/// Below it.
pub(super) const SECTOR_2: &[SymbolEntity] = &[
    entity(1, "air independent propulsion", "text 28 100,131.5 AI"),
    entity(2, "diesel electric, general", "text 28 100,131.5 D"),
    entity(3, "diesel - type 1", "text 28 100,131.5 D1"),
    entity(4, "diesel - type 2", "text 28 100,131.5 D2"),
    entity(5, "diesel - type 3", "text 28 100,131.5 D3"),
    entity(6, "nuclear powered, general", "text 28 100,131.5 N"),
    entity(7, "nuclear - type 1", "text 28 100,131.5 N1"),
    entity(8, "nuclear - type 2", "text 28 100,131.5 N2"),
    entity(9, "nuclear - type 3", "text 28 100,131.5 N3"),
    entity(10, "nuclear - type 4", "text 28 100,131.5 N4"),
    entity(11, "nuclear - type 5", "text 28 100,131.5 N5"),
    entity(12, "nuclear - type 6", "text 28 100,131.5 N6"),
    entity(13, "nuclear - type 7", "text 28 100,131.5 N7"),
    entity(14, "autonomous control", "text 25 100,132 AUT"),
    entity(15, "remotely piloted", "text 28 100,131.5 RP"),
    entity(16, "expendable", "text 25 100,132 EXP"),
    entity(17, "cyberspace", "text 25 100,132 CYB"),
];
