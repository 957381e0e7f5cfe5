//! Civilian units and organizations on land: MIL-STD-2525D, appendix D.

use crate::entities::entity::{SymbolEntity, entity};

pub(super) const LAND_CIVILIANS: &[SymbolEntity] = &[
    entity(110000, "civilian", "pale text 39 CIV"),
    entity(
        110100,
        "environmental protection",
        "M100,80 L90,95 L95,95 L85,105 L90,105 L80,115 L95,115 L95,120 L105,120 L105,115 L120,115 L110,105 L115,105 \
         L105,95 L110,95 Z",
    ),
    entity(110200, "governmental organization", "text 45 GO"),
    entity(110300, "individual", "@individual"),
    entity(
        110400,
        "organization or group",
        "M125,97.3 L125,122.3 M115,102.3 L135,102.3 M75,97.3 L75,122.3 M65,102.3 L85,102.3 M100,102.3 L100,127.3 \
         M90,107.3 L110,107.3; circle 125.5,90 7.6; circle 75.5,90 7.6; circle 100.5,95 7.6",
    ),
    entity(110500, "killing victim", "@killing-victim"),
    entity(110600, "killing victims", "@killing-victims"),
    entity(
        110700,
        "victim of an attempted crime",
        "@individual; M127,114.4 L132,117.1 M117,109 L122,111.7 M107,103.6 L112,106.3 M97,98.1 L102,100.9 M87,92.7 \
         L92,95.4 M77,87.3 L82,90 M67,81.9 L72,84.6",
    ),
    entity(110800, "spy", "text 39 SPY"),
    entity(110900, "composite loss", "M100,85 L100,115 M65,100 L110,100; circle 120,100 10"),
    entity(111000, "emergency medical operation", "@emergency-medical-operation"),
];
