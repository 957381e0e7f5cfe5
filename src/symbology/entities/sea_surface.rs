//! Ships: MIL-STD-2525D, table A-XXX and appendix E.

use crate::entities::entity::{SymbolEntity, entity};

pub(super) const SHIPS: &[SymbolEntity] = &[
    entity(110000, "military", "text 39 MIL"),
    entity(120100, "carrier", "fill M78.5,79 L101.5,79 L101.5,99 L124,99 L100,122 L78.5,101 Z"),
    entity(120202, "cruiser", "text 45 CG"),
    entity(120203, "destroyer", "text 45 DD"),
    entity(120204, "frigate", "text 45 FF"),
    entity(120205, "corvette", "text 45 FS"),
    entity(120300, "amphibious warfare ship", "@hull; M100,120.5 L118,120.5"),
    entity(
        120400,
        "mine warfare ship",
        "fill circle 100,97 13; fill M77,99 L123,99 L100,122 Z; fill M75.5,96 L124.5,96 L124.5,101.5 L75.5,101.5 Z; \
         broad M100,80 L100,90 M86,84 L92,90 M114,84 L108,90",
    ),
    entity(120500, "patrol boat", "@hull"),
    entity(130100, "auxiliary ship", "text 45 AA"),
    entity(140000, "civilian", "pale text 39 CIV"),
    entity(
        140100,
        "merchant ship",
        "pale M75,65 L125,65 L125,100.5 L145,100.5 L131,135 L70,135 L55.5,100.5 L75,100.5 Z",
    ),
];
