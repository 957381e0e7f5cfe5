//! The sun, by its direction or by date and time, and the exaggeration of heights.

use egui::{Key, Slider, TextEdit, Ui};
use glam::{DVec2, Vec3};

use sandtable_geom::crs::Crs;
use sandtable_geom::sun_position::{SunPosition, sun_position, unix_seconds};

/// The content of the panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightPanel {
    /// Clockwise from north, degrees.
    pub azimuth_deg: f32,
    /// Above the horizon, degrees.
    pub altitude_deg: f32,
    /// The date and time in the field.
    pub time: String,
    /// What is wrong with it.
    pub problem: Option<String>,
    /// How many times as high heights are drawn.
    pub exaggeration: f64,
}

/// A change in the panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightEvent {
    /// The sun moved; a unit vector toward it.
    Sun(Vec3),
    /// Heights are to be drawn this many times as high.
    Exaggeration(f64),
}

impl LightPanel {
    /// A panel for a sun in this direction.
    pub fn new(to_sun: Vec3, exaggeration: f64) -> Self {
        Self {
            azimuth_deg: libm::atan2f(to_sun.x, to_sun.y).to_degrees().rem_euclid(360.0),
            altitude_deg: libm::asinf(to_sun.z.clamp(-1.0, 1.0)).to_degrees(),
            exaggeration,
            ..Self::default()
        }
    }

    /// Unit vector toward the sun.
    pub fn to_sun(&self) -> Vec3 {
        let (azimuth, altitude) = (self.azimuth_deg.to_radians(), self.altitude_deg.to_radians());
        let level = libm::cosf(altitude);
        Vec3::new(libm::sinf(azimuth) * level, libm::cosf(azimuth) * level, libm::sinf(altitude))
    }

    /// Takes the sun of the date and time in the field, at longitude and latitude `place`.
    fn take_time(&mut self, place: Option<DVec2>) -> bool {
        let Some(place) = place else {
            self.problem = Some("the scene has no place on Earth".to_owned());
            return false;
        };
        let Some(seconds) = unix_seconds(self.time.trim()) else {
            self.problem = Some("write it as 2026-06-21T09:30:00+02:00, or ending in Z for UTC".to_owned());
            return false;
        };
        let SunPosition { azimuth_rad, altitude_rad } = sun_position(seconds, place);
        if altitude_rad <= 0.0 {
            self.problem =
                Some(format!("the sun is {:.0}° below the horizon then", -altitude_rad.to_degrees()));
            return false;
        }
        self.azimuth_deg = (azimuth_rad.to_degrees() as f32).rem_euclid(360.0);
        self.altitude_deg = altitude_rad.to_degrees() as f32;
        self.problem = None;
        true
    }
}

/// Draws the sun's direction and the exaggeration. `middle` is the middle of the scene in coordinates of `crs`.
pub fn light_panel(ui: &mut Ui, panel: &mut LightPanel, crs: &Crs, middle: DVec2) -> Option<LightEvent> {
    let mut event = None;
    ui.horizontal(|ui| {
        let label = ui.label("Azimuth");
        let slider = ui.add(Slider::new(&mut panel.azimuth_deg, 0.0..=360.0).suffix("°").fixed_decimals(0));
        let slider = slider.labelled_by(label.id);
        if slider.drag_stopped() || (slider.changed() && !slider.dragged()) {
            event = Some(LightEvent::Sun(panel.to_sun()));
        }
    });
    ui.horizontal(|ui| {
        let label = ui.label("Altitude");
        let slider = ui.add(Slider::new(&mut panel.altitude_deg, 1.0..=90.0).suffix("°").fixed_decimals(0));
        let slider = slider.labelled_by(label.id);
        if slider.drag_stopped() || (slider.changed() && !slider.dragged()) {
            event = Some(LightEvent::Sun(panel.to_sun()));
        }
    });
    ui.horizontal(|ui| {
        let label = ui.label("Time");
        let field =
            TextEdit::singleline(&mut panel.time).hint_text("2026-06-21T09:30:00Z").desired_width(170.0);
        let field = ui.add(field).labelled_by(label.id);
        let is_entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if ui.button("Set sun").clicked() || is_entered {
            let place = crs.transform(&Crs::wgs84(), middle).ok();
            if panel.take_time(place) {
                event = Some(LightEvent::Sun(panel.to_sun()));
            }
        }
    });
    if let Some(problem) = &panel.problem {
        ui.colored_label(ui.visuals().error_fg_color, problem);
    }
    ui.horizontal(|ui| {
        let label = ui.label("Heights ×");
        let slider = Slider::new(&mut panel.exaggeration, 0.5..=10.0).fixed_decimals(1);
        let slider =
            ui.add(slider).labelled_by(label.id).on_hover_text("How many times as high heights are drawn");
        if slider.drag_stopped() || (slider.changed() && !slider.dragged()) {
            event = Some(LightEvent::Exaggeration(panel.exaggeration));
        }
    });
    event
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    fn at_noon(time: &str) -> (LightPanel, Option<LightEvent>) {
        let panel = LightPanel { time: time.to_owned(), ..LightPanel::new(Vec3::Z, 1.0) };
        let draw = |ui: &mut Ui, state: &mut (LightPanel, Option<LightEvent>)| {
            let event = light_panel(ui, &mut state.0, &Crs::wgs84(), DVec2::new(15.0, 48.0));
            state.1 = event.or(state.1);
        };
        let mut harness = Harness::new_ui_state(draw, (panel, None));
        harness.get_by_label("Set sun").click();
        harness.run();
        harness.into_state()
    }

    #[test]
    fn the_sun_of_a_summer_noon_stands_high_in_the_south() {
        let (panel, event) = at_noon("2026-06-21T11:00:00Z");
        assert!((panel.azimuth_deg - 180.0).abs() < 3.0, "{panel:?}");
        assert!((panel.altitude_deg - 65.4).abs() < 0.5, "{panel:?}");
        assert_eq!(event, Some(LightEvent::Sun(panel.to_sun())));
        assert_eq!(LightPanel::new(panel.to_sun(), 1.0).azimuth_deg.round(), panel.azimuth_deg.round());
    }

    #[test]
    fn a_night_and_a_text_that_is_no_time_leave_the_sun() {
        for (time, problem) in [("2026-06-21T23:00:00Z", "below the horizon"), ("noon", "write it as")] {
            let (panel, event) = at_noon(time);
            assert_eq!(event, None);
            assert!(panel.problem.is_some_and(|text| text.contains(problem)));
        }
    }
}
