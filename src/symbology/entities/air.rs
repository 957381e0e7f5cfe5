//! Aircraft: MIL-STD-2525D, table A-III and appendix B.

use crate::entities::entity::{SymbolEntity, entity};

pub(super) const AIRCRAFT: &[SymbolEntity] = &[
    entity(110000, "military", "text 39 MIL"),
    entity(
        110100,
        "military, fixed wing",
        "fill M100,79 Q103,79 103,84 L103,92 L122,106.5 L121.5,112 L103,103.5 L102.5,113.5 L107.5,117 L107.5,120.5 \
         L100,118.5 L92.5,120.5 L92.5,117 L97.5,113.5 L97,103.5 L78.5,112 L78,106.5 L97,92 L97,84 Q97,79 100,79 Z",
    ),
    entity(
        110101,
        "fixed wing, medical evacuation (MEDEVAC)",
        "solid M93,83 L107,83 L107,93 L117,93 L117,107 L107,107 L107,117 L93,117 L93,107 L83,107 L83,93 L93,93 Z",
    ),
    entity(110102, "attack or strike", "text 45 A"),
    entity(110103, "bomber", "text 45 B"),
    entity(110104, "fighter", "text 45 F"),
    entity(110105, "fixed wing, fighter/bomber", "text 39 F/B"),
    entity(110106, "reserved", ""),
    entity(110107, "cargo", "text 45 C"),
    entity(110108, "fixed wing, electronic combat (EC)/jammer", "text 45 J"),
    entity(110109, "tanker", "text 45 K"),
    entity(110110, "fixed wing, patrol", "text 45 P"),
    entity(110111, "reconnaissance aircraft", "text 45 R"),
    entity(110112, "fixed wing, trainer", "text 45 T"),
    entity(110113, "fixed wing, utility", "text 45 U"),
    entity(110114, "fixed wing, vertical or short take-off and landing (VSTOL)", "text 45 V"),
    entity(110115, "fixed wing, airborne command post (ACP)", "text 39 ACP"),
    entity(110116, "fixed wing, airborne early warning (AEW)", "text 39 AEW"),
    entity(110117, "fixed wing, antisurface warfare", "text 33 ASUW"),
    entity(110118, "fixed wing, antisubmarine warfare", "text 39 ASW"),
    entity(110119, "fixed wing, communications", "text 39 COM"),
    entity(110120, "fixed wing, combat search and rescue (CSAR)", "text 33 CSAR"),
    entity(110121, "fixed wing, electronic support (ES)", "text 45 ES"),
    entity(110122, "fixed wing, government", "text 39 GOV"),
    entity(110123, "fixed wing, mine countermeasures (MCM)", "text 39 MCM"),
    entity(110124, "fixed wing, personnel recovery", "text 45 PR"),
    entity(110125, "fixed wing, search and rescue", "text 39 SAR"),
    entity(110126, "fixed wing, special operations forces", "text 39 SOF"),
    entity(110127, "fixed wing, ultra light", "text 45 UL"),
    entity(110128, "fixed wing, photographic reconnaissance", "text 45 PH"),
    entity(110129, "fixed wing, very important person (VIP)", "text 39 VIP"),
    entity(110130, "fixed wing, suppression of enemy air defense", "text 33 SEAD"),
    entity(110131, "fixed wing, passenger", "text 45 PX"),
    entity(110132, "fixed wing, escort", "text 45 E"),
    entity(110133, "fixed wing, electronic attack (EA)", "text 45 EA"),
    entity(110200, "military, rotary wing", "fill M59,83 L100,97.5 L141,83 L141,117 L100,102.5 L59,117 Z"),
    entity(110300, "unmanned aircraft", "@unmanned"),
    entity(
        110400,
        "vertical-takeoff UAV (VT-UAV)",
        "solid M70,84 L100,98 L130,84 L130,81 L100,91 L70,81 Z M70,93 L100,108 L130,93 L130,118 L100,108 L70,118 Z",
    ),
    entity(110500, "lighter than air", "solid circle 100,95 15; solid M95,110 L95,120 L105,120 L105,110 Z"),
    entity(
        110600,
        "airship",
        "solid M126,107 C122,109 116,110 110,110 L120,120 L130,120 Z M120,80 L111,89.4 C116,90 122,91.1 126,92.6 \
         L130,80 Z M135,100 C135,106 119,111 100,111 C80.7,111 65,106 65,100 C65,93.9 80.7,88.9 100,88.9 C119,88.9 \
         135,93.9 135,100 Z",
    ),
    entity(
        110700,
        "tethered lighter than air",
        "solid M75,110 L85,95 M80,115 C80,117.8 77.8,120 75,120 C72.2,120 70,117.8 70,115 C70,112.2 72.2,110 75,110 \
         C77.8,110 80,112.2 80,115 Z M95,109 L95,120 L105,120 L105,109 M115,95 C115,103.3 108.3,110 100,110 \
         C91.7,110 85,103.3 85,95 C85,86.7 91.7,80 100,80 C108.3,80 115,86.7 115,95 Z",
    ),
    entity(120000, "civilian", "pale text 39 CIV"),
    entity(
        120100,
        "civilian, fixed wing",
        "pale M96,81 L104,81 L104,84 L106,84 L106,90.5 L126,90.5 L126,100 L106,100 L104,116 L113,116 L113,120 \
         L87,120 L87,116 L96,116 L94,100 L74,100 L74,90.5 L94,90.5 L94,84 L96,84 Z",
    ),
    entity(
        120200,
        "civilian, rotary wing",
        "pale M60,84.5 L100,100 L60,115.5 Z; pale M140,84.5 L100,100 L140,115.5 Z",
    ),
    entity(
        120300,
        "unmanned aircraft (UA)/unmanned aerial vehicle (UAV)/unmanned aircraft system (UAS)/remotely piloted vehicle (RPV)",
        "pale M60,84 L100,104 L140,84 L140,92 L100,117 L60,92 Z",
    ),
    entity(120400, "lighter than air", "pale circle 100,95 15; pale M95,110 L95,120 L105,120 L105,110 Z"),
    entity(
        120500,
        "airship",
        "pale M126,107 C122,109 116,110 110,110 L120,120 L130,120 Z M120,80 L111,89.4 C116,90 122,91.1 126,92.6 \
         L130,80 Z M135,100 C135,106 119,111 100,111 C80.7,111 65,106 65,100 C65,93.9 80.7,88.9 100,88.9 C119,88.9 \
         135,93.9 135,100 Z",
    ),
    entity(
        120600,
        "tethered lighter than air",
        "pale M75,110 L85,95 M80,115 C80,117.8 77.8,120 75,120 C72.2,120 70,117.8 70,115 C70,112.2 72.2,110 75,110 \
         C77.8,110 80,112.2 80,115 Z M95,109 L95,120 L105,120 L105,109 M115,95 C115,103.3 108.3,110 100,110 \
         C91.7,110 85,103.3 85,95 C85,86.7 91.7,80 100,80 C108.3,80 115,86.7 115,95 Z",
    ),
    entity(
        120700,
        "civilian, medical evacuation",
        "pale M93,83 L107,83 L107,93 L117,93 L117,107 L107,107 L107,117 L93,117 L93,107 L83,107 L83,93 L93,93 Z",
    ),
    entity(130000, "weapon", "text 39 WPN"),
    entity(130100, "bomb", "text 33 BOMB"),
    entity(
        130200,
        "decoy",
        "solid M86.6,82.8 L68.7,100 L86.6,117 Z M109,82.8 L91,100 L109,117 Z M132,82.8 L114,100 L132,117 Z",
    ),
    entity(140000, "manual track", "text 39 MAN"),
];
