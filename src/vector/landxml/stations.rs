//! Stations as they are written: `1+234` of kilometers and meters, `12+34` of hundreds of feet, over the equations at which
//! their count changes.

use crate::xml::XmlElement;

/// Places between which stations are counted anew.
#[derive(Debug, Default)]
pub(super) struct StationEquations {
    /// Where the count changes, as counted from the start, and the station that follows there.
    ahead: Vec<[f64; 2]>,
}

impl StationEquations {
    /// The equations of an alignment whose stations begin at `start`.
    pub fn of(alignment: &XmlElement<'_>) -> Self {
        let mut ahead: Vec<[f64; 2]> = alignment
            .children_named("StaEquation")
            .filter_map(|equation| {
                let ahead = equation.number::<f64>("staAhead")?;
                let internal =
                    equation.number::<f64>("staInternal").or_else(|| equation.number("staBack"))?;
                (ahead.is_finite() && internal.is_finite()).then_some([internal, ahead])
            })
            .collect();
        ahead.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Self { ahead }
    }

    /// The station that is written where `internal` is counted from the start.
    pub fn written(&self, internal: f64) -> f64 {
        let passed = self.ahead.iter().rev().find(|[place, _]| *place <= internal);
        passed.map_or(internal, |[place, ahead]| ahead + (internal - place))
    }
}

/// A station as text, to the unit; with decimals where it lies between.
pub(super) fn text(station: f64, is_imperial: bool) -> String {
    let hundred = if is_imperial { 100.0 } else { 1000.0 };
    let digits = if is_imperial { 2 } else { 3 };
    let rounded = (station.abs() * 100.0).round() / 100.0;
    let whole = (rounded / hundred).floor();
    let rest = rounded - whole * hundred;
    let sign = if station < 0.0 && rounded > 0.0 { "-" } else { "" };
    match rest.fract().abs() < 0.005 || rest.fract() > 0.995 {
        true => format!("{sign}{whole:.0}+{:0digits$.0}", rest.round()),
        false => format!("{sign}{whole:.0}+{rest:0width$.2}", width = digits + 3),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stations_are_written_in_kilometers_or_hundreds_of_feet() {
        assert_eq!(text(1234.0, false), "1+234");
        assert_eq!(text(20.5, false), "0+020.50");
        assert_eq!(text(1234.0, true), "12+34");
        assert_eq!(text(1205.25, true), "12+05.25");
        assert_eq!(text(-20.0, false), "-0+020");
        assert_eq!(text(99.999, true), "1+00");
    }
}
