//! The members of a CityJSON text that are read (CityJSON 1.0.3, 1.1.3 and 2.0.1).
//!
//! City objects and their geometries stay as text until each is read by itself, so that one odd object does not cost the
//! others.

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde_json::Value;
use serde_json::value::RawValue;

use crate::cityjson::boundary::Nested;

/// A `CityJSON` object or, in a sequence, a `CityJSONFeature`.
#[derive(Deserialize)]
pub(super) struct CityText<'a> {
    #[serde(rename = "type")]
    pub kind: String,
    pub version: Option<Value>,
    pub transform: Option<VertexTransform>,
    pub metadata: Option<CityMetadata>,
    #[serde(rename = "CityObjects", default, borrow)]
    pub objects: InOrder<&'a RawValue>,
    #[serde(default)]
    pub vertices: Vec<[f64; 3]>,
    #[serde(default)]
    pub appearance: CityAppearance,
    #[serde(rename = "geometry-templates", borrow)]
    pub templates: Option<TemplatesText<'a>>,
}

/// Vertices are whole numbers: `scale` times those plus `translate` are coordinates.
#[derive(Clone, Copy, Deserialize)]
pub(super) struct VertexTransform {
    pub scale: [f64; 3],
    pub translate: [f64; 3],
}

#[derive(Deserialize)]
pub(super) struct CityMetadata {
    #[serde(rename = "referenceSystem")]
    pub reference_system: Option<String>,
}

#[derive(Default, Deserialize)]
pub(super) struct CityAppearance {
    #[serde(default)]
    pub materials: Vec<MaterialText>,
    #[serde(default)]
    pub textures: Vec<TextureText>,
    #[serde(rename = "vertices-texture", default)]
    pub texture_vertices: Vec<[f64; 2]>,
    #[serde(rename = "default-theme-material")]
    pub material_theme: Option<String>,
    #[serde(rename = "default-theme-texture")]
    pub texture_theme: Option<String>,
}

#[derive(Deserialize)]
pub(super) struct MaterialText {
    #[serde(rename = "diffuseColor")]
    pub diffuse: Option<[f64; 3]>,
}

#[derive(Deserialize)]
pub(super) struct TextureText {
    pub image: String,
}

#[derive(Deserialize)]
pub(super) struct TemplatesText<'a> {
    #[serde(borrow)]
    pub templates: Vec<&'a RawValue>,
    #[serde(rename = "vertices-templates")]
    pub vertices: Vec<[f64; 3]>,
}

#[derive(Deserialize)]
pub(super) struct ObjectText<'a> {
    #[serde(rename = "type")]
    pub kind: String,
    #[serde(default)]
    pub attributes: Option<serde_json::Map<String, Value>>,
    #[serde(default)]
    pub parents: Option<Vec<String>>,
    #[serde(default, borrow)]
    pub geometry: Option<Vec<&'a RawValue>>,
}

#[derive(Deserialize)]
pub(super) struct GeometryText {
    #[serde(rename = "type")]
    pub kind: String,
    pub lod: Option<Value>,
    pub boundaries: Nested,
    pub semantics: Option<SemanticsText>,
    #[serde(default)]
    pub material: BTreeMap<String, MaterialUse>,
    #[serde(default)]
    pub texture: BTreeMap<String, TextureUse>,
    pub template: Option<usize>,
    #[serde(rename = "transformationMatrix")]
    pub matrix: Option<[f64; 16]>,
}

#[derive(Deserialize)]
pub(super) struct SemanticsText {
    pub surfaces: Vec<SemanticSurface>,
    pub values: Option<Nested>,
}

#[derive(Deserialize)]
pub(super) struct SemanticSurface {
    #[serde(rename = "type")]
    pub kind: String,
}

/// Materials of the surfaces one by one, or one for all.
#[derive(Deserialize)]
pub(super) struct MaterialUse {
    pub values: Option<Nested>,
    pub value: Option<usize>,
}

#[derive(Deserialize)]
pub(super) struct TextureUse {
    pub values: Option<Nested>,
}

/// The members of an object in the text's order.
pub(super) struct InOrder<T>(pub Vec<(String, T)>);

impl<T> Default for InOrder<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de: 'a, 'a> Deserialize<'de> for InOrder<&'a RawValue> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(InOrderVisitor(PhantomData))
    }
}

struct InOrderVisitor<'a>(PhantomData<&'a ()>);

impl<'de: 'a, 'a> Visitor<'de> for InOrderVisitor<'a> {
    type Value = InOrder<&'a RawValue>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Self::Value, A::Error> {
        let mut list = Vec::new();
        while let Some(member) = members.next_entry::<String, &'a RawValue>()? {
            list.push(member);
        }
        Ok(InOrder(list))
    }
}

/// Whether a text is a CityJSON object or feature; of a sequence, its first.
pub(crate) fn is_cityjson(text: &[u8]) -> bool {
    #[derive(Deserialize)]
    struct CityHead {
        #[serde(rename = "type")]
        kind: String,
    }
    let Ok(all) = std::str::from_utf8(text) else { return false };
    // A look for the word first: no other JSON is parsed for this.
    all.starts_with('{')
        && all.contains("\"CityJSON")
        && serde_json::Deserializer::from_str(all)
            .into_iter::<CityHead>()
            .next()
            .and_then(Result::ok)
            .is_some_and(|head| head.kind == "CityJSON" || head.kind == "CityJSONFeature")
}
