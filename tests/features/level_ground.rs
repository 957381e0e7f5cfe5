//! Level ground with one vector file on it, as readers and tables of features meet it.

use glam::DVec2;
use sandtable_description::finding::Finding;
use sandtable_description::finding_code::FindingCode;
use sandtable_geom::crs::Crs;
use sandtable_scene::feature::FeatureKind;
use sandtable_scene::scene_file::open_scene;
use sandtable_scene::scene_model::SceneModel;

use crate::common::findings::findings;
use crate::common::scratch::Scratch;

/// The corner of the ground, 400 m square and level, in UTM zone 33.
pub const CORNER: DVec2 = DVec2::new(500_000.0, 4_500_000.0);

fn ground() -> String {
    let row = "100 ".repeat(41);
    let head = "ncols 41\nnrows 41\nxllcorner 500000\nyllcorner 4500000\ncellsize 10\n";
    format!("{head}{}", format!("{row}\n").repeat(41))
}

/// A place on the ground in degrees.
pub fn degrees(x: f64, y: f64) -> DVec2 {
    let utm = Crs::from_epsg(32633).expect("a zone");
    utm.transform(&Crs::wgs84(), CORNER + DVec2::new(x, y)).expect("on Earth")
}

/// Longitude and latitude, parted by `separator`.
pub fn written(at: DVec2, separator: &str) -> String {
    format!("{:.8}{separator}{:.8}", at.x, at.y)
}

/// A scene with one table of a file.
pub struct Read {
    scratch: Scratch,
    table: String,
}

impl Read {
    /// The scene of `table`, with a file beside it.
    pub fn new(table: &str, name: &str, bytes: impl AsRef<[u8]>) -> Self {
        let scratch = Scratch::new();
        scratch.write("ground.asc", ground());
        scratch.write(name, bytes);
        let table = format!("[terrain]\ndem = \"ground.asc\"\ncrs = \"EPSG:32633\"\n{table}");
        Self { scratch, table }
    }

    /// What a check finds.
    pub fn findings(&self) -> Vec<Finding> {
        findings(&self.scratch.write("scene.toml", &self.table), &[])
    }

    /// The scene.
    pub fn scene(&self) -> SceneModel {
        let scene = open_scene(&self.scratch.write("scene.toml", &self.table), &[], &|_| ());
        scene.unwrap_or_else(|error| panic!("{error}"))
    }

    /// How many features of a kind stand in the scene.
    pub fn built(&self, kind: FeatureKind) -> usize {
        self.scene().features.iter().filter(|feature| feature.kind == kind).count()
    }

    /// The messages of a code.
    pub fn messages(&self, code: FindingCode) -> Vec<String> {
        let of_code = |finding: &Finding| finding.code == code;
        self.findings().into_iter().filter(of_code).map(|finding| finding.message).collect()
    }

    /// Checks that the scene has `built` roads, and one finding of a code that holds all of `parts`.
    pub fn reports(&self, built: usize, code: FindingCode, parts: &[&str]) {
        assert_eq!(self.built(FeatureKind::Road), built, "{:?}", self.findings());
        let messages = self.messages(code);
        let [message] = &messages[..] else { panic!("one sentence of {}: {messages:?}", code.word()) };
        for part in parts {
            assert!(message.contains(part), "'{part}' in: {message}");
        }
    }
}
