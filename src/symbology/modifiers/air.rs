//! Sector 1 and sector 2 modifiers of aircraft.

use crate::entities::entity::{SymbolEntity, entity};

/// Above the icon.
pub(super) const SECTOR_1: &[SymbolEntity] = &[
    entity(1, "attack/strike", "text 28 100,68.5 A"),
    entity(2, "bomber", "text 28 100,68.5 B"),
    entity(3, "cargo", "text 28 100,68.5 C"),
    entity(4, "fighter", "text 28 100,68.5 F"),
    entity(5, "interceptor", "text 28 100,68.5 I"),
    entity(6, "tanker", "text 28 100,68.5 K"),
    entity(7, "utility", "text 28 100,68.5 U"),
    entity(
        8,
        "vertical or short take-off and landing (VSTOL)/vertical take-off and landing (VTOL)",
        "text 28 100,68.5 V",
    ),
    entity(9, "passenger", "text 28 100,68.5 PX"),
    entity(10, "ultra light", "text 28 100,68.5 UL"),
    entity(11, "airborne command post (ACP)", "text 25 100,69 ACP"),
    entity(12, "airborne early warning (AEW)", "text 25 100,69 AEW"),
    entity(13, "government", "text 25 100,69 GOV"),
    entity(
        14,
        "medical evacuation (MEDEVAC)",
        "fill M95.5,80 L104.5,80 L104.5,71 L113.5,71 L113.5,62 L104.5,62 L104.5,53 L95.5,53 L95.5,62 L86.5,62 \
         L86.5,71 L95.5,71 Z",
    ),
    entity(15, "escort", "text 28 100,68.5 E"),
    entity(16, "electronic combat (EC)/jammer", "text 28 100,68.5 J"),
    entity(17, "patrol", "text 28 100,68.5 P"),
    entity(18, "reconnaissance", "text 28 100,68.5 R"),
    entity(19, "trainer", "text 28 100,68.5 T"),
    entity(20, "photographic (reconnaissance)", "text 28 100,68.5 PH"),
    entity(21, "personnel recovery", "text 28 100,68.5 PR"),
    entity(22, "antisubmarine warfare", "text 25 100,69 ASW"),
    entity(23, "communications", "text 25 100,69 COM"),
    entity(24, "electronic support (ES)", "text 28 100,68.5 ES"),
    entity(25, "mine countermeasures (MCM)", "text 25 100,69 MCM"),
    entity(26, "search and rescue", "text 25 100,69 SAR"),
    entity(27, "special operations forces", "text 25 100,69 SOF"),
    entity(28, "surface warfare", "text 25 100,69 SUW"),
    entity(29, "very important person (VIP) transport", "text 25 100,69 VIP"),
    entity(30, "combat search and rescue (CSAR)", "text 22 100,69 CSAR"),
    entity(31, "suppression of enemy air defenses", "text 22 100,69 SEAD"),
    entity(32, "antisurface warfare", "text 22 100,69 ASUW"),
    entity(33, "fighter/bomber", "text 25 100,69 F/B"),
    entity(34, "intensive care", "text 28 100,68.5 IC"),
    entity(35, "electronic attack (EA)", "text 28 100,68.5 EA"),
    entity(36, "multimission", "text 28 100,68.5 MM"),
    entity(37, "hijacking/hijacked", "text 28 100,68.5 H"),
    entity(38, "ASW helo LAMPS", "text 28 100,68.5 LP"),
    entity(39, "ASW helo-sh-60r", "text 25 100,69 60R"),
    entity(40, "hijacker", "text 28 100,68.5 HJ"),
    entity(41, "cyberspace", "text 25 100,69 CYB"),
];

/// Below it.
pub(super) const SECTOR_2: &[SymbolEntity] = &[
    entity(1, "heavy", "text 28 100,131.5 H"),
    entity(2, "medium", "text 28 100,131.5 M"),
    entity(3, "light", "text 28 100,131.5 L"),
    entity(4, "boom-only", "text 28 100,131.5 B"),
    entity(5, "drogue-only", "text 28 100,131.5 D"),
    entity(6, "boom and drogue", "text 25 100,132 B/D"),
    entity(7, "close range", "text 28 100,131.5 CR"),
    entity(8, "short range", "text 28 100,131.5 SR"),
    entity(9, "medium range", "text 28 100,131.5 MR"),
    entity(10, "long range", "text 28 100,131.5 LR"),
    entity(11, "downlinked", "text 25 100,131 DL"),
    entity(12, "cyberspace", "text 25 100,132 CYB"),
];
