//! The draped features of a scene by patch, so that a flight cuts again only the patches that changed.
//!
//! ```text
//!  ribbons ──────────────────► plans that stay   ─┐
//!                                                 ├─► parts by patch ─► cut to the displayed triangles ─► pieces
//!  line symbols for a camera ► plans of a while  ─┘
//! ```

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::DVec2;

use crate::drapes::{
    BELOW_RIVERS, BELOW_ROADS, RibbonLook, add_material, fill_color, lake_material, sources, tapered,
};
use crate::graphic_lines::{self, LinePlan};
use crate::lake_tint::{LakeTint, longest_lakes};
use crate::line_scale::LineScale;
use crate::markings::faded;
use crate::overlay::GROUND_TINT_LAYER;
use crate::placed_text::PlacedText;
use crate::post_tint::{self, TintPlan};
use crate::symbols::{PlannedSymbol, RibbonShow, planned};
use crate::{analyses, ground, overlay, sight};
use sandtable_draw::color::Srgba;
use sandtable_draw::list::{DepthLayer, DrawList, DrawMesh, FeatureId, MaterialId};
use sandtable_draw::patches::DrapedPiece;
use sandtable_geom::convex;
use sandtable_ribbon::patches::{Borders, Drapes, StalePatch};
use sandtable_ribbon::plan::PlanMesh;
use sandtable_ribbon::texture::RibbonSurface;
use sandtable_roam::graph::Vertex;
use sandtable_roam::patched_ground::PatchedGround;
use sandtable_scene::analyses::SceneAnalysis;
use sandtable_scene::feature_meshes::Ribbon;
use sandtable_scene::scene_model::SceneModel;
use sandtable_scene::symbols::LineSymbol;
use sandtable_terrain::lattice::Lattice;
use sandtable_terrain::sight::viewshed::Viewshed;
use sandtable_terrain::triangle_surface::TriangleSurface;
use sandtable_view::camera::Camera;

/// The scene's ribbons divided along its patches, numbered as [`sandtable_roam::layout::PatchLayout::patches`] lists them;
/// the places of ribbons are those in [`SceneModel::ribbons`].
pub fn drapes(scene: &SceneModel) -> Drapes {
    Drapes::new(&borders(scene.ground().patched()), scene.ribbons.iter().map(|ribbon| &ribbon.plan))
}

/// The borders as f32 has them, where the displayed triangles end.
fn borders(ground: PatchedGround<'_>) -> Borders {
    let layout = ground.layout;
    let (columns, rows) = layout.patch_grid();
    let at =
        |x: usize, y: usize| ground.plan(Vertex::new(x as i32 * layout.patch(), y as i32 * layout.patch()));
    Borders {
        east: (0..=columns).map(|column| f64::from(at(column, 0).x)).collect(),
        north: (0..=rows).map(|row| f64::from(at(0, row).y)).collect(),
    }
}

/// The tint of a viewshed, before it is draped over the ground.
pub struct SeenTint(TintPlan);

impl SeenTint {
    /// The tint of the posts of a viewshed over `lattice`; `None` where no post was examined.
    pub fn new(seen: &Viewshed, lattice: &Lattice) -> Option<Self> {
        sight::seen_tint(seen, lattice).map(Self)
    }
}

/// The sheets of [`GroundSheets`].
pub(super) const SHEETS: usize = 7;

/// The draped features of a walk by patch, and their materials.
#[derive(Default)]
pub struct GroundSheets {
    pub(super) head: DrawList,
    looks: BTreeMap<RibbonLook, MaterialId>,
    pub(super) borders: Borders,
    ribbons: DrapeSheet,
    symbols: DrapeSheet,
    /// Tints of analyses.
    ground_tints: DrapeSheet,
    /// The tint of an analysis that is tried.
    pub(super) tried_tint: DrapeSheet,
    pub(super) tried_material: Option<MaterialId>,
    pub(super) tried: Option<Arc<SceneAnalysis>>,
    /// Tints of sight.
    tints: DrapeSheet,
    /// What a user looks at is seen from a place.
    seen: DrapeSheet,
    seen_material: Option<MaterialId>,
    /// Lines of sight and tactical graphics.
    graphics: DrapeSheet,
    pub(super) graphic_colors: BTreeMap<[u8; 4], MaterialId>,
    texts: Vec<PlacedText>,
    /// The features whose ribbons their symbols take the place of.
    replaced: BTreeSet<FeatureId>,
}

/// Plans in drawing order, cut by patch.
#[derive(Default)]
pub(super) struct DrapeSheet {
    pub drapes: Drapes,
    pub plans: Vec<SheetPlan>,
}

/// How a plan is drawn.
pub(super) struct SheetPlan {
    material: MaterialId,
    markings: Option<MaterialId>,
    layer: u8,
    feature: FeatureId,
}

impl GroundSheets {
    /// The ribbons of a scene, and no symbols yet; nothing is cut. `ground` is the scene's, or an edited one with as many
    /// posts.
    pub fn new(scene: &SceneModel, ground: PatchedGround<'_>) -> Self {
        let mut head = DrawList::default();
        ground::add_material(&mut head);
        let mut sheets = Self { head, borders: borders(ground), ..Self::default() };
        let sources = sources(scene);
        let mut lakes: BTreeMap<FeatureId, LakeTint> =
            longest_lakes(scene, |bounds| Some(bounds.size().max_element()))
                .into_iter()
                .map(|(feature, outline)| (feature, outline.tint()))
                .collect();
        let mut order: Vec<&Ribbon> = scene.ribbons.iter().collect();
        order.sort_by_key(|ribbon| ribbon.layer);
        let tapers: Vec<Option<PlanMesh>> = order
            .iter()
            .map(|ribbon| sources.get(&ribbon.feature).and_then(|symbol| tapered(ribbon, symbol)))
            .collect();
        let mut plans = Vec::with_capacity(order.len());
        let mut shapes: Vec<Cow<'_, PlanMesh>> = Vec::with_capacity(order.len());
        for (ribbon, taper) in order.iter().zip(&tapers) {
            let is_lake = ribbon.surface == RibbonSurface::Lake;
            let lake = if is_lake { lakes.remove(&ribbon.feature) } else { None };
            let shape = taper.as_ref().unwrap_or(&ribbon.plan);
            shapes.push(match &lake {
                Some(lake) => Cow::Owned(lake.laid_over(shape)),
                None => Cow::Borrowed(shape),
            });
            plans.push(sheets.ribbon(ribbon, lake));
        }
        let shapes = shapes.iter().map(|shape| &**shape);
        sheets.ribbons = DrapeSheet { drapes: Drapes::new(&sheets.borders, shapes), plans };
        for symbol in &scene.symbols {
            sheets.material(RibbonLook::Casing(symbol.surface));
            sheets.material(RibbonLook::Fill(symbol.surface, fill_color(symbol)));
        }
        sheets.ground_tints = sheets.tint_sheet(analyses::tints(scene), GROUND_TINT_LAYER);
        sheets.tints = sheets.tint_sheet(sight::tints(scene), post_tint::TINT_LAYER);
        for color in overlay::colors(scene) {
            let material = graphic_lines::add_material(&mut sheets.head, Srgba(color));
            sheets.graphic_colors.insert(color, material);
        }
        sheets
    }

    /// Tints with their materials; they are not cut yet.
    fn tint_sheet(&mut self, tints: Vec<TintPlan>, layer: u8) -> DrapeSheet {
        let (mut plans, mut shapes) = (Vec::new(), Vec::new());
        for TintPlan { plan, color, texture, feature } in tints {
            let material = post_tint::add_material(&mut self.head, color, texture);
            plans.push(SheetPlan::tint(material, layer, feature));
            shapes.push(plan);
        }
        DrapeSheet { drapes: Drapes::new(&self.borders, &shapes), plans }
    }

    /// Whether lines or texts of graphics were planned last, or are to be planned of an analysis that is tried.
    pub fn has_graphics(&self) -> bool {
        self.tried.is_some() || !self.graphics.plans.is_empty() || !self.texts.is_empty()
    }

    /// The texts of tactical graphics, as they were planned last.
    pub fn texts(&self) -> &[PlacedText] {
        &self.texts
    }

    pub(super) fn sheets(&self) -> [&DrapeSheet; SHEETS] {
        let Self { ribbons, symbols, ground_tints, tried_tint, tints, seen, graphics, .. } = self;
        [ribbons, symbols, ground_tints, tried_tint, tints, seen, graphics]
    }

    pub(super) fn sheets_mut(&mut self) -> [&mut DrapeSheet; SHEETS] {
        let Self { ribbons, symbols, ground_tints, tried_tint, tints, seen, graphics, .. } = self;
        [ribbons, symbols, ground_tints, tried_tint, tints, seen, graphics]
    }

    /// Adds the texture of a tint to the materials, before the tint is draped.
    pub fn add_texture(&mut self, SeenTint(tint): &mut SeenTint) {
        let texture = tint.texture.take();
        let known = self.seen_material.and_then(|id| self.head.materials[id.0 as usize].texture);
        match (known, texture) {
            // The tint before lies nowhere any more.
            (Some(id), Some(pixels)) => self.head.textures[id.0 as usize] = pixels,
            (_, texture) => {
                self.seen_material = Some(post_tint::add_material(&mut self.head, tint.color, texture));
            }
        }
    }

    /// Drapes a tint whose texture was added over the ground, or removes the current one. It is not cut yet; returns
    /// the patches in which what lies has changed.
    pub fn lay_tint(&mut self, tint: Option<&SeenTint>) -> Vec<usize> {
        let laid = tint.zip(self.seen_material).map(|(SeenTint(tint), material)| {
            let (layer, feature) = (post_tint::TINT_LAYER, tint.feature);
            let plans = vec![SheetPlan::tint(material, layer, feature)];
            DrapeSheet { drapes: Drapes::new(&self.borders, [&tint.plan]), plans }
        });
        let before = std::mem::replace(&mut self.seen, laid.unwrap_or_default());
        let is_held =
            |&patch: &usize| before.drapes.is_occupied(patch) || self.seen.drapes.is_occupied(patch);
        (0..self.borders.patch_count()).filter(is_held).collect()
    }

    /// The materials of the ground, which is the first, and of all that lies on it, and their textures.
    pub fn head(&self) -> &DrawList {
        &self.head
    }

    /// Whether a patch has draped features.
    pub fn is_occupied(&self, patch: usize) -> bool {
        self.sheets().iter().any(|sheet| sheet.drapes.is_occupied(patch))
    }

    /// Cuts the draped features of the patches in `stale` to the triangles displayed there.
    pub fn recut(&mut self, stale: &[StalePatch], ground: &dyn TriangleSurface) {
        self.sheets_mut().into_iter().for_each(|sheet| sheet.drapes.recut(stale, ground));
    }

    /// Plans the lines of sight and the tactical graphics for an eye that turns around where `camera` is, over the finest
    /// ground. They are not cut yet; returns the patches in which what lies has changed.
    pub fn plan_graphics(&mut self, scene: &SceneModel, camera: &Camera) -> Vec<usize> {
        let (lines, texts) = overlay::planned((scene, self.tried.as_deref()), camera);
        self.texts = texts;
        let (mut plans, mut shapes) = (Vec::new(), Vec::new());
        for LinePlan { plan, color, feature } in lines {
            let Some(&material) = self.graphic_colors.get(&color.0) else { continue };
            plans.push(SheetPlan::tint(material, graphic_lines::LAYER, feature));
            shapes.push(plan);
        }
        let drapes = Drapes::new(&self.borders, &shapes);
        let before = std::mem::replace(&mut self.graphics, DrapeSheet { drapes, plans });
        let is_held =
            |&patch: &usize| before.drapes.is_occupied(patch) || self.graphics.drapes.is_occupied(patch);
        (0..self.borders.patch_count()).filter(is_held).collect()
    }

    /// Plans the symbols of the lines that are too narrow for an eye that turns around where `camera` is. They are not cut
    /// yet; returns the patches in which what lies has changed.
    pub fn plan_symbols(&mut self, scene: &SceneModel, camera: &Camera) -> Vec<usize> {
        let (lines, shows) = planned(scene, camera, LineScale::around(camera));
        let (mut shores, mut rivers, mut roads) = (Vec::new(), Vec::new(), Vec::new());
        // A walk shows bridges as they are, and drapes all symbols.
        for line in lines.into_iter().filter(|line| line.deck.is_none()) {
            match line.symbol.surface {
                RibbonSurface::ShoreLine => shores.push(line),
                RibbonSurface::River => rivers.push(line),
                _ => roads.push(line),
            }
        }
        let (mut plans, mut shapes) = (Vec::new(), Vec::new());
        for (layer, mut lines) in [(BELOW_RIVERS, shores), (BELOW_RIVERS, rivers), (BELOW_ROADS, roads)] {
            lines.sort_by(|a, b| a.symbol.least_px.total_cmp(&b.symbol.least_px));
            let mut fills = Vec::new();
            for PlannedSymbol { symbol, casing, fill, .. } in lines {
                plans.push(self.line(RibbonLook::Casing(symbol.surface), symbol, layer));
                shapes.push(casing);
                fills.push((
                    self.line(RibbonLook::Fill(symbol.surface, fill_color(symbol)), symbol, layer),
                    fill,
                ));
            }
            for (plan, shape) in fills {
                plans.push(plan);
                shapes.push(shape);
            }
        }
        let before = std::mem::replace(
            &mut self.symbols,
            DrapeSheet { drapes: Drapes::new(&self.borders, &shapes), plans },
        );
        let replaced = shows.into_iter().filter(|(_, show)| *show == RibbonShow::Replaced);
        let replaced: BTreeSet<FeatureId> = replaced.map(|(feature, _)| feature).collect();
        let turned: BTreeSet<FeatureId> = replaced.symmetric_difference(&self.replaced).copied().collect();
        self.replaced = replaced;
        let has_turned = |patch: usize| self.ribbons.features(patch).any(|feature| turned.contains(&feature));
        (0..self.borders.patch_count())
            .filter(|&patch| {
                before.drapes.is_occupied(patch)
                    || self.symbols.drapes.is_occupied(patch)
                    || has_turned(patch)
            })
            .collect()
    }

    /// Whether what shows in a patch depends on how far away it is: markings, which fade.
    pub fn fades(&self, patch: usize) -> bool {
        self.ribbons.drapes.in_patch(patch).any(|(plan, _)| self.ribbons.plans[plan].markings.is_some())
    }

    /// The draped features of a patch as they were last cut, in drawing order, with the markings that `camera` sees.
    pub fn pieces(&self, patch: usize, camera: &Camera) -> Vec<DrapedPiece> {
        let scale = LineScale::around(camera);
        let (mut pieces, mut symbols) = (Vec::new(), self.symbols.drapes.in_patch(patch).peekable());
        let ground_tints = [&self.ground_tints, &self.tried_tint]
            .into_iter()
            .flat_map(|sheet| sheet.drapes.in_patch(patch).map(|(at, mesh)| (&sheet.plans[at], mesh)));
        let mut tints = ground_tints.peekable();
        for (at, mesh) in self.ribbons.drapes.in_patch(patch) {
            let plan = &self.ribbons.plans[at];
            while let Some((tint, mesh)) = tints.next_if(|_| plan.layer > GROUND_TINT_LAYER) {
                tint.add(Arc::clone(mesh), &mut pieces);
            }
            while let Some((at, mesh)) = symbols.next_if(|(at, _)| self.symbols.plans[*at].layer < plan.layer)
            {
                self.symbols.plans[at].add(Arc::clone(mesh), &mut pieces);
            }
            if self.replaced.contains(&plan.feature) {
                continue;
            }
            plan.add(Arc::clone(mesh), &mut pieces);
            if let Some(material) = plan.markings {
                plan.add_with(material, Arc::new(faded(mesh, &scale)), &mut pieces);
            }
        }
        tints.for_each(|(tint, mesh)| tint.add(Arc::clone(mesh), &mut pieces));
        symbols.for_each(|(at, mesh)| self.symbols.plans[at].add(Arc::clone(mesh), &mut pieces));
        for sheet in [&self.tints, &self.seen, &self.graphics] {
            let cut = sheet.drapes.in_patch(patch);
            cut.for_each(|(at, mesh)| sheet.plans[at].add(Arc::clone(mesh), &mut pieces));
        }
        pieces
    }

    /// The uppermost draped feature of a patch, as it was last cut, at a world position; `None` for bare ground.
    pub fn feature_at(&self, patch: usize, at: DVec2) -> Option<FeatureId> {
        let holds = |mesh: &DrawMesh| {
            mesh.triangles.iter().any(|corners| {
                let plan = corners.map(|id| {
                    let [x, y, _] = mesh.vertices[id.index()].position;
                    DVec2::new(f64::from(x), f64::from(y))
                });
                convex::contains(&plan, at)
            })
        };
        let of = |sheet: &DrapeSheet, is_symbol: bool| {
            let found = sheet.drapes.in_patch(patch).filter(|(plan, mesh)| {
                (is_symbol || !self.replaced.contains(&sheet.plans[*plan].feature)) && holds(mesh)
            });
            found.last().map(|(plan, _)| ((sheet.plans[plan].layer, is_symbol), sheet.plans[plan].feature))
        };
        let graphics = of(&self.graphics, true).or_else(|| of(&self.tints, true));
        let uppermost = graphics
            .into_iter()
            .chain(
                [
                    of(&self.ribbons, false),
                    of(&self.symbols, true),
                    of(&self.ground_tints, true),
                    of(&self.tried_tint, true),
                ]
                .into_iter()
                .flatten(),
            )
            .max();
        uppermost.map(|(_, feature)| feature)
    }

    /// The largest clearance in meters between the cut features of `patches` and the ground displayed there now.
    pub fn check(&self, patches: &[usize], ground: &dyn TriangleSurface) -> f64 {
        let of = |sheet: &DrapeSheet| sheet.drapes.check_in(&self.borders, patches, ground);
        self.sheets().into_iter().map(of).fold(0.0, f64::max)
    }

    fn ribbon(&mut self, ribbon: &Ribbon, lake: Option<LakeTint>) -> SheetPlan {
        let is_marked = ribbon.surface != ribbon.surface.unmarked();
        let material = match lake {
            Some(lake) => {
                let material = lake_material(&mut self.head, lake.pixels);
                self.head.add_material(material)
            }
            None => self.material(RibbonLook::Textured(ribbon.surface.unmarked(), ribbon.tint.0)),
        };
        let markings = is_marked.then(|| self.material(RibbonLook::Markings(ribbon.surface)));
        SheetPlan { material, markings, layer: ribbon.layer, feature: ribbon.feature }
    }

    fn line(&mut self, look: RibbonLook, symbol: &LineSymbol, layer: u8) -> SheetPlan {
        SheetPlan { material: self.material(look), markings: None, layer, feature: symbol.feature }
    }

    fn material(&mut self, look: RibbonLook) -> MaterialId {
        let head = &mut self.head;
        *self.looks.entry(look).or_insert_with(|| add_material(head, look))
    }
}

impl DrapeSheet {
    fn features(&self, patch: usize) -> impl Iterator<Item = FeatureId> {
        self.drapes.held(patch).map(|plan| self.plans[plan].feature)
    }
}

impl SheetPlan {
    /// A tint.
    pub(super) fn tint(material: MaterialId, layer: u8, feature: FeatureId) -> Self {
        Self { material, markings: None, layer, feature }
    }

    fn add(&self, mesh: Arc<DrawMesh>, pieces: &mut Vec<DrapedPiece>) {
        self.add_with(self.material, mesh, pieces);
    }

    fn add_with(&self, material: MaterialId, mesh: Arc<DrawMesh>, pieces: &mut Vec<DrapedPiece>) {
        if !mesh.triangles.is_empty() {
            let layer = DepthLayer::Draped(self.layer);
            pieces.push(DrapedPiece { mesh, material, layer, feature: self.feature });
        }
    }
}
