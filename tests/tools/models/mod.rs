//! The project's own models, built from boxes, beams and polygons, and written as real files.
//!
//! Meters, Z up, the ground at z = 0, the origin at the middle of the footprint, the front toward −Y.

mod bridge;
mod farmhouse;
mod firtree;
mod shape;
mod tent;
mod truck;
mod watchtower;
mod write_3ds;
mod write_glb;
mod write_obj;

/// All files, by name.
pub fn files() -> Vec<(&'static str, Vec<u8>)> {
    let house = farmhouse::build();
    let tree = firtree::build();
    vec![
        ("watchtower.3ds", write_3ds::write(&watchtower::build(), &[])),
        ("farmhouse.obj", write_obj::objects(&house, "farmhouse.mtl")),
        ("farmhouse.mtl", write_obj::library(&house)),
        ("farmhouse_walls.png", shape::png(&farmhouse::walls())),
        ("bridge.glb", write_glb::write(&bridge::build())),
        ("tent.glb", write_glb::write(&tent::build())),
        ("firtree.obj", write_obj::objects(&tree, "firtree.mtl")),
        ("firtree.mtl", write_obj::library(&tree)),
        ("truck.3ds", write_3ds::write(&truck::build(), &truck::wheels())),
    ]
}
