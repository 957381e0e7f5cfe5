//! The table of graphics: their words and codes, draw rules, points and fields.

use crate::graphic::kind::{DrawRule, GraphicKind, GraphicShape, GraphicTint, MOST_POINTS};
use crate::graphic::{area, axis, corridor, crossing, fires, lines, point, task, teeth, wire};

impl GraphicKind {
    /// The kind with a word.
    pub fn of_word(word: &str) -> Option<&'static Self> {
        GRAPHIC_KINDS.iter().find(|kind| kind.word == word)
    }

    /// The kind with a six-digit code of symbol set 25.
    pub fn of_code(code: &str) -> Option<&'static Self> {
        GRAPHIC_KINDS.iter().find(|kind| kind.code == code)
    }
}

#[expect(clippy::too_many_arguments, reason = "the columns of one table")]
const fn row(
    word: &'static str,
    code: &'static str,
    name: &'static str,
    rule: &'static str,
    shape: GraphicShape,
    points: [usize; 2],
    fields: &'static str,
    label: &'static str,
    tint: GraphicTint,
    rule_fn: DrawRule,
) -> GraphicKind {
    GraphicKind { word, code, name, rule, shape, points, fields, label, tint, rule_fn }
}

/// Every graphic, by code.
#[rustfmt::skip]
pub const GRAPHIC_KINDS: &[GraphicKind] = &[
    // Command and control.
    row("boundary", "110100", "Boundary", "LINE7", GraphicShape::Line, [2, MOST_POINTS], "T T1 B AS", "", GraphicTint::Own, lines::boundary),
    row("light_line", "110200", "Light line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "LL", GraphicTint::Own, lines::end_labeled),
    row("engineer_work_line", "110300", "Engineer work line", "LINE7", GraphicShape::Line, [2, MOST_POINTS], "T T1 AS", "EWL {}", GraphicTint::Own, lines::middle_labeled),
    row("area_of_operations", "120100", "Area of operations", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "AO {}", GraphicTint::Own, area::area),
    row("named_area_of_interest", "120200", "Named area of interest", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "NAI {}", GraphicTint::Own, area::area),
    row("targeted_area_of_interest", "120300", "Targeted area of interest", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "TAI {}", GraphicTint::Own, area::area),
    row("action_point", "130100", "Action point", "POINT1", GraphicShape::Point, [1, 1], "T N W W1", "", GraphicTint::Own, point::flagged),
    row("amnesty_point", "130200", "Amnesty point", "POINT1", GraphicShape::Point, [1, 1], "T N W W1", "AMN", GraphicTint::Own, point::flagged),
    row("checkpoint", "130300", "Checkpoint", "POINT1", GraphicShape::Point, [1, 1], "T N W W1", "CKP", GraphicTint::Own, point::flagged),
    row("contact_point", "130500", "Contact point", "POINT2", GraphicShape::Point, [1, 1], "T", "", GraphicTint::Own, point::contact_point),
    row("coordinating_point", "130600", "Coordinating point", "POINT2", GraphicShape::Point, [1, 1], "", "", GraphicTint::Own, point::coordinating),
    row("decision_point", "130700", "Decision point", "POINT2", GraphicShape::Point, [1, 1], "T", "", GraphicTint::Own, point::decision),
    row("entry_control_point", "130900", "Entry control point", "POINT1", GraphicShape::Point, [1, 1], "T N W W1", "ECP", GraphicTint::Own, point::flagged),
    row("linkup_point", "131100", "Linkup point", "POINT1", GraphicShape::Point, [1, 1], "T N W W1", "LU", GraphicTint::Own, point::flagged),
    row("passage_point", "131200", "Passage point", "POINT1", GraphicShape::Point, [1, 1], "T N W W1", "PP", GraphicTint::Own, point::flagged),
    row("rally_point", "131400", "Rally point", "POINT1", GraphicShape::Point, [1, 1], "T N W W1", "RLY", GraphicTint::Own, point::flagged),
    row("release_point", "131500", "Release point", "POINT1", GraphicShape::Point, [1, 1], "T N W W1", "RP", GraphicTint::Own, point::flagged),
    row("start_point", "131600", "Start point", "POINT1", GraphicShape::Point, [1, 1], "T N W W1", "SP", GraphicTint::Own, point::flagged),
    row("waypoint", "131800", "Waypoint", "POINT2", GraphicShape::Point, [1, 1], "T", "{}", GraphicTint::Own, point::circled),
    row("key_terrain", "132100", "Key terrain", "POINT2", GraphicShape::Point, [1, 1], "", "", GraphicTint::Own, point::key_terrain),
    // Maneuver lines.
    row("forward_line_of_troops", "140100", "Forward line of troops", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "W W1", "FLOT", GraphicTint::Own, teeth::flot),
    row("line_of_contact", "140200", "Line of contact", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "W W1", "LC", GraphicTint::Own, teeth::contact),
    row("phase_line", "140300", "Phase line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "PL {}", GraphicTint::Own, lines::end_labeled),
    row("forward_edge_of_battle_area", "140400", "Forward edge of the battle area", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "FEBA", GraphicTint::Own, lines::end_labeled),
    row("principal_direction_of_fire", "140500", "Principal direction of fire", "LINE3", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Own, fires::principal_direction),
    row("attack_by_aviation", "140601", "Direction of attack, aviation", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "{}", GraphicTint::Own, lines::direction_of_attack),
    row("main_direction_of_attack", "140602", "Direction of main attack", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "{}", GraphicTint::Own, lines::direction_of_attack),
    row("supporting_direction_of_attack", "140603", "Direction of supporting attack", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "{}", GraphicTint::Own, lines::direction_of_attack),
    row("feint_direction_of_attack", "140605", "Direction of attack, feint", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "{}", GraphicTint::Own, lines::direction_of_attack),
    row("final_coordination_line", "140700", "Final coordination line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "FCL", GraphicTint::Own, lines::end_labeled),
    row("infiltration_lane", "140800", "Infiltration lane", "POLYLINE1", GraphicShape::Wide, [3, MOST_POINTS], "T", "{}", GraphicTint::Own, corridor::infiltration_lane),
    row("limit_of_advance", "140900", "Limit of advance", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "LOA", GraphicTint::Own, lines::end_labeled),
    row("line_of_departure", "141000", "Line of departure", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "LD", GraphicTint::Own, lines::end_labeled),
    row("line_of_departure_and_contact", "141100", "Line of departure and line of contact", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "LD/LC", GraphicTint::Own, lines::end_labeled),
    row("line_of_deployment", "141200", "Probable line of deployment", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "PLD", GraphicTint::Own, lines::end_labeled),
    row("bridgehead_line", "141400", "Bridgehead line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "BL", GraphicTint::Own, lines::end_labeled),
    row("holding_line", "141500", "Holding line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "HL", GraphicTint::Own, lines::end_labeled),
    row("release_line", "141600", "Release line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "RL", GraphicTint::Own, lines::end_labeled),
    row("ambush", "141700", "Ambush", "LINE29", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Own, task::ambush),
    // Maneuver areas.
    row("assembly_area", "150200", "Assembly area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "AA {}", GraphicTint::Own, area::area),
    row("occupied_assembly_area", "150300", "Occupied assembly area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "AA {}", GraphicTint::Own, area::area),
    row("drop_zone", "150600", "Drop zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "DZ {}", GraphicTint::Own, area::area),
    row("extraction_zone", "150700", "Extraction zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "EZ {}", GraphicTint::Own, area::area),
    row("landing_zone", "150800", "Landing zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "LZ {}", GraphicTint::Own, area::area),
    row("pickup_zone", "150900", "Pickup zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "PZ {}", GraphicTint::Own, area::area),
    row("fortified_area", "151000", "Fortified area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "{}", GraphicTint::Own, teeth::fortified),
    row("battle_position", "151200", "Battle position", "AREA3", GraphicShape::Area, [3, MOST_POINTS], "T B", "{}", GraphicTint::Own, area::battle_position),
    row("strong_point", "151203", "Strong point", "AREA4", GraphicShape::Area, [3, MOST_POINTS], "T B", "{}", GraphicTint::Own, teeth::strong_point),
    row("contain", "151204", "Contain", "AREA5", GraphicShape::Figure, [3, 3], "", "C", GraphicTint::Own, task::contain),
    row("retain", "151205", "Retain", "AREA6", GraphicShape::Figure, [2, 2], "", "R", GraphicTint::Own, task::circle_task),
    row("engagement_area", "151300", "Engagement area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "EA {}", GraphicTint::Own, area::area),
    row("axis_aviation", "151401", "Axis of advance, aviation", "AXIS1", GraphicShape::Axis, [3, 50], "T W W1", "{}", GraphicTint::Own, axis::axis),
    row("axis_attack_helicopter", "151402", "Axis of advance, attack helicopter", "AXIS1", GraphicShape::Axis, [3, 50], "T W W1", "{}", GraphicTint::Own, axis::axis),
    row("axis_main_attack", "151403", "Axis of advance, main attack", "AXIS2", GraphicShape::Axis, [3, 50], "T W W1", "{}", GraphicTint::Own, axis::axis),
    row("axis_supporting_attack", "151404", "Axis of advance, supporting attack", "AXIS2", GraphicShape::Axis, [3, 50], "T W W1", "{}", GraphicTint::Own, axis::axis),
    row("axis_feint", "151406", "Axis of advance, feint", "AXIS2", GraphicShape::Axis, [3, 50], "T W W1", "{}", GraphicTint::Own, axis::axis),
    row("assault_position", "151500", "Assault position", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "ASLT {}", GraphicTint::Own, area::area),
    row("attack_position", "151600", "Attack position", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "ATK {}", GraphicTint::Own, area::area),
    row("objective", "151700", "Objective", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "OBJ {}", GraphicTint::Own, area::area),
    row("penetration_box", "151900", "Penetration box", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "", "", GraphicTint::Own, area::area),
    row("attack_by_fire", "152000", "Attack by fire position", "AREA7", GraphicShape::Figure, [3, 3], "T", "{}", GraphicTint::Own, task::by_fire),
    row("support_by_fire", "152100", "Support by fire", "AREA8", GraphicShape::Figure, [4, 4], "T", "{}", GraphicTint::Own, task::by_fire),
    row("observation_post", "160100", "Observation post", "POINT2", GraphicShape::Point, [1, 1], "T", "", GraphicTint::Own, point::outpost),
    row("reconnaissance_outpost", "160201", "Reconnaissance outpost", "POINT2", GraphicShape::Point, [1, 1], "T", "R", GraphicTint::Own, point::outpost),
    row("forward_observer", "160202", "Forward observer position", "POINT2", GraphicShape::Point, [1, 1], "T", "F", GraphicTint::Own, point::outpost),
    row("target_reference_point", "160300", "Target reference point", "POINT2", GraphicShape::Point, [1, 1], "T", "", GraphicTint::Own, point::crossed),
    // Airspace.
    row("air_corridor", "170100", "Air corridor", "CORRIDOR1", GraphicShape::Corridor, [2, MOST_POINTS], "T AM X W W1", "AC {}", GraphicTint::Own, corridor::air_corridor),
    row("low_level_transit_route", "170200", "Low level transit route", "CORRIDOR1", GraphicShape::Corridor, [2, MOST_POINTS], "T AM X W W1", "LLTR {}", GraphicTint::Own, corridor::air_corridor),
    row("minimum_risk_route", "170300", "Minimum-risk route", "CORRIDOR1", GraphicShape::Corridor, [2, MOST_POINTS], "T AM X W W1", "MRR {}", GraphicTint::Own, corridor::air_corridor),
    row("safe_lane", "170400", "Safe lane", "CORRIDOR1", GraphicShape::Corridor, [2, MOST_POINTS], "T AM X W W1", "SL {}", GraphicTint::Own, corridor::air_corridor),
    row("standard_army_aircraft_route", "170500", "Standard use Army aircraft flight route", "CORRIDOR1", GraphicShape::Corridor, [2, MOST_POINTS], "T AM X W W1", "SAAFR {}", GraphicTint::Own, corridor::air_corridor),
    row("restricted_operations_zone", "171000", "Restricted operations zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "ROZ {}", GraphicTint::Own, area::area),
    row("missile_engagement_zone", "171600", "Missile engagement zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "MEZ {}", GraphicTint::Own, area::area),
    row("weapons_free_zone", "172000", "Weapons free zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "WFZ {}", GraphicTint::Own, area::area),
    row("air_control_point", "180100", "Air control point", "POINT2", GraphicShape::Point, [1, 1], "T", "ACP {}", GraphicTint::Own, point::circled),
    // Fires.
    row("airspace_coordination_area", "240101", "Airspace coordination area, irregular", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "ACA {}", GraphicTint::Own, area::area),
    row("free_fire_area", "240201", "Free fire area, irregular", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "FFA {}", GraphicTint::Own, area::area),
    row("no_fire_area", "240301", "No fire area, irregular", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "NFA {}", GraphicTint::Own, area::area),
    row("restricted_fire_area", "240401", "Restricted fire area, irregular", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "RFA {}", GraphicTint::Own, area::area),
    row("position_area_for_artillery", "240502", "Position area for artillery, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "PAA {}", GraphicTint::Own, fires::circular),
    row("point_target", "240601", "Point target", "POINT2", GraphicShape::Point, [1, 1], "AP", "", GraphicTint::Own, point::crossed),
    row("linear_target", "240701", "Linear target", "LINE5", GraphicShape::Figure, [2, 2], "AP", "", GraphicTint::Own, fires::linear_target),
    row("linear_smoke_target", "240702", "Linear smoke target", "LINE5", GraphicShape::Figure, [2, 2], "AP", "SMOKE", GraphicTint::Own, fires::linear_target),
    row("final_protective_fire", "240703", "Final protective fire", "LINE5", GraphicShape::Figure, [2, 2], "AP T1", "FPF {}", GraphicTint::Own, fires::linear_target),
    row("area_target", "240801", "Area target", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "AP", "", GraphicTint::Own, area::target_area),
    row("circular_target", "240803", "Circular target", "CIRCULAR1", GraphicShape::Circle, [1, 1], "AM AP", "", GraphicTint::Own, fires::circular),
    row("range_fan_circular", "242100", "Weapon or sensor range fan, circular", "CIRCULAR2", GraphicShape::Circle, [1, 1], "AM X", "", GraphicTint::Own, fires::range_rings),
    row("range_fan_sector", "242200", "Weapon or sensor range fan, sector", "ARC1", GraphicShape::Sector, [1, 1], "AM AN X", "", GraphicTint::Own, fires::range_sector),
    row("fire_support_coordination_line", "260100", "Fire support coordination line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "{} FSCL", GraphicTint::Own, lines::end_labeled),
    row("coordinated_fire_line", "260200", "Coordinated fire line", "LINE7", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "CFL {}", GraphicTint::Own, lines::middle_labeled),
    row("no_fire_line", "260300", "No fire line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "NFL {}", GraphicTint::Own, lines::end_labeled),
    row("battlefield_coordination_line", "260400", "Battlefield coordination line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "{} BCL", GraphicTint::Own, lines::end_labeled),
    row("restrictive_fire_line", "260500", "Restrictive fire line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "RFL {}", GraphicTint::Own, lines::end_labeled),
    // Protection.
    row("obstacle_belt", "270100", "Obstacle belt", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "{}", GraphicTint::Obstacle, teeth::obstacle),
    row("obstacle_zone", "270200", "Obstacle zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "{}", GraphicTint::Obstacle, teeth::obstacle),
    row("obstacle_free_zone", "270300", "Obstacle free zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "FREE {}", GraphicTint::Obstacle, teeth::obstacle),
    row("obstacle_block", "270501", "Obstacle effect: block", "AREA11", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, task::block),
    row("obstacle_disrupt", "270502", "Obstacle effect: disrupt", "AREA12", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, task::disrupt),
    row("obstacle_fix", "270503", "Obstacle effect: fix", "LINE9", GraphicShape::Figure, [2, 2], "", "", GraphicTint::Obstacle, axis::fix),
    row("obstacle_turn", "270504", "Obstacle effect: turn", "LINE10", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, task::turn),
    row("obstacle_bypass", "270601", "Obstacle bypass, easy", "POINT12", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, task::bracket),
    row("decoy_minefield", "270707", "Minefield, dynamic depiction", "AREA23", GraphicShape::Area, [3, MOST_POINTS], "", "", GraphicTint::Obstacle, area::dashed_area),
    row("mined_area", "270800", "Mined area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "H N W", "", GraphicTint::Obstacle, area::mined_area),
    row("unexploded_ordnance_area", "271000", "Unexploded explosive ordnance area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "", "UXO", GraphicTint::Obstacle, area::marked_area),
    row("bridge", "271100", "Bridge or gap", "LINE11", GraphicShape::Figure, [4, 4], "T W W1", "", GraphicTint::Own, crossing::bridge),
    row("assault_crossing", "271300", "Assault crossing", "LINE16", GraphicShape::Figure, [4, 4], "W W1", "", GraphicTint::Own, crossing::bridge),
    row("ford_easy", "271500", "Ford, easy", "LINE17", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Own, crossing::ford),
    row("ford_difficult", "271600", "Ford, difficult", "LINE17", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Own, crossing::ford),
    row("abatis", "280100", "Abatis", "LINE13", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, crossing::abatis),
    row("obstacle_line", "290100", "Obstacle line", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "T", "", GraphicTint::Obstacle, teeth::obstacle),
    row("mine_line", "290101", "Mine line", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "N", "", GraphicTint::Obstacle, teeth::mine_line),
    row("ditch_under_construction", "290201", "Antitank ditch under construction", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, teeth::ditch),
    row("ditch", "290202", "Antitank ditch, completed", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, teeth::ditch),
    row("ditch_with_mines", "290203", "Antitank ditch, reinforced with mines", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, teeth::ditch),
    row("antitank_wall", "290204", "Antitank wall", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, teeth::wall),
    row("wire", "290301", "Unspecified wire", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, wire::wire),
    row("single_fence", "290302", "Single fence wire", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, wire::wire),
    row("double_fence", "290303", "Double fence wire", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, wire::wire),
    row("double_apron_fence", "290304", "Double apron fence", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, wire::wire),
    row("low_wire_fence", "290305", "Low wire fence", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, wire::wire),
    row("high_wire_fence", "290306", "High wire fence", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, wire::wire),
    row("single_concertina", "290307", "Single concertina", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, wire::wire),
    row("double_concertina", "290308", "Double strand concertina", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, wire::wire),
    row("triple_concertina", "290309", "Triple strand concertina", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, wire::wire),
    row("lane", "290600", "Lane", "LINE14", GraphicShape::Figure, [2, 2], "W W1", "", GraphicTint::Obstacle, corridor::lane),
    row("ferry", "290700", "Ferry", "LINE18", GraphicShape::Figure, [2, 2], "", "", GraphicTint::Own, crossing::ferry),
    row("raft_site", "290800", "Raft site", "LINE14", GraphicShape::Figure, [2, 2], "", "", GraphicTint::Own, corridor::lane),
    row("fortified_line", "290900", "Fortified line", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Own, teeth::fortified),
    row("fighting_position", "291000", "Fighting position", "LINE19", GraphicShape::Figure, [2, 2], "", "", GraphicTint::Own, crossing::fighting_position),
    // Sustainment.
    row("moving_convoy", "330100", "Moving convoy", "LINE9", GraphicShape::Figure, [2, 2], "H", "", GraphicTint::Own, crossing::convoy),
    row("halted_convoy", "330200", "Halted convoy", "LINE20", GraphicShape::Figure, [2, 2], "H", "", GraphicTint::Own, crossing::convoy),
    row("main_supply_route", "330300", "Main supply route", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "MSR {}", GraphicTint::Own, lines::route),
    row("main_supply_route_one_way", "330301", "Main supply route, one-way traffic", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "MSR {}", GraphicTint::Own, lines::route),
    row("main_supply_route_two_way", "330302", "Main supply route, two-way traffic", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "MSR {}", GraphicTint::Own, lines::route),
    row("alternate_supply_route", "330400", "Alternate supply route", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "ASR {}", GraphicTint::Own, lines::route),
    row("alternate_supply_route_one_way", "330401", "Alternate supply route, one-way traffic", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "ASR {}", GraphicTint::Own, lines::route),
    // Mission tasks.
    row("block", "340100", "Block", "AREA24", GraphicShape::Figure, [3, 3], "", "B", GraphicTint::Own, task::block),
    row("breach", "340200", "Breach", "LINE22", GraphicShape::Figure, [3, 3], "", "B", GraphicTint::Own, task::bracket),
    row("bypass", "340300", "Bypass", "POINT12", GraphicShape::Figure, [3, 3], "", "B", GraphicTint::Own, task::bracket),
    row("canalize", "340400", "Canalize", "POINT12", GraphicShape::Figure, [3, 3], "", "C", GraphicTint::Own, task::bracket),
    row("clear", "340500", "Clear", "LINE23", GraphicShape::Figure, [3, 3], "", "C", GraphicTint::Own, task::arrows_to_line),
    row("counterattack", "340600", "Counterattack", "AXIS2", GraphicShape::Axis, [3, 50], "T", "CATK", GraphicTint::Own, axis::axis),
    row("delay", "340800", "Delay", "LINE24", GraphicShape::Figure, [3, 3], "W", "D", GraphicTint::Own, task::delay),
    row("disrupt", "341000", "Disrupt", "AREA25", GraphicShape::Figure, [3, 3], "", "D", GraphicTint::Own, task::disrupt),
    row("fix", "341100", "Fix", "LINE28", GraphicShape::Figure, [2, 2], "", "F", GraphicTint::Own, axis::fix),
    row("follow_and_assume", "341200", "Follow and assume", "LINE25", GraphicShape::Figure, [2, 2], "T", "", GraphicTint::Own, task::follow),
    row("follow_and_support", "341300", "Follow and support", "LINE25", GraphicShape::Figure, [2, 2], "T", "", GraphicTint::Own, task::follow),
    row("isolate", "341500", "Isolate", "AREA15", GraphicShape::Figure, [2, 2], "", "I", GraphicTint::Own, task::circle_task),
    row("occupy", "341700", "Occupy", "AREA16", GraphicShape::Figure, [2, 2], "", "O", GraphicTint::Own, task::circle_task),
    row("penetrate", "341800", "Penetrate", "AREA17", GraphicShape::Figure, [3, 3], "", "P", GraphicTint::Own, task::arrows_to_line),
    row("retire", "342000", "Retire", "LINE24", GraphicShape::Figure, [3, 3], "", "R", GraphicTint::Own, task::delay),
    row("secure", "342100", "Secure", "AREA19", GraphicShape::Figure, [2, 2], "", "S", GraphicTint::Own, task::circle_task),
    row("cover", "342201", "Cover", "LINE26", GraphicShape::Figure, [3, 3], "", "C", GraphicTint::Own, task::screen),
    row("guard", "342202", "Guard", "LINE26", GraphicShape::Figure, [3, 3], "", "G", GraphicTint::Own, task::screen),
    row("screen", "342203", "Screen", "LINE26", GraphicShape::Figure, [3, 3], "", "S", GraphicTint::Own, task::screen),
    row("seize", "342300", "Seize", "LINE27", GraphicShape::Figure, [3, 4], "", "S", GraphicTint::Own, task::seize),
    row("withdraw", "342400", "Withdraw", "LINE24", GraphicShape::Figure, [3, 3], "", "W", GraphicTint::Own, task::delay),
    row("withdraw_under_pressure", "342500", "Withdraw under pressure", "LINE24", GraphicShape::Figure, [3, 3], "", "WP", GraphicTint::Own, task::delay),
];

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::graphic::check::{PlacedGraphic, check};
    use crate::graphic::drawing::GraphicInput;
    use crate::graphic::fields::GraphicFields;

    #[test]
    fn words_and_codes_are_unique_and_rising() {
        let codes: Vec<&str> = GRAPHIC_KINDS.iter().map(|kind| kind.code).collect();
        assert!(codes.windows(2).all(|pair| pair[0] < pair[1]), "by code, each once");
        let mut words: Vec<&str> = GRAPHIC_KINDS.iter().map(|kind| kind.word).collect();
        words.sort_unstable();
        assert!(words.windows(2).all(|pair| pair[0] < pair[1]), "each word once");
        assert!(GRAPHIC_KINDS.len() >= 120, "{}", GRAPHIC_KINDS.len());
    }

    /// Points that fit any kind: a zigzag line, or a ring for areas.
    fn points_of(kind: &GraphicKind, scale: f64, quarter: u32) -> Vec<DVec2> {
        let ring = [[0.0, 0.0], [3.0, -0.4], [4.0, 2.0], [1.8, 3.2], [-0.5, 1.7]];
        let axis = [[6.0, 2.0], [3.0, 1.2], [0.0, 1.6], [5.2, 2.9]];
        let figure = [[0.0, 2.0], [0.0, 0.0], [4.0, 1.2], [4.4, -1.0]];
        let count = kind.points[0].max(if kind.is_area() { 5 } else { 2 });
        let all: &[[f64; 2]] = match kind.shape {
            GraphicShape::Area => &ring[..count],
            GraphicShape::Axis | GraphicShape::Wide => &axis,
            _ => &figure[..kind.points[0]],
        };
        let turn = |at: DVec2| (0..quarter).fold(at, |at, _| at.perp());
        all.iter().map(|&at| turn(DVec2::from(at)) * scale).collect()
    }

    #[test]
    fn every_graphic_is_finite_and_near_its_points_however_turned_and_scaled() {
        let fields = GraphicFields {
            designation: "RED".into(),
            distances_m: vec![500.0, 1000.0],
            azimuths_deg: vec![20.0, 90.0, 30.0, 80.0],
            ..GraphicFields::default()
        };
        for kind in GRAPHIC_KINDS {
            for (scale, quarter) in [(1000.0, 0), (1000.0, 1), (1000.0, 2), (10.0, 3), (100_000.0, 0)] {
                let points = points_of(kind, scale, quarter);
                let placed = PlacedGraphic { points: &points, width_m: None, fields: &fields };
                check(kind, &placed).unwrap_or_else(|error| panic!("{}: {error}", kind.word));
                let input = GraphicInput {
                    points: &points,
                    em_m: scale / 20.0,
                    up: DVec2::Y,
                    width_m: None,
                    fields: &fields,
                };
                let drawing = kind.draw(&input);
                assert!(!drawing.strokes.is_empty(), "{}", kind.word);
                let drawn = drawing.strokes.iter().flat_map(|stroke| &stroke.points);
                let drawn = drawn.chain(drawing.fills.iter().flatten());
                let far = drawn.chain(drawing.texts.iter().map(|text| &text.at)).map(|at| at.length());
                let reach = 9.0 * scale + 1300.0;
                for distance in far {
                    assert!(distance < reach, "{} at {scale}: {distance}", kind.word);
                }
                assert!(drawing.strokes.iter().all(|stroke| stroke.points.len() > 1));
            }
        }
    }

    #[test]
    fn a_graphic_turned_by_a_quarter_is_drawn_as_it_was_and_turned() {
        let fields = GraphicFields { distances_m: vec![500.0], ..GraphicFields::default() };
        for kind in GRAPHIC_KINDS.iter().filter(|kind| !matches!(kind.shape, GraphicShape::Sector)) {
            let drawn = |quarter: u32| {
                let points = points_of(kind, 1000.0, quarter);
                let up = (0..quarter).fold(DVec2::Y, |up, _| up.perp());
                let input = GraphicInput { points: &points, em_m: 50.0, up, width_m: None, fields: &fields };
                kind.draw(&input)
            };
            let (first, second) = (drawn(0), drawn(1));
            assert_eq!(first.strokes.len(), second.strokes.len(), "{}", kind.word);
            for (a, b) in first.strokes.iter().zip(&second.strokes) {
                for at in a.points.iter().map(|at| at.perp()) {
                    let is_there = b.points.iter().any(|turned| at.distance(*turned) < 1e-6);
                    assert!(is_there || kind.shape == GraphicShape::Corridor, "{}: {at}", kind.word);
                }
            }
        }
    }

    #[test]
    fn fields_are_letters_of_the_standard() {
        let letters = ["T", "T1", "B", "AS", "N", "H", "AP", "W", "W1", "X", "AM", "AN"];
        for kind in GRAPHIC_KINDS {
            for field in kind.fields.split(' ').filter(|field| !field.is_empty()) {
                assert!(letters.contains(&field), "{}: {field}", kind.word);
            }
        }
    }
}
