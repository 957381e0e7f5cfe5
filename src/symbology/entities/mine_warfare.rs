//! Mines at sea in the colors of the mine warfare evaluation and decision aids library (MEDAL): MIL-STD-2525D.

use crate::entities::entity::{SymbolEntity, entity};

pub(super) const SEA_MINES: &[SymbolEntity] = &[
    entity(110000, "sea mine, general", "@sea-mine"),
    entity(110100, "sea mine, bottom", "@sea-mine; red M74.8,125.2 L125.2,125.2 L125.2,137.8 L74.8,137.8 Z"),
    entity(110200, "sea mine, moored", "@sea-mine; M75.5,136.8 L124.5,136.8 M100,130.5 L100,137.8"),
    entity(
        110300,
        "sea mine, floating",
        "@sea-mine; M75,140 L80,130 L85,140 L90,130 L95,140 L100,130 L105,140 L110,130 L115,140 L120,130 L125,140",
    ),
    entity(110400, "sea mine, rising", "@sea-mine; red M100,128 L90,143 L110,143 Z"),
    entity(110500, "sea mine, other position", "@sea-mine; M130,100 L145,100 M70,100 L55,100"),
    entity(110600, "kingfisher", "@sea-mine; text 35 K"),
    entity(110700, "small object, mine-like", "@sea-mine; text 30 100,100.5 SO"),
    entity(110800, "exercise mine, general", "@sea-mine-exercise-mine"),
    entity(
        110801,
        "exercise mine, general, exercise mine, bottom",
        "@sea-mine-exercise-mine; green M74.8,125.2 L125.2,125.2 L125.2,137.8 L74.8,137.8 Z",
    ),
    entity(
        110802,
        "exercise mine, general, exercise mine, moored",
        "@sea-mine-exercise-mine; M75.5,136.8 L124.5,136.8 M100,130.5 L100,137.8",
    ),
    entity(
        110803,
        "exercise mine, general, exercise mine, floating",
        "@sea-mine-exercise-mine; M75,140 L80,130 L85,140 L90,130 L95,140 L100,130 L105,140 L110,130 L115,140 \
         L120,130 L125,140",
    ),
    entity(
        110804,
        "exercise mine, general, exercise mine, rising",
        "@sea-mine-exercise-mine; green M100,128 L90,143 L110,143 Z",
    ),
    entity(110900, "neutralized mine, general", "@sea-mine-neutralized"),
    entity(
        110901,
        "neutralized mine, general, neutralized mine, bottom",
        "@sea-mine-neutralized; lime M74.8,125.2 L125.2,125.2 L125.2,137.8 L74.8,137.8 Z",
    ),
    entity(
        110902,
        "neutralized mine, general, neutralized mine, moored",
        "@sea-mine-neutralized; M75.5,136.8 L124.5,136.8 M100,130.5 L100,137.8",
    ),
    entity(
        110903,
        "neutralized mine, general, neutralized mine, floating",
        "@sea-mine-neutralized; M75,140 L80,130 L85,140 L90,130 L95,140 L100,130 L105,140 L110,130 L115,140 \
         L120,130 L125,140",
    ),
    entity(
        110904,
        "neutralized mine, general, neutralized mine, rising",
        "@sea-mine-neutralized; lime M100,128 L90,143 L110,143 Z",
    ),
    entity(
        110905,
        "neutralized mine, general, neutralized mine, other position",
        "@sea-mine-neutralized; M130,100 L145,100 M70,100 L55,100",
    ),
    entity(
        120000,
        "unexploded ordnance",
        "red-line dashed M85,65 L115,65 L135,85 L135,115 L115,135 L85,135 L65,115 L65,85 Z; red text 30 100,100.5 \
         UXO",
    ),
    entity(130000, "sea mine decoy", "@sea-mine-decoy"),
    entity(
        130100,
        "sea mine decoy, bottom",
        "@sea-mine-decoy; green M74.8,125.2 L125.2,125.2 L125.2,137.8 L74.8,137.8 Z",
    ),
    entity(130200, "sea mine decoy, moored", "@sea-mine-decoy; M75,140 L125,140 M100,100 L100,140"),
    entity(140000, "mine-like contact (MILCO)", ""),
    entity(140100, "MILCO - general", "@sea-mine-milco 0,0 1.3"),
    entity(140101, "MILCO - general, confidence level 1", "@sea-mine-milco 0,0 1.3; text 46 1"),
    entity(140102, "MILCO - general, confidence level 2", "@sea-mine-milco 0,0 1.3; text 46 2"),
    entity(140103, "MILCO - general, confidence level 3", "@sea-mine-milco 0,0 1.3; text 46 3"),
    entity(140104, "MILCO - general, confidence level 4", "@sea-mine-milco 0,0 1.3; text 46 4"),
    entity(140105, "MILCO - general, confidence level 5", "@sea-mine-milco 0,0 1.3; text 46 5"),
    entity(140200, "MILCO - bottom", "@sea-mine-milco-bottom"),
    entity(140201, "MILCO - bottom, confidence level 1", "@sea-mine-milco-bottom; text 35 1"),
    entity(140202, "MILCO - bottom, confidence level 2", "@sea-mine-milco-bottom; text 35 2"),
    entity(140203, "MILCO - bottom, confidence level 3", "@sea-mine-milco-bottom; text 35 3"),
    entity(140204, "MILCO - bottom, confidence level 4", "@sea-mine-milco-bottom; text 35 4"),
    entity(140205, "MILCO - bottom, confidence level 5", "@sea-mine-milco-bottom; text 35 5"),
    entity(140300, "MILCO - moored", "@sea-mine-milco-moored"),
    entity(140301, "MILCO - moored, confidence level 1", "@sea-mine-milco-moored; text 35 1"),
    entity(140302, "MILCO - moored, confidence level 2", "@sea-mine-milco-moored; text 35 2"),
    entity(140303, "MILCO - moored, confidence level 3", "@sea-mine-milco-moored; text 35 3"),
    entity(140304, "MILCO - moored, confidence level 4", "@sea-mine-milco-moored; text 35 4"),
    entity(140305, "MILCO - moored, confidence level 5", "@sea-mine-milco-moored; text 35 5"),
    entity(140400, "MILCO - floating", "@sea-mine-milco-floating"),
    entity(140401, "MILCO - floating, confidence level 1", "@sea-mine-milco-floating; text 35 1"),
    entity(140402, "MILCO - floating, confidence level 2", "@sea-mine-milco-floating; text 35 2"),
    entity(140403, "MILCO - floating, confidence level 3", "@sea-mine-milco-floating; text 35 3"),
    entity(140404, "MILCO - floating, confidence level 4", "@sea-mine-milco-floating; text 35 4"),
    entity(140405, "MILCO - floating, confidence level 5", "@sea-mine-milco-floating; text 35 5"),
    entity(150000, "mine-like echo (MILEC), general", "@sea-mine-milec 0,0 1.3"),
    entity(
        150100,
        "mine-like echo, bottom",
        "@sea-mine-milec; yellow M74.8,125.2 L125.2,125.2 L125.2,137.8 L74.8,137.8 Z",
    ),
    entity(
        150200,
        "mine-like echo, moored",
        "@sea-mine-milec; M75.5,136.8 L124.5,136.8 M100,128.5 L100,137.8",
    ),
    entity(
        150300,
        "mine-like echo, floating",
        "@sea-mine-milec; M75,140 L80,130 L85,140 L90,130 L95,140 L100,130 L105,140 L110,130 L115,140 L120,130 \
         L125,140",
    ),
    entity(160000, "negative reacquisition, general", "@sea-mine-negative-reacquisition 0,0 1.3"),
    entity(
        160100,
        "negative reacquisition, bottom",
        "@sea-mine-negative-reacquisition; yellow M74.8,125.2 L125.2,125.2 L125.2,137.8 L74.8,137.8 Z",
    ),
    entity(
        160200,
        "negative reacquisition, moored",
        "@sea-mine-negative-reacquisition; M75.5,136.8 L124.5,136.8 M100,130.5 L100,137.8",
    ),
    entity(
        160300,
        "negative reacquisition, floating",
        "@sea-mine-negative-reacquisition; M75,140 L80,130 L85,140 L90,130 L95,140 L100,130 L105,140 L110,130 \
         L115,140 L120,130 L125,140",
    ),
    entity(
        170000,
        "obstructor",
        "yellow bold M117.9,135.9 L82.1,135.9 L64.1,117.9 L64.1,82.1 L82.1,64.1 L117.9,64.1 L135.9,82.1 \
         L135.9,117.9 Z; text 39 100,100.5 OB",
    ),
    entity(
        170100,
        "neutralized obstructor",
        "lime M113.8,127.6 L86.2,127.6 L72.4,113.8 L72.4,86.2 L86.2,72.4 L113.8,72.4 L127.6,86.2 L127.6,113.8 Z; \
         text 30 100,101.5 OB; broad M135,65 L65,135 M65,65 L135,135",
    ),
    entity(
        180000,
        "general mine anchor",
        "green bold M117.9,135.9 L82.1,135.9 L64.1,117.9 L64.1,82.1 L82.1,64.1 L117.9,64.1 L135.9,82.1 L135.9,117.9 \
         Z; text 23 100,102 ANCR",
    ),
    entity(190000, "non-mine mine-like object (NMLO), general", "@sea-mine-non-mine 0,0 1.3"),
    entity(
        190100,
        "non-mine mine-like object, bottom",
        "@sea-mine-non-mine; green M74.8,125.2 L125.2,125.2 L125.2,137.8 L74.8,137.8 Z",
    ),
    entity(
        190200,
        "non-mine mine-like object, moored",
        "@sea-mine-non-mine; M75.5,136.8 L124.5,136.8 M100,128.5 L100,137.8",
    ),
    entity(
        190300,
        "non-mine mine-like object, floating",
        "@sea-mine-non-mine; M75,140 L80,130 L85,140 L90,130 L95,140 L100,130 L105,140 L110,130 L115,140 L120,130 \
         L125,140",
    ),
    entity(
        200000,
        "environmental report location",
        "lime-line M70,70 L70,130 L130,130 L130,70 Z; lime text 60 100,102 E",
    ),
    entity(
        210000,
        "dive report location",
        "lime-line M70,70 L70,130 L130,130 L130,70 Z; lime text 60 100,102 D",
    ),
];
