//! The answer to a height query: a height, or the reason why there is none.

/// A height, or why there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    /// The height, true to scale: in meters, or as a sample of a raster in the raster's vertical unit.
    Height(f64),
    /// The position lies on the model, where it holds no data.
    NoData,
    /// The position lies outside the model, or is not finite.
    Outside,
}

/// The status of a height, in a slice parallel to the heights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    /// The height is valid.
    #[default]
    Ok,
    /// The position lies on the model, where it holds no data; the height is NaN.
    NoData,
    /// The position lies outside the model; the height is NaN.
    Outside,
}

impl Status {
    /// `Ok`, `NoData` or `Outside`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "Ok",
            Self::NoData => "NoData",
            Self::Outside => "Outside",
        }
    }

    /// The answer of this status and the height beside it.
    pub fn with_height(self, height: f64) -> Answer {
        match self {
            Self::Ok => Answer::Height(height),
            Self::NoData => Answer::NoData,
            Self::Outside => Answer::Outside,
        }
    }
}

impl Answer {
    /// The answer of a sample, which is NaN where the raster holds no data.
    pub fn from_sample(value: f64) -> Self {
        if value.is_nan() { Self::NoData } else { Self::Height(value) }
    }

    /// The height, where there is one.
    pub fn height_m(self) -> Option<f64> {
        match self {
            Self::Height(height) => Some(height),
            Self::NoData | Self::Outside => None,
        }
    }

    /// `Ok`, `NoData` or `Outside`.
    pub fn status(self) -> &'static str {
        self.kind().name()
    }

    /// The status alone.
    pub fn kind(self) -> Status {
        match self {
            Self::Height(_) => Status::Ok,
            Self::NoData => Status::NoData,
            Self::Outside => Status::Outside,
        }
    }

    /// The height, NaN where there is none, and the status beside it.
    pub fn parts(self) -> (f64, Status) {
        (self.height_m().unwrap_or(f64::NAN), self.kind())
    }
}
