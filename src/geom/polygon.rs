//! Polygons with holes: the one door to `geo`.
