//! Sector 1 and sector 2 modifiers of ships.

use crate::entities::entity::{SymbolEntity, entity};

/// Above the icon.
pub(super) const SECTOR_1: &[SymbolEntity] = &[
    entity(1, "own ship", "text 25 100,69 OWN"),
    entity(2, "antiair warfare", "text 25 100,69 AAW"),
    entity(3, "antisubmarine warfare", "text 25 100,69 ASW"),
    entity(4, "escort", "text 28 100,68.5 E"),
    entity(5, "electronic warfare", "text 28 100,68.5 EW"),
    entity(6, "intelligence, surveillance, reconnaissance", "text 25 100,69 ISR"),
    entity(7, "mine countermeasures", "text 25 100,69 MCM"),
    entity(8, "missile defense", "text 28 100,68.5 MD"),
    entity(9, "medical", "text 28 100,68.5 ME"),
    entity(10, "mine warfare", "text 25 100,69 MIW"),
    entity(11, "remote mult-imission vehicle (RMV)", "text 25 100,69 RMV"),
    entity(12, "special operations forces (SOF)", "text 25 100,69 SOF"),
    entity(13, "surface warfare", "text 25 100,69 SUW"),
    entity(14, "ballistic missile", "text 28 100,68.5 B"),
    entity(15, "guided missile", "text 28 100,68.5 G"),
    entity(16, "other guided missile", "text 28 100,68.5 M"),
    entity(17, "torpedo", "text 28 100,68.5 T"),
    entity(18, "drone-equipped", "fill M80,65 L100,78 L120,65 L120,60 L100,70 L80,60 Z"),
    entity(19, "helicopter-equipped/vstol", "text 28 100,68.5 H"),
    entity(20, "ballistic missile defense, shooter", "text 28 100,68.5 BM"),
    entity(21, "ballistic missile defense, long-range surveillance and track (LRS&T)", "text 28 100,68.5 ST"),
    entity(22, "sea-base x-band", "text 25 100,69 SBX"),
    entity(23, "hijacking/hijacked", "text 28 100,68.5 H"),
    entity(24, "hijacker", "text 28 100,68.5 HJ"),
    entity(25, "cyberspace", "text 25 100,69 CYB"),
];

/// Below it.
pub(super) const SECTOR_2: &[SymbolEntity] = &[
    entity(1, "nuclear powered", "text 28 100,131.5 N"),
    entity(2, "heavy", "text 28 100,131.5 H"),
    entity(3, "light", "text 28 100,131.5 L"),
    entity(4, "medium", "text 28 100,131.5 M"),
    entity(5, "dock", "text 28 100,131.5 D"),
    entity(6, "logistics", "text 25 100,132 LOG"),
    entity(7, "tank", "text 28 100,131.5 T"),
    entity(8, "vehicle", "text 28 100,131.5 V"),
    entity(9, "fast", "text 28 100,131.5 F"),
    entity(10, "air-cushioned (US)", "text 28 100,131.5 AC"),
    entity(11, "air-cushioned (NATO)", "text 28 100,131.5 J"),
    entity(12, "hydrofoil", "text 28 100,131.5 K"),
    entity(13, "autonomous control", "text 25 100,132 AUT"),
    entity(14, "remotely piloted", "text 28 100,131.5 RP"),
    entity(15, "expendable", "text 25 100,132 EXP"),
    entity(16, "cyberspace", "text 25 100,132 CYB"),
];
