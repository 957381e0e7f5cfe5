//! Aircraft: MIL-STD-2525D, table A-III and appendix B.

use crate::entities::entity::{SymbolEntity, entity};

pub(super) const AIRCRAFT: &[SymbolEntity] = &[
    entity(110000, "military", "text 39 MIL"),
    entity(
        110100,
        "military, fixed wing",
        "fill M100,79 Q103,79 103,84 L103,92 L122,106.5 L121.5,112 L103,103.5 L102.5,113.5 L107.5,117 L107.5,120.5 L100,118.5 \
         L92.5,120.5 L92.5,117 L97.5,113.5 L97,103.5 L78.5,112 L78,106.5 L97,92 L97,84 Q97,79 100,79 Z",
    ),
    entity(110102, "attack or strike", "text 45 A"),
    entity(110103, "bomber", "text 45 B"),
    entity(110104, "fighter", "text 45 F"),
    entity(110107, "cargo", "text 45 C"),
    entity(110109, "tanker", "text 45 K"),
    entity(110111, "reconnaissance aircraft", "text 45 R"),
    entity(110200, "military, rotary wing", "fill M59,83 L100,97.5 L141,83 L141,117 L100,102.5 L59,117 Z"),
    entity(110300, "unmanned aircraft", "@unmanned"),
    entity(120000, "civilian", "pale text 39 CIV"),
    entity(
        120100,
        "civilian, fixed wing",
        "pale M96,81 L104,81 L104,84 L106,84 L106,90.5 L126,90.5 L126,100 L106,100 L104,116 L113,116 L113,120 L87,120 \
         L87,116 L96,116 L94,100 L74,100 L74,90.5 L94,90.5 L94,84 L96,84 Z",
    ),
    entity(
        120200,
        "civilian, rotary wing",
        "pale M60,84.5 L100,100 L60,115.5 Z; pale M140,84.5 L100,100 L140,115.5 Z",
    ),
];
