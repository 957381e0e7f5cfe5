//! The features of a scene: what each is, what it is called, and where it comes from.

use crate::feature_origin::FeatureOrigin;
use sandtable_base::message::suggest::quoted;

/// The kind of a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FeatureKind {
    /// A lake.
    Lake,
    /// A river or stream.
    River,
    /// A road.
    Road,
    /// A bridge.
    Bridge,
    /// A tunnel.
    Tunnel,
    /// A ground cover.
    Area,
    /// A building.
    Building,
    /// A fence, wall, power line or another line.
    Fence,
    /// A model.
    Model,
    /// Models scattered over areas: one feature per table.
    Scattered,
    /// A tactical graphic.
    Graphic,
    /// A viewshed, lines of sight or a range.
    Sight,
    /// What the ground allows.
    Analysis,
}

/// The noun of each kind for one feature and for several, in the order of summaries.
pub(crate) const FEATURE_NOUNS: [(FeatureKind, &str, &str); 13] = [
    (FeatureKind::Lake, "lake", "lakes"),
    (FeatureKind::River, "river", "rivers"),
    (FeatureKind::Road, "road", "roads"),
    (FeatureKind::Bridge, "bridge", "bridges"),
    (FeatureKind::Tunnel, "tunnel", "tunnels"),
    (FeatureKind::Area, "area", "areas"),
    (FeatureKind::Building, "building", "buildings"),
    (FeatureKind::Fence, "line", "lines"),
    (FeatureKind::Model, "model", "models"),
    (FeatureKind::Scattered, "scatter of models", "scatters of models"),
    (FeatureKind::Graphic, "tactical graphic", "tactical graphics"),
    (FeatureKind::Sight, "layer of sight", "layers of sight"),
    (FeatureKind::Analysis, "analysis", "analyses"),
];

impl FeatureKind {
    /// Its noun for a count of one, or of several.
    pub fn noun(self, count: usize) -> &'static str {
        let (_, one, several) = FEATURE_NOUNS[self as usize];
        if count == 1 { one } else { several }
    }
}

/// One feature of the scene: one road line, one lake polygon, one model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneFeature {
    /// What it is.
    pub kind: FeatureKind,
    /// Its name; may be empty.
    pub name: String,
    /// Where it comes from.
    pub origin: FeatureOrigin,
}

impl SceneFeature {
    /// The name of the feature in messages: its kind with its name, or with its number in its file.
    pub fn described(&self) -> String {
        let kind = self.kind.noun(1);
        match (self.name.as_str(), self.origin.number) {
            ("", Some(number)) => format!("{kind} {number} of its file"),
            ("", None) => described(kind, ""),
            (name, _) => format!("{kind} '{}'", quoted(name)),
        }
    }
}

/// A feature in a note; many have no name.
pub fn described(kind: &str, name: &str) -> String {
    match name {
        "" if kind.starts_with(['a', 'e', 'i', 'o', 'u']) => format!("an {kind} without a name"),
        "" => format!("a {kind} without a name"),
        _ => format!("{kind} '{name}'"),
    }
}
