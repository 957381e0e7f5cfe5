//! The direction of a scene's light: from the left of each picture, the upper left in views from above, as on maps; or
//! from the sun's position at a time.
//!
//! Natural ground that falls away from light of the upper left as a whole, as a coast does, would lie in the dark with all
//! that stands on it: there the light comes from the left.

use glam::{DVec2, Vec2, Vec3};

use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::Document;
use sandtable_geom::crs::Crs;
use sandtable_geom::sun_position::{SunPosition, sun_position, unix_seconds};
use sandtable_view::camera::Camera;

/// The direction of the light of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sunlight {
    /// Clockwise from north, radians; `None` for the upper left of each picture: forms that are lit from below look like
    /// holes.
    pub azimuth_rad: Option<f32>,
    /// Above the horizon, radians.
    pub altitude_rad: f32,
    /// Where natural ground falls to as a whole: the sum of its downhill slopes as a part of the sum of their lengths, 0..=1.
    pub fall: Vec2,
}

/// The sun's height in degrees where it is not stated: low enough that gentle forms show.
pub const ALTITUDE_DEG: f64 = 40.0;

/// The light follows the camera in steps of this many degrees, so that a small turn does not move the shadows.
const STEP_DEG: f32 = 15.0;

/// How far to the left of the viewing direction the light comes from, degrees: in a view from above, where light from
/// below right would turn hills into holes; and in a view from the side, where fronts of buildings would be dark.
pub const LEFT_DEG: [f32; 2] = [45.0, 100.0];
/// From and up to how steep a view, degrees below the horizon, the light turns from one to the other.
const PITCH_DEG: [f32; 2] = [40.0, 22.0];
/// From and up to which fall away from the light of views from above it turns to that of views from the side.
const TURNING_FALL: [f32; 2] = [0.25, 0.45];

impl Sunlight {
    /// The document's light. `middle` is the middle of the scene in map coordinates of `crs`.
    ///
    /// # Errors
    /// A time at which the sun is below the horizon, one that is not a time, or one together with an angle.
    pub fn new(document: &Document, crs: &Crs, middle: DVec2) -> Result<Self, Diagnostic> {
        let light = &document.style.light;
        let Some(time) = &light.time else {
            return Ok(Self {
                azimuth_rad: light.azimuth.map(|degrees| degrees.to_radians() as f32),
                altitude_rad: light.altitude.unwrap_or(ALTITUDE_DEG).to_radians() as f32,
                fall: Vec2::ZERO,
            });
        };
        if light.azimuth.is_some() || light.altitude.is_some() {
            let message = "`azimuth` and `altitude` have no effect beside `time`";
            return Err(document.error(time, message).with_help("remove either"));
        }
        let seconds = unix_seconds(time).ok_or_else(|| {
            let help = "write it as RFC 3339 does: \"2026-06-21T09:30:00+02:00\", or ending in Z for UTC";
            document
                .error(time, format!("\"{}\" is not a date and time with an offset", **time))
                .with_help(help)
        })?;
        let failed = |error| document.error(time, format!("the sun's position is unknown here: {error}"));
        let wgs84 = Crs::wgs84();
        let place = crs.transform(&wgs84, middle).map_err(failed)?;
        let north = crs.transform(&wgs84, middle + DVec2::Y * 1000.0).map_err(failed)?;
        let SunPosition { azimuth_rad, altitude_rad } = sun_position(seconds, place);
        if altitude_rad <= 0.0 {
            let message = format!("the sun is {:.1}° below the horizon then", -altitude_rad.to_degrees());
            return Err(document.error(time, message).with_help("name a time of day"));
        }
        // Where the map's north points, seen on the globe.
        let turn = libm::atan2((north.x - place.x) * libm::cos(place.y.to_radians()), north.y - place.y);
        let azimuth_rad = Some((azimuth_rad - turn) as f32);
        Ok(Self { azimuth_rad, altitude_rad: altitude_rad as f32, fall: Vec2::ZERO })
    }

    /// The same over natural ground of a [`Self::fall`].
    pub fn over(self, fall: Vec2) -> Self {
        Self { fall, ..self }
    }

    /// Unit vector toward the sun in a picture of `camera`; without one, as on a map with north above.
    pub fn to_sun(&self, camera: Option<&Camera>) -> Vec3 {
        let azimuth = self.azimuth_rad.unwrap_or_else(|| {
            let (heading, down) = camera.map_or((Vec2::Y, 1.0), |camera| {
                ((camera.forward() + camera.up()).truncate(), -camera.forward().z)
            });
            let pitch = libm::asinf(down.clamp(-1.0, 1.0)).to_degrees();
            let part = |value: f32, [from, to]: [f32; 2]| ((value - from) / (to - from)).clamp(0.0, 1.0);
            let heading_deg = libm::atan2f(heading.x, heading.y).to_degrees();
            let upper_left = (heading_deg - LEFT_DEG[0]).to_radians();
            let away = -self.fall.dot(Vec2::new(libm::sinf(upper_left), libm::cosf(upper_left)));
            let share = part(pitch, PITCH_DEG).max(part(away, TURNING_FALL));
            let azimuth = heading_deg - LEFT_DEG[0] - (LEFT_DEG[1] - LEFT_DEG[0]) * share;
            ((azimuth / STEP_DEG).round() * STEP_DEG).to_radians()
        });
        let level = libm::cosf(self.altitude_rad);
        let to_sun = Vec3::new(
            libm::sinf(azimuth) * level,
            libm::cosf(azimuth) * level,
            libm::sinf(self.altitude_rad),
        );
        to_sun.normalize_or(Vec3::Z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sandtable_description::parse::parse_bytes;

    /// East of a zone's meridian the map's north points to the east of north.
    #[test]
    fn azimuths_of_the_sun_count_from_the_map_s_north() {
        let text = b"[terrain]\ndem = \"a.tif\"\n[style.light]\ntime = \"2026-06-21T10:38:00Z\"\n";
        let document = parse_bytes("scene.toml", text).expect("sound");
        let crs = Crs::from_epsg(32633).expect("known");
        let light = Sunlight::new(&document, &crs, DVec2::new(800_000.0, 7_000_000.0)).expect("by day");
        let azimuth = light.azimuth_rad.expect("stated").to_degrees();
        assert!((azimuth - (180.0 - 5.3)).abs() < 0.5, "{azimuth} at noon, 21° east and 63° north");
    }

    #[test]
    fn the_light_comes_from_the_left_of_every_picture_and_from_above_of_steep_ones() {
        let light = Sunlight { azimuth_rad: None, altitude_rad: 0.7, fall: Vec2::ZERO };
        for heading in 0..360 {
            let toward = Vec2::from_angle((90.0 - heading as f32).to_radians());
            for down in [0.1, 0.8, 1.2, 50.0] {
                let camera = Camera::new(Vec3::ZERO, toward.extend(-down), 0.5, (16, 9), (1.0, 9.0));
                let camera = camera.expect("sound");
                let to_sun = light.to_sun(Some(&camera));
                assert!(to_sun.dot(camera.right()) < -0.4, "left: {heading} {down}");
                let is_above = to_sun.truncate().dot(toward) > 0.0;
                assert_eq!(is_above, down > 0.5, "above: {heading} {down}");
            }
        }
        let north_west = light.to_sun(None);
        assert!((north_west.x + north_west.y).abs() < 1e-6 && north_west.x < 0.0, "{north_west}");
    }

    #[test]
    fn a_coast_that_falls_to_the_lower_right_is_lit_from_the_left_and_no_other() {
        let light = Sunlight { azimuth_rad: None, altitude_rad: 0.7, fall: Vec2::ZERO };
        for turn in [0.0, 90.0, 180.0, 270.0] {
            let toward = Vec2::from_angle((90.0 - turn as f32).to_radians());
            let camera = Camera::new(Vec3::ZERO, toward.extend(-50.0), 0.5, (16, 9), (1.0, 9.0));
            let camera = camera.expect("sound");
            let fall = |right: f32, ahead: f32| camera.right().truncate() * right + toward * ahead;
            let lit = |fall: Vec2| light.over(fall).to_sun(Some(&camera));
            let plain = lit(Vec2::ZERO);
            for gentle in [fall(0.1, -0.1), fall(-0.5, 0.5), fall(0.4, 0.4)] {
                assert_eq!(lit(gentle), plain, "{gentle}");
            }
            let turned = lit(fall(0.4, -0.4));
            assert!(turned.dot(camera.right()) < -0.7 && turned.truncate().dot(toward) < 0.1, "{turned}");
        }
    }
}
