//! Land installations: MIL-STD-2525D, table A-XXVI and appendix D.

use crate::entities::entity::{SymbolEntity, entity};

pub(super) const LAND_INSTALLATIONS: &[SymbolEntity] = &[
    entity(
        110300,
        "ammunition cache",
        "@supply; M90,115 L90,92 A100,92 10,10 180 360 L110,115 M85,115 L115,115",
    ),
    entity(
        112000,
        "warehouse or storage facility",
        "pale M69,87.5 L104,87.5 L104,75 L110,75 L110,87.5 L117.5,87.5 L117.5,75 L123.5,75 L123.5,87.5 L131,87.5 \
         L131,125 L69,125 Z; text 23 STOR",
    ),
    entity(120702, "medical treatment facility (hospital)", "@cross; M70,90 L70,110 M130,90 L130,110"),
    entity(120802, "military base", "M75,85 L125,115 M125,85 L75,115"),
    entity(121301, "airport or air base", "bold @wheel; M80,70 L120,70 M81,79.5 L105,55"),
    entity(
        121305,
        "helicopter landing site",
        "circle 100,100 40; bold M80,70 L120,110 M120,70 L80,110 M100,90 L100,135 M95,135 L105,135; \
         pale M113,90 A100,90 13,25 0 360 Z",
    ),
    entity(
        121307,
        "railhead or railroad station",
        "bold @wheel; M60,70 L140,70; circle 64.5,75.5 5.5; circle 75.5,75.5 5.5; circle 124.5,75.5 5.5; circle 135.5,75.5 5.5",
    ),
    entity(
        121309,
        "sea port or naval base",
        "bold @wheel; circle 100,56 3.5; M91,60 L109,60 M100,60 L100,75; M89,68 Q91,75.5 100,75.5 Q109,75.5 111,68; \
         fill M87,65 L94,70 L88,75 Z M113,65 L106,70 L112,75 Z",
    ),
    entity(
        121402,
        "dam",
        "fill M96,80 L101.5,80 L112.5,120 L96,120 Z; \
         thin M65,86 Q69,90 73,86 Q77,90 81,86 Q85,90 89,86 Q92,90 96,86; \
         thin M65,95 Q69,99 73,95 Q77,99 81,95 Q85,99 89,95 Q92,99 96,95; \
         thin M65,104 Q69,108 73,104 Q77,108 81,104 Q85,108 89,104 Q92,108 96,104; \
         thin M65,113 Q69,117 73,113 Q77,117 81,113 Q85,117 89,113 Q92,117 96,113; \
         thin M111,113 Q115,117 119,113 Q123,117 127,113 Q131,117 135,113",
    ),
];
