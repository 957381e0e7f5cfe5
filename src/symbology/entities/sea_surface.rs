//! Ships: MIL-STD-2525D, table A-XXX and appendix E.

use crate::entities::entity::{SymbolEntity, entity};

pub(super) const SHIPS: &[SymbolEntity] = &[
    entity(110000, "military", "text 39 MIL"),
    entity(
        120000,
        "military combatant",
        "M86.9,110 C83.3,112 79.7,113.9 76.1,115.9 C78.2,118.8 82.8,119.8 86.1,118 C88.7,117.1 90.8,114.2 \
         89.2,111.9 C88.4,111.3 87.7,110.6 86.9,110 Z M113.2,110.1 C116.8,112.1 120.4,114 124,116 C121.9,118.9 \
         117.3,119.9 114,118.1 C111.4,117.2 109.3,114.3 110.9,112 C111.7,111.4 112.4,110.7 113.2,110.1 Z; pale thin \
         M112.9,110 L103.2,102.9 L96.8,97.5 L92.2,91.5 L90,87.7 L87.6,82.4 L87.1,86.9 L87.7,91.4 L89.2,94.6 \
         L91.9,97.8 L95.1,100.8 L99.8,104.6 L110.6,112.2 L112.9,110 M87.2,110 L96.9,102.9 L103.3,97.5 L107.9,91.5 \
         L110.1,87.7 L112.5,82.4 L113,86.9 L112.4,91.4 L110.9,94.6 L108.2,97.8 L105,100.8 L100.3,104.6 L89.5,112.2 \
         L87.2,110",
    ),
    entity(120100, "carrier", "fill M78.5,79 L101.5,79 L101.5,99 L124,99 L100,122 L78.5,101 Z"),
    entity(
        120200,
        "surface combatant, line",
        "fill M100,120 L75,103 L90,105 L90,95 L95,95 L95,90 L80,90 L80,85 L95,85 L95,80 L105,80 L105,85 L120,85 \
         L120,90 L105,90 L105,95 L110,95 L110,105 L125,103 Z",
    ),
    entity(120201, "surface combatant, line, battleship", "text 45 BB"),
    entity(120202, "cruiser", "text 45 CG"),
    entity(120203, "destroyer", "text 45 DD"),
    entity(120204, "frigate", "text 45 FF"),
    entity(120205, "corvette", "text 45 FS"),
    entity(120206, "surface combatant, line, littoral combatant ship", "text 39 LCS"),
    entity(120300, "amphibious warfare ship", "@hull; M100,120.5 L118,120.5"),
    entity(120301, "amphibious warfare ship, amphibious command ship", "text 39 LCC"),
    entity(120302, "amphibious warfare ship, amphibious assault, non-specified", "text 45 LA"),
    entity(120303, "amphibious warfare ship, amphibious assault ship, general", "text 39 LHA"),
    entity(120304, "amphibious warfare ship, amphibious assault ship, multipurpose", "text 39 LHD"),
    entity(120305, "amphibious warfare ship, amphibious assault ship, helicopter", "text 39 LPH"),
    entity(120306, "amphibious warfare ship, amphibious transport dock", "text 39 LPD"),
    entity(120307, "amphibious warfare ship, landing ship", "text 45 LS"),
    entity(120308, "amphibious warfare ship, landing craft", "text 45 LC"),
    entity(
        120400,
        "mine warfare ship",
        "fill circle 100,97 13; fill M77,99 L123,99 L100,122 Z; fill M75.5,96 L124.5,96 L124.5,101.5 L75.5,101.5 Z; \
         broad M100,80 L100,90 M86,84 L92,90 M114,84 L108,90",
    ),
    entity(120401, "mine warfare ship, mine layer", "text 45 ML"),
    entity(120402, "mine warfare ship, mine sweeper", "text 45 MS"),
    entity(120403, "mine warfare ship, mine sweeper, drone", "text 39 MSD"),
    entity(120404, "mine warfare ship, mine hunter", "text 45 MH"),
    entity(120405, "mine warfare ship, mine countermeasures", "text 39 MCM"),
    entity(120406, "mine warfare ship, mine countermeasures, support ship", "text 39 MCS"),
    entity(120500, "patrol boat", "@hull"),
    entity(120501, "patrol boat, patrol craft, submarine chaser/escort, general", "text 45 PC"),
    entity(120502, "patrol boat, patrol ship, general", "text 45 PG"),
    entity(
        120600,
        "decoy",
        "solid M85.6,82.5 L68.2,99.9 L85.6,117 Z M109,82.5 L91.4,99.9 L109,117 Z M132,82.5 L115,99.9 L132,117 Z",
    ),
    entity(
        120700,
        "unmanned surface water vehicle (USV)",
        "fill M60,84 L100,104 L140,84 L140,92 L100,117 L60,92 Z",
    ),
    entity(120800, "speedboat", "fill M120,120 L80,120 L65,95 L80,95 L85,80 L95,80 L90,95 L135,95 Z"),
    entity(
        120801,
        "speedboat, rigid-hull inflatable boat (RHIB)",
        "fill M85,80 L80,95 L65,95 L80,120 L120,120 L135,95 L90,95 L95,80 Z M87,100.8 L95,100.8 L97.8,102 L98.6,104 \
         L98.4,106.4 L97.2,107.8 L95,108.8 L96.8,110.2 L100,115 L96.4,115 L92.8,109.8 L90.6,109 L90,109 L90,115 \
         L87,115 Z M101.6,100.8 L109.6,100.8 L112,102.2 L112.6,105 L112,106.6 L110.8,107.4 L112.8,108.8 \
         L113.6,110.8 L113,112.8 L111.8,114.2 L109.4,115 L101.6,115 Z M104.4,103.2 L104.4,106.4 L108.6,106.2 \
         L109.8,105.4 L109.8,104 L109.2,103.2 Z M90,103.2 L90,106.8 L94.4,106.6 L95.6,105.8 L95.6,104.4 L94.8,103.4 \
         Z M104.4,108.8 L104.4,112.6 L108.8,112.6 L110.4,111.4 L110.4,110 L109.4,109 Z; light M87,100.8 L95,100.8 \
         L97.8,102 L98.6,104 L98.4,106.4 L97.2,107.8 L94.8,108.8 L96.8,110.2 L99.8,115 L96.4,115 L92.8,109.8 \
         L89.8,109 L89.8,115 L87,115 Z M101.6,100.8 L109.2,100.8 L111.6,101.6 L112.8,104.4 L112,106.4 L110.8,107.4 \
         L112.8,108.8 L113.6,110.8 L112.8,113.2 L110.8,114.6 L101.6,115 Z M104.4,103.2 L104.4,106.4 L108.6,106.2 \
         L109.8,105.4 L109.4,103.4 L106,103.2 Z M89.8,103.2 L89.8,106.8 L94.2,106.6 L95.4,106 L95.8,105 L95.2,103.4 \
         L92.2,103.2 Z M104.4,108.8 L104.4,112.6 L108.8,112.6 L110.2,111.8 L110.4,110.6 L110,109.4 L106.8,108.8 Z",
    ),
    entity(120900, "jet ski", "fill M135,105 L135,120 L75,120 L65,105 L85,80 L95,80 L95,90 L90,90 L85,105 Z"),
    entity(121000, "Navy task organization", "@navy-task-organization-unit"),
    entity(
        121001,
        "Navy task organization, Navy task element",
        "@navy-task-organization-unit; text 30 100,107.5 TE",
    ),
    entity(
        121002,
        "Navy task organization, Navy task force",
        "@navy-task-organization-unit; text 30 100,107.5 TF",
    ),
    entity(
        121003,
        "Navy task organization, Navy task group",
        "@navy-task-organization-unit; text 30 100,107.5 TG",
    ),
    entity(
        121004,
        "Navy task organization, Navy task unit",
        "@navy-task-organization-unit; text 30 100,107.5 TU",
    ),
    entity(
        121005,
        "Navy task organization, convoy",
        "solid M80,115 L60,115 L60,80 L140,80 L140,115 L120,115 L120,95 L80,95 Z",
    ),
    entity(121100, "sea-based x-band radar", "M72,95 L102,70 L102,95 L132,70 M70,70 C70,105 85,120 120,120"),
    entity(
        130000,
        "military non combatant",
        "solid M80,100 L80,80 L120,80 L120,100 L135,100 L135,120 L65,120 L65,100 Z",
    ),
    entity(130100, "auxiliary ship", "text 45 AA"),
    entity(130101, "auxiliary ship, ammunition ship", "text 45 AE"),
    entity(130102, "auxiliary ship, naval stores ship", "text 45 AF"),
    entity(130103, "auxiliary ship, auxiliary flag ship", "text 39 AGF"),
    entity(130104, "auxiliary ship, intelligence collector", "text 39 AGI"),
    entity(130105, "auxiliary ship, oceanographic research ship", "text 39 AGO"),
    entity(130106, "auxiliary ship, survey ship", "text 39 AGS"),
    entity(130107, "auxiliary ship, hospital ship", "text 45 AH"),
    entity(130108, "auxiliary ship, naval cargo ship", "text 45 AK"),
    entity(130109, "auxiliary ship, combat support ship, fast", "text 39 AOE"),
    entity(130110, "auxiliary ship, oiler, replenishment", "text 39 AOR"),
    entity(130111, "auxiliary ship, repair ship", "text 45 AR"),
    entity(130112, "auxiliary ship, submarine tender", "text 45 AS"),
    entity(130113, "auxiliary ship, tug, ocean going", "text 45 AT"),
    entity(130200, "service craft/yard", "text 45 YY"),
    entity(130201, "service craft/yard, barge, not self-propelled", "text 45 YB"),
    entity(130202, "service craft/yard, barge, self-propelled", "text 45 YS"),
    entity(130203, "service craft/yard, tug, harbor", "text 45 YT"),
    entity(130204, "service craft/yard, launch", "text 39 YFT"),
    entity(140000, "civilian", "pale text 39 CIV"),
    entity(140100, "merchant ship", "@merchant-ship-general"),
    entity(140101, "merchant ship, cargo, general", "@merchant-ship-general; text 45 A"),
    entity(140102, "merchant ship, container ship", "@merchant-ship-general; text 45 C"),
    entity(140103, "merchant ship, dredge", "@merchant-ship-general; text 45 D"),
    entity(140104, "merchant ship, roll on/roll off", "@merchant-ship-general; text 45 E"),
    entity(140105, "merchant ship, ferry", "@merchant-ship-general; text 45 F"),
    entity(140106, "merchant ship, heavy lift", "@merchant-ship-general; text 45 H"),
    entity(140107, "merchant ship, hovercraft", "@merchant-ship-general; text 45 J"),
    entity(140108, "merchant ship, lash carrier (with barges)", "@merchant-ship-general; text 45 L"),
    entity(140109, "merchant ship, oiler/tanker", "@merchant-ship-general; text 45 O"),
    entity(140110, "merchant ship, passenger", "@merchant-ship-general; text 45 P"),
    entity(140111, "merchant ship, tug, ocean going", "@merchant-ship-general; text 45 T"),
    entity(140112, "merchant ship, tow", "@merchant-ship-general; text 35 100,117 TW"),
    entity(
        140113,
        "merchant ship, transport ship, hazardous material",
        "@merchant-ship-general; text 35 100,117 HZ",
    ),
    entity(140114, "merchant ship, junk/dhow", "@merchant-ship-general; text 35 100,117 QJ"),
    entity(140115, "merchant ship, barge, not self-propelled", "@merchant-ship-general; text 35 100,117 YB"),
    entity(
        140116,
        "merchant ship, hospital ship",
        "@merchant-ship-general; fill M95,95 L95,80 L105,80 L105,95 L120,95 L120,105 L105,105 L105,120 L95,120 \
         L95,105 L80,105 L80,95 Z",
    ),
    entity(140200, "fishing vessel", "@fishing-vessel"),
    entity(140201, "fishing vessel, drifter", "@fishing-vessel; text 30 100,117.5 DF"),
    entity(140202, "fishing vessel, trawler", "@fishing-vessel; text 30 100,117.5 TR"),
    entity(140203, "fishing vessel, dredger", "@fishing-vessel; text 30 100,117.5 DR"),
    entity(
        140300,
        "law enforcement vessel",
        "@merchant-ship-general; solid M135,100 L120,135 L110,135 L125,100 Z",
    ),
    entity(
        140400,
        "leisure craft, sailing",
        "pale M105,55 L105,95 L140,95 Z M100,50 L100,100 M145,100 L130,135 L70,135 L55,100 Z",
    ),
    entity(140500, "leisure craft, motorized", "@leisure-craft-motorized"),
    entity(
        140501,
        "leisure craft, motorized, rigid-hull inflatable boat (RHIB)",
        "@leisure-craft-motorized; text 30 100,117.5 RB",
    ),
    entity(140502, "leisure craft, motorized, speedboat", "@leisure-craft-motorized; text 30 100,117.5 SP"),
    entity(140600, "jet ski", "pale M85,60 L55,105 L65,120 L140,120 L140,100 L80,100 L90,70 L95,70 L95,60 Z"),
    entity(
        140700,
        "unmanned surface water vehicle (USV)",
        "pale M60,84 L100,104 L140,84 L140,92 L100,117 L60,92 Z",
    ),
    entity(150000, "own ship", "M50,100 L150,100 M100,50 L100,150; circle 100,100 50"),
    entity(160000, "fused track", "text 45 ?; M70,65 L80,100 L70,135 L130,135 L120,100 L130,65 Z"),
    entity(170000, "manual track", "text 39 MAN"),
];
