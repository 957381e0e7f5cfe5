//! The units of a scenario: where each is from state to state.

use glam::DVec3;
use serde_json::Value;

use super::{list, moment_of, place_of, states, text_of};
use crate::builder::{FeatureParts, LayerBuilder};
use crate::feature::Properties;
use crate::moment::Moment;
use crate::overlay_schema::{
    BEGIN, DESCRIPTION, END, ID, NAME, PARENT, REINFORCED, SIDC, SIDE, UNIQUE_DESIGNATION, field_property,
    set,
};
use crate::tally::RecordTally;

/// Of codes of 20 digits and more the digit of the standard identity; codes of letters have it in the second place too.
const IDENTITY_DIGIT: usize = 3;

/// Where a unit is for a time, and how it is then.
#[derive(Clone)]
struct Stay {
    begin: Option<Moment>,
    end: Option<Moment>,
    at: [f64; 3],
    sidc: Option<String>,
    reinforced: Option<String>,
}

struct UnitReader<'a, 'b> {
    builder: &'b mut LayerBuilder,
    side: &'a str,
    identity: Option<&'a str>,
    number: usize,
    /// Units that are where the unit above them is.
    led: RecordTally,
    placeless: RecordTally,
    /// States without a moment that is one.
    timeless: RecordTally,
}

/// Adds the units of all sides.
pub(super) fn add(scenario: &Value, builder: &mut LayerBuilder) {
    let [mut led, mut placeless, mut timeless] = [const { RecordTally::new() }; 3];
    let mut number = 0;
    for side in list(scenario, "sides") {
        let mut reader = UnitReader {
            builder,
            side: text_of(side, "name").unwrap_or_default(),
            identity: text_of(side, "standardIdentity"),
            number,
            led,
            placeless,
            timeless,
        };
        for unit in list(side, "subUnits") {
            reader.add(unit, "", &[]);
        }
        for group in list(side, "groups") {
            let of_side = reader.identity;
            reader.identity = text_of(group, "standardIdentity").or(of_side);
            list(group, "subUnits").iter().for_each(|unit| reader.add(unit, "", &[]));
            reader.identity = of_side;
        }
        UnitReader { number, led, placeless, timeless, .. } = reader;
    }
    let led = led.text("unit is where the unit above it is", "units are where the units above them are");
    let placeless = placeless.text("unit without a place", "units without a place");
    led.into_iter().for_each(|note| builder.note(note));
    placeless.into_iter().for_each(|note| builder.note(format!("left out: {note}")));
    let timeless = timeless.text("state without a moment", "states without a moment");
    timeless.into_iter().for_each(|fault| builder.fault(format!("left out: {fault}")));
}

impl UnitReader<'_, '_> {
    /// Adds a unit and those below it; `above` are the stays of the unit above.
    fn add(&mut self, unit: &Value, parent: &str, above: &[Stay]) {
        self.number += 1;
        let number = self.number;
        let name = text_of(unit, "name").or_else(|| text_of(unit, "shortName")).unwrap_or_default();
        let place = || if name.is_empty() { format!("unit {number}") } else { format!("unit '{name}'") };
        let timed = states(unit).len();
        self.timeless.add_many(list(unit, "state").len() - timed, place);
        let mut stays = stays(unit);
        if stays.is_empty() {
            stays = above.iter().map(|stay| Stay { sidc: None, reinforced: None, ..stay.clone() }).collect();
            let tally = if stays.is_empty() { &mut self.placeless } else { &mut self.led };
            tally.add(place);
        }
        let common = self.properties(unit, parent);
        for stay in &stays {
            let mut properties = common.clone();
            let code = stay.sidc.as_deref().or_else(|| text_of(unit, "sidc"));
            if let Some(code) = code {
                set(&mut properties, SIDC, self.identified(code));
            }
            if let Some(reinforced) = &stay.reinforced {
                set(&mut properties, REINFORCED, reinforced.clone());
            }
            stay.begin.into_iter().for_each(|begin| set(&mut properties, BEGIN, begin.to_string()));
            stay.end.into_iter().for_each(|end| set(&mut properties, END, end.to_string()));
            let mut parts = FeatureParts::default();
            parts.add_points(vec![DVec3::from(stay.at)]);
            self.builder.add_at(parts, properties, place);
        }
        for below in list(unit, "subUnits") {
            self.add(below, name, &stays);
        }
    }

    fn properties(&self, unit: &Value, parent: &str) -> Properties {
        let mut properties = Properties::new();
        let named = [(ID, "id"), (NAME, "name"), (DESCRIPTION, "description")];
        for (property, key) in named {
            text_of(unit, key).into_iter().for_each(|text| set(&mut properties, property, text));
        }
        let designation = text_of(unit, "shortName").or_else(|| text_of(unit, "name"));
        designation.into_iter().for_each(|text| set(&mut properties, UNIQUE_DESIGNATION, text));
        for (property, text) in [(SIDE, self.side), (PARENT, parent)] {
            if !text.is_empty() {
                set(&mut properties, property, text);
            }
        }
        let reinforced = text_of(unit, "reinforcedStatus").and_then(reinforced_mark);
        reinforced.into_iter().for_each(|mark| set(&mut properties, REINFORCED, mark));
        // The fields of text that are stated count before those that are derived.
        for (key, value) in unit.get("textAmplifiers").and_then(Value::as_object).into_iter().flatten() {
            if let (Some(property), Some(text)) = (field_property(key), amplifier(value)) {
                set(&mut properties, property, text);
            }
        }
        properties
    }

    /// The code with the identity of the side.
    fn identified(&self, code: &str) -> String {
        let is_digits = code.len() >= 20 && code.bytes().all(|byte| byte.is_ascii_digit());
        match self.identity {
            Some(identity) if is_digits && identity.len() == 1 && identity.as_bytes()[0].is_ascii_digit() => {
                format!("{}{identity}{}", &code[..IDENTITY_DIGIT], &code[IDENTITY_DIGIT + 1..])
            }
            _ => code.to_owned(),
        }
    }
}

/// The text of a field; `None` for an empty one.
pub(super) fn amplifier(value: &Value) -> Option<String> {
    match value {
        Value::String(text) if !text.trim().is_empty() => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        _ => None,
    }
}

fn reinforced_mark(status: &str) -> Option<&'static str> {
    match status {
        "Reinforced" => Some("(+)"),
        "Reduced" => Some("(-)"),
        "ReinforcedReduced" => Some("(±)"),
        _ => None,
    }
}

/// The times at which a unit has a place.
fn stays(unit: &Value) -> Vec<Stay> {
    let mut at = unit.get("location").and_then(place_of);
    let [mut sidc, mut reinforced] = [const { None }; 2];
    let mut begin = moment_of(unit, "startTime");
    let mut stays: Vec<Stay> = Vec::new();
    for (moment, state) in states(unit) {
        let changes = ["location", "sidc", "reinforcedStatus"].iter().any(|key| state.contains_key(*key));
        if !changes {
            continue;
        }
        if let Some(at) = at {
            stays.push(Stay {
                begin,
                end: Some(moment),
                at,
                sidc: sidc.clone(),
                reinforced: reinforced.clone(),
            });
        }
        begin = Some(moment);
        match state.get("location") {
            Some(Value::Null) => at = None,
            Some(place) => at = place_of(place).or(at),
            None => {}
        }
        if let Some(Value::String(code)) = state.get("sidc") {
            sidc = Some(code.clone());
        }
        if let Some(Value::String(status)) = state.get("reinforcedStatus") {
            reinforced = Some(reinforced_mark(status).unwrap_or_default().to_owned());
        }
    }
    if let Some(at) = at {
        stays.push(Stay { begin, end: None, at, sidc, reinforced });
    }
    stays.retain(|stay| stay.end.is_none_or(|end| stay.begin.is_none_or(|begin| begin < end)));
    stays
}
