//! Whatever a reader leaves out reaches the findings: each format with odd records among sound ones, the sound ones built
//! and the odd ones counted, with their places.

use glam::DVec2;
use sandtable_base::archive::zip;
use sandtable_description::finding_code::FindingCode;
use sandtable_scene::feature::FeatureKind;

use crate::level_ground::{CORNER, Read, degrees, written};

fn roads(file: &str) -> String {
    format!("[[road]]\nfile = \"{file}\"\n")
}

fn geojson_line(at: f64) -> String {
    let (from, to) = (degrees(50.0, at), degrees(350.0, at));
    let line = format!("[[{}],[{}]]", written(from, ","), written(to, ","));
    format!(
        r#"{{"type":"Feature","properties":{{}},"geometry":{{"type":"LineString","coordinates":{line}}}}}"#
    )
}

#[test]
fn geojson_with_an_odd_feature() {
    let collection = |odd: &str| {
        let (first, second) = (geojson_line(100.0), geojson_line(200.0));
        format!(r#"{{"type":"FeatureCollection","features":[{first},{odd},{second}]}}"#)
    };
    let odd = r#"{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[["a",1],[2,3]]}}"#;
    Read::new(&roads("a.geojson"), "a.geojson", collection(odd)).reports(
        2,
        FindingCode::RecordsBroken,
        &["'a.geojson': left out: 1 record", "feature 2: a coordinate is \"a\""],
    );
    let empty = r#"{"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[]}}"#;
    Read::new(&roads("a.geojson"), "a.geojson", collection(empty)).reports(
        2,
        FindingCode::VectorRead,
        &["left out: 1 feature without a usable geometry (feature 2)"],
    );
    let far = r#"{"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[15,95]}}"#;
    Read::new(&roads("a.geojson"), "a.geojson", collection(far)).reports(
        2,
        FindingCode::RecordsBroken,
        &["feature 2: a vertex at (15, 95)"],
    );
    let sequence = format!("{}\n{{\"type\":\"Feature\",\n{}\n", geojson_line(100.0), geojson_line(200.0));
    Read::new(&roads("a.geojsonl"), "a.geojsonl", sequence).reports(
        2,
        FindingCode::RecordsBroken,
        &["left out: 1 record", "line 2"],
    );
}

#[test]
fn kml_and_kmz_with_an_odd_placemark() {
    let place = |coordinates: &str| {
        format!("<Placemark><LineString><coordinates>{coordinates}</coordinates></LineString></Placemark>\n")
    };
    let line =
        |at: f64| place(&format!("{} {}", written(degrees(50.0, at), ","), written(degrees(350.0, at), ",")));
    let kml =
        format!("<kml>\n<Document>{}{}{}</Document></kml>", line(100.0), place("15,x 16,3"), line(200.0));
    let parts = ["left out: 1 record", "line 3: '15,x'"];
    Read::new(&roads("a.kml"), "a.kml", &kml).reports(2, FindingCode::RecordsBroken, &parts);
    let kmz = zip(&[("doc.kml", kml.as_bytes())]).expect("memory");
    Read::new(&roads("a.kmz"), "a.kmz", kmz).reports(2, FindingCode::RecordsBroken, &parts);
    let track = format!(
        "<kml xmlns:gx='x'><Placemark><gx:Track><gx:coord>{} 1</gx:coord><gx:coord/><gx:coord></gx:coord><gx:coord>{} \
         2</gx:coord></gx:Track></Placemark></kml>",
        written(degrees(50.0, 100.0), " "),
        written(degrees(350.0, 100.0), " ")
    );
    Read::new(&roads("a.kml"), "a.kml", track).reports(
        1,
        FindingCode::VectorRead,
        &["left out: 2 moments of tracks without a position"],
    );
}

#[test]
fn gpx_with_an_odd_point() {
    let point = |at: DVec2| format!("<trkpt lon='{:.8}' lat='{:.8}'/>\n", at.x, at.y);
    let gpx = format!(
        "<gpx><trk><trkseg>\n{}<trkpt lon='15'/>\n{}</trkseg></trk></gpx>",
        point(degrees(50.0, 100.0)),
        point(degrees(350.0, 100.0))
    );
    Read::new(&roads("a.gpx"), "a.gpx", gpx).reports(
        1,
        FindingCode::RecordsBroken,
        &["left out: 1 record", "line 3: a point has no latitude"],
    );
}

/// A shapefile of records with this content.
fn shapefile(contents: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = 9994u32.to_be_bytes().to_vec();
    bytes.resize(100, 0);
    for (index, content) in contents.iter().enumerate() {
        bytes.extend((index as u32 + 1).to_be_bytes());
        bytes.extend((content.len() as u32 / 2).to_be_bytes());
        bytes.extend(content);
    }
    bytes
}

/// A line or area of parts, in meters from the corner.
fn shape(kind: u32, parts: &[&[[f64; 2]]]) -> Vec<u8> {
    let count: usize = parts.iter().map(|part| part.len()).sum();
    let mut bytes = kind.to_le_bytes().to_vec();
    bytes.extend([0; 32]);
    bytes.extend([parts.len() as u32, count as u32].map(u32::to_le_bytes).concat());
    let mut first = 0u32;
    for part in parts {
        bytes.extend(first.to_le_bytes());
        first += part.len() as u32;
    }
    for [x, y] in parts.iter().flat_map(|part| part.iter()) {
        bytes.extend([CORNER.x + x, CORNER.y + y].map(f64::to_le_bytes).concat());
    }
    bytes
}

#[test]
fn a_shapefile_with_an_odd_record_and_rings_that_run_the_wrong_way() {
    let line = |at: f64| shape(3, &[&[[50.0, at], [350.0, at]]]);
    let mut forged = line(150.0);
    forged[40..44].copy_from_slice(&9000u32.to_le_bytes());
    let file = shapefile(&[line(100.0), forged, line(200.0), 0u32.to_le_bytes().to_vec()]);
    let table = roads("a.shp") + "crs = \"EPSG:32633\"\n";
    let read = Read::new(&table, "a.shp", file);
    read.reports(2, FindingCode::RecordsBroken, &["left out: 1 record", "record 2: its counts of parts"]);
    let notes = read.messages(FindingCode::VectorRead);
    assert_eq!(notes, ["'a.shp': left out: 1 feature without a usable geometry (record 4)"]);

    let outer = [[100.0, 100.0], [160.0, 100.0], [160.0, 160.0], [100.0, 160.0], [100.0, 100.0]];
    let yard = [[120.0, 120.0], [120.0, 140.0], [140.0, 140.0], [140.0, 120.0], [120.0, 120.0]];
    let table = "[[building]]\nfile = \"b.shp\"\ncrs = \"EPSG:32633\"\nheight = 10\n";
    let read = Read::new(table, "b.shp", shapefile(&[shape(5, &[&outer, &yard])]));
    assert_eq!(read.built(FeatureKind::Building), 1, "one with a courtyard, not two");
    assert_eq!(
        read.messages(FindingCode::VectorRead),
        ["'b.shp': rings of 1 polygon (record 1) run the wrong way: one that lies in another is its hole"]
    );
}

/// An extract with nodes by their number, places, and the rest as text.
fn extract(nodes: &[(u32, f64, f64)], rest: &str) -> String {
    let node = |&(id, x, y): &(u32, f64, f64)| {
        let at = degrees(x, y);
        format!("<node id='{id}' lon='{:.8}' lat='{:.8}'/>", at.x, at.y)
    };
    format!("<osm>{}\n{rest}</osm>", nodes.iter().map(node).collect::<String>())
}

fn way(id: u32, nodes: &[u32], tags: &[(&str, &str)]) -> String {
    let nodes: String = nodes.iter().map(|node| format!("<nd ref='{node}'/>")).collect();
    let tags: String = tags.iter().map(|(key, value)| format!("<tag k='{key}' v='{value}'/>")).collect();
    format!("<way id='{id}'>{nodes}{tags}</way>\n")
}

#[test]
fn openstreetmap_with_an_odd_node_a_gap_and_an_open_relation() {
    let nodes = [(1, 50.0, 50.0), (2, 150.0, 50.0), (3, 250.0, 50.0), (4, 350.0, 50.0), (5, 350.0, 90.0)];
    let road = [("highway", "residential"), ("name", "Gap Road")];
    let odd = "<node id='9' lon='x' lat='1'/>\n";
    let table = roads("a.osm") + "layer = \"roads\"\n";
    let read =
        Read::new(&table, "a.osm", extract(&nodes, &(odd.to_owned() + &way(1, &[1, 2, 77, 3, 4], &road))));
    read.reports(2, FindingCode::RecordsBroken, &["left out: 1 record", "line 2: a node has no latitude"]);
    let notes = read.messages(FindingCode::VectorRead);
    let [note] = &notes[..] else { panic!("one sentence: {notes:?}") };
    assert!(note.contains("1 way that leaves the extract (way 1 'Gap Road')"), "{note}");

    let house = [("building", "yes"), ("height", "9")];
    let relation = "<relation id='4'><member type='way' ref='2' role='outer'/><member type='way' ref='99' role='inner'/>\
        <tag k='type' v='multipolygon'/><tag k='building' v='yes'/><tag k='name' v='Mill'/></relation>";
    let rest = way(1, &[1, 2, 5, 1], &house) + &way(2, &[2, 3, 5, 2], &[]) + relation;
    let buildings = "[[building]]\nfile = \"a.osm\"\nlayer = \"buildings\"\n";
    let read = Read::new(buildings, "a.osm", extract(&nodes, &rest));
    assert_eq!(read.built(FeatureKind::Building), 1);
    let expected = "'a.osm': left out: 1 area of a relation that leaves the extract or does not close (relation 4 'Mill')";
    assert_eq!(read.messages(FindingCode::VectorRead), [expected]);
    let alone = way(2, &[2, 3, 5, 2], &[]) + relation;
    let found = Read::new(buildings, "a.osm", extract(&nodes, &alone)).findings();
    let [error] = &found[..] else { panic!("one error: {found:?}") };
    assert_eq!(error.message, "the layer 'buildings' of 'a.osm' holds no features");
    assert!(error.help.as_ref().is_some_and(|help| help.contains("(relation 4 'Mill')")), "{error}");
}

/// A message of protocol buffers: fields of numbers, or of bytes.
enum Field<'a> {
    Number(u64, u64),
    Bytes(u64, &'a [u8]),
}

fn varint(mut number: u64, out: &mut Vec<u8>) {
    while number > 0x7f {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
}

fn message(fields: &[Field<'_>]) -> Vec<u8> {
    let mut out = Vec::new();
    for field in fields {
        match field {
            Field::Number(id, number) => {
                varint(id << 3, &mut out);
                varint(*number, &mut out);
            }
            Field::Bytes(id, bytes) => {
                varint(id << 3 | 2, &mut out);
                varint(bytes.len() as u64, &mut out);
                out.extend(*bytes);
            }
        }
    }
    out
}

fn packed(numbers: impl IntoIterator<Item = u64>) -> Vec<u8> {
    let mut out = Vec::new();
    numbers.into_iter().for_each(|number| varint(number, &mut out));
    out
}

fn zigzag(number: i64) -> u64 {
    ((number << 1) ^ (number >> 63)) as u64
}

fn blob(kind: &str, content: &[u8]) -> Vec<u8> {
    let content = message(&[Field::Bytes(1, content)]);
    let header = message(&[Field::Bytes(1, kind.as_bytes()), Field::Number(3, content.len() as u64)]);
    [&(header.len() as u32).to_be_bytes()[..], &header, &content].concat()
}

#[test]
fn openstreetmap_as_protocol_buffers_with_an_odd_way_and_an_odd_node() {
    let texts = ["", "highway", "track"].map(str::as_bytes);
    let table = message(&texts.map(|text| Field::Bytes(1, text)));
    let node = |id: i64, at: DVec2| {
        let units = |degrees: f64| zigzag((degrees * 1e7).round() as i64);
        message(&[Field::Number(1, zigzag(id)), Field::Number(8, units(at.y)), Field::Number(9, units(at.x))])
    };
    let way = |id: u64, value: u64, refs: [i64; 2]| {
        let steps = packed([zigzag(refs[0]), zigzag(refs[1] - refs[0])]);
        let (key, value) = (packed([1]), packed([value]));
        message(&[
            Field::Number(1, id),
            Field::Bytes(2, &key),
            Field::Bytes(3, &value),
            Field::Bytes(8, &steps),
        ])
    };
    let nodes =
        [node(1, degrees(50.0, 100.0)), node(2, degrees(350.0, 100.0)), node(3, DVec2::new(15.0, 95.0))];
    // The second names a text that the block does not have.
    let ways = [way(1, 2, [1, 2]), way(2, 7, [1, 2])];
    let nodes = message(&nodes.each_ref().map(|node| Field::Bytes(1, node)));
    let ways = message(&ways.each_ref().map(|way| Field::Bytes(3, way)));
    let block = message(&[Field::Bytes(1, &table), Field::Bytes(2, &nodes), Field::Bytes(2, &ways)]);
    let file = [blob("OSMHeader", &[]), blob("OSMData", &block)].concat();
    let table = roads("a.osm.pbf") + "layer = \"roads\"\n";
    Read::new(&table, "a.osm.pbf", file).reports(
        1,
        FindingCode::RecordsBroken,
        &["left out: 2 records", "a node lies beyond the poles", "a way in the blob at byte"],
    );
}

#[test]
fn a_file_of_which_two_layers_are_used_reports_what_they_share_once() {
    let nodes = [(1, 50.0, 50.0), (2, 150.0, 50.0), (3, 150.0, 90.0)];
    let rest = "<node id='9' lon='x' lat='1'/>".to_owned()
        + &way(1, &[1, 2], &[("highway", "track")])
        + &way(2, &[1, 2, 3, 1], &[("building", "yes")]);
    let tables =
        roads("a.osm") + "layer = \"roads\"\n[[building]]\nfile = \"a.osm\"\nlayer = \"buildings\"\n";
    let read = Read::new(&tables, "a.osm", extract(&nodes, &rest));
    assert_eq!(read.messages(FindingCode::RecordsBroken).len(), 1);
}

#[test]
fn features_of_another_shape_than_the_table_draws_are_counted() {
    let at = degrees(200.0, 300.0);
    let point = format!(
        r#"{{"type":"Feature","properties":{{}},"geometry":{{"type":"Point","coordinates":[{}]}}}}"#,
        written(at, ",")
    );
    let text =
        format!(r#"{{"type":"FeatureCollection","features":[{},{point},{point}]}}"#, geojson_line(100.0));
    Read::new(&roads("a.geojson"), "a.geojson", text).reports(
        1,
        FindingCode::LeftOut,
        &["'a.geojson': left out: 2 features that have another shape than the table draws: points"],
    );
    let found = Read::new(&roads("a.geojson"), "a.geojson", point).findings();
    assert_eq!(found[0].help.as_deref(), Some("the file's only feature is of points"));
}
