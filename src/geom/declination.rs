//! Magnetic declination and grid convergence: the angles between the three norths; the one user of
//! `world_magnetic_model`.

use glam::DVec2;
use world_magnetic_model::GeomagneticField;
use world_magnetic_model::time::{Date, Month};
use world_magnetic_model::uom::si::angle::degree;
use world_magnetic_model::uom::si::f32::{Angle, Length};
use world_magnetic_model::uom::si::length::meter;

use crate::crs::Crs;

/// A day of the calendar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CalendarDay {
    year: i32,
    month: u8,
    day: u8,
}

/// The direction of a compass needle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Declination {
    /// From true north, clockwise, degrees.
    pub east_deg: f64,
    /// Its standard error, degrees.
    pub error_deg: f64,
}

impl CalendarDay {
    /// The day that `text` names as `2026-06-21`; `None` where it names none.
    pub fn parse(text: &str) -> Option<Self> {
        let mut parts = text.split('-');
        let [year, month, day] = [parts.next()?, parts.next()?, parts.next()?];
        let is_whole = parts.next().is_none() && [year.len(), month.len(), day.len()] == [4, 2, 2];
        let day = Self { year: year.parse().ok()?, month: month.parse().ok()?, day: day.parse().ok()? };
        day.date().filter(|_| is_whole).map(|_| day)
    }

    fn date(self) -> Option<Date> {
        Date::from_calendar_date(self.year, Month::try_from(self.month).ok()?, self.day).ok()
    }
}

/// The declination at a longitude and latitude on WGS 84 (degrees) and a height in meters, by the World Magnetic Model
/// (NOAA and BGS 2020, 2025). `None` outside the years 2020 to 2029 and beyond the model's heights.
pub fn declination(place: DVec2, height_m: f64, day: CalendarDay) -> Option<Declination> {
    let field = GeomagneticField::new(
        Length::new::<meter>(height_m as f32),
        Angle::new::<degree>(place.y as f32),
        Angle::new::<degree>(place.x as f32),
        day.date()?,
    );
    let field = field.ok()?;
    let declination = Declination {
        east_deg: field.declination().get::<degree>().into(),
        error_deg: field.declination_uncertainty().get::<degree>().into(),
    };
    declination.east_deg.is_finite().then_some(declination)
}

/// The direction in which northings of `crs` grow at a longitude and latitude (degrees): from true north, clockwise,
/// degrees. `None` where the place is outside the system, and for a system without northings.
pub fn convergence_deg(crs: &Crs, place: DVec2) -> Option<f64> {
    let true_north = meridian(crs, place).filter(|_| !crs.is_geographic())?;
    Some(-libm::atan2(true_north.x, true_north.y).to_degrees())
}

/// The direction of true north at the map coordinates `at` of `crs`, in map coordinates, of length 1. `None` where they have
/// no place on Earth, and at a pole.
///
/// ```
/// use glam::DVec2;
/// use sandtable_geom::{crs::Crs, declination::true_north};
/// let utm = Crs::from_epsg(32633).unwrap();
/// // West of the central meridian true north is to the right of grid north.
/// assert!(true_north(&utm, DVec2::new(300_000.0, 5_000_000.0)).unwrap().x > 0.02);
/// ```
pub fn true_north(crs: &Crs, at: DVec2) -> Option<DVec2> {
    meridian(crs, crs.transform(&Crs::wgs84(), at).ok()?)
}

/// The direction of the meridian at a longitude and latitude (degrees), northward, in map coordinates of `crs`, of length 1.
fn meridian(crs: &Crs, place: DVec2) -> Option<DVec2> {
    /// Far enough for the numbers' precision, near enough for a straight line.
    const STEP_DEG: f64 = 1e-4;
    let wgs84 = Crs::wgs84();
    // No step goes beyond a pole.
    let [south, north] = [-STEP_DEG, STEP_DEG].map(|step| {
        let latitude = (place.y + step).clamp(-90.0, 90.0);
        wgs84.transform(crs, DVec2::new(place.x, latitude)).ok()
    });
    let is_pole = place.y.abs() > 90.0 - 1e-9;
    (north? - south?).try_normalize().filter(|_| !is_pole)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn declinations_are_the_test_values_that_the_models_were_published_with() {
        let table = include_str!("../../tests/heights/declinations.txt");
        let rows = table.lines().filter(|line| !line.starts_with('#'));
        let mut worst_deg = 0.0f64;
        for row in rows.clone() {
            let [year, height_km, latitude, longitude, expected] = numbers(row);
            // The years are whole or have a half, which is noon of a day early in July.
            let (month, day) = if year.fract() == 0.0 { (1, 1) } else { (7, 2) };
            let day = CalendarDay { year: year as i32, month, day };
            let found = declination(DVec2::new(longitude, latitude), 1000.0 * height_km, day);
            let off_deg = (found.expect("covered").east_deg - expected).abs();
            assert!(off_deg < 0.0101, "{row}: {found:?}");
            worst_deg = worst_deg.max(off_deg);
        }
        assert_eq!(rows.count(), 200);
        assert!(worst_deg > 0.001, "expected values have two decimals");
    }

    fn numbers(row: &str) -> [f64; 5] {
        let numbers: Vec<f64> = row.split(' ').map(|word| word.parse().expect("a number")).collect();
        numbers.try_into().expect("five columns")
    }

    #[test]
    fn beyond_the_model_there_is_no_declination() {
        let at = |year| declination(DVec2::new(-84.0, 36.0), 300.0, CalendarDay { year, month: 6, day: 1 });
        assert!(at(2026).is_some() && at(2019).is_none() && at(2031).is_none());
    }

    #[test]
    fn a_day_is_written_with_year_month_and_day() {
        assert_eq!(CalendarDay::parse("2026-02-28"), Some(CalendarDay { year: 2026, month: 2, day: 28 }));
        for wrong in ["2026-02-30", "2026-2-3", "26-02-03", "2026-02-03T", "", "2026-02-03-01", "2026-aa-01"]
        {
            assert_eq!(CalendarDay::parse(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn grid_north_turns_east_of_true_north_east_of_the_central_meridian() {
        let utm = Crs::from_epsg(32616).expect("in the table");
        let at = |longitude: f64| convergence_deg(&utm, DVec2::new(longitude, 36.3)).expect("covered");
        assert!(at(-87.0).abs() < 1e-6);
        // The first term of the series: difference in longitude times the sine of the latitude.
        assert!((at(-84.2) - 2.8 * libm::sin(36.3f64.to_radians())).abs() < 0.01);
        assert!(at(-88.0) < 0.0);
        assert_eq!(convergence_deg(&Crs::wgs84(), DVec2::ZERO), None);
    }

    #[test]
    fn true_north_points_to_the_pole_of_a_polar_system() {
        let polar = Crs::from_epsg(3413).expect("in the table");
        for at in [DVec2::new(4e5, -3e5), DVec2::new(-2e5, 1e5), DVec2::new(5.0, 5.0)] {
            let north = true_north(&polar, at).expect("on Earth");
            assert!((north + at.normalize()).length() < 1e-3, "{at}: {north}");
        }
        assert_eq!(true_north(&polar, DVec2::ZERO), None);
        assert_eq!(true_north(&Crs::local(), DVec2::ONE), None);
        // 66° to the left of grid north where northings grow 66° east of true north.
        let place = DVec2::new(21.0, 84.5);
        let at = Crs::wgs84().transform(&polar, place).expect("in range");
        let convergence = convergence_deg(&polar, place).expect("in range").to_radians();
        let north = true_north(&polar, at).expect("on Earth");
        assert!((convergence - 66f64.to_radians()).abs() < 1e-3);
        assert!((north - DVec2::new(-libm::sin(convergence), libm::cos(convergence))).length() < 1e-6);
    }
}
