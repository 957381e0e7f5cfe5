//! Activities: MIL-STD-2525D, table A-XLVI and appendix G.

use crate::symbology::entities::{SymbolEntity, entity};

pub(super) const ACTIVITIES: &[SymbolEntity] = &[
    entity(110300, "improvised explosive device event", "text 39 IED"),
    entity(
        110600,
        "explosion",
        "M87,54 L97,70 L107,54 L112,74 L127,63 L127,84 L144,85 L134,95.5 L143,105 L128,106 L133,125 L112,120 \
         L107,141 L97.5,124 L86.5,145.5 L82,119.5 L62.5,131 L66.5,113.5 L52,104.5 L67,95.5 L57,85 L67,83.5 L67,64 \
         L82.5,74 Z",
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
