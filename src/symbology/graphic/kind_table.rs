//! The table of graphics: their words and codes, draw rules, points and fields.

use crate::graphic::kind::{DrawRule, GraphicKind, GraphicShape, GraphicTint, MOST_POINTS};
use crate::graphic::point_table::POINT_KINDS;
use crate::graphic::weather_table::WEATHER_KINDS;
use crate::graphic::{area, axis, corridor, crossing, fires, lines, maneuver, task, teeth, wire, zone};

impl GraphicKind {
    /// The kind with a word.
    pub fn of_word(word: &str) -> Option<&'static Self> {
        GRAPHIC_KINDS.iter().find(|kind| kind.word == word)
    }

    /// The kind with a six-digit code of a symbol set.
    pub fn of_code(set: u8, code: &str) -> Option<&'static Self> {
        GRAPHIC_KINDS.iter().find(|kind| kind.set == set && kind.code == code)
    }
}

/// Every graphic: lines and areas, points, weather and sea.
pub static GRAPHIC_KINDS: &[GraphicKind] = &ALL_KINDS;

static ALL_KINDS: [GraphicKind; LINE_KINDS.len() + POINT_KINDS.len() + WEATHER_KINDS.len()] = {
    let mut all = [LINE_KINDS[0]; LINE_KINDS.len() + POINT_KINDS.len() + WEATHER_KINDS.len()];
    let tables = [LINE_KINDS, POINT_KINDS, WEATHER_KINDS];
    let (mut filled, mut table) = (0, 0);
    while table < tables.len() {
        let mut row = 0;
        while row < tables[table].len() {
            all[filled] = tables[table][row];
            (filled, row) = (filled + 1, row + 1);
        }
        table += 1;
    }
    all
};

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
    GraphicKind { word, set: 25, code, name, rule, shape, points, fields, label, tint, icon: "", rule_fn }
}

/// Every line and area of symbol set 25, by code.
#[rustfmt::skip]
const LINE_KINDS: &[GraphicKind] = &[
    // Command and control.
    row("boundary", "110100", "Boundary", "LINE7", GraphicShape::Line, [2, MOST_POINTS], "T T1 B AS", "", GraphicTint::Own, lines::boundary),
    row("light_line", "110200", "Light line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "LL", GraphicTint::Own, lines::end_labeled),
    row("engineer_work_line", "110300", "Engineer work line", "LINE7", GraphicShape::Line, [2, MOST_POINTS], "T T1 AS", "EWL", GraphicTint::Own, lines::work_line),
    row("control_line", "110400", "Control line, generic", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "T H W W1", "{H} {}", GraphicTint::Own, lines::end_labeled),
    row("area_of_operations", "120100", "Area of operations", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "AO {}", GraphicTint::Own, area::area),
    row("named_area_of_interest", "120200", "Named area of interest", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "NAI {}", GraphicTint::Own, area::area),
    row("targeted_area_of_interest", "120300", "Targeted area of interest", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "TAI {}", GraphicTint::Own, area::area),
    row("airfield_zone", "120400", "Airfield zone", "AREA20", GraphicShape::Area, [3, MOST_POINTS], "H", "", GraphicTint::Own, area::airfield_zone),
    row("base_camp", "120500", "Base camp", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T B H N W W1", "BC {}", GraphicTint::Own, area::battle_position),
    row("guerrilla_base", "120600", "Guerrilla base", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T B H N W W1", "GB {}", GraphicTint::Own, area::battle_position),
    row("control_area", "120700", "Control area, generic", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T H N W W1", "{H} {}", GraphicTint::Own, area::area),
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
    row("airhead_line", "141300", "Airhead line", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "N", "AIRHEAD LINE", GraphicTint::Own, area::airhead),
    row("bridgehead_line", "141400", "Bridgehead line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "BL", GraphicTint::Own, lines::end_labeled),
    row("holding_line", "141500", "Holding line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "HL", GraphicTint::Own, lines::end_labeled),
    row("release_line", "141600", "Release line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "W W1", "RL", GraphicTint::Own, lines::end_labeled),
    row("ambush", "141700", "Ambush", "LINE29", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Own, task::ambush),
    row("handover_line", "141800", "Handover line", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "HOL", GraphicTint::Own, lines::end_labeled),
    row("battle_handover_line", "141900", "Battle handover line", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "BHL", GraphicTint::Own, lines::end_labeled),
    // Maneuver areas.
    row("area", "150100", "Area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T N", "{}", GraphicTint::Own, area::area),
    row("assembly_area", "150200", "Assembly area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "AA {}", GraphicTint::Own, area::area),
    row("occupied_assembly_area", "150300", "Occupied assembly area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "AA {}", GraphicTint::Own, area::area),
    row("joint_tactical_action_area", "150501", "Joint tactical action area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T N W W1", "JTAA - {}", GraphicTint::Own, area::area),
    row("submarine_action_area", "150502", "Submarine action area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T N W W1", "SAA - {}", GraphicTint::Own, area::area),
    row("submarine_generated_action_area", "150503", "Submarine-generated action area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T N W W1", "SGAA - {}", GraphicTint::Own, area::area),
    row("drop_zone", "150600", "Drop zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "DZ {}", GraphicTint::Own, area::area),
    row("extraction_zone", "150700", "Extraction zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "EZ {}", GraphicTint::Own, area::area),
    row("landing_zone", "150800", "Landing zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "LZ {}", GraphicTint::Own, area::area),
    row("pickup_zone", "150900", "Pickup zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "PZ {}", GraphicTint::Own, area::area),
    row("fortified_area", "151000", "Fortified area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "{}", GraphicTint::Own, teeth::fortified),
    row("limited_access_area", "151100", "Limited access area", "AREA2", GraphicShape::Area, [3, MOST_POINTS], "", "LAA", GraphicTint::Own, area::area),
    row("battle_position", "151200", "Battle position", "AREA3", GraphicShape::Area, [3, MOST_POINTS], "T B", "{}", GraphicTint::Own, area::battle_position),
    row("prepared_battle_position", "151202", "Battle position, prepared but not occupied", "AREA3", GraphicShape::Area, [3, MOST_POINTS], "T B N", "(P) {}", GraphicTint::Own, area::battle_position),
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
    row("encirclement", "151800", "Encirclement", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T N", "{}", GraphicTint::Own, teeth::encirclement),
    row("penetration_box", "151900", "Penetration box", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "", "", GraphicTint::Own, area::area),
    row("attack_by_fire", "152000", "Attack by fire position", "AREA7", GraphicShape::Figure, [3, 3], "T", "{}", GraphicTint::Own, task::by_fire),
    row("support_by_fire", "152100", "Support by fire", "AREA8", GraphicShape::Figure, [4, 4], "T", "{}", GraphicTint::Own, task::by_fire),
    row("search_area", "152200", "Search area, reconnaissance area", "AREA21", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Own, maneuver::search_area),
    row("area_defense", "152600", "Area defense", "AREA15", GraphicShape::Figure, [2, 2], "", "AD", GraphicTint::Own, task::circle_task),
    row("frontal_attack", "152700", "Frontal attack", "AXIS1", GraphicShape::Axis, [3, 50], "T W W1", "{}", GraphicTint::Own, axis::axis),
    row("mobile_defense", "152800", "Mobile defense", "AREA27", GraphicShape::Figure, [3, 3], "", "MD", GraphicTint::Own, maneuver::mobile_defense),
    row("turning_movement", "152900", "Turning movement", "AXIS1", GraphicShape::Axis, [3, 50], "T W W1", "{}", GraphicTint::Own, axis::axis),
    // Airspace.
    row("air_corridor", "170100", "Air corridor", "CORRIDOR1", GraphicShape::Corridor, [2, MOST_POINTS], "T AM X W W1", "AC {}", GraphicTint::Own, corridor::air_corridor),
    row("low_level_transit_route", "170200", "Low level transit route", "CORRIDOR1", GraphicShape::Corridor, [2, MOST_POINTS], "T AM X W W1", "LLTR {}", GraphicTint::Own, corridor::air_corridor),
    row("minimum_risk_route", "170300", "Minimum-risk route", "CORRIDOR1", GraphicShape::Corridor, [2, MOST_POINTS], "T AM X W W1", "MRR {}", GraphicTint::Own, corridor::air_corridor),
    row("safe_lane", "170400", "Safe lane", "CORRIDOR1", GraphicShape::Corridor, [2, MOST_POINTS], "T AM X W W1", "SL {}", GraphicTint::Own, corridor::air_corridor),
    row("standard_army_aircraft_route", "170500", "Standard use Army aircraft flight route", "CORRIDOR1", GraphicShape::Corridor, [2, MOST_POINTS], "T AM X W W1", "SAAFR {}", GraphicTint::Own, corridor::air_corridor),
    row("transit_corridor", "170600", "Transit corridor", "CORRIDOR1", GraphicShape::Corridor, [2, MOST_POINTS], "T AM X W W1", "TC {}", GraphicTint::Own, corridor::air_corridor),
    row("special_corridor", "170700", "Special corridor", "CORRIDOR1", GraphicShape::Corridor, [2, MOST_POINTS], "T AM X W W1", "SC {}", GraphicTint::Own, corridor::air_corridor),
    row("base_defense_zone", "170800", "Base defense zone", "AREA22", GraphicShape::Circle, [1, 1], "T AM W W1", "BDZ {}", GraphicTint::Own, fires::circular),
    row("high_density_airspace_control_zone", "170900", "High-density airspace control zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "HIDACZ {}", GraphicTint::Own, area::area),
    row("restricted_operations_zone", "171000", "Restricted operations zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "ROZ {}", GraphicTint::Own, area::area),
    row("air_to_air_restricted_operations_zone", "171100", "Air-to-air restricted operations zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "AARROZ {}", GraphicTint::Own, area::area),
    row("unmanned_aircraft_restricted_operations_zone", "171200", "Unmanned aircraft restricted operations zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "UAROZ {}", GraphicTint::Own, area::area),
    row("weapon_engagement_zone", "171300", "Weapon engagement zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "WEZ {}", GraphicTint::Own, area::area),
    row("fighter_engagement_zone", "171400", "Fighter engagement zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "FEZ {}", GraphicTint::Own, area::area),
    row("joint_engagement_zone", "171500", "Joint engagement zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "JEZ {}", GraphicTint::Own, area::area),
    row("missile_engagement_zone", "171600", "Missile engagement zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "MEZ {}", GraphicTint::Own, area::area),
    row("low_altitude_missile_engagement_zone", "171700", "Low altitude missile engagement zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "LOMEZ {}", GraphicTint::Own, area::area),
    row("high_altitude_missile_engagement_zone", "171800", "High altitude missile engagement zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "HIMEZ {}", GraphicTint::Own, area::area),
    row("short_range_air_defense_engagement_zone", "171900", "Short range air defense engagement zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T X W W1", "SHORADEZ {}", GraphicTint::Own, area::area),
    row("weapons_free_zone", "172000", "Weapons free zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "WFZ {}", GraphicTint::Own, area::area),
    row("iff_off_line", "190100", "Identification friend or foe off line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "T", "IFF OFF {}", GraphicTint::Own, lines::end_labeled),
    row("iff_on_line", "190200", "Identification friend or foe on line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "T", "IFF ON {}", GraphicTint::Own, lines::end_labeled),
    // At sea.
    row("launch_area", "200101", "Launch area, ellipse", "ELLIPSE1", GraphicShape::Ellipse, [1, 1], "T AM AN", "LA - {}", GraphicTint::Own, zone::ellipse),
    row("defended_area", "200201", "Defended area, ellipse", "ELLIPSE1", GraphicShape::Ellipse, [1, 1], "T AM AN", "DA - {}", GraphicTint::Own, zone::ellipse),
    row("defended_area_rectangle", "200202", "Defended area, rectangle", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM", "DA - {}", GraphicTint::Own, zone::rectangle),
    row("no_attack_zone", "200300", "No attack zone", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "N {}", GraphicTint::Own, fires::circular),
    row("ship_area_of_interest_ellipse", "200401", "Ship area of interest, ellipse", "ELLIPSE1", GraphicShape::Ellipse, [1, 1], "T AM AN", "AOI {}", GraphicTint::Own, zone::ellipse),
    row("ship_area_of_interest_rectangle", "200402", "Ship area of interest, rectangle", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM", "AOI {}", GraphicTint::Own, zone::rectangle),
    row("cued_acquisition_doctrine", "200600", "Cued acquisition doctrine", "POINT17", GraphicShape::Ellipse, [1, 1], "T AM AN", "{}", GraphicTint::Own, zone::box_about),
    row("radar_search_doctrine", "200700", "Radar search doctrine", "POINT18", GraphicShape::Sector, [1, 1], "T AM AN", "{}", GraphicTint::Own, zone::radar_search),
    row("navigational_line", "218400", "Navigational line", "LINE4", GraphicShape::Figure, [2, 2], "", "", GraphicTint::Own, lines::navigational),
    row("bearing_line", "220100", "Bearing line", "LINE5", GraphicShape::Line, [2, MOST_POINTS], "H", "B", GraphicTint::Own, lines::bearing),
    row("electronic_bearing_line", "220101", "Bearing line, electronic", "LINE5", GraphicShape::Line, [2, MOST_POINTS], "H", "E", GraphicTint::Own, lines::bearing),
    row("electronic_warfare_bearing_line", "220102", "Bearing line, electronic warfare", "LINE5", GraphicShape::Line, [2, MOST_POINTS], "H", "EW", GraphicTint::Own, lines::bearing),
    row("acoustic_bearing_line", "220103", "Bearing line, acoustic", "LINE5", GraphicShape::Line, [2, MOST_POINTS], "H", "A", GraphicTint::Own, lines::bearing),
    row("ambiguous_acoustic_bearing_line", "220104", "Bearing line, acoustic, ambiguous", "LINE5", GraphicShape::Line, [2, MOST_POINTS], "H", "A", GraphicTint::Own, lines::bearing),
    row("torpedo_bearing_line", "220105", "Bearing line, torpedo", "LINE5", GraphicShape::Line, [2, MOST_POINTS], "H", "T", GraphicTint::Own, lines::bearing),
    row("electro_optical_bearing_line", "220106", "Bearing line, electro-optical intercept", "LINE5", GraphicShape::Line, [2, MOST_POINTS], "H", "O", GraphicTint::Own, lines::bearing),
    row("jammer_bearing_line", "220107", "Bearing line, jammer", "LINE5", GraphicShape::Line, [2, MOST_POINTS], "H", "J", GraphicTint::Own, lines::bearing),
    row("radio_direction_finder_bearing_line", "220108", "Bearing line, radio direction finder", "LINE5", GraphicShape::Line, [2, MOST_POINTS], "H", "RDF", GraphicTint::Own, lines::bearing),
    // Fires.
    row("airspace_coordination_area", "240101", "Airspace coordination area, irregular", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T T1 X Y W W1", "ACA {}", GraphicTint::Own, area::area),
    row("airspace_coordination_area_rectangle", "240102", "Airspace coordination area, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T T1 AM X Y W W1", "ACA {}", GraphicTint::Own, zone::rectangle),
    row("airspace_coordination_area_circle", "240103", "Airspace coordination area, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T T1 AM X Y W W1", "ACA {}", GraphicTint::Own, fires::circular),
    row("free_fire_area", "240201", "Free fire area, irregular", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "FFA {}", GraphicTint::Own, area::area),
    row("free_fire_area_rectangle", "240202", "Free fire area, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "FFA {}", GraphicTint::Own, zone::rectangle),
    row("free_fire_area_circle", "240203", "Free fire area, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "FFA {}", GraphicTint::Own, fires::circular),
    row("no_fire_area", "240301", "No fire area, irregular", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "NFA {}", GraphicTint::Own, area::area),
    row("no_fire_area_rectangle", "240302", "No fire area, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "NFA {}", GraphicTint::Own, zone::rectangle),
    row("no_fire_area_circle", "240303", "No fire area, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "NFA {}", GraphicTint::Own, fires::circular),
    row("restricted_fire_area", "240401", "Restricted fire area, irregular", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "RFA {}", GraphicTint::Own, area::area),
    row("restricted_fire_area_rectangle", "240402", "Restricted fire area, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "RFA {}", GraphicTint::Own, zone::rectangle),
    row("restricted_fire_area_circle", "240403", "Restricted fire area, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "RFA {}", GraphicTint::Own, fires::circular),
    row("position_area_for_artillery_rectangle", "240501", "Position area for artillery, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "PAA", GraphicTint::Own, zone::rectangle),
    row("position_area_for_artillery", "240502", "Position area for artillery, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "PAA {}", GraphicTint::Own, fires::circular),
    row("position_area_for_artillery_irregular", "240503", "Position area for artillery, irregular", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "PAA", GraphicTint::Own, area::position_area),
    row("linear_target", "240701", "Linear target", "LINE5", GraphicShape::Line, [2, MOST_POINTS], "AP", "", GraphicTint::Own, fires::linear_target),
    row("linear_smoke_target", "240702", "Linear smoke target", "LINE5", GraphicShape::Line, [2, MOST_POINTS], "AP", "SMOKE", GraphicTint::Own, fires::linear_target),
    row("final_protective_fire", "240703", "Final protective fire", "LINE5", GraphicShape::Line, [2, MOST_POINTS], "AP T1 V", "FPF {}", GraphicTint::Own, fires::linear_target),
    row("area_target", "240801", "Area target", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "AP", "", GraphicTint::Own, area::target_area),
    row("rectangular_target", "240802", "Rectangular target", "RECTANGULAR2", GraphicShape::Ellipse, [1, 1], "AM AN AP", "", GraphicTint::Own, zone::box_about),
    row("circular_target", "240803", "Circular target", "CIRCULAR1", GraphicShape::Circle, [1, 1], "AM AP", "", GraphicTint::Own, fires::circular),
    row("rectangular_single_target", "240804", "Rectangular target, single target", "RECTANGULAR3", GraphicShape::Corridor, [2, 2], "T AM", "{}", GraphicTint::Own, zone::single_target),
    row("series_of_targets", "240805", "Series or group of targets", "AREA9", GraphicShape::Area, [3, MOST_POINTS], "T", "{}", GraphicTint::Own, area::top_labeled),
    row("smoke_area", "240806", "Smoke", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "AP W W1", "SMOKE", GraphicTint::Own, area::area),
    row("bomb_area", "240808", "Bomb area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "", "BOMB", GraphicTint::Own, area::area),
    row("fire_support_area", "241001", "Fire support area, irregular", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "FSA {}", GraphicTint::Own, area::area),
    row("fire_support_area_rectangle", "241002", "Fire support area, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "FSA {}", GraphicTint::Own, zone::rectangle),
    row("fire_support_area_circle", "241003", "Fire support area, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "FSA {}", GraphicTint::Own, fires::circular),
    row("artillery_target_intelligence_zone", "241101", "Artillery target intelligence zone, irregular", "AREA10", GraphicShape::Area, [3, 6], "T W W1", "ATI ZONE {}", GraphicTint::Own, area::area),
    row("artillery_target_intelligence_zone_rectangle", "241102", "Artillery target intelligence zone, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "ATI ZONE {}", GraphicTint::Own, zone::rectangle),
    row("artillery_target_intelligence_zone_circle", "241103", "Artillery target intelligence zone, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "ATI ZONE {}", GraphicTint::Own, fires::circular),
    row("call_for_fire_zone", "241201", "Call for fire zone, irregular", "AREA10", GraphicShape::Area, [3, 6], "T W W1", "CFF ZONE {}", GraphicTint::Own, area::area),
    row("call_for_fire_zone_rectangle", "241202", "Call for fire zone, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "CFF ZONE {}", GraphicTint::Own, zone::rectangle),
    row("call_for_fire_zone_circle", "241203", "Call for fire zone, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "CFF ZONE {}", GraphicTint::Own, fires::circular),
    row("censor_zone", "241301", "Censor zone, irregular", "AREA10", GraphicShape::Area, [3, 6], "T W W1", "CENSOR ZONE {}", GraphicTint::Own, area::area),
    row("censor_zone_rectangle", "241302", "Censor zone, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "CENSOR ZONE {}", GraphicTint::Own, zone::rectangle),
    row("censor_zone_circle", "241303", "Censor zone, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "CENSOR ZONE {}", GraphicTint::Own, fires::circular),
    row("critical_friendly_zone", "241401", "Critical friendly zone, irregular", "AREA10", GraphicShape::Area, [3, 6], "T W W1", "CF ZONE {}", GraphicTint::Own, area::area),
    row("critical_friendly_zone_rectangle", "241402", "Critical friendly zone, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "CF ZONE {}", GraphicTint::Own, zone::rectangle),
    row("critical_friendly_zone_circle", "241403", "Critical friendly zone, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "CF ZONE {}", GraphicTint::Own, fires::circular),
    row("dead_space_area", "241501", "Dead space area, irregular", "AREA10", GraphicShape::Area, [3, 6], "T W W1", "DA {}", GraphicTint::Own, area::area),
    row("dead_space_area_rectangle", "241502", "Dead space area, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "DA {}", GraphicTint::Own, zone::rectangle),
    row("dead_space_area_circle", "241503", "Dead space area, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "DA {}", GraphicTint::Own, fires::circular),
    row("sensor_zone", "241601", "Sensor zone, irregular", "AREA10", GraphicShape::Area, [3, 6], "T W W1", "SENSOR ZONE {}", GraphicTint::Own, area::area),
    row("sensor_zone_rectangle", "241602", "Sensor zone, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "SENSOR ZONE {}", GraphicTint::Own, zone::rectangle),
    row("sensor_zone_circle", "241603", "Sensor zone, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "SENSOR ZONE {}", GraphicTint::Own, fires::circular),
    row("target_build_up_area", "241701", "Target build-up area, irregular", "AREA10", GraphicShape::Area, [3, 6], "T W W1", "TBA {}", GraphicTint::Own, area::area),
    row("target_build_up_area_rectangle", "241702", "Target build-up area, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "TBA {}", GraphicTint::Own, zone::rectangle),
    row("target_build_up_area_circle", "241703", "Target build-up area, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "TBA {}", GraphicTint::Own, fires::circular),
    row("target_value_area", "241801", "Target value area, irregular", "AREA10", GraphicShape::Area, [3, 6], "T W W1", "TVAR {}", GraphicTint::Own, area::area),
    row("target_value_area_rectangle", "241802", "Target value area, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "TVAR {}", GraphicTint::Own, zone::rectangle),
    row("target_value_area_circle", "241803", "Target value area, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "TVAR {}", GraphicTint::Own, fires::circular),
    row("zone_of_responsibility", "241901", "Zone of responsibility, irregular", "AREA10", GraphicShape::Area, [3, 6], "T W W1", "ZOR {}", GraphicTint::Own, area::area),
    row("zone_of_responsibility_rectangle", "241902", "Zone of responsibility, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "ZOR {}", GraphicTint::Own, zone::rectangle),
    row("zone_of_responsibility_circle", "241903", "Zone of responsibility, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "ZOR {}", GraphicTint::Own, fires::circular),
    row("munition_footprint", "242000", "Terminally guided munition footprint", "AREA10", GraphicShape::Area, [3, 6], "", "TGMF", GraphicTint::Own, area::area),
    row("range_fan_circular", "242100", "Weapon or sensor range fan, circular", "CIRCULAR2", GraphicShape::Circle, [1, 1], "AM X", "", GraphicTint::Own, fires::range_rings),
    row("range_fan_sector", "242200", "Weapon or sensor range fan, sector", "ARC1", GraphicShape::Sector, [1, 1], "AM AN X", "", GraphicTint::Own, fires::range_sector),
    row("blue_kill_box", "242301", "Kill box, blue, irregular", "AREA10", GraphicShape::Area, [3, 6], "T W W1", "BKB {}", GraphicTint::Own, area::area),
    row("blue_kill_box_rectangle", "242302", "Kill box, blue, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "BKB {}", GraphicTint::Own, zone::rectangle),
    row("blue_kill_box_circle", "242303", "Kill box, blue, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "BKB {}", GraphicTint::Own, fires::circular),
    row("purple_kill_box", "242304", "Kill box, purple, irregular", "AREA10", GraphicShape::Area, [3, 6], "T W W1", "PKB {}", GraphicTint::Own, area::area),
    row("purple_kill_box_rectangle", "242305", "Kill box, purple, rectangular", "RECTANGULAR1", GraphicShape::Corridor, [2, 2], "T AM W W1", "PKB {}", GraphicTint::Own, zone::rectangle),
    row("purple_kill_box_circle", "242306", "Kill box, purple, circular", "CIRCULAR1", GraphicShape::Circle, [1, 1], "T AM W W1", "PKB {}", GraphicTint::Own, fires::circular),
    row("kill_zone", "242800", "Kill zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "KILL ZONE {}", GraphicTint::Own, area::area),
    row("fire_support_coordination_line", "260100", "Fire support coordination line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "{} FSCL", GraphicTint::Own, lines::end_labeled),
    row("coordinated_fire_line", "260200", "Coordinated fire line", "LINE7", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "CFL {}", GraphicTint::Own, lines::middle_labeled),
    row("no_fire_line", "260300", "No fire line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "NFL {}", GraphicTint::Own, lines::end_labeled),
    row("battlefield_coordination_line", "260400", "Battlefield coordination line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "{} BCL", GraphicTint::Own, lines::end_labeled),
    row("restrictive_fire_line", "260500", "Restrictive fire line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "RFL {}", GraphicTint::Own, lines::end_labeled),
    row("munition_flight_path", "260600", "Munition flight path", "LINE8", GraphicShape::Line, [2, 300], "W W1", "MFP", GraphicTint::Own, lines::middle_labeled),
    // Protection.
    row("obstacle_belt", "270100", "Obstacle belt", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "{}", GraphicTint::Obstacle, teeth::obstacle),
    row("obstacle_zone", "270200", "Obstacle zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "{}", GraphicTint::Obstacle, teeth::obstacle),
    row("obstacle_free_zone", "270300", "Obstacle free zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "FREE {}", GraphicTint::Obstacle, teeth::obstacle),
    row("obstacle_restricted_zone", "270400", "Obstacle restricted zone", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "{}", GraphicTint::Obstacle, teeth::obstacle),
    row("obstacle_block", "270501", "Obstacle effect: block", "AREA11", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, task::block),
    row("obstacle_disrupt", "270502", "Obstacle effect: disrupt", "AREA12", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, task::disrupt),
    row("obstacle_fix", "270503", "Obstacle effect: fix", "LINE9", GraphicShape::Figure, [2, 2], "", "", GraphicTint::Obstacle, axis::fix),
    row("obstacle_turn", "270504", "Obstacle effect: turn", "LINE10", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, task::turn),
    row("obstacle_bypass", "270601", "Obstacle bypass, easy", "POINT12", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, task::bracket),
    row("obstacle_bypass_difficult", "270602", "Obstacle bypass, difficult", "POINT12", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, task::bracket),
    row("obstacle_bypass_impossible", "270603", "Obstacle bypass, impossible", "POINT12", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, task::bracket),
    row("decoy_minefield", "270707", "Minefield, dynamic depiction", "AREA23", GraphicShape::Area, [3, MOST_POINTS], "", "", GraphicTint::Obstacle, area::dashed_area),
    row("mined_area", "270800", "Mined area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "H N W", "", GraphicTint::Obstacle, area::mined_area),
    row("fenced_mined_area", "270801", "Mined area, fenced", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "H N W", "", GraphicTint::Obstacle, area::mined_area),
    row("unexploded_ordnance_area", "271000", "Unexploded explosive ordnance area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "", "UXO", GraphicTint::Obstacle, area::marked_area),
    row("bridge", "271100", "Bridge or gap", "LINE11", GraphicShape::Figure, [4, 4], "T W W1", "", GraphicTint::Own, crossing::bridge),
    row("roadblock_planned", "271201", "Roadblock, crater or blown bridge, planned", "LINE12", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, crossing::roadblock),
    row("roadblock_safe", "271202", "Roadblock, crater or blown bridge, state of readiness 1 (safe)", "LINE12", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, crossing::roadblock),
    row("roadblock_armed", "271203", "Roadblock, crater or blown bridge, state of readiness 2 (armed but passable)", "LINE12", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, crossing::roadblock),
    row("roadblock", "271204", "Roadblock, complete (executed)", "LINE12", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Obstacle, crossing::roadblock),
    row("assault_crossing", "271300", "Assault crossing", "LINE16", GraphicShape::Figure, [4, 4], "W W1", "", GraphicTint::Own, crossing::bridge),
    row("ford_easy", "271500", "Ford, easy", "LINE17", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Own, crossing::ford),
    row("ford_difficult", "271600", "Ford, difficult", "LINE17", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Own, crossing::ford),
    row("biological_contaminated_area", "271700", "Biological contaminated area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "B", GraphicTint::Own, area::contaminated),
    row("chemical_contaminated_area", "271800", "Chemical contaminated area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "C", GraphicTint::Own, area::contaminated),
    row("nuclear_contaminated_area", "271900", "Nuclear contaminated area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "N", GraphicTint::Own, area::contaminated),
    row("radiological_contaminated_area", "272000", "Radiological contaminated area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T W W1", "R", GraphicTint::Own, area::contaminated),
    row("minimum_safe_distance_zone", "272100", "Minimum safe distance zone", "AREA14", GraphicShape::Figure, [3, 4], "", "", GraphicTint::Own, zone::safe_distances),
    row("strike_warning", "272101", "Multiple strikes, STRIKWARN", "AREA26", GraphicShape::Figure, [6, MOST_POINTS], "", "", GraphicTint::Own, zone::strike_warning),
    row("dose_rate_contour", "272200", "Radiation dose rate contour line", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "{}", GraphicTint::Own, area::top_labeled),
    row("abatis", "280100", "Abatis", "LINE13", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Obstacle, crossing::abatis),
    row("overhead_wire", "282003", "Overhead wire", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "X", "", GraphicTint::Own, lines::overhead_wire),
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
    row("mine_cluster", "290400", "Mine cluster", "AREA13", GraphicShape::Figure, [2, 2], "", "", GraphicTint::Obstacle, zone::mine_cluster),
    row("trip_wire", "290500", "Trip wire", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "t", GraphicTint::Obstacle, lines::segment_labeled),
    row("lane", "290600", "Lane", "LINE14", GraphicShape::Figure, [2, 2], "W W1", "", GraphicTint::Obstacle, corridor::lane),
    row("ferry", "290700", "Ferry", "LINE18", GraphicShape::Figure, [2, 2], "", "", GraphicTint::Own, crossing::ferry),
    row("raft_site", "290800", "Raft site", "LINE14", GraphicShape::Figure, [2, 2], "", "", GraphicTint::Own, corridor::lane),
    row("fortified_line", "290900", "Fortified line", "LINE1", GraphicShape::Line, [2, MOST_POINTS], "", "", GraphicTint::Own, teeth::fortified),
    row("fighting_position", "291000", "Fighting position", "LINE19", GraphicShape::Figure, [2, 2], "", "", GraphicTint::Own, crossing::fighting_position),
    // Intelligence and sustainment.
    row("intelligence_coordination_line", "300100", "Intelligence coordination line", "LINE2", GraphicShape::Line, [2, MOST_POINTS], "T W W1", "ICL {}", GraphicTint::Own, lines::end_labeled),
    row("detainee_holding_area", "310100", "Detainee holding area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "DETAINEE\nHOLDING\nAREA\n{}", GraphicTint::Own, area::area),
    row("prisoner_holding_area", "310200", "Enemy prisoner of war holding area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "EPW\nHOLDING\nAREA\n{}", GraphicTint::Own, area::area),
    row("forward_arming_and_refueling_area", "310300", "Forward arming and refueling point", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "FARP\n{}", GraphicTint::Own, area::area),
    row("refugee_holding_area", "310400", "Refugee holding area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "REFUGEE\nHOLDING\nAREA\n{}", GraphicTint::Own, area::area),
    row("regimental_support_area", "310500", "Regimental support area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "RSA {}", GraphicTint::Own, area::area),
    row("brigade_support_area", "310600", "Brigade support area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "BSA {}", GraphicTint::Own, area::area),
    row("division_support_area", "310700", "Division support area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "DSA {}", GraphicTint::Own, area::area),
    row("corps_support_area", "310800", "Corps support area", "AREA1", GraphicShape::Area, [3, MOST_POINTS], "T", "CSA {}", GraphicTint::Own, area::area),
    row("moving_convoy", "330100", "Moving convoy", "LINE9", GraphicShape::Figure, [2, 2], "H V W W1", "", GraphicTint::Own, crossing::convoy),
    row("halted_convoy", "330200", "Halted convoy", "LINE20", GraphicShape::Figure, [2, 2], "H V W W1", "", GraphicTint::Own, crossing::convoy),
    row("main_supply_route", "330300", "Main supply route", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "MSR {}", GraphicTint::Own, lines::route),
    row("main_supply_route_one_way", "330301", "Main supply route, one-way traffic", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "MSR {}", GraphicTint::Own, lines::route),
    row("main_supply_route_two_way", "330302", "Main supply route, two-way traffic", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "MSR {}", GraphicTint::Own, lines::route),
    row("main_supply_route_alternating", "330303", "Main supply route, alternating traffic", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "MSR {}", GraphicTint::Own, lines::route),
    row("alternate_supply_route", "330400", "Alternate supply route", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "ASR {}", GraphicTint::Own, lines::route),
    row("alternate_supply_route_one_way", "330401", "Alternate supply route, one-way traffic", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "ASR {}", GraphicTint::Own, lines::route),
    row("alternate_supply_route_two_way", "330402", "Alternate supply route, two-way traffic", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "ASR {}", GraphicTint::Own, lines::route),
    row("alternate_supply_route_alternating", "330403", "Alternate supply route, alternating traffic", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "ASR {}", GraphicTint::Own, lines::route),
    row("traffic_route", "330500", "Traffic route", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "ROUTE {}", GraphicTint::Own, lines::route),
    row("traffic_route_one_way", "330501", "Traffic route, one-way traffic", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "ROUTE {}", GraphicTint::Own, lines::route),
    row("traffic_route_alternating", "330502", "Traffic route, alternating traffic", "LINE21", GraphicShape::Line, [2, MOST_POINTS], "T", "ROUTE {}", GraphicTint::Own, lines::route),
    // Mission tasks.
    row("block", "340100", "Block", "AREA24", GraphicShape::Figure, [3, 3], "", "B", GraphicTint::Own, task::block),
    row("breach", "340200", "Breach", "LINE22", GraphicShape::Figure, [3, 3], "", "B", GraphicTint::Own, task::bracket),
    row("bypass", "340300", "Bypass", "POINT12", GraphicShape::Figure, [3, 3], "", "B", GraphicTint::Own, task::bracket),
    row("canalize", "340400", "Canalize", "POINT12", GraphicShape::Figure, [3, 3], "", "C", GraphicTint::Own, task::bracket),
    row("clear", "340500", "Clear", "LINE23", GraphicShape::Figure, [3, 3], "", "C", GraphicTint::Own, task::arrows_to_line),
    row("counterattack", "340600", "Counterattack", "AXIS2", GraphicShape::Axis, [3, 50], "T", "CATK", GraphicTint::Own, axis::axis),
    row("counterattack_by_fire", "340700", "Counterattack by fire", "AXIS2", GraphicShape::Axis, [3, 50], "T", "CATK", GraphicTint::Own, axis::axis),
    row("delay", "340800", "Delay", "LINE24", GraphicShape::Figure, [3, 3], "W", "D", GraphicTint::Own, task::delay),
    row("disrupt", "341000", "Disrupt", "AREA25", GraphicShape::Figure, [3, 3], "", "D", GraphicTint::Own, task::disrupt),
    row("fix", "341100", "Fix", "LINE28", GraphicShape::Figure, [2, 2], "", "F", GraphicTint::Own, axis::fix),
    row("follow_and_assume", "341200", "Follow and assume", "LINE25", GraphicShape::Figure, [2, 2], "T", "", GraphicTint::Own, task::follow),
    row("follow_and_support", "341300", "Follow and support", "LINE25", GraphicShape::Figure, [2, 2], "T", "", GraphicTint::Own, task::follow),
    row("isolate", "341500", "Isolate", "AREA15", GraphicShape::Figure, [2, 2], "", "I", GraphicTint::Own, task::circle_task),
    row("occupy", "341700", "Occupy", "AREA16", GraphicShape::Figure, [2, 2], "", "O", GraphicTint::Own, task::circle_task),
    row("penetrate", "341800", "Penetrate", "AREA17", GraphicShape::Figure, [3, 3], "", "P", GraphicTint::Own, task::arrows_to_line),
    row("relief_in_place", "341900", "Relief in place", "AREA18", GraphicShape::Figure, [4, 4], "", "RIP", GraphicTint::Own, maneuver::relief),
    row("retire", "342000", "Retire", "LINE24", GraphicShape::Figure, [3, 3], "", "R", GraphicTint::Own, task::delay),
    row("secure", "342100", "Secure", "AREA19", GraphicShape::Figure, [2, 2], "", "S", GraphicTint::Own, task::circle_task),
    row("cover", "342201", "Cover", "LINE26", GraphicShape::Figure, [3, 4], "", "C", GraphicTint::Own, task::screen),
    row("guard", "342202", "Guard", "LINE26", GraphicShape::Figure, [3, 4], "", "G", GraphicTint::Own, task::screen),
    row("screen", "342203", "Screen", "LINE26", GraphicShape::Figure, [3, 4], "", "S", GraphicTint::Own, task::screen),
    row("seize", "342300", "Seize", "LINE27", GraphicShape::Figure, [3, 4], "", "S", GraphicTint::Own, task::seize),
    row("withdraw", "342400", "Withdraw", "LINE24", GraphicShape::Figure, [2, 3], "", "W", GraphicTint::Own, task::delay),
    row("withdraw_under_pressure", "342500", "Withdraw under pressure", "LINE24", GraphicShape::Figure, [2, 3], "", "WP", GraphicTint::Own, task::delay),
    row("cordon_and_knock", "342600", "Cordon and knock", "AREA15", GraphicShape::Figure, [2, 2], "", "C/K", GraphicTint::Own, task::circle_task),
    row("cordon_and_search", "342700", "Cordon and search", "AREA15", GraphicShape::Figure, [2, 2], "", "C/S", GraphicTint::Own, task::circle_task),
    row("movement_to_contact", "342900", "Movement to contact", "AXIS1", GraphicShape::Axis, [3, 50], "T W W1", "{}", GraphicTint::Own, axis::axis),
    row("exploit", "343100", "Exploit, exploitation", "LINE30", GraphicShape::Figure, [3, 3], "", "", GraphicTint::Own, maneuver::exploit),
    row("demonstrate", "343300", "Demonstrate, demonstration", "AREA18", GraphicShape::Figure, [4, 4], "", "DEM", GraphicTint::Own, maneuver::relief),
    row("envelopment", "343500", "Envelopment", "LINE31", GraphicShape::Figure, [4, 4], "", "E", GraphicTint::Own, maneuver::envelopment),
    row("infiltration", "343800", "Infiltration", "LINE32", GraphicShape::Figure, [3, 3], "", "IN", GraphicTint::Own, maneuver::infiltration),
    row("pursuit", "344000", "Pursuit", "LINE33", GraphicShape::Figure, [3, 3], "", "P", GraphicTint::Own, maneuver::pursuit),
    row("forward_passage_of_lines", "344100", "Forward passage of lines", "LINE24", GraphicShape::Figure, [3, 3], "", "P(F)", GraphicTint::Own, task::delay),
    row("rearward_passage_of_lines", "344200", "Rearward passage of lines", "LINE24", GraphicShape::Figure, [3, 3], "", "P(R)", GraphicTint::Own, task::delay),
    row("disengage", "344400", "Disengage", "LINE24", GraphicShape::Figure, [3, 3], "", "DIS", GraphicTint::Own, task::delay),
    row("evacuate", "344500", "Evacuate, evacuation", "LINE27", GraphicShape::Figure, [4, 4], "", "E", GraphicTint::Own, task::seize),
    row("turn", "344700", "Turn", "LINE10", GraphicShape::Figure, [3, 3], "", "T", GraphicTint::Own, task::turn),
];

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::graphic::check::{PlacedGraphic, check};
    use crate::graphic::drawing::{GraphicInput, StrokeDash};
    use crate::graphic::fields::GraphicFields;

    #[test]
    fn words_and_codes_are_unique_and_rising() {
        for table in [LINE_KINDS, POINT_KINDS, WEATHER_KINDS] {
            let codes: Vec<(u8, &str)> = table.iter().map(|kind| (kind.set, kind.code)).collect();
            assert!(codes.windows(2).all(|pair| pair[0] < pair[1]), "by code, each once");
        }
        let mut words: Vec<&str> = GRAPHIC_KINDS.iter().map(|kind| kind.word).collect();
        words.sort_unstable();
        assert!(words.windows(2).all(|pair| pair[0] < pair[1]), "each word once");
        let mut codes: Vec<(u8, &str)> = GRAPHIC_KINDS.iter().map(|kind| (kind.set, kind.code)).collect();
        codes.sort_unstable();
        assert!(codes.windows(2).all(|pair| pair[0] < pair[1]), "each code once");
        assert!(GRAPHIC_KINDS.len() >= 690, "{}", GRAPHIC_KINDS.len());
    }

    /// Points that fit any kind: a zigzag line, or a ring for areas.
    fn points_of(kind: &GraphicKind, scale: f64, quarter: u32) -> Vec<DVec2> {
        let ring = [[0.0, 0.0], [3.0, -0.4], [4.0, 2.0], [1.8, 3.2], [-0.5, 1.7]];
        let axis = [[6.0, 2.0], [3.0, 1.2], [0.0, 1.6], [5.2, 2.9]];
        let figure = [[0.0, 2.0], [0.0, 0.0], [4.0, 1.2], [4.4, -1.0], [6.0, 1.0], [5.0, 3.0]];
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
            let mut fields = fields.clone();
            fields.azimuths_deg.truncate(if kind.rule == "POINT18" { 2 } else { 4 });
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
                let drawn = drawn.chain(drawing.fills.iter().flat_map(|fill| &fill.ring));
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
        for kind in GRAPHIC_KINDS
            .iter()
            .filter(|kind| !matches!(kind.shape, GraphicShape::Sector | GraphicShape::Ellipse))
        {
            let drawn = |quarter: u32| {
                let points = points_of(kind, 1000.0, quarter);
                let up = (0..quarter).fold(DVec2::Y, |up, _| up.perp());
                let input = GraphicInput { points: &points, em_m: 50.0, up, width_m: None, fields: &fields };
                kind.draw(&input)
            };
            let (mut first, mut second) = (drawn(0), drawn(1));
            // Where hatching begins is a matter of the last bit.
            for drawing in [&mut first, &mut second] {
                drawing.strokes.retain(|stroke| stroke.dash != StrokeDash::Hatch);
            }
            assert_eq!(first.strokes.len(), second.strokes.len(), "{}", kind.word);
            for (a, b) in first.strokes.iter().zip(&second.strokes) {
                for at in a.points.iter().map(|at| at.perp()) {
                    // What stands in the middle of an area stands level on the picture.
                    let is_there = b.points.iter().any(|turned| at.distance(*turned) < 1e-6);
                    assert!(
                        is_there || kind.shape == GraphicShape::Corridor || kind.word == "training_area",
                        "{}: {at}",
                        kind.word
                    );
                }
            }
        }
    }

    #[test]
    fn fields_are_letters_of_the_standard() {
        let letters = ["T", "T1", "B", "AS", "N", "H", "AP", "W", "W1", "X", "AM", "AN", "V", "C", "Y", "Q"];
        for kind in GRAPHIC_KINDS {
            for field in kind.fields.split(' ').filter(|field| !field.is_empty()) {
                assert!(letters.contains(&field), "{}: {field}", kind.word);
            }
        }
    }
}
