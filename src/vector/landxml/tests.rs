//! LandXML by its published structure.

use super::*;
use crate::read;

/// A road of a line, a clothoid, an arc, a clothoid and a line: R 200, L 60, 40 gon or so, then a profile over it.
fn road(units: &str, body: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\" version=\"1.2\">\n\
         <Units>{units}</Units>\n<CoordinateSystem epsgCode=\"32616\"/>\n{body}\n</LandXML>"
    )
}

const METRIC: &str = "<Metric linearUnit=\"meter\" elevationUnit=\"meter\"/>";

fn layer(text: &str, layer: Option<&str>) -> Result<VectorLayer, VectorError> {
    read::read("a.xml", text.as_bytes(), &VectorHints { layer, ..VectorHints::default() })
}

#[test]
fn lines_and_arcs_have_their_length_and_points_are_northing_before_easting() {
    let quarter = "<Alignments><Alignment name=\"A\" length=\"257.08\" staStart=\"1000\"><CoordGeom>\
        <Line><Start>4000000 500000</Start><End>4000100 500000</End></Line>\
        <Curve rot=\"cw\" radius=\"100\"><Start>4000100 500000</Start><Center>4000100 500100</Center>\
        <End>4000200 500100</End></Curve></CoordGeom></Alignment></Alignments>";
    let layer = layer(&road(METRIC, quarter), None).expect("an alignment");
    let [alignment] = &layer.features[..] else { panic!("{layer:?}") };
    let line = &alignment.lines()[0];
    assert_eq!((line[0], line[1]), (DVec2::new(500_000.0, 4_000_000.0), DVec2::new(500_000.0, 4_000_100.0)));
    assert_eq!(line.last(), Some(&DVec2::new(500_100.0, 4_000_200.0)));
    let center = DVec2::new(500_100.0, 4_000_100.0);
    for pair in line[1..].windows(2) {
        let sagitta = 100.0 - ((pair[0] + pair[1]) / 2.0).distance(center);
        assert!((0.0..0.0101).contains(&sagitta), "{sagitta}");
    }
    let length = alignment.properties["length"].as_f64().expect("a number");
    assert!((length - (100.0 + 50.0 * std::f64::consts::PI)).abs() < 1e-3, "{length}");
    assert_eq!(alignment.properties["station_start"], 1000.0);
    assert!(alignment.elevations.is_none());
    assert!(layer.notes.is_empty() && layer.faults.is_empty(), "{layer:?}");
}

/// The end of a clothoid from a straight to a radius, by its series (Fresnel): along the tangent and aside.
fn clothoid_end(length: f64, radius: f64) -> DVec2 {
    let t = length / (2.0 * radius);
    let x = length * (1.0 - t.powi(2) / 10.0 + t.powi(4) / 216.0 - t.powi(6) / 9360.0);
    let y = length * (t / 3.0 - t.powi(3) / 42.0 + t.powi(5) / 1320.0);
    DVec2::new(x, y)
}

#[test]
fn a_clothoid_ends_where_its_series_does() {
    let (length, radius) = (60.0, 200.0);
    let end = clothoid_end(length, radius);
    let turned = length / (2.0 * radius);
    let pi = end.x - end.y / turned.tan();
    let (e, n) = (500_000.0, 4_000_000.0);
    let spiral = format!(
        "<Alignments><Alignment name=\"S\" staStart=\"0\"><CoordGeom><Spiral rot=\"ccw\" spiType=\"clothoid\" length=\"{length}\" \
         radiusStart=\"INF\" radiusEnd=\"{radius}\"><Start>{n} {e}</Start><PI>{n} {}</PI><End>{} {}</End></Spiral>\
         </CoordGeom></Alignment></Alignments>",
        e + pi,
        n + end.y,
        e + end.x
    );
    let layer = layer(&road(METRIC, &spiral), None).expect("an alignment");
    assert!(layer.notes.is_empty(), "it is not bent: {:?}", layer.notes);
    let line = &layer.features[0].lines()[0];
    let half = line[line.len() / 2] - DVec2::new(e, n);
    let share = (line.len() / 2) as f64 / (line.len() - 1) as f64;
    // Half way it has the radius over the share.
    let expected = clothoid_end(length * share, radius / share);
    assert!(half.distance(expected) < 1e-6, "{half} {expected}");
}

#[test]
fn a_profile_gives_elevations_with_its_curves() {
    let body = "<Alignments><Alignment name=\"A\" staStart=\"100\"><CoordGeom>\
        <Line><Start>4000000 500000</Start><End>4000000 500400</End></Line></CoordGeom>\
        <Profile><ProfAlign name=\"FG\"><PVI>100 50</PVI><ParaCurve length=\"100\">300 60</ParaCurve>\
        <PVI>500 50</PVI></ProfAlign></Profile></Alignment></Alignments>";
    let layer = layer(&road(METRIC, body), None).expect("an alignment");
    let alignment = &layer.features[0];
    assert_eq!(alignment.properties["profile"], "FG");
    let elevations = alignment.elevations.as_ref().expect("a profile");
    let at = |easting: f64| {
        let nearest = alignment.lines()[0].iter().zip(elevations);
        let nearest = nearest.min_by(|a, b| (a.0.x - easting).abs().total_cmp(&(b.0.x - easting).abs()));
        *nearest.expect("vertices").1
    };
    assert_eq!((at(500_000.0), at(500_400.0)), (50.0, 50.0));
    assert!((at(500_150.0) - 57.5).abs() < 1e-9, "where the curve begins");
    // L·(g2 − g1)/8 below the point of intersection.
    assert!((at(500_200.0) - (60.0 - 100.0 * 0.1 / 8.0)).abs() < 1e-9);
}

#[test]
fn a_circular_curve_and_an_unsymmetrical_one_touch_their_tangents() {
    for curve in [
        "<CircCurve length=\"100\" radius=\"1000\">300 60</CircCurve>",
        "<UnsymParaCurve lengthIn=\"40\" lengthOut=\"80\">300 60</UnsymParaCurve>",
    ] {
        let text = format!("<ProfAlign><PVI>100 50</PVI>{curve}<PVI>500 50</PVI></ProfAlign>");
        let mut xml = XmlReader::new(&text, FORMAT);
        let root = xml.root().expect("an element");
        let profile =
            vertical::elevations(&xml.read(root).expect("read")).expect("sound").expect("two points");
        let grades: Vec<f64> = profile
            .stations()
            .windows(2)
            .zip(profile.values().windows(2))
            .map(|(at, level)| (level[1] - level[0]) / (at[1] - at[0]))
            .collect();
        assert!((grades[0] - 0.05).abs() < 1e-9 && (grades[grades.len() - 1] + 0.05).abs() < 1e-9);
        assert!(grades.windows(2).all(|pair| pair[1] <= pair[0] + 1e-9), "it never turns back: {grades:?}");
        assert!(grades.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.01), "no kink: {grades:?}");
    }
}

#[test]
fn us_survey_feet_become_meters_of_the_system() {
    let feet = "<Imperial linearUnit=\"USSurveyFoot\" elevationUnit=\"feet\"/>";
    let body = "<CgPoints><CgPoint name=\"1\" code=\"CP\">13123333.333 1640416.667 1000</CgPoint></CgPoints>";
    let layer = layer(&road(feet, body), None).expect("a point");
    let point = &layer.features[0];
    assert!(point.points()[0].distance(DVec2::new(500_000.0, 4_000_000.0)) < 0.01, "{point:?}");
    let elevation = point.elevations.as_ref().expect("an elevation")[0];
    assert!((elevation - 1000.0 * 1200.0 / 3937.0).abs() < 1e-9, "{elevation}");
    assert_eq!((&point.properties["name"], &point.properties["code"]), (&"1".into(), &"CP".into()));
}

#[test]
fn stations_are_points_with_their_text_and_follow_equations() {
    let body = "<Alignments><Alignment name=\"A\" staStart=\"1950\"><CoordGeom>\
        <Line><Start>4000000 500000</Start><End>4000000 500320</End></Line></CoordGeom>\
        <StaEquation staAhead=\"5000\" staBack=\"2100\" staInternal=\"2100\"/></Alignment></Alignments>";
    let layer = layer(&road(METRIC, body), Some("stations")).expect("stations");
    let texts: Vec<_> =
        layer.features.iter().map(|at| at.properties["station"].as_str().expect("text")).collect();
    assert_eq!(texts, ["1+950", "2+000", "5+000", "5+100", "5+170"]);
    assert_eq!(layer.features[1].points()[0], DVec2::new(500_050.0, 4_000_000.0));
    assert_eq!(layer.features[1].properties["azimuth"], 90.0);
}

#[test]
fn points_are_found_by_name_and_what_is_missing_is_told() {
    let body = |reference: &str| {
        format!(
            "<Alignments><Alignment name=\"A\"><CoordGeom><Line><Start pntRef=\"1\"/><End pntRef=\"{reference}\"/></Line>\
             </CoordGeom></Alignment></Alignments><CgPoints><CgPoint name=\"1\">0 0</CgPoint>\
             <CgPoint name=\"2\">0 50</CgPoint></CgPoints>"
        )
    };
    let found = layer(&road(METRIC, &body("2")), None).expect("both points are there");
    assert_eq!(found.features[0].lines()[0], [DVec2::ZERO, DVec2::X * 50.0]);
    assert!(found.notes[0].contains("2 in 'points'"), "{:?}", found.notes);
    let error = layer(&road(METRIC, &body("7")), None).expect_err("no point 7").to_string();
    assert!(error.contains("line 5") && error.contains("'7'"), "{error}");
    let no_system = road(METRIC, &body("2")).replace("epsgCode", "code");
    assert!(layer(&no_system, None).expect_err("no system").to_string().contains("'crs'"));
    let surface = road(METRIC, "<Surfaces><Surface name=\"EG\"/></Surfaces>");
    assert!(layer(&surface, None).expect_err("a surface").to_string().contains("`dem`"));
}
