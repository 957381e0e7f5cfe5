//! Submarines and what lies below the sea: MIL-STD-2525D, appendix F.

use crate::entities::entity::{SymbolEntity, entity};

pub(super) const SUBMARINES: &[SymbolEntity] = &[
    entity(110000, "military", "text 39 MIL"),
    entity(110100, "submarine", "solid M75,85 L125,85 L140,100 L125,115 L75,115 L60,100 Z"),
    entity(
        110101,
        "submarine, surfaced",
        "solid M75,80 L125,80 L140,95 L125,110 L75,110 L60,95 Z; M65,120 L75,110 L85,120 L95,110 L105,120 L115,110 \
         L125,120 L135,110",
    ),
    entity(
        110102,
        "submarine, snorkeling",
        "solid M75,120 L65,110 L75,100 L95,100 L95,80 L105,80 L105,100 L125,100 L135,110 L125,120 Z; M65,95 L75,85 \
         L85,95 L95,85 L105,95 L115,85 L125,95 L135,85",
    ),
    entity(
        110103,
        "submarine, bottomed",
        "solid M75,80 L125,80 L140,95 L125,110 L75,110 L60,95 Z; solid M70,120 L70,115 L130,115 L130,120 Z",
    ),
    entity(
        110200,
        "other submersible",
        "solid M85,90 L85,80 L115,80 L115,90 M135,100 C135,105.5 119.3,110 100,110 C80.7,110 65,105.5 65,100 \
         C65,94.5 80.7,90 100,90 C119.3,90 135,94.5 135,100 Z",
    ),
    entity(110300, "nonsubmarine", "text 23 100,91 NON; text 23 100,111 SUB"),
    entity(
        110400,
        "autonomous underwater vehicle (auv)/unmanned underwater vehicle (UUV)",
        "fill M60,84 L100,104 L140,84 L140,92 L100,117 L60,92 Z",
    ),
    entity(
        110500,
        "diver",
        "fill M100,80 C93.7,80 88.3,82.7 85.8,88.3 L77.8,88.3 L77.8,105 L85.8,105 L85.8,104.8 C87.3,108.2 88.8,110 \
         92,111.7 L92.1,111.7 L84.2,120 L115.8,120 L107.9,111.7 L108,111.7 C111.1,110 112.8,108.3 114.3,105 \
         L122.2,105 L122.2,88.3 L114.3,88.3 C111.7,82.8 106.3,80 100,80 Z M100,86.6 C105.4,86.6 109.8,91.1 \
         109.8,96.6 C109.8,102.1 105.4,106.6 100,106.6 C94.6,106.6 90.1,102.1 90.1,96.6 C90.1,91.1 94.6,86.6 \
         100,86.6 Z M100,89.6 C96.2,89.6 93.1,92.7 93.1,96.6 C93.1,100.5 96.2,103.6 100,103.6 C103.8,103.6 \
         106.8,100.5 106.8,96.6 C106.8,92.7 103.8,89.6 100,89.6 Z",
    ),
    entity(120000, "civilian", "pale text 39 CIV"),
    entity(
        120100,
        "submersible",
        "pale M85,90 L85,80 L115,80 L115,90 M135,100 C135,105.5 119.3,110 100,110 C80.7,110 65,105.5 65,100 \
         C65,94.5 80.7,90 100,90 C119.3,90 135,94.5 135,100 Z",
    ),
    entity(
        120200,
        "autonomous underwater vehicle (AUV)/unmanned underwater vehicle (UUV)",
        "pale M60,84 L100,104 L140,84 L140,92 L100,117 L60,92 Z",
    ),
    entity(
        120300,
        "diver",
        "pale M114.3,94 C114.3,102.3 107.9,109 100,109 C92.1,109 85.8,102.3 85.8,94 C85.8,85.7 92.2,79 100,79 \
         C107.9,79 114.3,85.7 114.3,94 Z M114.3,121 L128.6,136 L71.6,136 L85.9,121 M125.7,79 L140,79 L140,109 \
         L125.7,109 M74.4,109 L60.1,109 L60.1,79 L74.4,79 M128.6,94 C128.6,110.6 115.8,124 100.1,124 C84.4,124 \
         71.6,110.6 71.6,94 C71.5,77.4 84.3,64 100,64 C115.7,64 128.5,77.4 128.5,94 Z",
    ),
    entity(130000, "weapon", "text 39 WPN"),
    entity(
        130100,
        "torpedo",
        "solid M65,105 L60,100 L65,95 L125,95 C125,95 130,100 130,100 L135,95 L135,105 L130,100 L125,105 Z",
    ),
    entity(130200, "improvised explosive device (IED)", "text 39 IED"),
    entity(
        130300,
        "decoy",
        "solid M85,81 L65,98 L85,119 Z M110,81 L90,98 L110,119 Z M135,81 L115,98 L135,119 Z",
    ),
    entity(140000, "echo tracker classifier (ETC)/possible contact (POSCON)", "text 60 100,115 ?"),
    entity(150000, "fused track", "text 45 ?; M70,65 L80,100 L70,135 L130,135 L120,100 L130,65"),
    entity(160000, "manual track", "text 39 MAN"),
    entity(
        200000,
        "seabed installation, man-made, military",
        "solid M75,80 L75,120 L125,120 L125,105 L110,105 L110,95 L90,95 L90,80 Z",
    ),
    entity(
        210000,
        "seabed installation, man-made, non-military",
        "pale M75,80 L75,120 L125,120 L125,105 L110,105 L110,95 L90,95 L90,80 Z",
    ),
];
