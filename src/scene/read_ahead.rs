//! OpenStreetMap extracts that are read, and layers that are made of them, while the elevation is read.
//!
//! Only files on the disk whose names say that they are extracts are read: of others more may be read than is taken of them.
//! What cannot be read is left out, so that [`Sources`](crate::sources::Sources) reads it again and reports the error where
//! the scene file names it.

use std::borrow::Cow;
use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::assets::Assets;
use crate::layer_key::{LayerKey, layer_key};
use sandtable_description::document::Document;
use sandtable_description::feature_source::FeatureSource;
use sandtable_description::table_sources::{TableSource, table_sources};
use sandtable_remote::address::is_address;
use sandtable_vector::feature::VectorLayer;
use sandtable_vector::hints::VectorHints;
use sandtable_vector::read::LayeredFile;

/// Files that were read, with the layers that a document takes of them.
#[derive(Default)]
pub struct SourcesAhead {
    /// By name.
    pub(super) files: BTreeMap<String, LayeredFile>,
    /// The layers of these.
    pub(super) layers: BTreeMap<LayerKey, VectorLayer>,
}

/// The layers that a document takes of one file.
type WantedLayers<'a> = BTreeMap<LayerKey, Cow<'a, FeatureSource>>;

impl SourcesAhead {
    /// Reads the extracts that the tables of a document name.
    pub fn of(document: &Document, assets: &Assets) -> Self {
        let files: Vec<(String, WantedLayers<'_>)> = extracts(document, assets).into_iter().collect();
        let read: Vec<Self> =
            files.into_par_iter().filter_map(|(name, wanted)| read(&name, &wanted, assets)).collect();
        let mut all = Self::default();
        for Self { files, layers } in read {
            all.files.extend(files);
            all.layers.extend(layers);
        }
        all
    }
}

/// The extracts that a document names.
fn extracts<'a>(document: &'a Document, assets: &Assets) -> BTreeMap<String, WantedLayers<'a>> {
    let mut files: BTreeMap<String, WantedLayers<'_>> = BTreeMap::new();
    for TableSource { source, .. } in table_sources(document) {
        let Some(file) = source.file.as_ref().filter(|file| is_extract(file)) else { continue };
        if assets.given().layer(file).is_none() {
            let (name, key) = (file.to_string(), layer_key(file, &source));
            files.entry(name).or_default().entry(key).or_insert(source);
        }
    }
    files
}

/// Whether a name is that of an OpenStreetMap extract on the disk.
fn is_extract(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    [".osm", ".pbf"].iter().any(|extension| name.ends_with(extension)) && !is_address(&name)
}

/// Reads a file and makes the layers that are wanted of it; `None` where it cannot be read.
fn read(name: &str, wanted: &WantedLayers<'_>, assets: &Assets) -> Option<SourcesAhead> {
    let bytes = assets.read(name).ok()?;
    let (_, first) = wanted.first_key_value()?;
    let file = LayeredFile::read(name, &bytes, &hints(first))?.ok()?;
    let wanted: Vec<(&LayerKey, &FeatureSource)> =
        wanted.iter().map(|(key, source)| (key, &**source)).collect();
    let layer =
        |(key, source): (&LayerKey, &FeatureSource)| Some((key.clone(), file.layer(&hints(source)).ok()?));
    let layers = wanted.into_par_iter().filter_map(layer).collect();
    Some(SourcesAhead { files: BTreeMap::from([(name.to_owned(), file)]), layers })
}

/// What a source states of its file, of which an extract has no companions and states no system.
fn hints(source: &FeatureSource) -> VectorHints<'_> {
    let layer = source.layer.as_ref().map(|name| name.as_str());
    VectorHints { crs: source.crs.as_ref(), layer, ..VectorHints::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::given_data::GivenData;
    use sandtable_description::parse::parse;
    use std::path::Path;

    const EXTRACT: &str = "<osm><node id='1' lat='48' lon='15'/><node id='2' lat='48' lon='15.1'/>\
        <way id='4'><nd ref='1'/><nd ref='2'/><tag k='highway' v='track'/></way></osm>";

    /// What is read ahead of roads with these keys.
    fn ahead(roads: &[&str]) -> SourcesAhead {
        let tables: String = roads.iter().map(|keys| format!("[[road]]\n{keys}\n")).collect();
        let text = format!("[terrain]\ndem = \"a\"\n{tables}");
        let document = parse("scene.toml", &text).expect("a valid scene");
        let mut given = GivenData::default();
        given.add_file("town.osm", EXTRACT.as_bytes().into());
        given.add_file("town.xml", EXTRACT.as_bytes().into());
        given.add_file("broken.osm", b"<osm><way".as_slice().into());
        let assets = Assets::new(Path::new("scene.toml"), &[]).expect("a folder").with_given(given);
        SourcesAhead::of(&document, &assets)
    }

    #[test]
    fn an_extract_is_read_once_with_each_layer_that_is_taken_of_it() {
        let lines = "file = \"town.osm\"\nlayer = \"lines\"";
        let read = ahead(&[lines, "file = \"town.osm\"\nlayer = \"roads\"", lines]);
        assert_eq!(read.files.keys().collect::<Vec<_>>(), ["town.osm"]);
        assert_eq!(read.layers.values().map(|layer| layer.features.len()).collect::<Vec<_>>(), [1, 1]);
    }

    #[test]
    fn what_is_no_extract_or_broken_is_left_to_be_read_where_it_is_needed() {
        let read = ahead(&[
            "file = \"broken.osm\"\nlayer = \"lines\"",
            "file = \"town.xml\"\nlayer = \"lines\"",
            "file = \"https://a.example/town.osm\"\nlayer = \"lines\"",
            "file = \"missing.pbf\"\nlayer = \"lines\"",
        ]);
        assert!(read.files.is_empty() && read.layers.is_empty());
        let read = ahead(&["file = \"town.osm\"\nlayer = \"nothing\""]);
        assert!(read.layers.is_empty());
    }
}
