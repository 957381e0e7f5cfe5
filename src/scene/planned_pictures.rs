//! What a scene is built for, as far as that decides how many samples of its elevation are read.

/// How many samples of the elevation a scene needs.
#[derive(Clone, Copy, Debug)]
pub enum ElevationNeed<'a> {
    /// All: heights are answered from them.
    All,
    /// All that fit into the memory, for pictures and meshes that are not known yet.
    AllThatFit,
    /// As many as pictures show, for these and for nothing else.
    Pictures(&'a PlannedPictures),
}

/// The pictures that a scene is built for.
#[derive(Clone, Debug, Default)]
pub struct PlannedPictures {
    /// What they are seen by.
    pub cameras: PlannedCameras,
    /// Their greatest size, pixels; `None` for that of each camera's paper, or of a screen.
    pub size: Option<(u32, u32)>,
}

/// The cameras of planned pictures.
#[derive(Clone, Debug, Default)]
pub enum PlannedCameras {
    /// The first of the scene.
    #[default]
    First,
    /// The one of this name.
    Named(String),
    /// All.
    All,
    /// None of the scene: plans of any part of the ground whose pixels are so many meters wide.
    Plans(f64),
}
