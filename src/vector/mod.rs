//! Lines, polygons and points with properties: what maps are made of, one file per format.

pub mod feature;
