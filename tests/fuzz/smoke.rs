//! Each fuzz target on its seeds and on mutants of them, the same in every run.

#[path = "targets.rs"]
mod targets;

use std::path::Path;

use targets::TARGETS;

/// Mutants of each seed.
const MUTANTS: u64 = 120;

/// Numbers that look random, the same for the same seed (xorshift, Marsaglia 2003).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, most: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as usize % most.max(1)
    }
}

/// What often breaks a reader, in place of bytes.
const PIECES: [&[u8]; 14] = [
    b"\0\0\0\0",
    b"\xff\xff\xff\xff",
    b"\x7f\xff\xff\xff",
    b"\xff\xff\xff\x7f",
    b"\x80\0\0\0",
    b"-1",
    b"0",
    b"1e308",
    b"-1e-308",
    b"nan",
    b"4294967296",
    b"[[",
    b"\"",
    b"\n",
];

/// A seed with one to four changes: bytes flipped, replaced, cut out, repeated or moved.
fn mutant(seed: &[u8], numbers: &mut Numbers) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=numbers.below(4) {
        let at = numbers.below(bytes.len());
        let length = numbers.below(16).min(bytes.len() - at);
        match numbers.below(6) {
            0 if !bytes.is_empty() => bytes[at] ^= 1 << numbers.below(8),
            1 => drop(bytes.splice(at..at + length, PIECES[numbers.below(PIECES.len())].iter().copied())),
            2 => drop(bytes.drain(at..at + length)),
            3 => bytes.truncate(at),
            4 => {
                let repeated = bytes[at..at + length].to_vec();
                drop(bytes.splice(at..at, repeated));
            }
            _ => {
                let moved: Vec<u8> = bytes.drain(at..at + length).collect();
                let to = numbers.below(bytes.len() + 1);
                drop(bytes.splice(to..to, moved));
            }
        }
    }
    bytes
}

/// A file of the project, after the byte that picks its name.
fn whole(name: u8, path: &str) -> Vec<u8> {
    let bytes = std::fs::read(Path::new(env!("SANDTABLE_ROOT")).join(path)).expect("a file of the project");
    [&[name], &bytes[..]].concat()
}

/// A file of the project without the lines of a range, so that it is short.
fn bytes(path: &str, without: std::ops::Range<usize>) -> Vec<u8> {
    let bytes = std::fs::read(Path::new(env!("SANDTABLE_ROOT")).join(path)).expect("a file of the project");
    let lines = bytes.split_inclusive(|&byte| byte == b'\n').enumerate();
    lines.filter(|(number, _)| !without.contains(number)).flat_map(|(_, line)| line.to_vec()).collect()
}

/// The start of a file of the project, after the byte that picks its name.
fn file(name: u8, path: &str) -> Vec<u8> {
    const MOST: usize = 6000;
    let bytes = std::fs::read(Path::new(env!("SANDTABLE_ROOT")).join(path)).expect("a file of the project");
    [&[name], &bytes[..bytes.len().min(MOST)]].concat()
}

fn text(name: u8, text: &str) -> Vec<u8> {
    [&[name], text.as_bytes()].concat()
}

fn seeds(target: &str) -> Vec<Vec<u8>> {
    match target {
        "elevation" => vec![
            file(0, "assets/jacksboro/dem.tif"),
            file(1, "assets/jacksboro/valley.asc"),
            text(1, "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -1\n1 2 3\n4 5 -1\n"),
            vec![2; 2 * 1201 * 3],
            text(5, "binterr1.3\x03\0\0\0\x03\0\0\0\x02\0\0\0\x01\0\x10\0"),
            text(7, "DSAA\n3 2\n0 20\n0 10\n1 6\n1 2 3\n4 5 6\n"),
            text(8, "0 0 1\n5 0 2\n0 5 3\n5 5 4\n"),
            file(9, "assets/jacksboro/hills.png"),
            whole(0, "tests/elevation/stored/meters_lzma.tif"),
            whole(0, "tests/elevation/stored/near_lerc.tif"),
            whole(0, "tests/elevation/stored/bytes_lerc.tif"),
            whole(12, "tests/elevation/stored/levels_packed.img"),
            whole(13, "tests/elevation/stored/hills.gpkg"),
            text(10, "NROWS 2\nNCOLS 2\nNBITS 16\nBYTEORDER I\nULXMAP 0\nULYMAP 9\nXDIM 1\nYDIM 1\n"),
        ],
        "points" => vec![
            b"x,y,z\n1,2,3\n4,5,6\n".to_vec(),
            [&b"LASF"[..], &[0; 20], &[1, 2], &[0; 68], &[227, 0, 227, 0], &[0; 200]].concat(),
        ],
        "vectors" => vec![
            file(0, "assets/jacksboro/lake.geojson"),
            file(0, "assets/jacksboro/crossing.geojson"),
            whole(0, "assets/jacksboro/crossing.orbat.json"),
            text(4, "<gpx version=\"1.1\"><trk><name>a</name><trkseg><trkpt lat=\"1\" lon=\"2\"><ele>3</ele></trkpt>\
                     <trkpt lat=\"1.1\" lon=\"2\"/></trkseg></trk></gpx>"),
            text(5, "<kml><Document><Placemark><name>a</name><Polygon><outerBoundaryIs><LinearRing><coordinates>0,0 1,0 \
                     1,1 0,0</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></Document></kml>"),
            text(6, "<osm><node id=\"1\" lat=\"1\" lon=\"2\"/><node id=\"2\" lat=\"1.1\" lon=\"2\"/><way id=\"3\">\
                     <nd ref=\"1\"/><nd ref=\"2\"/><tag k=\"highway\" v=\"track\"/></way></osm>"),
            whole(9, "assets/jacksboro/scenario.msdl.xml"),
            file(10, "assets/jacksboro/plan.nvg"),
            file(11, "assets/jacksboro/picture.milxly"),
            file(12, "assets/jacksboro/tracks.cot"),
            [&[1][..], &[0, 0, 0x27, 0x0a], &[0; 20], &[0, 0, 0, 50], &[0xe8, 3, 0, 0, 3, 0, 0, 0], &[0; 72]].concat(),
        ],
        "city_models" => vec![
            bytes("assets/jacksboro/hamlet.city.json", 0..0),
            b"{\"type\":\"CityJSON\",\"version\":\"2.0\",\"transform\":{\"scale\":[1,1,1],\"translate\":[0,0,0]},\"CityObjects\":{\"a\":{\"type\":\"Building\",\
              \"geometry\":[{\"type\":\"Solid\",\"lod\":\"2\",\"boundaries\":[[[[0,1,2,3],[4,5,6,7]],[[0,1,2]]]],\"semantics\":{\"surfaces\":[{\"type\":\
              \"RoofSurface\"}],\"values\":[[0,null]]},\"texture\":{\"t\":{\"values\":[[[[0,0,1,2,3],[null]],[[null]]]]}}},{\"type\":\"GeometryInstance\",\
              \"template\":0,\"boundaries\":[1],\"transformationMatrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}]}},\"vertices\":[[0,0,0],[9,0,0],[9,9,1],[0,9,1],\
              [3,3,0],[3,6,1],[6,6,1],[6,3,0]],\"appearance\":{\"textures\":[{\"type\":\"PNG\",\"image\":\"a.png\"}],\"vertices-texture\":[[0,0],[1,0],\
              [1,1],[0,1]]},\"geometry-templates\":{\"templates\":[{\"type\":\"MultiSurface\",\"lod\":\"2\",\"boundaries\":[[[0,1,2]]]}],\
              \"vertices-templates\":[[0,0,0],[1,0,0],[0,1,0]]}}"
                .to_vec(),
        ],
        "drawings" => vec![
            bytes("assets/jacksboro/works.dxf", 0..0),
            b"0\nSECTION\n2\nENTITIES\n0\nSPLINE\n71\n2\n40\n0\n40\n0\n40\n0\n40\n1\n40\n1\n40\n1\n10\n0\n20\n0\n10\n1\n20\n1\n10\n2\n20\n0\n0\nHATCH\n91\n1\n\
              92\n0\n93\n2\n72\n2\n10\n5\n20\n5\n40\n2\n50\n0\n51\n180\n73\n1\n72\n1\n10\n3\n20\n5\n11\n7\n21\n5\n0\nPOLYLINE\n70\n64\n0\nVERTEX\n70\n192\n\
              10\n0\n20\n0\n0\nVERTEX\n70\n128\n71\n1\n72\n1\n73\n1\n0\nSEQEND\n0\nENDSEC\n0\nEOF\n"
                .to_vec(),
            b"AutoCAD Binary DXF\r\n\x1a\0\0\0SECTION\0\x02\0ENTITIES\0\0\0POINT\0\x0a\0\0\0\0\0\0\0\xf0\x3f\x14\0\0\0\0\0\0\0\xf0\x3f\0\0ENDSEC\0\0\0EOF\0".to_vec(),
        ],
        "land_xml" => vec![
            bytes("assets/jacksboro/bypass.xml", 400..1200),
            b"<LandXML><Units><Imperial linearUnit=\"foot\"/></Units><CoordinateSystem epsgCode=\"32616\"/><CgPoints><CgPoint name=\"1\">0 0 1</CgPoint>\
              </CgPoints><Alignments><Alignment name=\"a\" staStart=\"5\"><CoordGeom><Line><Start pntRef=\"1\"/><End>0 90</End></Line><Spiral rot=\"cw\" \
              length=\"30\" radiusStart=\"INF\" radiusEnd=\"90\"><Start>0 90</Start><PI>0 110</PI><End>-2 119</End></Spiral><Curve rot=\"ccw\" radius=\"90\">\
              <Start>-2 119</Start><End>20 150</End></Curve></CoordGeom><Profile><ProfAlign><PVI>5 1</PVI><CircCurve radius=\"900\">60 9</CircCurve><UnsymParaCurve \
              lengthIn=\"9\" lengthOut=\"12\">90 2</UnsymParaCurve><PVI>200 3</PVI></ProfAlign></Profile></Alignment></Alignments><Surfaces><Surface name=\"s\">\
              <Definition><Pnts><P id=\"1\">0 0 1</P><P id=\"2\">90 0 2</P><P id=\"3\">0 90 3</P></Pnts><Faces><F>1 2 3</F></Faces></Definition></Surface>\
              </Surfaces></LandXML>"
                .to_vec(),
            b"<LandXML><Surfaces><Surface><SourceData><DataPoints><PntList3D>0 0 1 0 90 2 90 0 3 90 90 4</PntList3D></DataPoints><Breaklines><Breakline>\
              <PntList3D>0 0 1 90 90 4</PntList3D></Breakline></Breaklines><Boundaries><Boundary bndType=\"void\"><PntList2D>9 9 9 20 20 20</PntList2D></Boundary>\
              </Boundaries></SourceData></Surface></Surfaces></LandXML>"
                .to_vec(),
        ],
        "models" => vec![
            file(0, "assets/models/watchtower.3ds"),
            file(1, "assets/models/farmhouse.obj"),
            file(2, "assets/models/tent.glb"),
            text(3, "{\"asset\":{\"version\":\"2.0\"},\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\
                     \"accessors\":[{\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"bufferView\":0}]}"),
        ],
        "scene_text" => ["road", "areas", "symbols", "expressions", "phases"]
            .map(|name| file(b'\n', &format!("scenes/{name}.toml")))
            .to_vec(),
        "scene_build" => [
            "[[road]]\nwidth = 6\nprofile = \"conform\"\npoints = [[500030, 4000060], [500240, 4000200], [500450, 4000300]]\n",
            "[[river]]\nwidth = 4\npoints = [[500450, 4000450], [500240, 4000200], [500030, 4000060]]\n",
            "[[lake]]\npoints = [[500090, 4000090], [500200, 4000090], [500190, 4000200], [500080, 4000190]]\n",
            "[[area]]\ncover = \"forest\"\npoints = [[500030, 4000030], [500400, 4000400], [500400, 4000030], [500030, 4000400]]\n",
            "[[building]]\nheight = 9\npoints = [[500090, 4000090], [500120, 4000090], [500120, 4000110], [500090, 4000110]]\n",
            "[[label]]\ntext = \"a\"\nat = [500240, 4000240]\n[[camera]]\nname = \"c\"\neye = [500240, 3999900]\n\
             eye_elevation = 300\nlook_at = [500240, 4000240]\n",
            "[[earthwork]]\nkind = \"crater\"\nradius = 20\npoints = [[500240, 4000240]]\n",
        ]
        .map(|tables| tables.as_bytes().to_vec())
        .to_vec(),
        "scene_shapes" | "scene_picture" | "walk" => {
            // Choices, not a text: whatever bytes they are, they choose something.
            let mut numbers = Numbers(0x5851_F42D_4C95_7F2D);
            let any = (0..12).map(|seed| (0..60 + 20 * seed).map(|_| numbers.below(256) as u8).collect());
            // A lake all of whose points are one.
            any.chain([b"\xf8\xff\xff\x9a\x9a\x90\xff\xff".to_vec()]).collect()
        }
        "tables" => vec![
            whole(0, "assets/jacksboro/units.csv"),
            text(1, "sep=;\nName;L\u{e4}nge;Breite;a\n\"x\ny\";-84,2;36,3;16SGF5000018000\nb;84.2W;36.3N;1.0031E+19\n"),
            text(0, "a;wkt\n1;POINT Z (1 2 3)\n2;\"POLYGON((0 0,4 0,4 4,0 0),(1 0.5,2 0.5,2 1,1 0.5))\"\n3;GEOMETRYCOLLECTION(POINT(1 1))\n"),
            text(2, "<o:c xmlns:o='o' xmlns:t='t' xmlns:x='x'><o:body><o:spreadsheet><t:table t:name='a'><t:table-row><t:table-cell><x:p>lon</x:p>\
                     </t:table-cell><t:table-cell><x:p>lat</x:p></t:table-cell></t:table-row><t:table-row t:number-rows-repeated='3'>\
                     <t:table-cell t:number-columns-repeated='2' o:value-type='float' o:value='7.5'/></t:table-row></t:table></o:spreadsheet>\
                     </o:body></o:c>"),
            text(3, "<worksheet><dimension ref='A1:XFD1048576'/><sheetData><row r='1'><c r='A1' t='inlineStr'><is><t>a</t></is></c>\
                     <c r='B1' t='inlineStr'><is><t>sidc</t></is></c></row><row r='2'><c r='A2' t='inlineStr'><is><t>16SGF5000018000</t></is>\
                     </c><c r='B2'><v>10031000161211000000</v></c></row></sheetData></worksheet>"),
        ],
        "positions" => [
            "750000,4018000",
            "16S GF 50000 18000",
            "ZAH12345678",
            "33T 500000 5200000",
            "33 south 500000 5200000",
            "Z 2100000 1900000",
            "36.277N 84.215W",
            "W 84\u{b0}12'54\" N 36\u{b0}16'37\"",
            "36 16.62 N 84 12.9 W",
            "3616N08412W",
        ]
        .map(|words| words.as_bytes().to_vec())
        .to_vec(),
        "http_request" => {
            const UTM: &str = "crs=EPSG:32616";
            let asked = |choice: u8, words: &str| text(choice, words);
            vec![
                asked(0, "36.143,-87.0"),
                asked(1, "locations=_p~iF~ps|U_ulLnnqC&interpolation=cubic"),
                asked(2, "dataset=hill&from=500030,4000060&to=500240,4000200&samples=9&crs=EPSG:32616"),
                asked(3, &format!("dataset=hill&from=500030,4000060&to=500240,4000200&{UTM}")),
                asked(4, &format!("dataset=hill&from=500240,4000200&range=100&{UTM}")),
                asked(7, "500000,4000000,500200,4000200&crs=native"),
                asked(7, "500000,4000000;500200,4000000;500000,4000200&crs=native&unit=degrees&format=json"),
                asked(8, "500040,4000060|500100,4000100&crs=native"),
                asked(5, "hill,hill?locations=1,2|3,4"),
                asked(10, "{\"locations\":\"36.143,-87.0\",\"interpolation\":\"nearest\"}"),
                asked(30, "locations=36.143,-87.0&format=geojson"),
                asked(50, "--b\r\nContent-Disposition: form-data; name=\"locations\"\r\n\r\n36.143,-87.0\r\n--b--\r\n"),
                asked(6, "locations=36.143,-87.0|1,2"),
                asked(16, "{\"locations\":[{\"latitude\":36.143,\"longitude\":-87.0}]}"),
                asked(9, "GET /health HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"),
                asked(9, "POST /v1/hill HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n5\r\nlocat\r\n0\r\n\r\n"),
            ]
        }
        _ => [
            "width * 2 + if(lanes > 2, 3.5, 0)",
            "EPSG:32616 +to_meter=0.3048",
            "+proj=lcc +lat_1=49 +lat_2=44 +lat_0=46.5 +lon_0=3 +ellps=GRS80 +units=m",
            "PROJCS[\"a\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],PRIMEM[\"Greenwich\",0],\
             UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"central_meridian\",-87],\
             UNIT[\"metre\",1]]",
            "130310001612110001041020000000",
        ]
        .map(|words| words.as_bytes().to_vec())
        .to_vec(),
    }
}

#[test]
fn every_target_ends_with_an_answer_or_an_error_on_seeds_and_mutants() {
    for (name, target) in TARGETS {
        // A scene is built by many passes, which takes longer than reading a file.
        let mutants = match name {
            "scene_build" => MUTANTS / 3,
            "scene_shapes" | "http_request" => MUTANTS / 8,
            "scene_picture" | "walk" => MUTANTS / 40,
            _ => MUTANTS,
        };
        let seeds = seeds(name);
        assert!(!seeds.is_empty(), "{name}");
        for (index, seed) in seeds.iter().enumerate() {
            target(seed);
            let mut numbers = Numbers(0x9E37_79B9_7F4A_7C15 ^ (index as u64 + 1));
            for _ in 0..mutants {
                target(&mutant(seed, &mut numbers));
            }
        }
    }
}

#[test]
fn seeds_reach_behind_the_first_check() {
    // A seed that no reader takes makes mutants that test nothing.
    use sandtable_dem::hints::DemHints;
    use sandtable_dem::read::read;
    let grid = &seeds("elevation")[2];
    assert!(read("a.asc", &grid[1..], &DemHints::default()).is_ok());
    for seed in seeds("vectors").iter().filter(|seed| seed[0] >= 9) {
        let layer = sandtable_vector::read::read("a.xml", &seed[1..], &Default::default());
        assert!(
            layer.is_ok_and(|layer| !layer.features.is_empty() && layer.faults.is_empty()),
            "{}",
            seed[0]
        );
    }
    for seed in seeds("scene_build") {
        let tables = String::from_utf8(seed).expect("text");
        targets::on_hill(&tables).unwrap_or_else(|error| panic!("{tables}: {error:?}"));
    }
}
