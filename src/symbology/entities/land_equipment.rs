//! Land equipment: MIL-STD-2525D, table A-XXIII and appendix D.

use crate::entities::entity::{SymbolEntity, entity};

pub(super) const LAND_EQUIPMENT: &[SymbolEntity] = &[
    entity(110200, "machine gun", "@arrow; M100,60 L100,140 M80,140 L120,140"),
    entity(110500, "air defense gun", "@barrels; M100,60 L100,125; @shield"),
    entity(110600, "antitank gun", "@barrels; M100,60 L100,125 M85,140 L100,125 L115,140"),
    entity(110900, "howitzer", "@barrels; M100,60 L100,120; circle 100,130 10"),
    entity(
        111100,
        "air defense missile launcher",
        "@launcher; M85,140 L85,75 M115,75 L115,140 M100,60 L100,125; @shield",
    ),
    entity(
        111200,
        "antitank missile launcher",
        "@launcher; M85,120 L85,75 M115,75 L115,120 M100,60 L100,125 M85,140 L100,125 L115,140",
    ),
    entity(
        111300,
        "surface-to-surface missile launcher",
        "@launcher; M85,75 L85,140 L115,140 L115,75 M100,60 L100,140",
    ),
    entity(111400, "mortar", "@arrow; M100,60 L100,120; circle 100,130 10"),
    entity(
        111600,
        "multiple rocket launcher",
        "@arrow; M85,85 L100,70 L115,85 M100,70 L100,140 M85,90 L85,130 M115,90 L115,130",
    ),
    entity(
        120101,
        "armored fighting vehicle",
        "M70,70 L70,130 M130,70 L130,130 M70,100 L100,70 L130,100 L100,130 Z",
    ),
    entity(120103, "armored personnel carrier", "M70,70 L70,130 L130,130 L130,70 M70,79.5 L100,70 L130,79.5"),
    entity(120200, "tank", "M70,70 L70,130 M130,70 L130,130 M70,80 L130,80 M70,120 L130,120"),
    entity(130100, "bridge", "bold M70,85 L80,95 L120,95 L130,85 M70,115 L80,105 L120,105 L130,115"),
    entity(130900, "mine clearing equipment", "M100,80 L100,95 M100,95 L131,120 L69,120 Z"),
    entity(140100, "vehicle", "M70,65 L70,130 L130,130 L130,65 M70,67 Q100,87 130,67"),
    entity(210100, "land mine", "circle 100,100 22.5"),
    entity(220300, "radar", "M70,70 Q70,120 120,120 M72.5,94 L102.5,69.5 L102.5,95.5 L132,70.5"),
];
