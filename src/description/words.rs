//! The words a scene file may choose from, as types.

/// A key's value that is one of a few words.
pub trait Word: Copy + Sized + 'static {
    /// Every word with what it means, in the order in which messages list them.
    const ALL: &'static [(&'static str, Self)];
}

/// What a road is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Surface {
    /// `asphalt`: paved.
    #[default]
    Asphalt,
    /// `gravel`: a made road without a seal.
    Gravel,
    /// `track`: worn, not made.
    Track,
}

impl Word for Surface {
    const ALL: &'static [(&'static str, Self)] =
        &[("asphalt", Self::Asphalt), ("gravel", Self::Gravel), ("track", Self::Track)];
}

/// How a model's height is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Clamp {
    /// `ground`: its lowest point stands on the ground.
    #[default]
    Ground,
    /// `relative`: its origin is `height` metres above the ground.
    Relative,
    /// `absolute`: its origin is at elevation `height`.
    Absolute,
}

impl Word for Clamp {
    const ALL: &'static [(&'static str, Self)] =
        &[("ground", Self::Ground), ("relative", Self::Relative), ("absolute", Self::Absolute)];
}

/// What a label names; decides its type and symbol.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum LabelKind {
    /// `summit`.
    Summit,
    /// `place`: a town, a farm.
    #[default]
    Place,
    /// `water`: a river or lake.
    Water,
    /// `point`: anything else.
    Point,
}

impl Word for LabelKind {
    const ALL: &'static [(&'static str, Self)] =
        &[("summit", Self::Summit), ("place", Self::Place), ("water", Self::Water), ("point", Self::Point)];
}

/// A built-in colour ramp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Ramp {
    /// `atlas`: green lowland over yellow and brown to white.
    #[default]
    Atlas,
    /// `desert`: sand over red rock.
    Desert,
    /// `grey`: dark to light.
    Grey,
}

impl Word for Ramp {
    const ALL: &'static [(&'static str, Self)] =
        &[("atlas", Self::Atlas), ("desert", Self::Desert), ("grey", Self::Grey)];
}

/// What the colours of a PNG mean in metres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum HeightEncoding {
    /// `terrain-rgb`: Mapbox's.
    TerrainRgb,
    /// `terrarium`: Mapzen's.
    Terrarium,
}

impl Word for HeightEncoding {
    const ALL: &'static [(&'static str, Self)] =
        &[("terrain-rgb", Self::TerrainRgb), ("terrarium", Self::Terrarium)];
}
