//! The output of the passes over a document: features with their ids, ribbons, solids, findings and reports.

use rayon::prelude::*;

use crate::attributes::DefaultCounts;
use crate::build_errors::BuildErrorSink;
use crate::feature::{FeatureKind, SceneFeature};
use crate::feature_meshes::{FeatureSolid, Ribbon, Solid};
use crate::feature_origin::FeatureOrigin;
use crate::report::SceneReport;
use crate::roads::profiles::{BridgeProfile, RoadProfile};
use crate::scene_findings::SceneFindings;
use crate::scene_graphic::SceneGraphic;
use crate::symbols::LineSymbol;
use crate::tag_notes::TagNotes;
use crate::water::culvert::Culvert;
use crate::water::lake_level::LakeSurface;
use sandtable_draw::color::Srgba;
use sandtable_draw::list::FeatureId;
use sandtable_draw::pixels::Pixels;
use sandtable_ribbon::partition;
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_terrain::triangle_surface::SurfaceTriangle;

/// The plans of ribbons that a thread keeps in one go.
const PLANS: usize = 64;

/// The features of a scene so far, with their meshes, findings and reports.
pub struct SceneBuilder {
    /// Meshes draped on the ground.
    pub ribbons: Vec<Ribbon>,
    /// Roads and rivers as lines.
    pub symbols: Vec<LineSymbol>,
    /// Tactical graphics.
    pub graphics: Vec<SceneGraphic>,
    /// Every feature so far; ids count from 2.
    pub features: Vec<SceneFeature>,
    /// Solids with fixed heights.
    pub solids: Vec<Solid>,
    /// Pictures on solids.
    pub pictures: Vec<Pixels>,
    /// Solids that each picture sets on its displayed ground.
    pub uprights: Vec<FeatureSolid>,
    /// Decks above the ground for height queries: triangles in world space, true heights in meters.
    pub decks: Vec<SurfaceTriangle>,
    /// Lakes with their levels.
    pub lakes: Vec<LakeSurface>,
    /// Reaches of rivers in culverts.
    pub culverts: Vec<Culvert>,
    /// The findings so far, for the user.
    pub findings: SceneFindings,
    /// The errors so far, each of which keeps the scene from being built.
    pub errors: BuildErrorSink,
    /// The number of expressions without a value, by key and default.
    pub default_counts: DefaultCounts,
    /// Properties that tables read by themselves and that were guessed at or not understood.
    pub tag_notes: TagNotes,
    /// Measures of single features.
    pub report: SceneReport,
    /// The longitudinal profile of every road that the ground follows.
    pub profiles: Vec<RoadProfile>,
    /// The longitudinal profile of every bridge.
    pub bridge_profiles: Vec<BridgeProfile>,
}

impl SceneBuilder {
    /// An empty scene with the findings so far.
    pub fn new(findings: SceneFindings) -> Self {
        Self {
            ribbons: Vec::new(),
            symbols: Vec::new(),
            graphics: Vec::new(),
            features: Vec::new(),
            solids: Vec::new(),
            pictures: Vec::new(),
            uprights: Vec::new(),
            decks: Vec::new(),
            lakes: Vec::new(),
            culverts: Vec::new(),
            errors: BuildErrorSink::new(findings.source()),
            findings,
            default_counts: DefaultCounts::new(),
            tag_notes: TagNotes::default(),
            report: SceneReport::default(),
            profiles: Vec::new(),
            bridge_profiles: Vec::new(),
        }
    }

    /// Adds a feature and returns its id.
    pub fn add(&mut self, kind: FeatureKind, name: String, origin: FeatureOrigin) -> FeatureId {
        let feature = FeatureId::of_index(self.features.len());
        self.features.push(SceneFeature { kind, name, origin });
        feature
    }

    /// The feature of an id; `None` for the ground and beyond the last.
    pub fn feature(&self, id: FeatureId) -> Option<&SceneFeature> {
        self.features.get(id.index()?)
    }

    /// The name of a feature; may be empty.
    pub fn name(&self, feature: FeatureId) -> &str {
        self.feature(feature).map_or("", |feature| &feature.name)
    }

    /// Adds a ribbon over those of its class and below.
    pub fn lay(&mut self, plan: PlanMesh, surface: RibbonSurface, feature: FeatureId) {
        self.lay_tinted(plan, (surface, Srgba::WHITE), feature);
    }

    /// As [`Self::lay`], with the surface's color and alpha multiplied by a tint.
    pub fn lay_tinted(
        &mut self,
        plan: PlanMesh,
        (surface, tint): (RibbonSurface, Srgba),
        feature: FeatureId,
    ) {
        self.ribbons.push(Ribbon { plan, surface, tint, layer: layer_of(surface), feature });
    }

    /// Clips ribbons by those that cover them, so that no two share any ground. Classes cover one another in the order of
    /// `layer_of`; within a class junctions cover roads, and later ribbons earlier ones.
    pub fn resolve_overlaps(&mut self) {
        let order = |ribbon: &Ribbon| (ribbon.layer, ribbon.surface.is_junction());
        self.ribbons.sort_by_key(order);
        let from_above: Vec<&PlanMesh> = self.ribbons.iter().rev().map(|ribbon| &ribbon.plan).collect();
        let parts = partition::apart(from_above.iter().copied());
        let whole = self.ribbons.par_iter_mut().rev().with_min_len(PLANS);
        whole.zip(parts).for_each(|(ribbon, plan)| {
            ribbon.plan = plan;
            ribbon.plan.vertices.shrink_to_fit();
            ribbon.plan.triangles.shrink_to_fit();
        });
        self.ribbons.retain(|ribbon| !ribbon.plan.triangles.is_empty());
    }
}

/// The class of a surface; a higher class covers a lower.
fn layer_of(surface: RibbonSurface) -> u8 {
    match surface {
        RibbonSurface::Cover(_) | RibbonSurface::CoverEdge(_) | RibbonSurface::Border => 0,
        RibbonSurface::Bank | RibbonSurface::ShoreLine => 1,
        RibbonSurface::River
        | RibbonSurface::Confluence
        | RibbonSurface::Rapids
        | RibbonSurface::Falls
        | RibbonSurface::Bar => 2,
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
