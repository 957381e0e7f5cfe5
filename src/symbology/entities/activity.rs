//! Activities: MIL-STD-2525D, table A-XLVI and appendix G.

use crate::entities::entity::{SymbolEntity, entity};

pub(super) const ACTIVITIES: &[SymbolEntity] = &[
    entity(110300, "improvised explosive device event", "text 39 IED"),
    entity(
        110600,
        "explosion",
        "M90,55 L100,70 L110,55 L115,75 L130,65 L130,80 L145,85 L130,95 L145,105 L130,110 L135,125 L115,120 L110,140 \
         L100,125 L90,145 L85,120 L65,130 L70,115 L55,105 L70,95 L60,85 L70,80 L70,65 L85,75 Z",
    ),
    entity(120100, "demonstration", "text 33 MASS"),
    entity(
        130100,
        "patrolling",
        "M125,90 L85,90 L100,105 L61,105 M75,95 L61,105 L75,115; M130,97.5 L130,82 L135,82 A135,86 4,4 -90 90 L130,90",
    ),
    entity(
        130500,
        "mine laying",
        "M59.5,85 L140.5,85 L140.5,115 L59.5,115 Z; fill circle 75,100 10; fill circle 100,100 10; fill circle 125,100 10",
    ),
    entity(
        170202,
        "flood",
        "thin M78,117 L78,93.5 L100,73.5 L122,93.5 L122,117 M78,93.5 L122,93.5; \
         fill M64,116 Q69,121 73,117 Q78,121 83,117 Q88,121 93,117 Q98,121 103,117 Q108,121 113,117 Q118,121 123,117 \
         Q130,121 136,117 L136,126 L64,126 Z",
    ),
];
