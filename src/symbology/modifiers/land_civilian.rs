//! Sector 1 and sector 2 modifiers of civilian units and organizations on land.

use crate::entities::entity::{SymbolEntity, entity};

/// Above the icon.
pub(super) const SECTOR_1: &[SymbolEntity] = &[
    entity(1, "assassination", "text 28 100,68.5 AS"),
    entity(2, "execution (wrongful killing)", "text 28 100,68.5 EX"),
    entity(3, "murder victims", "text 28 100,68.5 MU"),
    entity(4, "hijacking/hijacked", "text 28 100,68.5 H"),
    entity(5, "kidnapping", "text 28 100,68.5 K"),
    entity(6, "piracy", "text 28 100,68.5 PI"),
    entity(7, "rape", "text 28 100,68.5 RA"),
    entity(8, "civilian", "text 25 100,69 CIV"),
    entity(9, "displaced person(s), refugee(s) and evacuee(s)", "text 22 100,69 DPRE"),
    entity(10, "foreign fighter(s)", "text 28 100,68.5 FF"),
    entity(11, "gang member or gang", "text 22 100,69 GANG"),
    entity(12, "government organization", "text 28 100,68.5 GO"),
    entity(13, "leader or leadership", "text 25 100,69 LDR"),
    entity(14, "nongovernmental organization member or nongovernmental organization", "text 25 100,69 NGO"),
    entity(15, "unwilling/coerced recruit", "text 28 100,68.5 UR"),
    entity(16, "willing recruit", "text 28 100,68.5 WR"),
    entity(17, "religious or religious organization", "text 25 100,69 REL"),
    entity(18, "targeted individual or organization", "text 25 100,69 TGT"),
    entity(19, "terrorist or terrorist organization", "text 25 100,69 TER"),
    entity(20, "speaker", "text 25 100,69 SPK"),
    entity(21, "accident", "text 25 100,69 ACC"),
    entity(22, "combat", "text 25 100,69 CBT"),
    entity(23, "other", "text 25 100,69 OTH"),
    entity(24, "loot", "text 22 100,69 LOOT"),
    entity(25, "hijacker", "text 28 100,68.5 HJ"),
    entity(26, "cyberspace", "text 25 100,69 CYB"),
];

/// Below it.
pub(super) const SECTOR_2: &[SymbolEntity] = &[
    entity(1, "leader or leadership", "text 25 100,132 LDR"),
    entity(2, "cyberspace", "text 25 100,132 CYB"),
];
