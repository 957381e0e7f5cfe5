//! Vehicles, and people on foot: what ground they can cross, and how fast.

use crate::error::AnalysisError;
use crate::land::{Land, RoadClass};
use sandtable_base::message::suggest::{listed, nearest, quoted};

/// The names of the built-in vehicles.
pub const BUILT_IN_NAMES: [&str; 4] = ["foot", "wheeled", "tracked", "truck"];

/// Why a vehicle cannot be reckoned with.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{key}` {problem}")]
pub struct VehicleFault {
    /// The field that is at fault.
    pub key: &'static str,
    /// What is wrong with it, the rest of a sentence after the key.
    pub problem: String,
}

/// A vehicle, or people on foot.
#[derive(Clone, Debug, PartialEq)]
pub struct Vehicle {
    /// The name by which analyses refer to it.
    pub name: String,
    /// How it moves.
    pub drive: Drive,
    /// Slopes uphill in percent: up to the first it goes freely, up to the second slowly, above that not.
    pub slope_up_percent: [f64; 2],
    /// The same downhill.
    pub slope_down_percent: [f64; 2],
    /// The same across its way.
    pub slope_across_percent: [f64; 2],
    /// Its speed on level open ground, km/h.
    pub speed_kmh: f64,
    /// Its speed in built-up ground off the roads, km/h; 0 where it cannot go.
    pub built_up_kmh: f64,
    /// Its greatest speed on each surface of road, km/h, from [`RoadClass::Path`] to [`RoadClass::Motorway`].
    pub road_speed_kmh: [f64; 5],
    /// The depth of water that it wades, meters.
    pub ford_m: f64,
    /// The width of a gap that it crosses, meters.
    pub gap_m: f64,
    /// The height of a step that it climbs, meters.
    pub step_m: f64,
    /// Its width, meters.
    pub width_m: f64,
    /// The diameter of stems that it pushes over, meters.
    pub stem_m: f64,
    /// Its mass, tonnes.
    pub mass_t: f64,
}

/// How a vehicle moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// On foot.
    Foot,
    /// On wheels.
    Wheels,
    /// On tracks.
    Tracks,
}

impl Vehicle {
    /// Its greatest speed on a surface of road, km/h; that of open ground where there is no road.
    pub fn speed_on_kmh(&self, surface: RoadClass) -> f64 {
        match (surface as usize).checked_sub(1) {
            Some(index) => self.road_speed_kmh[index],
            None => self.speed_kmh,
        }
    }

    /// A built-in vehicle: people on foot, an armored personnel carrier on wheels, a battle tank, an off-road truck. The
    /// numbers are defaults of this program, not of a manual; a scene's `[vehicle.NAME]` has others.
    pub fn built_in(name: &str) -> Option<Self> {
        let vehicle = |drive, slopes: [[f64; 2]; 3], speed_kmh, road_speed_kmh| Self {
            name: name.to_owned(),
            drive,
            slope_up_percent: slopes[0],
            slope_down_percent: slopes[1],
            slope_across_percent: slopes[2],
            speed_kmh,
            built_up_kmh: match drive {
                Drive::Foot => 0.9,
                Drive::Wheels => 0.5,
                Drive::Tracks => 0.4,
            } * speed_kmh,
            road_speed_kmh,
            ford_m: 0.8,
            gap_m: 0.5,
            step_m: 0.4,
            width_m: 2.5,
            stem_m: 0.05,
            mass_t: 10.0,
        };
        Some(match name {
            "foot" => Self {
                gap_m: 1.0,
                step_m: 1.2,
                width_m: 0.7,
                stem_m: 0.0,
                mass_t: 0.1,
                ..vehicle(
                    Drive::Foot,
                    [[45.0, 100.0], [45.0, 100.0], [60.0, 120.0]],
                    LEVEL_FOOT_KMH,
                    [LEVEL_FOOT_KMH; 5],
                )
            },
            "wheeled" => Self {
                ford_m: 1.5,
                gap_m: 1.5,
                step_m: 0.5,
                width_m: 3.0,
                stem_m: 0.1,
                mass_t: 20.0,
                ..vehicle(
                    Drive::Wheels,
                    [[25.0, 45.0], [25.0, 45.0], [15.0, 30.0]],
                    25.0,
                    [0.0, 35.0, 70.0, 80.0, 90.0],
                )
            },
            "tracked" => Self {
                ford_m: 1.2,
                gap_m: 2.5,
                step_m: 0.9,
                width_m: 3.6,
                stem_m: 0.15,
                mass_t: 60.0,
                ..vehicle(
                    Drive::Tracks,
                    [[30.0, 45.0], [30.0, 45.0], [20.0, 30.0]],
                    30.0,
                    [0.0, 35.0, 50.0, 55.0, 60.0],
                )
            },
            "truck" => vehicle(
                Drive::Wheels,
                [[15.0, 30.0], [15.0, 30.0], [10.0, 20.0]],
                15.0,
                [0.0, 25.0, 60.0, 70.0, 80.0],
            ),
            _ => return None,
        })
    }

    /// The vehicle of this name: one of the land, else a built-in one.
    ///
    /// # Errors
    /// There is none, or its limits are out of order; the error names the key `vehicle`.
    pub fn named(land: &Land, name: &str) -> Result<Self, AnalysisError> {
        let stated = land.vehicles.iter().find(|vehicle| vehicle.name == name).cloned();
        let Some(vehicle) = stated.or_else(|| Self::built_in(name)) else {
            let mut valid: Vec<&str> = land.vehicles.iter().map(|vehicle| vehicle.name.as_str()).collect();
            valid.extend(BUILT_IN_NAMES);
            let remedy = match nearest(name, valid.iter().copied()) {
                Some(near) => format!("did you mean `{near}`? There are"),
                None => "there are".to_owned(),
            };
            let problem = format!("`{}` is not a vehicle; {remedy} {}", quoted(name), listed(&valid));
            return Err(AnalysisError::argument("vehicle", problem));
        };
        vehicle.check().map_err(|fault| {
            AnalysisError::argument("vehicle", format!("`{}`: {fault}", quoted(&vehicle.name)))
        })?;
        Ok(vehicle)
    }

    /// Checks that its limits are numbers in order.
    ///
    /// # Errors
    /// The first field that is at fault.
    pub fn check(&self) -> Result<(), VehicleFault> {
        let fault = |key, problem: String| Err(VehicleFault { key, problem });
        let slopes = [
            ("slope_up_percent", self.slope_up_percent),
            ("slope_down_percent", self.slope_down_percent),
            ("slope_across_percent", self.slope_across_percent),
        ];
        for (key, [free, slow]) in slopes {
            if !(free > 0.0 && free <= slow && slow <= 200.0) {
                return fault(
                    key,
                    format!("must be two numbers above 0, rising, up to 200, and is {free}, {slow}"),
                );
            }
        }
        if !(self.speed_kmh >= 0.1 && self.speed_kmh <= 300.0) {
            return fault("speed_kmh", format!("must be from 0.1 to 300 and is {}", self.speed_kmh));
        }
        if !(self.built_up_kmh == 0.0 || (0.1..=300.0).contains(&self.built_up_kmh)) {
            return fault(
                "built_up_kmh",
                format!("must be 0 or from 0.1 to 300 and is {}", self.built_up_kmh),
            );
        }
        let is_road_speed = |speed: &f64| *speed == 0.0 || (0.1..=300.0).contains(speed);
        if let Some(speed) = self.road_speed_kmh.iter().find(|speed| !is_road_speed(speed)) {
            return fault("road_speed_kmh", format!("must be 0 or from 0.1 to 300 and is {speed}"));
        }
        let sizes = [
            ("ford_m", self.ford_m),
            ("gap_m", self.gap_m),
            ("step_m", self.step_m),
            ("width_m", self.width_m),
            ("stem_m", self.stem_m),
            ("mass_t", self.mass_t),
        ];
        match sizes.into_iter().find(|&(_, size)| !(0.0..=10_000.0).contains(&size)) {
            Some((key, size)) => fault(key, format!("must be from 0 to 10000 and is {size}")),
            None => Ok(()),
        }
    }
}

/// The speed of people on foot on level open ground for which the formulas of Tobler and of Langmuir hold unscaled, km/h.
pub(crate) const LEVEL_FOOT_KMH: f64 = 5.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_land::flat;

    #[test]
    fn built_in_vehicles_are_in_order_and_a_vehicle_of_the_scene_comes_first() {
        let mut land = flat(3, 3, 10.0);
        for name in BUILT_IN_NAMES {
            assert_eq!(Vehicle::named(&land, name).expect("built in").check(), Ok(()));
        }
        let own = Vehicle { speed_kmh: 7.0, ..Vehicle::built_in("truck").expect("built in") };
        land.vehicles.push(own.clone());
        assert_eq!(Vehicle::named(&land, "truck"), Ok(own));
    }

    #[test]
    fn an_unknown_vehicle_and_limits_out_of_order_are_errors_that_name_the_key() {
        let mut land = flat(3, 3, 10.0);
        let error = Vehicle::named(&land, "traked").expect_err("unknown");
        assert_eq!(error.key(), Some("vehicle"));
        assert!(error.to_string().contains("did you mean `tracked`?"), "{error}");
        let truck = Vehicle::built_in("truck").expect("built in");
        land.vehicles.push(Vehicle { slope_up_percent: [40.0, 30.0], ..truck });
        let error = Vehicle::named(&land, "truck").expect_err("out of order");
        assert!(error.key() == Some("vehicle") && error.to_string().contains("slope_up_percent"), "{error}");
    }
}
