//! CityJSON as people write it, and as nobody should.

use super::*;
use crate::cityjson::body::SurfaceRole;
use crate::read as vector_file;
use glam::DVec2;
use serde_json::json;

/// A box of 4 × 3 × 2 m in millimeters, with a gable's worth of semantics, in two levels of detail.
fn house() -> Value {
    let faces = json!([
        [[0, 3, 2, 1]],
        [[4, 5, 6, 7]],
        [[0, 1, 5, 4]],
        [[1, 2, 6, 5]],
        [[2, 3, 7, 6]],
        [[3, 0, 4, 7]]
    ]);
    json!({
        "type": "CityJSON", "version": "1.1",
        "transform": {"scale": [0.001, 0.001, 0.001], "translate": [85000.0, 447000.0, 10.0]},
        "metadata": {"referenceSystem": "https://www.opengis.net/def/crs/EPSG/0/7415"},
        "CityObjects": {
            "b": {"type": "Building", "attributes": {"name": "Hall", "storeys": 2}, "children": ["p"]},
            "p": {"type": "BuildingPart", "parents": ["b"], "attributes": {"storeys": 1}, "geometry": [
                {"type": "MultiSurface", "lod": 1, "boundaries": [[[0, 3, 2, 1]]]},
                {"type": "Solid", "lod": "2.2", "boundaries": [faces],
                 "semantics": {"surfaces": [{"type": "GroundSurface"}, {"type": "RoofSurface"}, {"type": "WallSurface"}],
                               "values": [[0, 1, 2, 2, 2, null]]},
                 "material": {"day": {"values": [[null, 0, null, null, null, null]]}}}
            ]}
        },
        "appearance": {"materials": [{"name": "tiles", "diffuseColor": [1.0, 0.5, 0.0]}]},
        "vertices": [[0,0,0],[4000,0,0],[4000,3000,0],[0,3000,0],[0,0,2000],[4000,0,2000],[4000,3000,2000],[0,3000,2000]]
    })
}

fn read_value(value: &Value) -> Result<(VectorLayer, CityModel), VectorError> {
    read(value.to_string().as_bytes(), &VectorHints::default())
}

fn model(value: &Value) -> Result<CityModel, VectorError> {
    read_value(value).map(|(_, model)| model)
}

#[test]
fn an_object_is_a_footprint_with_its_own_attributes_and_those_of_its_parents() {
    let read = vector_file::read("a.city.json", house().to_string().as_bytes(), &VectorHints::default());
    let layer = read.expect("CityJSON");
    assert_eq!(layer.crs.epsg(), Some(7415), "RD New and NAP");
    let [part] = &layer.features[..] else { panic!("{:?}", layer.features) };
    assert_eq!(part.properties["name"], "Hall");
    assert_eq!(part.properties["storeys"], 1);
    assert_eq!(part.properties["type"], "BuildingPart");
    assert_eq!(part.properties["parent"], "b");
    assert_eq!(part.properties["lod"], "2.2");
    let ring = &part.polygons()[0].exterior;
    assert_eq!(ring.len(), 4);
    assert!(ring.contains(&DVec2::new(85_004.0, 447_003.0)));
    assert_eq!(part.elevations.as_deref(), Some(&[10.0; 4][..]));
    assert!(layer.notes.is_empty() && layer.faults.is_empty(), "{:?} {:?}", layer.notes, layer.faults);
}

#[test]
fn surfaces_have_their_roles_and_materials_in_each_level_of_detail() {
    let model = model(&house()).expect("CityJSON");
    let part = &model.objects["p"];
    assert_eq!((part.root.as_str(), part.bodies.len()), ("b", 2));
    let body = part.body(None).expect("the highest");
    assert_eq!(body.lod, "2.2");
    let roles: Vec<_> = body.surfaces.iter().map(|surface| surface.role).collect();
    let [ground, roof, wall] = [SurfaceRole::Ground, SurfaceRole::Roof, SurfaceRole::Wall].map(Some);
    assert_eq!(roles, [ground, roof, wall, wall, wall, None]);
    assert_eq!(body.surfaces[1].color, Some([255, 128, 0]));
    assert_eq!(body.surfaces[2].color, None);
    let area: f64 = body.surfaces.iter().map(|surface| surface.doubled_area().length() / 2.0).sum();
    assert!((area - 52.0).abs() < 1e-6, "{area}");
    assert_eq!(part.body(Some("1")).expect("exact").lod, "1");
    assert_eq!(part.body(Some("2.1")).expect("the next below").lod, "1");
    assert_eq!(part.body(Some("0")).expect("the lowest").lod, "1");
}

#[test]
fn templates_are_placed_turned_and_scaled() {
    let mut value = house();
    value["geometry-templates"] = json!({
        "templates": [{"type": "MultiSurface", "lod": "2", "boundaries": [[[0, 1, 2]]]}],
        "vertices-templates": [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    });
    value["CityObjects"] = json!({"tree": {"type": "SolitaryVegetationObject", "geometry": [{
        "type": "GeometryInstance", "template": 0, "boundaries": [6],
        "transformationMatrix": [0.0, -2.0, 0.0, 10.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.5, 0.0, 0.0, 0.0, 1.0]
    }]}});
    let model = model(&value).expect("CityJSON");
    let ring = &model.objects["tree"].bodies[0].surfaces[0].rings[0];
    let anchor = DVec3::new(85_004.0, 447_003.0, 12.0);
    let wanted = [(10.0, 0.0, 0.5), (10.0, 2.0, 0.5), (8.0, 0.0, 0.5)].map(|at| anchor + DVec3::from(at));
    assert!(ring.iter().zip(wanted).all(|(at, wanted)| at.distance(wanted) < 1e-9), "{ring:?}");
}

#[test]
fn a_sequence_has_an_object_on_its_first_line_and_features_on_the_others() {
    let mut head = house();
    let mut feature = house();
    head["CityObjects"] = json!({});
    head["vertices"] = json!([]);
    feature["type"] = json!("CityJSONFeature");
    feature["id"] = json!("b");
    for member in ["transform", "metadata", "version", "appearance"] {
        feature.as_object_mut().expect("an object").remove(member);
    }
    let text = format!("{head}\n{feature}\n{{\"type\":\n");
    let (layer, model) = read(text.as_bytes(), &VectorHints::default()).expect("a sequence");
    assert_eq!(layer.features.len(), 1);
    assert_eq!(
        model.objects["p"].bodies[1].surfaces[1].color,
        Some([255, 128, 0]),
        "by the head's materials"
    );
    assert!(layer.faults[0].contains("line 3"), "{:?}", layer.faults);
    let alone = read(feature.to_string().as_bytes(), &VectorHints::default()).expect_err("alone");
    assert!(alone.to_string().contains("first line of its sequence"), "{alone}");
}

#[test]
fn textures_have_a_place_in_their_picture_for_every_vertex() {
    let mut value = house();
    value["appearance"]["textures"] = json!([{"type": "PNG", "image": "wall.png"}]);
    value["appearance"]["vertices-texture"] = json!([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    value["CityObjects"]["p"]["geometry"][1]["texture"] = json!({"day": {"values":
        [[[[null]], [[null]], [[0, 0, 1, 2, 3]], [[null]], [[null]], [[null]]]]}});
    let read = model(&value).expect("CityJSON");
    let body = read.objects["p"].body(None).expect("a body");
    assert_eq!(read.images, ["wall.png"]);
    let texture = body.surfaces[2].texture.as_ref().expect("textured");
    assert_eq!((texture.image, texture.places[0][2]), (0, DVec2::new(1.0, 1.0)));
    assert!(body.surfaces[3].texture.is_none());
    value["appearance"]["textures"] = json!([]);
    let (layer, model) = read_value(&value).expect("without its picture");
    assert!(model.objects["p"].body(None).expect("a body").surfaces[2].texture.is_none());
    assert!(layer.notes[0].contains("1 ring without the texture"), "{:?}", layer.notes);
}

#[test]
fn an_object_that_is_wrong_is_left_out_and_told() {
    for (pointer, wrong, reason) in [
        (
            "/CityObjects/p/geometry/0/boundaries",
            json!([[[0, 3, 99, 1]]]),
            "names vertex 99, and there are 8",
        ),
        ("/CityObjects/p/geometry/0/type", json!("Sphere"), "type 'Sphere' is unknown"),
        ("/CityObjects/p/geometry/0/boundaries", json!([[[0, -3, 9, 1]]]), "integer `-3`"),
        ("/CityObjects/p/geometry", json!(7), "invalid type"),
        ("/vertices/2", json!([1, 2]), "line 1"),
    ] {
        let mut value = house();
        *value.pointer_mut(pointer).expect("there") = wrong;
        let error = model(&value).expect_err(reason).to_string();
        assert!(error.contains(reason), "{error}");
        value["CityObjects"]["other"] = json!({"type": "Building", "geometry": [
            {"type": "MultiSurface", "lod": "1", "boundaries": [[[0, 3, 2, 1]]]}]});
        if pointer.starts_with("/CityObjects") {
            let (layer, _) = read_value(&value).expect("the other is sound");
            assert_eq!(layer.features.len(), 1);
            assert!(layer.faults[0].contains("city object 'p'"), "{:?}", layer.faults);
        }
    }
    let mut value = house();
    value["metadata"] = json!({});
    assert!(model(&value).expect_err("no system").to_string().contains("the key 'crs'"));
}

#[test]
fn parents_that_name_each_other_end() {
    let mut value = house();
    value["CityObjects"]["b"]["parents"] = json!(["p"]);
    assert_eq!(model(&value).expect("read").objects.len(), 1);
}

#[test]
fn templates_cannot_multiply_without_end() {
    let mut tally = ShapeTally { vertices_left: 10, lost_textures: 0 };
    let nested =
        serde_json::from_str("[[[0, 1, 2]], [[0, 1, 2]], [[0, 1, 2]], [[0, 1, 2]]]").expect("nested");
    let geometry = GeometryText {
        kind: "MultiSurface".into(),
        lod: None,
        boundaries: nested,
        semantics: None,
        material: BTreeMap::new(),
        texture: BTreeMap::new(),
        template: None,
        matrix: None,
    };
    let (vertices, appearance, templates) =
        ([DVec3::ZERO; 3], CityAppearance::default(), Templates::default());
    let referred =
        Referred { vertices: &vertices, appearance: &appearance, first_image: 0, templates: &templates };
    let refused = body::shapes(&geometry, &referred, &mut tally).err().expect("too many");
    assert!(refused.contains("design-vertices"), "{refused}");
}
