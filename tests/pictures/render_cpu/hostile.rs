//! Lists no sound program makes: they are refused in words or drawn without harm.

use glam::{Mat4, Vec3};
use proptest::prelude::*;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{
    DepthLayer, DrawList, DrawListError, DrawMesh, DrawVertex, FeatureId, MaterialId,
};
use sandtable_draw::material::{AlphaMode, Material};
use sandtable_draw::pixels::Pixels;
use sandtable_mesh::sink::{MeshSink, VertexId};
use sandtable_render::cpu::{CpuRenderError, RenderQuality, SampleCount, render};

use crate::render_cpu::landscape::{BOX, draped_material, ground_map, ground_material, ground_mesh, item};
use crate::render_cpu::{count, northward, shot, wall};

fn triangle(corners: [[f32; 3]; 3]) -> DrawMesh {
    let mut mesh = DrawMesh::default();
    let uv = [f32::NAN, f32::MAX];
    let ids = corners
        .map(|position| mesh.vertex(DrawVertex { position, normal: [f32::NAN; 3], uv, color: Srgba::WHITE }));
    mesh.triangle(ids);
    mesh
}

#[test]
fn triangles_with_a_corner_that_is_not_finite_are_left_out() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut list = DrawList::default();
        let mesh = triangle([[-1.0, 5.0, -1.0], [1.0, 5.0, bad], [0.0, 5.0, 1.0]]);
        item(&mut list, mesh, Material { two_sided: true, ..Material::default() }, DepthLayer::Solid, BOX);
        assert_eq!(count(&shot(&list, &northward((40, 30))), FeatureId::NONE), 40 * 30);
    }
}

#[test]
fn a_triangle_of_astronomic_size_through_the_near_plane_is_not_nearer_than_it() {
    let mut list = DrawList::default();
    let mesh = triangle([[0.0, -16.2, 0.0], [4.4, 0.0, -1.2e13], [0.0, 2e36, 0.0]]);
    item(&mut list, mesh, Material { two_sided: true, ..Material::default() }, DepthLayer::Solid, BOX);
    let picture = shot(&list, &crate::render_cpu::looking(Vec3::new(0.0, -15.0, 1.0), Vec3::ZERO, (67, 41)));
    assert!(picture.depth_m.iter().all(|&depth| depth > 0.499));
}

#[test]
fn a_matrix_that_is_not_finite_hides_its_item() {
    let mut list = DrawList::default();
    item(
        &mut list,
        wall(5.0, [-1.0, 1.0], [-1.0, 1.0], Srgba::WHITE),
        Material::default(),
        DepthLayer::Solid,
        BOX,
    );
    list.items[0].world_from_mesh = Mat4::NAN;
    assert_eq!(count(&shot(&list, &northward((40, 30))), FeatureId::NONE), 40 * 30);
}

#[test]
fn a_wall_as_wide_as_numbers_go_covers_the_picture() {
    for reach in [1e6, 1e12, 1e30] {
        let mut list = DrawList::default();
        let mesh = wall(5.0, [-reach, reach], [-reach, reach], Srgba::WHITE);
        item(&mut list, mesh, Material::default(), DepthLayer::Solid, BOX);
        assert_eq!(count(&shot(&list, &northward((70, 130))), BOX), 70 * 130, "{reach:e}");
    }
}

#[test]
fn textures_without_pixels_and_triangles_without_area_do_no_harm() {
    let mut list = DrawList::default();
    let texture = Some(list.add_texture(Pixels::filled(0, 0, Srgba::WHITE)));
    for alpha in [AlphaMode::Opaque, AlphaMode::Mask(f32::NAN), AlphaMode::Blend] {
        let material = Material { texture, alpha, ..Material::default() };
        let mesh = wall(5.0, [-1.0, 1.0], [-1.0, 1.0], Srgba::WHITE);
        item(&mut list, mesh, material.clone(), DepthLayer::Solid, BOX);
        item(&mut list, triangle([[0.0, 5.0, 0.0]; 3]), material, DepthLayer::Solid, BOX);
    }
    assert!(count(&shot(&list, &northward((40, 30))), BOX) > 0);
}

#[test]
fn lists_that_are_not_sound_are_refused_with_a_reason() {
    let camera = northward((40, 30));
    let refused = |list: &DrawList| render(list, &camera, &RenderQuality::default()).expect_err("not sound");
    let mut list = DrawList::default();
    item(
        &mut list,
        wall(5.0, [-1.0, 1.0], [-1.0, 1.0], Srgba::WHITE),
        ground_material(),
        DepthLayer::Solid,
        BOX,
    );
    assert_eq!(refused(&list), CpuRenderError::List(DrawListError::MissingGroundMap(0)));

    let mut bare = list.clone();
    let mut map = ground_map(5, 10.0, false, |_, _| 0.0);
    map.columns = u32::MAX;
    bare.ground = Some(map.into());
    assert!(matches!(refused(&bare), CpuRenderError::List(_)));

    let mut dangling = list.clone();
    dangling.items[0].material = MaterialId(9);
    assert!(matches!(refused(&dangling), CpuRenderError::List(_)));

    let mut pointing = list;
    pointing.meshes[0].triangles[0][1] = VertexId(99);
    assert!(matches!(refused(&pointing), CpuRenderError::List(_)));
}

#[test]
fn ground_maps_of_one_post_or_one_row_can_be_read() {
    for (columns, rows) in [(1, 1), (7, 1), (1, 6), (2, 3)] {
        let mut map = ground_map(7, 10.0, true, |_, _| 5.0);
        (map.columns, map.rows) = (columns, rows);
        map.posts.truncate((columns * rows) as usize);
        let mut list = DrawList { ground: Some(map.into()), ..DrawList::default() };
        let mesh = ground_mesh(2, 10.0, |_, y| -3.0 + 0.1 * y);
        item(&mut list, mesh, ground_material(), DepthLayer::Ground, FeatureId::GROUND);
        assert!(count(&shot(&list, &northward((40, 30))), FeatureId::GROUND) > 100);
    }
}

fn any_coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![3 => -20.0f32..20.0, 1 => any::<f32>(), 1 => Just(0.0)]
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 300,
        failure_persistence: None,
        rng_seed: proptest::test_runner::RngSeed::Fixed(1),
        ..ProptestConfig::default()
    })]

    #[test]
    fn any_triangles_are_drawn_without_harm(
        corners in prop::collection::vec(prop::array::uniform3(prop::array::uniform3(any_coordinate())), 1..8),
        blends in any::<bool>(),
        draped in any::<bool>(),
    ) {
        let mut list = DrawList { ground: Some(ground_map(3, 5.0, true, |x, _| x).into()), ..DrawList::default() };
        let alpha = if blends { AlphaMode::Blend } else { AlphaMode::Opaque };
        for corners in corners {
            let base = if draped { draped_material(Srgba([9, 9, 9, 99])) } else { Material::default() };
            let material = Material { two_sided: true, alpha, ..base };
            let layer = if draped { DepthLayer::Draped(3) } else { DepthLayer::Solid };
            item(&mut list, triangle(corners), material, layer, BOX);
        }
        let camera = crate::render_cpu::looking(Vec3::new(0.0, -15.0, 1.0), Vec3::ZERO, (67, 41));
        for samples in [SampleCount::One, SampleCount::Eight] {
            let options = RenderQuality { samples, anisotropy: u32::MAX };
            let picture = render(&list, &camera, &options).expect("indices are sound");
            prop_assert!(picture.depth_m.iter().all(|&depth| depth >= 0.5 * 0.999));
        }
    }
}
