//! The words a scene file may choose from, as types.

/// A key's value that is one of a few words.
pub trait Word: Copy + Sized + 'static {
    /// Every word with what it means, in the order in which messages list them.
    const ALL: &'static [(&'static str, Self)];
}

/// What a road is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RoadSurface {
    /// `asphalt`: paved.
    #[default]
    Asphalt,
    /// `gravel`: a made road without a seal.
    Gravel,
    /// `track`: worn, not made.
    Track,
}

impl Word for RoadSurface {
    const ALL: &'static [(&'static str, Self)] =
        &[("asphalt", Self::Asphalt), ("gravel", Self::Gravel), ("track", Self::Track)];
}

/// How a model's height is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Clamp {
    /// `ground`: its lowest point stands on the ground.
    #[default]
    Ground,
    /// `relative`: its origin is `height` meters above the ground.
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

/// A built-in color ramp.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RampName {
    /// `atlas`: green lowland over yellow and brown to white.
    #[default]
    Atlas,
    /// `desert`: sand over red rock.
    Desert,
    /// `gray`: dark to light.
    Gray,
}

impl Word for RampName {
    const ALL: &'static [(&'static str, Self)] =
        &[("atlas", Self::Atlas), ("desert", Self::Desert), ("gray", Self::Gray)];
}

/// What the colors of a PNG mean in meters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum HeightEncodingWord {
    /// `terrain-rgb`: Mapbox's.
    TerrainRgb,
    /// `terrarium`: Mapzen's.
    Terrarium,
}

impl Word for HeightEncodingWord {
    const ALL: &'static [(&'static str, Self)] =
        &[("terrain-rgb", Self::TerrainRgb), ("terrarium", Self::Terrarium)];
}

/// How two segments of a road meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Join {
    /// `miter`: both edges go on until they meet.
    #[default]
    Miter,
    /// `bevel`: the outer corner is cut off.
    Bevel,
    /// `round`: the outer corner is an arc.
    Round,
}

impl Word for Join {
    const ALL: &'static [(&'static str, Self)] =
        &[("miter", Self::Miter), ("bevel", Self::Bevel), ("round", Self::Round)];
}

/// The lines on a paved road.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Markings {
    /// `dashed`: edge lines and a dashed center line.
    #[default]
    Dashed,
    /// `solid`: edge lines and a solid center line.
    Solid,
    /// `edges`: edge lines only.
    Edges,
    /// `none`: no lines.
    None,
}

impl Word for Markings {
    const ALL: &'static [(&'static str, Self)] =
        &[("dashed", Self::Dashed), ("solid", Self::Solid), ("edges", Self::Edges), ("none", Self::None)];
}

/// Which of road and ground follows the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ProfileMode {
    /// `drape`: the road follows the ground.
    #[default]
    Drape,
    /// `conform`: the ground follows the road.
    Conform,
}

impl Word for ProfileMode {
    const ALL: &'static [(&'static str, Self)] = &[("drape", Self::Drape), ("conform", Self::Conform)];
}

/// Where a river's water lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Water {
    /// `falls`: its level never rises downstream, and the ground is cut to it.
    #[default]
    Falls,
    /// `drape`: it lies on the ground as it is.
    Drape,
}

impl Word for Water {
    const ALL: &'static [(&'static str, Self)] = &[("falls", Self::Falls), ("drape", Self::Drape)];
}

/// Which height along its shore is a lake's level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum LevelRule {
    /// `lowest`: the lowest.
    #[default]
    Lowest,
    /// `median`: the middle one.
    Median,
    /// `mean`: the mean.
    Mean,
}

impl Word for LevelRule {
    const ALL: &'static [(&'static str, Self)] =
        &[("lowest", Self::Lowest), ("median", Self::Median), ("mean", Self::Mean)];
}

/// What an area is covered with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Cover {
    /// `forest`: trees.
    Forest,
    /// `scrub`: bushes.
    Scrub,
    /// `meadow`: grass.
    Meadow,
    /// `field`: crops in rows.
    Field,
    /// `orchard`: fruit trees or vines in rows.
    Orchard,
    /// `wetland`: marsh.
    Wetland,
    /// `sand`: sand or beach.
    Sand,
    /// `rock`: bare rock.
    Rock,
    /// `built-up`: houses and yards.
    BuiltUp,
    /// `industry`: halls and yards.
    Industry,
    /// `restricted`: hatched: what may not be entered.
    Restricted,
}

impl Word for Cover {
    const ALL: &'static [(&'static str, Self)] = &[
        ("forest", Self::Forest),
        ("scrub", Self::Scrub),
        ("meadow", Self::Meadow),
        ("field", Self::Field),
        ("orchard", Self::Orchard),
        ("wetland", Self::Wetland),
        ("sand", Self::Sand),
        ("rock", Self::Rock),
        ("built-up", Self::BuiltUp),
        ("industry", Self::Industry),
        ("restricted", Self::Restricted),
    ];
}

/// The line along an area's outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Border {
    /// `none`: no line.
    None,
    /// `solid`: an unbroken line.
    Solid,
    /// `dashed`: dashes.
    Dashed,
}

impl Word for Border {
    const ALL: &'static [(&'static str, Self)] =
        &[("none", Self::None), ("solid", Self::Solid), ("dashed", Self::Dashed)];
}

/// Which ground a building stands on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BaseRule {
    /// `lowest`: the lowest under its footprint.
    #[default]
    Lowest,
    /// `mean`: the mean under its footprint.
    Mean,
    /// `highest`: the highest under its footprint.
    Highest,
    /// `pad`: the ground is leveled to its mean.
    Pad,
}

impl Word for BaseRule {
    const ALL: &'static [(&'static str, Self)] =
        &[("lowest", Self::Lowest), ("mean", Self::Mean), ("highest", Self::Highest), ("pad", Self::Pad)];
}

/// The shape of a roof.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RoofShape {
    /// `flat`: level.
    #[default]
    Flat,
    /// `gabled`: two slopes and two gables.
    Gabled,
    /// `hipped`: four slopes.
    Hipped,
    /// `pyramidal`: slopes that meet in one point.
    Pyramidal,
}

impl Word for RoofShape {
    const ALL: &'static [(&'static str, Self)] = &[
        ("flat", Self::Flat),
        ("gabled", Self::Gabled),
        ("hipped", Self::Hipped),
        ("pyramidal", Self::Pyramidal),
    ];
}

/// What stands or runs along a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum FenceKind {
    /// `fence`: posts and rails.
    #[default]
    Fence,
    /// `wall`: masonry.
    Wall,
    /// `hedge`: a row of bushes.
    Hedge,
    /// `power-line`: pylons and sagging wires.
    PowerLine,
    /// `trench`: a trench with a parapet.
    Trench,
    /// `obstacles`: a belt of obstacles.
    Obstacles,
    /// `boundary`: a dashed line on the ground.
    Boundary,
}

impl Word for FenceKind {
    const ALL: &'static [(&'static str, Self)] = &[
        ("fence", Self::Fence),
        ("wall", Self::Wall),
        ("hedge", Self::Hedge),
        ("power-line", Self::PowerLine),
        ("trench", Self::Trench),
        ("obstacles", Self::Obstacles),
        ("boundary", Self::Boundary),
    ];
}

/// Which ground counts as the ground a model stands on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Anchor {
    /// `origin`: that under its origin.
    #[default]
    Origin,
    /// `lowest`: the lowest under its footprint.
    Lowest,
    /// `highest`: the highest under its footprint.
    Highest,
    /// `mean`: the mean under its footprint.
    Mean,
}

impl Word for Anchor {
    const ALL: &'static [(&'static str, Self)] = &[
        ("origin", Self::Origin),
        ("lowest", Self::Lowest),
        ("highest", Self::Highest),
        ("mean", Self::Mean),
    ];
}

/// What fills the gap between a model and the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Footing {
    /// `none`: nothing.
    #[default]
    None,
    /// `plinth`: a block down to the ground.
    Plinth,
    /// `pad`: the ground is leveled.
    Pad,
}

impl Word for Footing {
    const ALL: &'static [(&'static str, Self)] =
        &[("none", Self::None), ("plinth", Self::Plinth), ("pad", Self::Pad)];
}
