//! Tables and spreadsheets that are read.

use serde_json::Value;

use crate::feature::{Geometry, VectorLayer};
use crate::hints::VectorHints;
use crate::read;
use sandtable_base::archive::zip;
use sandtable_geom::crs::Crs;

fn read_as(name: &str, bytes: &[u8], hints: &VectorHints<'_>) -> Result<VectorLayer, String> {
    read::read(name, bytes, hints).map_err(|error| error.to_string())
}

fn table(text: &str) -> VectorLayer {
    read_as("a.csv", text.as_bytes(), &VectorHints::default()).expect(text)
}

fn refused(text: &str) -> String {
    read_as("a.csv", text.as_bytes(), &VectorHints::default()).expect_err(text)
}

fn points(layer: &VectorLayer) -> Vec<[f64; 2]> {
    layer.features.iter().flat_map(|feature| feature.points()).map(|at| at.to_array()).collect()
}

#[test]
fn separators_decimal_commas_encodings_and_titles_make_no_difference() {
    let expected = vec![[-84.2, 36.3], [-84.5, 36.0]];
    for text in [
        "lon,lat,name\n-84.2,36.3,a\n-84.5,36.0,b\n",
        "Name;Länge;Breite\r\na;-84,2;36,3\r\nb;-84,5;36\r\n",
        "lat\tlon\n36.3\t-84.2\n36\t-84.5",
        "longitude|latitude\n-84.2|36.3\n-84.5|36\n",
        "sep=;\nlon;lat\n-84,2;36,3\n-84,5;36,0\n",
        "Units of 1 Brigade\nas of today, secret\n\nName,Longitude (°),Latitude (°)\na,84.2W,36.3N\nb,W 84 30 0,\"36°0'0\"\"N\"\n",
        "name,lon,lat\n\"two\nlines, and a \"\"word\"\"\",\"-84,2\",\"36,3\"\nb,-84.5,36\n",
    ] {
        assert_eq!(points(&table(text)), expected, "{text}");
    }
    let text = "Name;Länge;Breite\na;-84,2;36,3\nb;-84,5;36,0\n";
    let utf_16 = |mark: [u8; 2], bytes: fn(u16) -> [u8; 2]| {
        mark.into_iter().chain(text.encode_utf16().flat_map(bytes)).collect::<Vec<u8>>()
    };
    let ansi: Vec<u8> = text.chars().map(|letter| letter as u8).collect();
    let marked = [b"\xef\xbb\xbf", text.as_bytes()].concat();
    for bytes in
        [utf_16([0xff, 0xfe], u16::to_le_bytes), utf_16([0xfe, 0xff], u16::to_be_bytes), ansi, marked]
    {
        assert_eq!(points(&read_as("a.csv", &bytes, &VectorHints::default()).expect("a table")), expected);
    }
}

#[test]
fn a_position_is_taken_in_every_form_and_refused_where_it_has_two_readings() {
    let layer = table(
        "Unit,Grid\nA,16S GF 50000 18000\nB,36.277N 84.215W\nC,16N 750000 4018000\nD,somewhere\nE,16S 755447 4024162\nF,\n",
    );
    assert_eq!(layer.features.len(), 3);
    let places = points(&layer);
    assert!(places.iter().all(|[x, y]| (x + 84.2).abs() < 0.1 && (y - 36.28).abs() < 0.02), "{places:?}");
    let fault = &layer.faults[0];
    for expected in
        ["3 records", "line 5: 'somewhere'", "line 6", "line 7: nothing stands in the column 'Grid'"]
    {
        assert!(fault.contains(expected), "{fault}");
    }
}

#[test]
fn degrees_without_letters_are_ordered_by_what_can_be_no_latitude() {
    assert_eq!(
        points(&table("position\n\"36.3, -84.2\"\n\"36.5, -94.2\"\n")),
        [[-84.2, 36.3], [-94.2, 36.5]]
    );
    let error = refused("position\n\"36.3, -84.2\"\n");
    assert!(
        error.contains("can be longitude 36.3 and latitude -84.2, or latitude 36.3 and longitude -84.2"),
        "{error}"
    );
}

#[test]
fn eastings_and_northings_need_a_system_or_a_zone() {
    let text = "Rechts;Hoch\n750000,5;4018000\n";
    assert!(refused(text).contains("state it with the key 'crs'"));
    let crs = Crs::from_epsg(32616).expect("a zone");
    let hints = VectorHints { crs: Some(&crs), ..VectorHints::default() };
    let layer = read_as("a.csv", text.as_bytes(), &hints).expect("a table");
    assert_eq!((points(&layer), layer.crs.epsg()), (vec![[750_000.5, 4_018_000.0]], Some(32616)));
    let zoned = table("zone,easting,northing\n16N,750000,4018000\n");
    assert!((points(&zoned)[0][0] + 84.215).abs() < 0.01);
}

#[test]
fn shapes_of_well_known_text_are_read() {
    let layer = table(
        "id;wkt\n1;POINT Z (1 2 3)\n2;LINESTRING(0 0, 1 1 , 2 0)\n3;POLYGON((0 0,4 0,4 4,0 0),(1 0.5,2 0.5,2 1,1 0.5))\n\
         4;MULTIPOINT((1 1),(2 2))\n5;MULTIPOINT(1 1,2 2)\n6;MULTIPOLYGON(((0 0,1 0,1 1,0 0)),((5 5,6 5,6 6,5 5)))\n\
         7;GEOMETRYCOLLECTION(POINT(1 1),LINESTRING M (0 0 9,1 1 9))\n8;POINT EMPTY\n9;POINT(1)\n10;CIRCLE(1 2)\n",
    );
    let kinds: Vec<&str> = layer.features.iter().map(|feature| feature.geometry.kind()).collect();
    assert_eq!(kinds, ["points", "lines", "polygons", "points", "points", "polygons", "points", "lines"]);
    assert_eq!(layer.features[0].elevations.as_deref(), Some(&[3.0][..]));
    let Geometry::Polygons(polygons) = &layer.features[2].geometry else { panic!("a polygon") };
    assert_eq!(polygons[0].holes.len(), 1);
    assert!(
        layer.faults[0].contains("line 10: 'POINT(1)'") && layer.faults[0].contains("line 11"),
        "{:?}",
        layer.faults
    );
    let system = table("wkt\n\"SRID=32616;POINT(750000 4018000)\"\n");
    assert_eq!(system.crs.epsg(), Some(32616));
    let deep = format!("wkt\n\"{}\"\n", "GEOMETRYCOLLECTION(".repeat(5000));
    assert!(refused(&deep).contains("deep"));
}

#[test]
fn columns_of_the_schema_become_its_properties_and_keep_their_own_names() {
    let layer = table(
        "Unit,Higher,Code,Grid,Strength,Number\n1-5 IN,2 BDE,10031000161211000000,16SGF5000018000,650,007\n",
    );
    let unit = &layer.features[0].properties;
    for (name, expected) in [
        ("sidc", "10031000161211000000"),
        ("Code", "10031000161211000000"),
        ("unique_designation", "1-5 IN"),
        ("higher_formation", "2 BDE"),
        ("Number", "007"),
    ] {
        assert_eq!(unit[name], expected, "{name}");
    }
    assert_eq!(unit["Strength"], Value::from(650.0));
}

#[test]
fn a_code_that_lost_digits_is_told_and_never_taken() {
    let layer = table("SIDC,lon,lat\n1.0031E+19,1,2\nSFGPUCI--------,1,2\nnone,1,2\n");
    assert_eq!(layer.features.len(), 3);
    assert!(!layer.features[0].properties.contains_key("sidc"));
    assert!(
        layer.faults[0].contains("lost its last digits") && layer.faults[0].contains("line 2"),
        "{:?}",
        layer.faults
    );
    assert!(layer.faults[1].contains("line 4"), "{:?}", layer.faults);
}

#[test]
fn stated_columns_are_taken_and_missing_ones_named() {
    let text = "Wo,Was,lon,lat\n16SGF5000018000,SFGPUCI--------,1,2\n";
    let stated = |pairs: &[(&str, &str)]| -> Vec<(String, String)> {
        pairs.iter().map(|(role, name)| ((*role).to_owned(), (*name).to_owned())).collect()
    };
    let read = |pairs: &[(&str, &str)]| {
        read_as("a.csv", text.as_bytes(), &VectorHints { columns: &stated(pairs), ..VectorHints::default() })
    };
    let layer = read(&[("position", "Wo"), ("sidc", "Was"), ("note", "lat")]).expect("a table");
    assert!((points(&layer)[0][0] + 84.2).abs() < 0.1);
    assert_eq!(layer.features[0].properties["sidc"], "SFGPUCI--------");
    assert_eq!(layer.features[0].properties["note"], "2");
    let error = read(&[("position", "Wos")]).expect_err("no such column");
    let titled = format!("Units of today\n{text}");
    let columns = stated(&[("position", "Wos")]);
    let hints = VectorHints { columns: &columns, ..VectorHints::default() };
    assert_eq!(read_as("a.csv", titled.as_bytes(), &hints).expect_err("no such column"), error);
    assert!(
        error.contains("no column 'Wos'; did you mean 'Wo'?; its columns are Wo, Was, lon, lat"),
        "{error}"
    );
}

#[test]
fn a_table_without_a_place_says_what_it_has_and_what_to_state() {
    let error = refused("Name,Town\na,b\n");
    assert!(
        error.contains("its columns are Name, Town") && error.contains("columns = { position ="),
        "{error}"
    );
    for text in ["", "\n\n", "\"", "lon,lat\n", "1,2\n3,4\n", "position\nLondon\n"] {
        let _ = read_as("a.csv", text.as_bytes(), &VectorHints::default())
            .map(|layer| assert!(layer.features.is_empty()));
    }
}

const WORKBOOK: &str = r#"<workbook xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main" xmlns:r="http://schemas.openxmlformats.org/officeDocument/2006/relationships"><sheets><sheet name="Units" sheetId="1" r:id="rId1"/><sheet name="Notes" sheetId="2" r:id="rId2"/></sheets></workbook>"#;
const ROOT: &str = r#"<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rId1" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/officeDocument" Target="xl/workbook.xml"/></Relationships>"#;
const RELATIONS: &str = r#"<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rId1" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet" Target="worksheets/sheet1.xml"/><Relationship Id="rId2" Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/worksheet" Target="worksheets/sheet2.xml"/></Relationships>"#;

fn xlsx(sheet: &str) -> Vec<u8> {
    let sheet_of = |rows: &str| {
        format!(
            r#"<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><dimension ref="A1:XFD1048576"/><sheetData>{rows}</sheetData></worksheet>"#
        )
    };
    let notes = sheet_of(r#"<row r="1"><c r="A1" t="inlineStr"><is><t>remarks</t></is></c></row>"#);
    zip(&[
        ("_rels/.rels", ROOT.as_bytes()),
        ("xl/workbook.xml", WORKBOOK.as_bytes()),
        ("xl/_rels/workbook.xml.rels", RELATIONS.as_bytes()),
        ("xl/worksheets/sheet1.xml", sheet_of(sheet).as_bytes()),
        ("xl/worksheets/sheet2.xml", notes.as_bytes()),
    ])
    .expect("memory")
}

fn text_cell(place: &str, text: &str) -> String {
    format!(r#"<c r="{place}" t="inlineStr"><is><t>{text}</t></is></c>"#)
}

#[test]
fn sheets_of_xlsx_are_layers_whatever_size_they_declare() {
    let header = text_cell("A1", "MGRS") + &text_cell("B1", "SIDC") + &text_cell("XFD1", "far");
    let good = text_cell("A2", "16SGF5000018000") + &text_cell("B2", "10031000161211000000");
    let rounded =
        text_cell("A1048576", "16SGF5100018000") + r#"<c r="B1048576"><v>10031000161211000000</v></c>"#;
    let bytes = xlsx(&format!(
        "<row r=\"1\">{header}</row><row r=\"2\">{good}</row><row r=\"1048576\">{rounded}</row>"
    ));
    for layer in [None, Some("Units")] {
        let hints = VectorHints { layer, ..VectorHints::default() };
        let read = read_as("a.xlsx", &bytes, &hints).expect("a sheet");
        assert_eq!(read.features.len(), 2);
        assert_eq!(read.features[0].properties["sidc"], "10031000161211000000");
        assert!(
            !read.features[1].properties.contains_key("sidc")
                && !read.features[1].properties.contains_key("SIDC")
        );
        assert!(read.faults[0].contains("row 1048576"), "{:?}", read.faults);
    }
    let hints = VectorHints { layer: Some("Notes"), ..VectorHints::default() };
    assert!(read_as("a.xlsx", &bytes, &hints).expect_err("no places").contains("its columns are remarks"));
    let hints = VectorHints { layer: Some("unit"), ..VectorHints::default() };
    assert!(read_as("a.xlsx", &bytes, &hints).expect_err("no such").contains("its layers are Units, Notes"));
}

fn ods(rows: &str) -> Vec<u8> {
    let content = format!(
        r#"<office:document-content xmlns:office="o" xmlns:table="t" xmlns:text="x"><office:body><office:spreadsheet><table:table table:name="Sheet1">{rows}</table:table></office:spreadsheet></office:body></office:document-content>"#
    );
    zip(&[
        ("mimetype", b"application/vnd.oasis.opendocument.spreadsheet"),
        ("content.xml", content.as_bytes()),
    ])
    .expect("memory")
}

#[test]
fn sheets_of_opendocument_are_read_and_repeats_are_bounded() {
    let text = |text: &str| {
        format!(r#"<table:table-cell office:value-type="string"><text:p>{text}</text:p></table:table-cell>"#)
    };
    let number = |number: &str| {
        format!(
            r#"<table:table-cell office:value-type="float" office:value="{number}"><text:p>x</text:p></table:table-cell>"#
        )
    };
    let row = |cells: String| format!("<table:table-row>{cells}</table:table-row>");
    let empty = r#"<table:table-row table:number-rows-repeated="5"><table:table-cell table:number-columns-repeated="16384"/></table:table-row>"#;
    let rows = row(text("lon") + &text("lat") + &text("name"))
        + empty
        + &row(number("-84.2") + &number("36.3") + &text("hill"))
        + &row(text("east") + &text("north"));
    let layer = read_as("a.ods", &ods(&rows), &VectorHints::default()).expect("a sheet");
    assert_eq!(
        (points(&layer), layer.features[0].properties["name"].as_str()),
        (vec![[-84.2, 36.3]], Some("hill"))
    );
    assert!(layer.faults[0].contains("row 8"), "{:?}", layer.faults);
    let bomb = format!(
        r#"<table:table-row table:number-rows-repeated="1048576"><table:table-cell table:number-columns-repeated="16384" office:value-type="string"><text:p>{}</text:p></table:table-cell></table:table-row>"#,
        "x".repeat(1000)
    );
    assert!(
        read_as("a.ods", &ods(&bomb), &VectorHints::default())
            .expect_err("a bomb")
            .contains("bytes of cells")
    );
}

#[test]
fn thousands_of_rows_are_read_at_once() {
    let rows: String =
        (0..20_000).map(|index| format!("unit {index},16SGF{:05}{:05}\n", index, 99_999 - index)).collect();
    assert_eq!(table(&format!("unit,mgrs\n{rows}")).features.len(), 20_000);
}

/// A workbook of Excel 97, made by another program.
const UNITS_97: &[u8] = include_bytes!("../../../tests/features/units.xls");

#[test]
fn workbooks_of_excel_97_are_read_as_others_are() {
    let layer = read::read("units.xls", UNITS_97, &VectorHints::default()).expect("a workbook");
    assert_eq!(layer.features.len(), 2, "{:?}", layer.faults);
    let (first, second) = (&layer.features[0].properties, &layer.features[1].properties);
    for (name, expected) in [
        ("Unit", Value::from("2-77 IN")),
        ("sidc", Value::from("10031000161211000000")),
        ("Strength", Value::from(612.0)),
        ("Date", Value::from("2026-05-01T06:00:00Z")),
        ("Ready", Value::Bool(true)),
    ] {
        assert_eq!(first[name], expected, "{name}");
    }
    assert_eq!((second["Unit"].as_str(), second["Date"].as_str()), (Some("Рота"), Some("2026-05-02")));
    assert!(layer.faults.join("\n").contains("row 5"), "{:?}", layer.faults);
}

#[test]
fn broken_workbooks_of_excel_97_end_with_an_error_or_a_table() {
    let mut state = 7u64;
    let mut next = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for _ in 0..3000 {
        let mut bytes = UNITS_97.to_vec();
        for _ in 0..=next(8) {
            let at = next(bytes.len());
            bytes[at] = next(256) as u8;
        }
        if next(4) == 0 {
            bytes.truncate(next(bytes.len()));
        }
        let _ = read::read("units.xls", &bytes, &VectorHints::default());
    }
}
