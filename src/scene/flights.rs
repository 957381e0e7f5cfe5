//! Flights through a scene: where the eye is at each moment, and where it looks.
//!
//! The path's bends are rounded. The eye keeps its height above the highest ground around, smoothed, so that it climbs
//! before a ridge and does not follow every gully.

use glam::{DVec2, Vec3};

use crate::assets::Assets;
use crate::near::MERGE_M;
use crate::scene_findings::SceneFindings;
use crate::scene_model::SceneModel;
use crate::scene_view::{SceneView, ViewAim};
use crate::sources::Sources;
use crate::world_frame::WorldFrame;
use sandtable_description::diagnostic::Diagnostic;
use sandtable_description::document::{Document, FlightTable};
use sandtable_description::finding::Finding;
use sandtable_geom::polyline::Polyline;
use sandtable_geom::profile::Profile;
use sandtable_geom::smooth::smoothed;
use sandtable_view::camera::Camera;

/// Vertices of a path: as many as frames of a minute.
const VERTICES: usize = 1500;

/// How far bends are rounded, and how far ahead the eye turns, in heights above the ground.
const ROUNDED: f64 = 2.0;
const AHEAD: f64 = 3.0;

/// The ground that the eye keeps its height above reaches so many heights before and behind it, and its height changes
/// over so many.
const CLEARED: f64 = 1.0;
const EASED: f64 = 6.0;

/// The time of a flight whose speed is not stated, in seconds: as long as anyone looks.
const SECONDS: f64 = 20.0;

/// A flight, in world space.
#[derive(Clone, Debug)]
pub struct SceneFlight {
    /// Its name on the command line.
    pub name: String,
    /// How long it takes.
    pub seconds: f64,
    /// What reading its file left out, or took for something else.
    pub findings: Vec<Finding>,
    path: Polyline,
    /// World Z of the eye along the path.
    eye_z: Profile,
    /// Below the horizon.
    pitch_rad: f64,
    /// How far before the eye the place is that it turns to, in meters.
    ahead_m: f64,
    look_at: Option<Vec3>,
    fov_y_rad: f32,
}

/// The flight that `table` of `document` describes, through `scene`, which was built of it.
///
/// # Errors
/// A file cannot be read, or the path holds no line over the ground.
pub fn flight(
    document: &Document,
    table: &FlightTable,
    assets: &Assets,
    scene: &SceneModel,
) -> Result<SceneFlight, Diagnostic> {
    let lattice = &scene.lattice;
    let frame = &WorldFrame::new(document, &scene.crs, &scene.stated_crs, lattice.map_extent());
    let sources = Sources::new(frame, assets);
    let lines = sources.lines(&table.source)?;
    let mut findings = SceneFindings::new(document);
    sources.report_reading(&mut findings);
    let paths = lines.into_iter().filter_map(|line| Polyline::new(line.shape, MERGE_M));
    let path = paths.reduce(|best, next| if next.length() > best.length() { next } else { best });
    let Some(path) = path else {
        let help = "name two points or more, apart from each other";
        return Err(document.error(&table.name, "the flight's path has no length").with_help(help));
    };
    let step = path.length() / VERTICES as f64;
    let path = smoothed(&path, step, table.height * ROUNDED, VERTICES);
    let ground: Vec<f64> = path
        .points()
        .iter()
        .map(|&at| f64::from(frame.ground_at(lattice, at).map_or(f32::NEG_INFINITY, |ground| ground.z)))
        .collect();
    if ground.iter().all(|height| height.is_infinite()) {
        let message = "the flight's path is nowhere above the elevation model";
        return Err(document.error(&table.name, message).with_help("move it, or state its `crs`"));
    }
    let around = (table.height * CLEARED / (path.length() / ground.len() as f64)).ceil() as usize;
    let cleared: Vec<f64> = (0..ground.len())
        .map(|index| {
            let near = &ground[index.saturating_sub(around)..(index + around + 1).min(ground.len())];
            near.iter().copied().fold(f64::NEG_INFINITY, f64::max)
        })
        .collect();
    // Beside the model the eye stays as high as where it leaves it.
    let stations = path.stations().to_vec();
    let eye_z: Vec<f64> = filled(cleared).into_iter().map(|ground_z| ground_z + table.height).collect();
    let Some(profile) = Profile::new(stations.clone(), eye_z) else {
        return Err(document.error(&table.name, "the flight's path has no length"));
    };
    let eased = profile.smoothed(table.height * EASED);
    // Easing must not lead into the ground.
    let least = |(&eased, &ground): (&f64, &f64)| eased.max(ground + table.height * 0.5);
    let eye_z =
        Profile::new(stations, eased.values().iter().zip(&ground).map(least).collect()).unwrap_or(eased);
    let look_at = table
        .look_at
        .as_ref()
        .map(|at| frame.on_ground(lattice, at, frame.point(at, table.source.crs.as_ref())?));
    Ok(SceneFlight {
        name: table.name.to_string(),
        findings: findings.into_vec(),
        seconds: table.speed.map_or(SECONDS, |speed| path.length() / speed),
        eye_z,
        pitch_rad: table.pitch.to_radians(),
        ahead_m: table.height * AHEAD,
        look_at: look_at.transpose()?,
        fov_y_rad: table.field_of_view.to_radians() as f32,
        path,
    })
}

/// `values` with infinite ones replaced by the nearest finite one before them, or after where there is none.
fn filled(mut values: Vec<f64>) -> Vec<f64> {
    let first = values.iter().copied().find(|value| value.is_finite()).unwrap_or(0.0);
    let mut last = first;
    for value in &mut values {
        if value.is_finite() {
            last = *value;
        } else {
            *value = last;
        }
    }
    values
}

impl SceneFlight {
    /// The length of its path in meters.
    pub fn length_m(&self) -> f64 {
        self.path.length()
    }

    /// Fixes the direction of the light to that of a picture of `camera`, where the scene states none: light that follows
    /// the eye would turn the shadows.
    pub fn hold_light(scene: &mut SceneModel, camera: &Camera) {
        let to_sun = scene.sunlight.to_sun(Some(camera));
        scene.sunlight.azimuth_rad = Some(libm::atan2f(to_sun.x, to_sun.y));
    }

    /// The view after a share of the way, 0..=1.
    pub fn view(&self, share: f64) -> SceneView {
        let length = self.path.length();
        let station = share.clamp(0.0, 1.0) * length;
        let at = self.path.at(station);
        let eye = at.as_vec2().extend(self.eye_z.at(station) as f32);
        let target = self.look_at.unwrap_or_else(|| {
            let forward = self.forward(station, at);
            let (sin, cos) = (libm::sin(self.pitch_rad), libm::cos(self.pitch_rad));
            eye + (forward * cos).extend(-sin).as_vec3() * self.ahead_m as f32
        });
        SceneView {
            name: self.name.clone(),
            aim: ViewAim::At { eye, target },
            fov_y_rad: self.fov_y_rad,
            paper: None,
        }
    }

    /// Toward the path ahead; near its end, along it.
    fn forward(&self, station: f64, at: DVec2) -> DVec2 {
        let length = self.path.length();
        let ahead_m = self.ahead_m.min(length * 0.5);
        let from = station.min(length - ahead_m);
        let toward = self.path.at(from + ahead_m) - if from < station { self.path.at(from) } else { at };
        toward.normalize_or(DVec2::Y)
    }
}
