//! The key of a pipeline within a pass: depth rule, source of corners, what the shader reads.

use crate::parts::ShaderParts;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum DepthRule {
    /// Drawn where nearer; writes its depth.
    Solid,
    /// Blended where nearer; writes no depth.
    Blend,
    /// Blended where not farther by more than the drape tolerance; writes no depth.
    Drape,
    /// Lines blended where not farther than a little behind; writes no depth.
    Lines,
    /// Drawn where nothing has written its depth; writes none.
    Sky,
    /// Writes its depth where nearer, and no color.
    DepthOnly,
    /// Drawn where something has written its depth; writes none.
    Seen,
}

/// The source of the corners that a vertex shader reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum VertexSource {
    /// Many items, in world space.
    Merged,
    /// What lies on patches of ground, in world space.
    Draped,
    /// A mesh, placed by instances.
    Placed,
    /// Positions of bare ground.
    Patch,
    /// None: the shader makes them.
    None,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct PipelineKey {
    pub source: VertexSource,
    pub rule: DepthRule,
    pub two_sided: bool,
    /// Whether alpha cuts holes.
    pub masked: bool,
    /// Whether a texture is read.
    pub textured: bool,
    /// None where the color is not drawn.
    pub parts: ShaderParts,
}

impl PipelineKey {
    pub const SKY: Self = Self {
        source: VertexSource::None,
        rule: DepthRule::Sky,
        two_sided: true,
        masked: false,
        textured: false,
        parts: ShaderParts::NONE,
    };

    /// Bare ground by patches.
    pub const PATCH: Self = Self {
        source: VertexSource::Patch,
        rule: DepthRule::Solid,
        two_sided: false,
        masked: false,
        textured: false,
        parts: ShaderParts::NONE,
    };

    /// The depth of bare ground by patches.
    pub const PATCH_DEPTHS: Self = Self { rule: DepthRule::DepthOnly, ..Self::PATCH };

    /// The color of bare ground whose depth is drawn.
    pub const GROUND_PIXELS: Self = Self { rule: DepthRule::Seen, ..Self::SKY };

    /// The edges of bare ground by patches.
    pub const PATCH_LINES: Self = Self { rule: DepthRule::Lines, two_sided: true, ..Self::PATCH };

    /// This key with parts of the shading.
    pub fn with_parts(self, parts: ShaderParts) -> Self {
        Self { parts, ..self }
    }
}
