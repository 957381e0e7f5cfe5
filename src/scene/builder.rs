//! What the passes over a document gather: features with their ids, what lies and stands, and what there is to say.

use crate::draw::color::Srgba;
use crate::draw::list::FeatureId;
use crate::ribbon::partition;
use crate::ribbon::plan::PlanMesh;
use crate::ribbon::texture::RibbonSurface;
use crate::scene::attributes::DefaultCounts;
use crate::scene::report::SceneReport;
use crate::scene::roads::profiles::RoadProfile;
use crate::scene::{FeatureKind, FeatureSolid, Ribbon, SceneFeature, Solid};
use crate::terrain::triangle_surface::SurfaceTriangle;

/// Features with their ids, and what there is to say about them.
#[derive(Default)]
pub struct SceneBuilder {
    /// What lies on the ground.
    pub ribbons: Vec<Ribbon>,
    /// Every feature so far; ids count from 2.
    pub features: Vec<SceneFeature>,
    /// What has a shape of its own.
    pub solids: Vec<Solid>,
    /// What is set on the displayed ground for every picture.
    pub uprights: Vec<FeatureSolid>,
    /// What one can stand on above the ground: triangles in world space, heights in meters without exaggeration.
    pub decks: Vec<SurfaceTriangle>,
    /// For the user.
    pub notes: Vec<String>,
    /// How often expressions gave no value.
    pub default_counts: DefaultCounts,
    /// What was found out about single features.
    pub report: SceneReport,
    /// Of every road that the ground follows.
    pub profiles: Vec<RoadProfile>,
}

impl SceneBuilder {
    /// Notes a feature and returns its id.
    pub fn add(&mut self, kind: FeatureKind, name: String) -> FeatureId {
        self.features.push(SceneFeature { kind, name });
        FeatureId(FeatureId::GROUND.0 + self.features.len() as u32)
    }

    /// The name of a feature that was added; may be empty.
    pub fn name(&self, feature: FeatureId) -> &str {
        let place = feature.0.checked_sub(FeatureId::GROUND.0 + 1);
        place.and_then(|place| self.features.get(place as usize)).map_or("", |feature| &feature.name)
    }

    /// Lays a plan over what was laid before in its class and below.
    pub fn lay(&mut self, plan: PlanMesh, surface: RibbonSurface, feature: FeatureId) {
        self.lay_tinted(plan, (surface, Srgba::WHITE), feature);
    }

    /// Lays a plan as [`Self::lay`] does, its surface's color and alpha multiplied by a tint.
    pub fn lay_tinted(
        &mut self,
        plan: PlanMesh,
        (surface, tint): (RibbonSurface, Srgba),
        feature: FeatureId,
    ) {
        self.ribbons.push(Ribbon { plan, surface, tint, layer: layer_of(surface), feature });
    }

    /// Takes apart what lies over one another, so that no two ribbons share any ground: what covers what goes by class,
    /// and within a class the junctions come first and then what was laid last.
    pub fn resolve_overlaps(&mut self) {
        let order = |ribbon: &Ribbon| (ribbon.layer, ribbon.surface.is_junction());
        self.ribbons.sort_by_key(order);
        let from_above: Vec<&PlanMesh> = self.ribbons.iter().rev().map(|ribbon| &ribbon.plan).collect();
        let parts = partition::apart(from_above.iter().copied());
        for (ribbon, plan) in self.ribbons.iter_mut().rev().zip(parts) {
            ribbon.plan = plan;
        }
        self.ribbons.retain(|ribbon| !ribbon.plan.triangles.is_empty());
    }
}

/// What covers what, by class: banks over what covers the ground, still water over streams, roads over water, better
/// roads over lesser.
fn layer_of(surface: RibbonSurface) -> u8 {
    match surface {
        RibbonSurface::Cover(_) | RibbonSurface::Border => 0,
        RibbonSurface::Bank => 1,
        RibbonSurface::River | RibbonSurface::Confluence => 2,
        RibbonSurface::Lake => 3,
        // Shoulders are laid before tracks and so lie below them.
        RibbonSurface::Shoulder | RibbonSurface::Track | RibbonSurface::TrackJunction => 4,
        RibbonSurface::Gravel | RibbonSurface::GravelJunction => 5,
        RibbonSurface::Asphalt
        | RibbonSurface::AsphaltSolid
        | RibbonSurface::AsphaltEdges
        | RibbonSurface::AsphaltPlain
        | RibbonSurface::AsphaltJunction => 6,
        RibbonSurface::Trench => 7,
        RibbonSurface::Boundary => 8,
    }
}
