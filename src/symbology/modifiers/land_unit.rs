//! Sector 1 and sector 2 modifiers of land units: MIL-STD-2525D, tables D-V and D-VI.

use crate::entities::entity::{SymbolEntity, entity};

/// Above the icon.
pub(super) const SECTOR_1: &[SymbolEntity] = &[
    entity(
        1,
        "tactical satellite communications",
        "M105,65 L115,65 M85,65 L95,65 M85,77 C95,70 105,70 115,77; fill M75.4,60.9 L75.4,70 L88.5,70 L88.5,60.9 Z \
         M111.4,60.9 L111.4,70 L124.5,70 L124.5,60.9 Z M93.4,60.9 L93.4,70 L106.5,70 L106.5,60.9 Z",
    ),
    entity(2, "area", "text 22 100,69 AREA"),
    entity(3, "attack", "text 28 100,67 A"),
    entity(4, "biological", "text 28 100,68.5 B"),
    entity(5, "border", "text 25 100,69 BOR"),
    entity(6, "bridging", "M80,60.5 L86,67 L114,67 L120,60.5 M80,81 L86,75 L114,75 L120,81"),
    entity(7, "chemical", "text 28 100,68.5 C"),
    entity(8, "close protection", "text 25 100,69 CLP"),
    entity(9, "combat", "text 25 100,69 CBT"),
    entity(10, "command and control", "text 28 100,68.5 C2"),
    entity(11, "communications contingency package", "text 25 100,69 CCP"),
    entity(12, "construction", "text 20 100,68.5 CONST"),
    entity(13, "cross cultural communication", "text 25 100,69 CCC"),
    entity(14, "crowd and riot control", "text 25 100,69 CRC"),
    entity(15, "decontamination", "text 28 100,68.5 D"),
    entity(16, "detention", "text 25 100,69 DET"),
    entity(
        17,
        "direct communications",
        "M95,65 L90,70 L95,75 M105,65 L110,70 L105,75 M90,70 C110,70 110,70 110,70; circle 120,70 5; circle 80,70 5",
    ),
    entity(
        18,
        "diving",
        "M104.6,73.5 L109.2,78.3 L90.9,78.3 L95.5,73.5 M108.3,60 L112.9,60 L112.9,69.6 L108.3,69.6 M91.8,69.6 \
         L87.2,69.6 L87.2,60 L91.8,60; circle 100,64.8 4.7; circle 100,64.8 9.4",
    ),
    entity(19, "division", "@division-above"),
    entity(20, "dog", "text 25 100,69 DOG"),
    entity(21, "drilling", "solid M90,60 L95,75 L105,75 L110,60 Z"),
    entity(22, "electro-optical", "text 28 100,68.5 EO"),
    entity(23, "enhanced", "text 25 100,69 ENH"),
    entity(24, "explosive ordnance disposal (EOD)", "text 25 100,69 EOD"),
    entity(25, "fire direction center", "text 25 100,69 FDC"),
    entity(26, "force", "text 28 100,68.5 F"),
    entity(27, "forward", "text 25 100,69 FWD"),
    entity(28, "ground station module", "text 25 100,69 GSM"),
    entity(29, "landing support", "text 28 100,68.5 LS"),
    entity(30, "large extension node", "text 25 100,69 LEN"),
    entity(31, "maintenance", "@maintenance-above"),
    entity(32, "meteorological", "text 25 100,69 MET"),
    entity(33, "mine countermeasure", "text 25 100,69 MCM"),
    entity(34, "missile", "M95,78 L95,58 C95,53 105,53 105,58 L105,78"),
    entity(
        35,
        "mobile advisor and support",
        "M105,65 L110,70 L105,75 M90,70 C110,70 110,70 110,70; circle 120,70 5; circle 80,70 5",
    ),
    entity(36, "mobile subscriber equipment", "text 25 100,69 MSE"),
    entity(37, "mobility support", "text 28 100,68.5 MS"),
    entity(38, "movement control center", "text 25 100,69 MCC"),
    entity(39, "multinational", "text 28 100,68.5 MN"),
    entity(40, "multinational specialized unit", "text 25 100,69 MSU"),
    entity(41, "multiple rocket launcher", "M85,68 L100,53 L115,68 M85,76 L100,61 L115,76"),
    entity(42, "NATO medical role 1", "text 25 120,70 1"),
    entity(43, "NATO medical role 2", "text 25 120,70 2"),
    entity(44, "NATO medical role 3", "text 25 120,70 3"),
    entity(45, "NATO medical role 4", "text 25 120,70 4"),
    entity(46, "naval", "@naval-above"),
    entity(47, "unmanned aerial systems (UAS)", "fill M80,65 L100,78 L120,65 L120,60 L100,70 L80,60 Z"),
    entity(48, "nuclear", "text 28 100,68.5 N"),
    entity(49, "operations", "text 25 100,69 OPS"),
    entity(50, "radar", "M85,55 C85.1,76.4 96.7,79.6 110,80 M116,55 L101,67.5 L101,55 L86.6,66.9"),
    entity(51, "radio frequency identification (RFID) interrogator/sensor", "text 28 100,68.5 RF"),
    entity(52, "radiological", "text 25 100,69 RAD"),
    entity(53, "search and rescue", "text 25 100,69 SAR"),
    entity(54, "security", "text 25 100,67 SEC"),
    entity(
        55,
        "sensor",
        "solid M100,55 C98,60 95,63 90,65 C95,67 98,70 100,75 C102,70 105,67 110,65 C105,63 102,60 100,55 Z",
    ),
    entity(56, "weapons", "text 25 100,69 WPN"),
    entity(
        57,
        "signals intelligence",
        "M100,55 L100,78 M85,60 L90,55 L95,60 L100,55 L105,60 L110,55 L115,60",
    ),
    entity(58, "armored", "@armored-above"),
    entity(59, "single rocket launcher", "M85,75 L100,60 L115,75"),
    entity(60, "smoke", "text 28 100,68.5 S"),
    entity(61, "sniper", "@sniper-above"),
    entity(62, "sound ranging", "text 25 100,69 SDR"),
    entity(63, "special operations forces (SOF)", "text 25 100,69 SOF"),
    entity(64, "special weapons and tactics", "text 23 100,69 SWAT"),
    entity(65, "survey", "solid M108,78 L100,70 M100,70 L92,78 M100,70 L100,55 L115,63 Z"),
    entity(66, "tactical exploitation", "text 28 100,68.5 TE"),
    entity(67, "target acquisition", "text 28 100,68.5 TA"),
    entity(68, "topographic/geospatial", "M92,65 C98,68 102,68 108,65 M90,78 L100,55 L110,78"),
    entity(69, "utility", "text 28 100,68.5 U"),
    entity(
        70,
        "video imagery (combat camera)",
        "M120,65 L109,65 M120,75 L106,75 M110,61 L80,61 L80,79 L105,79 Z M120,63 L120,77",
    ),
    entity(71, "mobility assault", "text 28 100,68.5 MA"),
    entity(
        72,
        "amphibious warfare ship",
        "solid M113,75 L100,75 L90,64.3 L95,65 L95,57 L105,57 L105,65 L110.5,64.4 L100,75",
    ),
    entity(73, "load handling system", "text 25 100,69 LHS"),
    entity(74, "palletized load system", "text 25 100,69 PLS"),
    entity(75, "medevac", "@medevac-above"),
    entity(76, "ranger", "text 25 100,69 RGR"),
    entity(77, "support", "text 25 100,69 SPT"),
    entity(78, "aviation", "solid M75,60 L75,75 L125,60 L125,75 Z"),
    entity(79, "route, reconnaissance, and clearance", "text 25 100,69 RRC"),
    entity(80, "tilt-rotor", "text 28 100,68.5 TR"),
    entity(81, "command post node", "text 25 100,69 CPN"),
    entity(82, "joint network node", "text 25 100,69 JNN"),
    entity(83, "retransmission site", "text 22 100,69 RTNS"),
    entity(84, "assault", "text 22 100,69 ASLT"),
    entity(85, "weapons", "text 28 100,68.5 W"),
    entity(86, "criminal investigation division", "text 25 100,69 CID"),
    entity(87, "digital", "text 25 100,69 DIG"),
    entity(88, "network or network operations", "text 25 100,69 NET"),
    entity(
        89,
        "airfield, aerial port of debarkation, or aerial port of embarkation",
        "M80,70 L120,70 M80,80 L111,55",
    ),
    entity(
        90,
        "pipeline",
        "M92,66 L80,66 M92,74 L80,74 M108,74 L120,74 M108,66 L120,66 M100,55 L100,62 M95,55 L105,55 M92,62 L92,78 \
         L108,78 L108,62 L92,62",
    ),
    entity(91, "postal", "M90,60 L105,60 C105,65 105,70 115,75 C100,75 95,75 90,60"),
    entity(92, "water", "@water-above"),
    entity(93, "independent command", "M110,59 L110,75 M102,67 L118,67 M90,59 L90,75 M98,67 L82,67"),
    entity(
        94,
        "theater",
        "M135,66.6 L124,77.6 M124,66.6 L135,77.6 M120,66.6 L108,77.6 M108,66.6 L120,77.6 M105,66.6 L94.3,77.6 \
         M94.3,66.6 L105,77.6 M90.7,66.6 L79.6,77.6 M79.6,66.6 L90.7,77.6 M75.8,66.6 L64.7,77.6 M64.7,66.6 \
         L75.8,77.6",
    ),
    entity(
        95,
        "army or theater army",
        "M132,64.9 L119,77.6 M119,64.9 L132,77.6 M115,64.9 L102,77.6 M102,64.9 L115,77.6 M97.9,64.9 L85.2,77.6 \
         M85.2,64.9 L97.9,77.6 M80.9,64.9 L68.2,77.6 M68.2,64.9 L80.9,77.6",
    ),
    entity(
        96,
        "corps",
        "M127.5,62.5 L112.5,77.5 M112.5,62.5 L127.5,77.5 M107.5,62.5 L92.5,77.5 M92.5,62.5 L107.5,77.5 M87.5,62.5 \
         L72.5,77.5 M72.5,62.5 L87.5,77.5",
    ),
    entity(97, "brigade", "@brigade-above"),
    entity(98, "headquarters element", "@staff-line"),
    entity(
        99,
        "multi-domain",
        "M85.9,65.6 L85.9,60.9 L90.8,60.9 M100,75 L85.9,60.9 M83.7,71.6 L80.3,75 L83.7,79.1 M100,75 L80.3,75 \
         M116,71.6 L119,75 L116,79.1 M100,75 L119,75 M109,60.9 L114,60.9 L114,65.7 M100,75 L114,60.9 M96.6,58.3 \
         L100,54.9 L103,58.3 M100,75 L100,54.9",
    ),
];

/// Below it.
pub(super) const SECTOR_2: &[SymbolEntity] = &[
    entity(1, "airborne", "@airborne-below"),
    entity(2, "arctic", "M115,125 C125,125 125,135 115,135 L85,135 C75,135 75,125 85,125"),
    entity(3, "battle damage repair", "text 25 100,132 BDR"),
    entity(4, "bicycle equipped", "circle 100,132 11"),
    entity(5, "casualty staging", "text 18 122,131.5 CS"),
    entity(6, "clearing", "text 25 100,132 CLR"),
    entity(7, "close range", "text 28 100,131.5 CR"),
    entity(
        8,
        "control",
        "M98,130 L100,126 L102,130 M94,138 L90,136 L94,134 M102,142 L100,146 L98,142 M106,134 L110,136 L106,138 \
         M92,136 L108,136 M100,128 L100,144",
    ),
    entity(9, "decontamination", "text 28 100,131.5 D"),
    entity(10, "demolition", "text 25 100,132 DEM"),
    entity(11, "dental", "text 18 122,131.5 D"),
    entity(12, "digital", "text 25 100,132 DIG"),
    entity(
        13,
        "enhanced position location reporting system (EPLRS)",
        "M87,142 L100,130 L113,142 M100,122 L100,142",
    ),
    entity(14, "equipment", "text 28 100,131.5 E"),
    entity(15, "heavy", "text 28 100,131 H"),
    entity(16, "high altitude", "text 28 100,131.5 HA"),
    entity(
        17,
        "intermodal",
        "M80,125 L120,125 L120,121 L128,130 L120,139 L120,135 L80,135 L80,139 L72,130 L80,121 Z",
    ),
    entity(18, "intensive care", "text 18 122,131.5 IC"),
    entity(19, "light", "text 28 100,131 L"),
    entity(20, "laboratory", "text 25 100,132 LAB"),
    entity(21, "launcher", "M80,140 L115,120 L120,140"),
    entity(22, "long range", "text 28 100,131.5 LR"),
    entity(23, "low altitude", "text 28 100,131.5 LA"),
    entity(24, "medium", "text 28 100,131 M"),
    entity(25, "medium altitude", "text 28 100,131.5 MA"),
    entity(26, "medium range", "text 28 100,131.5 MR"),
    entity(27, "mountain", "@mountain-below"),
    entity(28, "high to medium altitude", "text 25 100,132 HMA"),
    entity(29, "multi-channel", "text 28 100,131.5 MC"),
    entity(30, "optical (flash)", "text 25 100,132 OPT"),
    entity(31, "pack animal", "M84,140 L93,125 L100,140 L107,125 L116,140"),
    entity(32, "patient evacuation coordination", "text 16 122,129.5 PEC"),
    entity(33, "preventive maintenance", "text 28 100,131.5 PM"),
    entity(34, "psychological", "text 28 115,132.5 P"),
    entity(
        35,
        "radio relay line of sight",
        "circle 100,132 11; solid M90.8,128.2 C90.3,129.3 90,130.6 90,132 C90,133.4 90.3,134.7 90.8,135.8 L100,132 \
         Z M100,132 L109.3,135.8 C109.7,134.7 110,133.4 110,132 C110,130.6 109.7,129.3 109.3,128.2 Z",
    ),
    entity(36, "railroad", "@railroad-below"),
    entity(37, "recovery (unmanned systems)", "M70,125 C70,145 130,145 130,125"),
    entity(
        38,
        "recovery (maintenance)",
        "M75,125 C83,125 83,141 75,141 M83,133 L118,133 M126,125 C118,125 118,141 126,141",
    ),
    entity(39, "rescue coordination center", "text 16 122,130.5 RCC"),
    entity(40, "riverine", "@riverine-below"),
    entity(41, "single channel", "text 28 100,131.5 SC"),
    entity(42, "ski", "@ski-below"),
    entity(43, "short range", "text 28 100,131.5 SR"),
    entity(44, "strategic", "text 25 100,132 STR"),
    entity(45, "support", "text 25 100,132 SPT"),
    entity(46, "tactical", "text 25 100,132 TAC"),
    entity(47, "towed", "@towed-below"),
    entity(48, "troop", "text 28 100,131.5 TR"),
    entity(49, "vertical or short take-off and landing (VTOL/VSTOL)", "text 20 100,128.5 VTOL"),
    entity(50, "veterinary", "text 28 115,134.5 V"),
    entity(51, "wheeled", "@wheeled-below"),
    entity(52, "high to low altitude", "text 25 100,132 HLA"),
    entity(53, "medium to low altitude", "text 25 100,132 MLA"),
    entity(54, "attack", "text 28 100,131.5 A"),
    entity(55, "refuel", "text 28 100,131.5 K"),
    entity(56, "utility", "text 28 100,131.5 U"),
    entity(57, "combat search and rescue", "text 20 100,132.5 CSAR"),
    entity(58, "guerrilla", "text 28 100,131.5 G"),
    entity(59, "air assault", "M85,125 L100,145 L115,125"),
    entity(60, "amphibious", "@amphibious-below"),
    entity(61, "very heavy", "text 28 100,131.5 VH"),
    entity(62, "supply", "@supply"),
    entity(63, "cyberspace", "text 25 100,132 CYB"),
    entity(64, "Navy barge, self-propelled", "text 28 100,131.5 YS"),
    entity(65, "Navy barge, not self-propelled", "text 28 100,131.5 YB"),
    entity(66, "launch", "text 25 100,132 YFT"),
    entity(67, "landing craft", "text 28 100,131.5 LC"),
    entity(68, "landing ship", "text 28 100,131.5 LS"),
    entity(69, "service craft/yard", "text 28 100,131.5 YY"),
    entity(70, "harbor tug", "text 28 100,131.5 YT"),
    entity(71, "ocean going tug boat", "text 28 100,131.5 AT"),
    entity(72, "surface deployment and distribution command", "text 20 100,132.5 SDDC"),
    entity(
        73,
        "noncombatant generic vessel",
        "fill M95,135 L95,125 L105,125 L105,135 L110,135 L110,145 L90,145 L90,135 Z",
    ),
    entity(74, "composite", "text 20 100,132.5 COMP"),
    entity(75, "shelter", "fill M85,140 L115,140 L110,125 L100,120 L90,125 Z"),
    entity(76, "light and medium", "text 25 100,132 L/M"),
    entity(77, "tracked", "M84,125 L116,125 A116,133 8,8 -90 90 L84,141 A84,133 8,8 90 270 Z"),
    entity(78, "security force assistance", "text 25 100,132 SFA"),
    entity(
        81,
        "surgical",
        "M114,126 L135,132 L114,138 M114,138 A110.1,138.2 3.9,3.9 -3 77 A110.9,138.1 3.9,3.9 88 182 A110.9,137.9 \
         3.9,3.9 178 272 A110.1,137.8 3.9,3.9 -77 3 Z; circle 110.5,125.5 3.5",
    ),
    entity(
        82,
        "blood",
        "fill M120,121 C118,128 114,131 114,134 C114,137 116,140 120,140 C124,140 126,137 126,134 C126,131 122,128 \
         120,121 Z",
    ),
    entity(
        83,
        "combat and operational stress control",
        "fill M118.6,133 L118.4,124 L117.8,123 L116.2,122.8 L116.2,122.4 L123.8,122.4 L123.8,122.8 L122,123 \
         L121.4,124 L121.4,133 L123.8,132.4 L124.8,131.4 L125.4,125 L126.2,123 L127.6,122.2 L130,122.2 L130,122.8 \
         L128.4,123.4 L128.2,129 L127.2,131.4 L124.8,133.2 L121.4,133.8 L121.6,137.6 L124,138.4 L124,139 L116.2,139 \
         L116.2,138.4 L118.4,137.6 L118.6,133.8 L115.2,133.2 L112.8,131.4 L111.8,129 L111.6,123.4 L110,122.8 \
         L110,122.2 L112.2,122.2 L113.8,123.2 L114.6,125 L115,131.4 L116.2,132.4 Z",
    ),
    entity(84, "jamming", "@jamming-below"),
    entity(
        86,
        "optometry",
        "solid thin M135,129 C133.3,127.2 127.3,121.2 119.9,121.2 L119.7,121.2 C112.4,121.2 106.3,126.9 104.6,128.7 \
         C104.2,129.1 104.2,129.9 104.6,130.3 C106.3,132.2 112.3,138.1 119.7,138.2 L119.9,138.2 C127.2,138.2 \
         133.3,132.4 135,130.7 C135.4,130.2 135.5,129.5 135,129 Z M119.9,136.9 L119.7,136.9 C112.8,136.8 \
         107.1,131.2 105.5,129.6 C107.1,127.9 112.9,122.4 119.7,122.4 L119.9,122.4 C126.7,122.5 132.4,128.1 \
         134,129.8 C132.4,131.5 126.7,136.9 119.9,136.9 Z; fill circle 119.8,130.3 3.9",
    ),
    entity(
        87,
        "preventive medicine",
        "fill M116.6,121.7 L110.1,131.6 L114.6,131.6 L115.9,127.1 L118.8,133.9 L119.7,131.7 L123,131.7 Z \
         M116.2,130.9 L115.6,132.9 L109.3,132.9 L105.8,138.3 L127.2,138.3 L123.8,133 L120.5,133 L118.8,137.2 Z",
    ),
    entity(89, "air defense", "@dome"),
];

/// Of MIL-STD-2525E, in the place of those of sector 1 with the same numbers.
pub(super) const CHANGED_1: &[SymbolEntity] = &[
    entity(81, "NATO medical role 2 basic", "text 25 120,70 2B"),
    entity(82, "NATO medical role 2 enhanced", "text 25 120,70 2E"),
    entity(83, "NATO medical role 2 forward", "text 25 120,70 2E"),
];

/// Of MIL-STD-2525E, in the place of those of sector 2 with the same numbers.
pub(super) const CHANGED_2: &[SymbolEntity] = &[entity(
    11,
    "dental",
    "fill M108.8,142 L107.8,141.2 L107,138.4 L106.4,130.8 L105.2,126.8 L105.2,124.4 L106.4,122.6 L108,121.8 \
         L111.6,122.2 L116.4,122 L118,123.4 L118.6,125.8 L117.4,130.8 L116.8,137.8 L116.2,140.8 L115.4,142 \
         L114.4,141.6 L113.6,135.8 L112.8,134.2 L111.8,133.6 L110.4,135.4 L109.4,141.4 Z",
)];
