//! Models, each set where it stands.

use rayon::prelude::*;

use crate::draw::list::{DrawList, DrawMesh, Layer};
use crate::draw::material::Material;
use crate::scene::footprint::Footprint;
use crate::scene::kind::{Placement, Scene};
use crate::scene::picture::add_mesh;
use crate::scene::picture::detail::{self, Placed, Viewer};
use crate::scene::stand::{Grounds, stand};
use crate::terrain::facets::Facets;
use crate::terrain::finest::Finest;

/// Adds every placement that has ground under it and may be seen, and the plinths.
pub(super) fn add(list: &mut DrawList, scene: &Scene, displayed: &dyn Facets, viewer: Viewer<'_>) {
    let finest = Finest { lattice: &scene.terrain.lattice, exaggeration: scene.terrain.exaggeration };
    let grounds = Grounds { displayed, finest };
    let footprints: Vec<Footprint> = scene.models.iter().map(Footprint::of).collect();
    let set = |placement: &Placement| -> Option<(Placed, Option<DrawMesh>)> {
        let footprint = &footprints[placement.model];
        let stand = stand(placement, footprint, &grounds)?;
        let Placement { model, feature, .. } = *placement;
        let plinth = stand.plinth(placement, footprint, &grounds);
        Some((Placed { model, world_from_model: stand.world_from_model, feature }, plinth))
    };
    let (placed, plinths): (Vec<Placed>, Vec<Option<DrawMesh>>) =
        scene.placements.par_iter().filter_map(set).unzip();
    let mut concrete = None;
    for (block, placed) in
        plinths.into_iter().zip(&placed).filter_map(|(block, placed)| Some((block?, placed)))
    {
        let material = *concrete.get_or_insert_with(|| {
            list.add_material(Material { name: "concrete".into(), ..Material::default() })
        });
        add_mesh(list, block, material, Layer::Solid, placed.feature);
    }
    detail::add(list, scene, &placed, viewer);
}
