"""A small program as a user writes it, for the type checkers; it also runs."""

import numpy as np
import sandtable as st
from numpy.typing import NDArray


def seen_share(dem: st.Dem, observer: tuple[float, float]) -> float:
    seen: st.Raster = dem.viewshed(observer, range=2_000.0, crs="EPSG:4326")
    looked_at: NDArray[np.bool_] = seen.array != seen.nodata
    return float((seen.array[looked_at] == 1).mean())


def main() -> None:
    dem = st.Dem.open("assets/jacksboro/dem.tif")
    xy = np.array([[-84.21, 36.28], [-84.20, 36.30]])
    heights: NDArray[np.float64] = dem.heights(xy, "planar", crs=4326)
    sight: st.LineOfSight = dem.line_of_sight((-84.21, 36.28), (-84.20, 36.30), crs=4326)
    clearance: float | None = sight.clearance
    profile: st.Profile = dem.profile(xy, crs=4326)
    image: NDArray[np.uint8] = st.Scene.open("scenes/road.toml").render("front", size=(64, 36))
    try:
        st.Scene.open("scenes/missing.toml")
    except st.SandtableError as error:
        places: list[tuple[str | None, int | None]] = [(finding.file, finding.line) for finding in error.findings]
        print(error.file, places)
    print(heights.round(), clearance, profile.length, image.shape, seen_share(dem, (-84.21, 36.28)))


if __name__ == "__main__":
    main()
