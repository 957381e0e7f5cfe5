//! What is read of a vector file: the key by which its layers are told apart.

use sandtable_description::feature_source::FeatureSource;
use sandtable_description::stated::Stated;

/// A file's name, and the layer, the system and the columns stated for it.
pub(super) type LayerKey = (String, Option<String>, Option<String>, Vec<(String, String)>);

/// The key of what `source` has of its `file`.
pub(super) fn layer_key(file: &Stated<String>, source: &FeatureSource) -> LayerKey {
    let columns = source.columns.iter().flat_map(|columns| columns.iter());
    (
        file.to_string(),
        source.layer.as_ref().map(|name| name.to_string()),
        source.crs.as_ref().map(|crs| crs.name().to_owned()),
        columns.map(|(role, name)| (role.clone(), name.clone())).collect(),
    )
}
