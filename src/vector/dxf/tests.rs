//! Drawings in pairs of a code and a value.

use super::*;
use crate::feature::Feature;
use glam::DVec2;
use sandtable_geom::crs::Crs;

/// A drawing in text: pairs of a code and a value, one a word, between a head with layers and a block, and an end.
fn drawing(entities: &str) -> String {
    let head = "0 SECTION 2 HEADER 9 $ACADVER 1 AC1027 9 $INSUNITS 70 6 0 ENDSEC \
        0 SECTION 2 TABLES 0 TABLE 2 LAYER 0 LAYER 2 ROADS 70 0 62 1 0 LAYER 2 OLD 70 1 62 3 0 LAYER 2 OFF 70 0 62 -4 0 ENDTAB 0 ENDSEC \
        0 SECTION 2 BLOCKS 0 BLOCK 2 TREE 10 1 20 1 0 LINE 8 0 62 0 10 1 20 1 11 2 21 1 0 POINT 8 MARKS 10 1 20 2 0 ENDBLK 0 ENDSEC";
    lines(&format!("{head} 0 SECTION 2 ENTITIES {entities} 0 ENDSEC 0 EOF"))
}

fn lines(words: &str) -> String {
    words.split_whitespace().map(|word| word.replace('_', " ") + "\r\n").collect()
}

fn read_text(text: &str, layer: Option<&str>) -> Result<VectorLayer, VectorError> {
    let crs = Crs::from_epsg(32_616).expect("known");
    crate::read::read(
        "a.dxf",
        text.as_bytes(),
        &VectorHints { crs: Some(&crs), layer, ..VectorHints::default() },
    )
}

fn features(entities: &str) -> Vec<Feature> {
    read_text(&drawing(entities), None).expect("a drawing").features
}

#[test]
fn entities_have_their_layer_color_and_handle() {
    let all = features(
        "0 LINE 8 ROADS 5 1F 10 1 20 2 11 3 21 4 0 LINE 8 ROADS 62 5 10 1 20 2 11 3 21 4 \
         0 LINE 8 ROADS 420 1193046 10 1 20 2 11 3 21 4",
    );
    let stroke: Vec<_> =
        all.iter().map(|feature| feature.properties["stroke"].as_str().expect("text")).collect();
    assert_eq!(stroke, ["#ff0000", "#0000ff", "#123456"]);
    assert_eq!((&all[0].properties["Layer"], &all[0].properties["handle"]), (&"ROADS".into(), &"1F".into()));
    assert_eq!(all[0].lines()[0], [DVec2::new(1.0, 2.0), DVec2::new(3.0, 4.0)]);
    assert!(all[0].elevations.is_none(), "a drawing in the plane");
}

#[test]
fn curves_are_chords_that_begin_and_end_where_they_should() {
    let all = features(
        "0 LWPOLYLINE 8 0 90 2 70 1 38 7 10 0 20 0 42 1 10 10 20 0 42 1 0 ARC 8 0 10 0 20 0 40 5 50 270 51 0 \
         0 CIRCLE 8 0 10 0 20 0 40 5 0 ELLIPSE 8 0 10 0 20 0 11 4 21 0 40 0.5 41 0 42 6.283185307179586 \
         0 POLYLINE 8 0 70 8 0 VERTEX 8 0 10 0 20 0 30 1 0 VERTEX 8 0 10 1 20 0 30 2 0 SEQEND",
    );
    let line = |index: usize| &all[index].lines()[0];
    assert_eq!(line(0).first(), line(0).last(), "closed");
    assert!(
        line(0).iter().all(|at| (at.distance(DVec2::new(5.0, 0.0)) - 5.0).abs() < 1e-9),
        "two half circles"
    );
    assert_eq!(all[0].elevations.as_ref().expect("elevated")[3], 7.0);
    let (first, last) = (line(1)[0], line(1)[line(1).len() - 1]);
    assert!(first.distance(DVec2::new(0.0, -5.0)) < 1e-9 && last.distance(DVec2::new(5.0, 0.0)) < 1e-9);
    assert_eq!((line(2).len(), line(2).first()), (361, line(2).last()));
    assert!(line(3).iter().any(|at| at.distance(DVec2::new(0.0, 2.0)) < 1e-9), "{:?}", line(3));
    assert_eq!(all[4].elevations.as_deref(), Some(&[1.0, 2.0][..]));
}

#[test]
fn blocks_are_drawn_where_they_are_inserted_turned_scaled_and_in_rows() {
    let all = features(
        "0 INSERT 8 ROADS 2 TREE 66 1 10 100 20 50 41 2 42 2 43 2 50 90 0 ATTRIB 8 0 2 SPECIES 1 oak 10 0 20 0 0 SEQEND \
         0 INSERT 8 0 2 TREE 10 0 20 0 70 3 71 2 44 10 45 20",
    );
    let [place, line, mark, ..] = &all[..] else { panic!("{all:?}") };
    assert_eq!(place.points(), [DVec2::new(100.0, 50.0)]);
    assert_eq!((&place.properties["SPECIES"], &place.properties["block"]), (&"oak".into(), &"TREE".into()));
    assert!(line.lines()[0][1].distance(DVec2::new(100.0, 52.0)) < 1e-9, "{line:?}");
    assert_eq!((&line.properties["Layer"], &line.properties["stroke"]), (&"ROADS".into(), &"#ff0000".into()));
    assert!(mark.points()[0].distance(DVec2::new(98.0, 50.0)) < 1e-9, "{mark:?}");
    assert_eq!(mark.properties["Layer"], "MARKS");
    let marks: Vec<DVec2> = all[3..].iter().flat_map(|feature| feature.points().to_vec()).collect();
    assert_eq!(marks.len(), 12, "the place and the mark of each");
    assert!(marks.contains(&DVec2::new(20.0, 20.0)) && marks.contains(&DVec2::new(20.0, 21.0)), "{marks:?}");
}

#[test]
fn faces_meshes_and_hatches_are_polygons() {
    let all = features(
        "0 3DFACE 8 0 10 0 20 0 30 1 11 4 21 0 31 2 12 4 22 4 32 3 13 4 23 4 33 3 \
         0 SOLID 8 0 10 0 20 0 11 4 21 0 12 0 22 4 13 4 23 4 \
         0 POLYLINE 8 0 70 64 71 3 72 1 0 VERTEX 70 192 10 0 20 0 30 5 0 VERTEX 70 192 10 1 20 0 30 5 0 VERTEX 70 192 10 0 20 1 30 6 \
         0 VERTEX 70 128 10 0 20 0 30 0 71 1 72 -2 73 3 0 SEQEND \
         0 POLYLINE 8 0 70 16 71 2 72 2 0 VERTEX 10 0 20 0 30 1 0 VERTEX 10 1 20 0 30 1 0 VERTEX 10 0 20 1 30 1 0 VERTEX 10 1 20 1 30 1 0 SEQEND \
         0 HATCH 8 0 10 0 20 0 30 0 2 SOLID 70 1 91 2 92 3 72 0 73 1 93 4 10 0 20 0 10 9 20 0 10 9 20 9 10 0 20 9 97 0 \
         92 0 93 2 72 2 10 5 20 5 40 2 50 0 51 180 73 1 72 1 10 3 20 5 11 7 21 5 97 0 75 0 76 1",
    );
    assert_eq!(all.len(), 5);
    assert_eq!(
        (all[0].polygons()[0].exterior.len(), all[0].elevations.as_deref()),
        (3, Some(&[1.0, 2.0, 3.0][..]))
    );
    assert_eq!(all[1].polygons()[0].exterior[2], DVec2::new(4.0, 4.0), "corners of solids cross");
    assert_eq!(all[2].elevations.as_deref(), Some(&[5.0, 5.0, 6.0][..]));
    assert_eq!(all[3].polygons()[0].exterior.len(), 4);
    let hatch = &all[4].polygons();
    assert_eq!((hatch.len(), hatch[0].exterior.len(), hatch[0].holes.len()), (1, 4, 1), "{hatch:?}");
}

#[test]
fn planes_that_face_down_mirror_their_entities() {
    let all = features(
        "0 CIRCLE 8 0 10 5 20 3 40 1 210 0 220 0 230 -1 0 TEXT 8 0 10 5 20 3 1 a%%d_b 210 0 220 0 230 -1",
    );
    let center = all[0].lines()[0][..360].iter().sum::<DVec2>() / 360.0;
    assert!(center.distance(DVec2::new(-5.0, 3.0)) < 1e-9, "{center}");
    assert_eq!((all[1].points()[0], &all[1].properties["text"]), (DVec2::new(-5.0, 3.0), &"a° b".into()));
}

#[test]
fn layers_that_are_off_are_left_out_unless_named_and_paper_always() {
    let text = drawing(
        "0 POINT 8 OLD 10 1 20 1 0 POINT 8 OFF 10 2 20 2 0 POINT 8 ROADS 10 3 20 3 0 POINT 8 ROADS 67 1 10 4 20 4 0 3DSOLID 8 ROADS",
    );
    let all = read_text(&text, None).expect("a drawing");
    assert_eq!(all.features.len(), 1);
    for told in ["2 entities on layers that are off", "1 entity on paper", "1 3DSOLID"] {
        assert!(all.notes.iter().any(|note| note.contains(told)), "{told}: {:?}", all.notes);
    }
    assert_eq!(read_text(&text, Some("OLD")).expect("named").features[0].points(), [DVec2::ONE]);
    let error = read_text(&text, Some("ROAD")).expect_err("no such layer").to_string();
    assert!(error.contains("did you mean 'ROADS'"), "{error}");
}

#[test]
fn a_drawing_needs_a_system_and_tells_its_unit() {
    let text = drawing("0 POINT 8 0 10 1 20 1").replace("$INSUNITS\r\n70\r\n6", "$INSUNITS\r\n70\r\n4");
    let error = crate::read::read("a.dxf", text.as_bytes(), &VectorHints::default()).expect_err("no system");
    assert!(error.to_string().contains("the key 'crs'"), "{error}");
    let notes = read_text(&text, None).expect("a drawing").notes;
    assert!(notes[0].contains("millimeters") && notes[0].contains("+to_meter=0.001"), "{notes:?}");
}

/// The groups of a text drawing in binary.
fn binary(text: &str) -> Vec<u8> {
    let mut bytes = b"AutoCAD Binary DXF\r\n\x1a\0".to_vec();
    let mut words = text.lines();
    while let (Some(code), Some(value)) = (words.next(), words.next()) {
        let code: i16 = code.parse().expect("a code");
        bytes.extend(code.to_le_bytes());
        match code {
            10..=59 | 210..=239 => bytes.extend(value.parse::<f64>().expect("a real").to_le_bytes()),
            60..=79 => bytes.extend(value.parse::<i16>().expect("whole").to_le_bytes()),
            90..=99 | 420..=429 => bytes.extend(value.parse::<i32>().expect("whole").to_le_bytes()),
            _ => bytes.extend([value.as_bytes(), b"\0"].concat()),
        }
    }
    bytes
}

#[test]
fn binary_drawings_are_read_as_those_in_text() {
    let text =
        drawing("0 LWPOLYLINE 8 ROADS 90 2 70 1 10 0 20 0 42 1 10 10 20 0 0 INSERT 8 0 2 TREE 10 7 20 7");
    let crs = Crs::from_epsg(32_616).expect("known");
    let hints = VectorHints { crs: Some(&crs), ..VectorHints::default() };
    let from_binary = crate::read::read("a.dxf", &binary(&text), &hints).expect("a drawing");
    assert_eq!(from_binary.features, read_text(&text, None).expect("a drawing").features);
    let whole = binary(&text);
    for length in 0..whole.len() {
        let _ = crate::read::read("a.dxf", &whole[..length], &hints);
    }
}

#[test]
fn blocks_that_hold_themselves_or_multiply_end() {
    let nested: String = (0..12)
        .map(|level| {
            let inner = level + 1;
            format!(
                "0 BLOCK 2 B{level} 10 0 20 0 {} 0 ENDBLK ",
                format!("0 INSERT 8 0 2 B{inner} 10 1 20 1 ").repeat(10)
            )
        })
        .collect();
    let bomb = lines(&format!(
        "0 SECTION 2 BLOCKS {nested} 0 BLOCK 2 SELF 10 0 20 0 0 INSERT 2 SELF 10 1 20 1 0 ENDBLK 0 ENDSEC 0 SECTION 2 ENTITIES 0 INSERT 2 SELF 10 0 20 0 0 ENDSEC 0 EOF"
    ));
    let ended = read_text(&bomb, None).expect("ends");
    assert!(ended.notes.iter().any(|note| note.contains("16 deep")), "{:?}", ended.notes);
    let error = read_text(
        &bomb.replace(
            "2\r\nSELF\r\n10\r\n0\r\n20\r\n0\r\n0\r\nENDSEC",
            "2\r\nB0\r\n10\r\n0\r\n20\r\n0\r\n0\r\nENDSEC",
        ),
        None,
    );
    assert!(error.expect_err("multiplies").to_string().contains("vertices with those of its blocks"));
}

#[test]
fn what_is_cut_short_is_read_as_far_as_it_goes_and_told() {
    let text = drawing("0 POINT 8 0 10 1 20 1 0 POINT 8 0 10 2 20 2");
    let cut = &text[..text.len() - 20];
    let read = read_text(cut, None).expect("two points");
    assert_eq!(read.features.len(), 2);
    assert!(read.faults[0].contains("not read to its end"), "{:?}", read.faults);
    let error = read_text("0\nSECTION\n2\nENTITIES\nxy\nLINE\n", None).expect_err("broken").to_string();
    assert!(error.contains("'xy' is no code"), "{error}");
}

#[test]
fn an_entity_of_too_many_groups_ends_the_file() {
    let text = format!(
        "0\nSECTION\n2\nENTITIES\n0\nPOINT\n10\n1\n20\n1\n0\nLINE\n10\n0\n20\n0\n11\n1\n21\n1\n{}",
        "40\n0\n".repeat(1 << 22)
    );
    let read = read_text(&text, None).expect("what precedes it");
    assert_eq!(read.features.len(), 2);
    assert!(read.faults[0].contains("more than 4194304 groups"), "{:?}", read.faults);
}
