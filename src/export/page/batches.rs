//! Groups the items of a page into few draw calls: a city has a hundred thousand walls and a dozen materials.
//!
//! Items that are placed by the identity and alike in material and layer are one batch, whose vertices name their
//! feature. Items that differ in placement and feature only are one batch drawn many times. Draped batches keep their order,
//! which says what lies over what.

use std::collections::BTreeMap;

use glam::{Mat4, Vec3};
use serde_json::{Value, json};

use crate::page::container::PageSections;
use sandtable_draw::list::{DepthLayer, DrawItem, DrawList, DrawMesh, DrawVertex, FeatureId, MaterialId};
use sandtable_draw::material::{Albedo, AlphaMode, Material, NormalSource, TextureWrap};
use sandtable_mesh::sink::VertexId;
use sandtable_picture::all_round::ItemShown;

/// Parts of a meter in positions of line symbols, and of a texture in texture coordinates: finer ones are not seen, and
/// take most of a page.
const SYMBOL_PARTS: f32 = 16.0;
const TEXTURE_PARTS: f32 = 2048.0;

/// The key under which items become one batch; layers, then the order in which a draped material first comes.
type BatchKey = (DepthLayer, ItemShown, MaterialId);

/// Items as batches, in drawing order. `shown` says of each item when it is shown.
pub fn batches(sections: &mut PageSections, list: &DrawList, shown: &[ItemShown]) -> Vec<Value> {
    let mut merged: Vec<(BatchKey, MergedMesh)> = Vec::new();
    let mut solids: BTreeMap<BatchKey, usize> = BTreeMap::new();
    let mut repeated = Vec::new();
    for run in list.runs() {
        let items = &list.items[run.clone()];
        let first = &items[0];
        if first.triangles.is_empty() {
            continue;
        }
        let range_of_run = shown[run.start];
        let is_form = matches!(range_of_run, ItemShown::Form(_));
        if items.len() > 1 || is_form || first.world_from_mesh != Mat4::IDENTITY {
            repeated.push((items, range_of_run));
            continue;
        }
        let key = (first.layer, range_of_run, first.material);
        let open = match first.layer {
            DepthLayer::Solid => solids.get(&key).copied(),
            _ => merged.len().checked_sub(1).filter(|&last| merged[last].0 == key),
        };
        let index = open.unwrap_or_else(|| {
            merged.push((key, MergedMesh::default()));
            solids.insert(key, merged.len() - 1);
            merged.len() - 1
        });
        merged[index].1.add(&list.meshes[first.mesh.0 as usize], first);
    }
    let mut batches = Vec::new();
    for ((layer, range, material), mesh) in &merged {
        let mut batch = mesh.write(sections, &list.materials[material.0 as usize], *layer, *range);
        batch["material"] = json!(material.0);
        batch["layer"] = json!(layer_word(*layer));
        note_range(&mut batch, *range);
        batches.push(batch);
    }
    for (items, range) in repeated {
        let mut batch = repeated_batch(sections, list, items);
        note_range(&mut batch, range);
        batches.push(batch);
    }
    batches
}

fn note_range(batch: &mut Value, range: ItemShown) {
    match range {
        ItemShown::Always => {}
        ItemShown::Band(band) => batch["band"] = json!(band),
        ItemShown::Table => batch["table"] = json!(true),
        ItemShown::Form(form) => batch["form"] = json!(form),
    }
}

fn layer_word(layer: DepthLayer) -> &'static str {
    match layer {
        DepthLayer::Ground => "ground",
        DepthLayer::Draped(_) => "draped",
        DepthLayer::Solid => "solid",
    }
}

/// Meshes with their features, as one.
#[derive(Default)]
struct MergedMesh {
    vertices: Vec<DrawVertex>,
    features: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

impl MergedMesh {
    /// Adds the triangles of an item, and of the mesh's vertices those that they use.
    fn add(&mut self, mesh: &DrawMesh, item: &DrawItem) {
        let mut numbers = vec![u32::MAX; mesh.vertices.len()];
        for corners in &mesh.triangles[item.triangles.start as usize..item.triangles.end as usize] {
            let corners = corners.map(|id: VertexId| {
                let number = &mut numbers[id.index()];
                if *number == u32::MAX {
                    *number = self.vertices.len() as u32;
                    self.vertices.push(mesh.vertices[id.index()]);
                    self.features.push(item.feature.0);
                }
                *number
            });
            self.triangles.push(corners);
        }
    }

    fn write(
        &self,
        sections: &mut PageSections,
        material: &Material,
        layer: DepthLayer,
        range: ItemShown,
    ) -> Value {
        let rounded = |value: f32, parts: f32| (value * parts).round() / parts;
        let is_symbol = matches!(range, ItemShown::Band(_));
        let place = |value: f32| if is_symbol { rounded(value, SYMBOL_PARTS) } else { value };
        let positions: Vec<f32> =
            self.vertices.iter().flat_map(|vertex| vertex.position.map(place)).collect();
        let is_uniform = self.features.windows(2).all(|pair| pair[0] == pair[1]);
        let mut batch = json!({
            "vertices": self.vertices.len(),
            "positions": sections.add_floats(&positions, 3),
            "triangles": sections.add_words(self.triangles.as_flattened(), 3),
            "feature": self.features.first(),
        });
        if !is_uniform {
            batch["features"] = sections.add_words(&self.features, 1);
        }
        if layer != DepthLayer::Ground && material.albedo == Albedo::Surface {
            if material.texture.is_some() || is_symbol {
                let part = |value: f32| rounded(value, TEXTURE_PARTS);
                let uvs: Vec<f32> = self.vertices.iter().flat_map(|vertex| vertex.uv.map(part)).collect();
                batch["uvs"] = sections.add_floats(&uvs, 2);
            }
            let first = self.vertices.first().map(|vertex| vertex.color);
            if self.vertices.iter().all(|vertex| Some(vertex.color) == first) {
                batch["color"] = json!(first.map(|color| color.0));
            } else {
                let colors: Vec<u8> = self.vertices.iter().flat_map(|vertex| vertex.color.0).collect();
                batch["colors"] = sections.add_bytes(&colors, 4);
            }
        }
        if material.normals == NormalSource::Vertex {
            let normals: Vec<u8> =
                self.vertices.iter().flat_map(|vertex| packed_normal(vertex.normal)).collect();
            batch["normals"] = sections.add_bytes(&normals, 3);
        }
        batch
    }
}

/// A normal in three signed bytes; 0 where the triangle's own counts.
fn packed_normal(normal: [f32; 3]) -> [u8; 3] {
    Vec3::from(normal).normalize_or_zero().to_array().map(|part| (part * 127.0).round() as i8 as u8)
}

/// The batch of items that differ in placement and feature only.
fn repeated_batch(sections: &mut PageSections, list: &DrawList, items: &[DrawItem]) -> Value {
    let first = &items[0];
    let mut mesh = MergedMesh::default();
    mesh.add(&list.meshes[first.mesh.0 as usize], &DrawItem { feature: FeatureId::NONE, ..first.clone() });
    let mut batch =
        mesh.write(sections, &list.materials[first.material.0 as usize], first.layer, ItemShown::Always);
    // Three rows of four: rotation, scale and translation.
    let rows = |item: &DrawItem| {
        let rows = item.world_from_mesh.transpose();
        [rows.x_axis, rows.y_axis, rows.z_axis].map(|row| row.to_array())
    };
    let places: Vec<f32> = items.iter().flat_map(rows).flatten().collect();
    let features: Vec<u32> = items.iter().map(|item| item.feature.0).collect();
    batch["places"] = sections.add_floats(&places, 12);
    batch["placeFeatures"] = sections.add_words(&features, 1);
    batch["count"] = json!(items.len());
    batch["material"] = json!(first.material.0);
    batch["layer"] = json!(layer_word(first.layer));
    batch
}

fn wrap_word(wrap: TextureWrap) -> &'static str {
    match wrap {
        TextureWrap::Repeat => "repeat",
        TextureWrap::Mirror => "mirror",
        TextureWrap::Clamp => "clamp",
    }
}

/// A material as the page's script reads it; colors in linear light.
pub fn material(material: &Material) -> Value {
    let alpha = match material.alpha {
        AlphaMode::Opaque => json!({"mode": "opaque"}),
        AlphaMode::Mask(cutoff) => json!({"mode": "mask", "cutoff": cutoff.max(0.0)}),
        AlphaMode::Blend => json!({"mode": "blend"}),
    };
    json!({
        "color": material.base_color.linear().extend(material.base_color.alpha()).to_array(),
        "texture": material.texture.map(|texture| texture.0),
        "wrap": material.texture_wrap.map(wrap_word),
        "alpha": alpha,
        "twoSided": material.two_sided,
        "onGround": material.normals == NormalSource::Ground,
        "groundMap": material.albedo == Albedo::GroundMap,
        "hatching": material.albedo == Albedo::Hatching,
        "isWater": material.is_water,
        "isNatural": material.is_natural,
        "area": material.area.map(|area| area.uniform().as_flattened().to_vec()),
        "shadows": material.receives_shadows,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::container::tests::words;
    use sandtable_draw::color::Srgba;
    use sandtable_mesh::sink::MeshSink;
    use sandtable_terrain::stop_flag::StopFlag;

    #[test]
    fn a_material_says_how_its_texture_goes_on_beyond_its_borders() {
        let texture_wrap = [TextureWrap::Mirror, TextureWrap::Clamp];
        let mirrored = material(&Material { texture_wrap, ..Material::default() });
        assert_eq!(mirrored["wrap"], json!(["mirror", "clamp"]));
        assert_eq!(material(&Material::default())["wrap"], json!(["repeat", "repeat"]));
    }

    fn triangle(x: f32) -> DrawMesh {
        let mut mesh = DrawMesh::default();
        let ids = [[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]].map(|position| {
            mesh.vertex(DrawVertex { position, normal: [0.0, 0.0, 1.0], uv: [0.0; 2], color: Srgba::WHITE })
        });
        mesh.triangle(ids);
        mesh
    }

    #[test]
    fn walls_of_one_material_are_one_batch_and_equal_trees_are_another() {
        let mut list = DrawList::default();
        let materials = [0, 1].map(|_| list.add_material(Material::default()));
        let mut add = |x: f32, material: MaterialId, at: f32, feature: u32| {
            let mesh = list.add_mesh(triangle(x));
            let world_from_mesh = Mat4::from_translation(Vec3::X * at);
            let (layer, feature) = (DepthLayer::Solid, FeatureId(feature));
            list.items.push(DrawItem { mesh, triangles: 0..1, material, world_from_mesh, layer, feature });
        };
        for (x, material, feature) in [(0.0, 0, 5), (9.0, 1, 6), (20.0, 0, 7)] {
            add(x, materials[material], 0.0, feature);
        }
        add(0.0, materials[0], 3.0, 8);
        let tree = list.items[3].clone();
        list.items.push(DrawItem { feature: FeatureId(9), ..tree });
        let mut sections = PageSections::default();
        let batches = batches(&mut sections, &list, &vec![ItemShown::Always; list.items.len()]);
        let sections = sections.finish(&StopFlag::default());
        let counts: Vec<_> = batches.iter().map(|batch| (&batch["vertices"], &batch["count"])).collect();
        let null = Value::Null;
        assert_eq!(counts, [(&json!(6), &null), (&json!(3), &null), (&json!(3), &json!(2))]);
        assert_eq!(words(&sections, &batches[0]["features"]), [5, 5, 5, 7, 7, 7]);
        assert_eq!(words(&sections, &batches[0]["triangles"]), [0, 1, 2, 3, 4, 5]);
        assert_eq!(words(&sections, &batches[2]["placeFeatures"]), [8, 9]);
    }
}
