"""Draws places beside what else draws them: the same ground, by the same camera, in pairs to be judged point by point.

    python3 tests/tools/side_by_side.py PROGRAM DATA OUT [--place NAME,…] [--reference NAME,…] [--size 960x540]

PROGRAM is a build of sandtable; DATA the folder of test data; OUT a folder for the pictures. `new` makes the scene of each place,
untouched, and its first camera is that of all references:

| reference | what it is | needs |
|---|---|---|
| cycles | Blender's path tracer, soft sun and sky, a cut block on a table | bpy |
| pyvista | VTK with ambient occlusion | pyvista |
| gmt | `grdview`, illuminated from the north-west; its own parallel view from the same side | gmt |
| rayshader | its recipe: spherical shading, rays to a low sun, ambient shade, draped | numpy |

Needs numpy, rasterio and pillow; a reference that is not at hand is named and left out. OUT gets PLACE.png, PLACE-REFERENCE.png and
PLACE-beside-REFERENCE.png, and `pairs.md`, a table of what to judge: relief, tint, light, water, ground, names, symbols and
composition, with figures of the ground's lightness and color on both.
"""

import argparse
import json
import math
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy
import rasterio
from PIL import Image, ImageDraw
from rasterio.enums import Resampling
from rasterio.transform import from_origin
from rasterio.warp import reproject, transform_bounds

PLACES = {
    "monaco": ("scenes/monaco/N43E007.hgt.zip", ["scenes/monaco/monaco.osm.gz"]),
    "swellendam": (
        "scenes/swellendam_za/dem_srtm_utm33s_i16.tif",
        [f"scenes/swellendam_za/{name}.shp" for name in ("rivers", "water", "places")],
    ),
    "taunton": ("scenes/taunton_uk/dtm.tif", [f"scenes/taunton_uk/{name}.shp" for name in ("buildings", "trees", "lines")]),
    "porto_alegre": ("scenes/porto_alegre_br/poa_elevation.tif", ["scenes/porto_alegre_br/poa_osm.pbf"]),
    "red_butte": (
        "scenes/redbutte_us/red_butte_dem.tif",
        [f"scenes/redbutte_us/red_butte_{name}.geojson" for name in ("reservoir", "road", "rna")],
    ),
    "crater_lake": ("scenes/crater_lake_bt/crater.bt", []),
    "saint_helens": ("dem/SainteHelens.dem", []),
    "big_tujunga": ("dem/bigtujunga_utm11_i16_tiled.tif", []),
    "boulder": ("dem/boulder_SRTMGL3.asc", []),
    "zion": ("dem/zion_srtm_u16_deflate.tif", []),
}

# Systems of files that state none.
SYSTEMS = {"boulder": "EPSG:4326"}

JUDGED = ["relief", "tint", "light", "water", "ground", "names", "symbols", "composition"]

# The most posts along the longer side of a reference's ground.
POSTS = 700

# Hypsometric tints after Patterson, from low to high: the same for every reference.
RAMP = [
    (0.0, (120, 158, 106)), (0.18, (156, 182, 124)), (0.38, (206, 206, 150)), (0.56, (216, 190, 138)),
    (0.74, (190, 156, 118)), (0.90, (172, 150, 134)), (1.0, (226, 220, 212)),
]

SUN_AZIMUTH_DEG, SUN_ALTITUDE_DEG = 315, 40


class Ground:
    """Heights as drawn, in meters, with the place of the north-western post; NaN where there are none."""

    def __init__(self, heights, west, north, cell):
        self.heights, self.west, self.north, self.cell = heights, west, north, cell

    @property
    def colors(self):
        """The ramp over the heights, 0 to 1, linear in sRGB."""
        low, high = numpy.nanmin(self.heights), numpy.nanmax(self.heights)
        share = (self.heights - low) / max(high - low, 1e-9)
        stops, tints = zip(*RAMP)
        share = numpy.nan_to_num(share)
        return numpy.stack([numpy.interp(share, stops, [tint[i] / 255 for tint in tints]) for i in range(3)], -1)


def run(*command):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stderr.strip()}")
    return done.stdout


def draw_ours(program, data, out, name, size):
    """The scene's folder and the sidecar of its first picture."""
    dem, vectors = PLACES[name]
    folder = out / "scenes" / name
    shutil.rmtree(folder, ignore_errors=True)
    options = [option for vector in vectors for option in ("--vectors", data / vector)]
    if name in SYSTEMS:
        options += ["--crs", SYSTEMS[name]]
    run(program, "new", folder, "--dem", data / dem, *options)
    picture = out / f"{name}.png"
    run(program, "render", folder / "scene.toml", "--allow", data, "--size", size, "--sidecar", "-o", picture)
    return folder, json.loads(picture.with_suffix(".json").read_text())


def ground_of(data, name, folder, sidecar):
    """The ground of the scene in its system, within its extent."""
    scene = tomllib.loads((folder / "scene.toml").read_text())
    crs, exaggeration = sidecar["scene"]["crs"], sidecar["scene"]["vertical_exaggeration"]
    dem = data / PLACES[name][0]
    with rasterio.open(dem) as source:
        # A file that states no system is in that of the scene.
        own = source.crs or SYSTEMS.get(name, crs)
        extent = scene["terrain"].get("extent")
        west, south, east, north = (
            [*extent[0], *extent[1]] if extent else transform_bounds(own, crs, *source.bounds, densify_pts=41)
        )
        cell = max(east - west, north - south) / POSTS
        shape = (math.ceil((north - south) / cell), math.ceil((east - west) / cell))
        heights = numpy.full(shape, numpy.nan, "f4")
        reproject(
            source.read(1).astype("f4"), heights, src_transform=source.transform, src_crs=own, src_nodata=source.nodata,
            dst_transform=from_origin(west, north, cell, cell), dst_crs=crs, dst_nodata=numpy.nan,
            resampling=Resampling.cubic,
        )
    return Ground(heights * exaggeration, west + cell / 2, north - cell / 2, cell)


def shaded_by_rays(ground):
    """The colors of rayshader's recipe: sphere_shade, ray_shade and ambient_shade multiplied (Morgan-Wall 2018)."""
    heights = numpy.nan_to_num(ground.heights, nan=float(numpy.nanmin(ground.heights)))
    south, east = numpy.gradient(heights, ground.cell)
    normal = numpy.stack([-east, south, numpy.ones_like(heights)], -1)
    normal /= numpy.linalg.norm(normal, axis=-1, keepdims=True)
    azimuth, altitude = math.radians(SUN_AZIMUTH_DEG), math.radians(SUN_ALTITUDE_DEG)
    sun = numpy.array([math.sin(azimuth) * math.cos(altitude), math.cos(azimuth) * math.cos(altitude), math.sin(altitude)])
    lit = numpy.clip(normal @ sun, 0, 1)

    def horizon(azimuth, reach):
        """The steepest rise toward an azimuth, as a tangent."""
        steepest = numpy.zeros_like(heights)
        rows, columns = numpy.indices(heights.shape)
        for step in numpy.unique(numpy.geomspace(1, reach, 24).round()):
            row = numpy.clip(rows - round(math.cos(azimuth) * step), 0, heights.shape[0] - 1)
            column = numpy.clip(columns + round(math.sin(azimuth) * step), 0, heights.shape[1] - 1)
            steepest = numpy.maximum(steepest, (heights[row, column] - heights) / (step * ground.cell))
        return steepest

    # The sun is an arc of angles, so that shadows are soft.
    angles = numpy.radians(numpy.arange(SUN_ALTITUDE_DEG - 5, SUN_ALTITUDE_DEG + 6, 2))
    toward_sun = horizon(azimuth, 200)
    ray = numpy.mean([toward_sun < math.tan(angle) for angle in angles], 0)
    open_sky = numpy.mean([1 - numpy.sin(numpy.arctan(horizon(math.tau * i / 12, 60))) for i in range(12)], 0)
    shade = (0.3 + 0.7 * lit) * (0.5 + 0.5 * ray) * (0.4 + 0.6 * open_sky)
    return numpy.clip(ground.colors * (shade / numpy.percentile(shade, 90))[..., None], 0, 1)


def draped(ground, colors, camera, size):
    """Colors on the ground through a camera: rays marched over the heights, the background white."""
    width, height = size
    projection = camera["projection"]
    right, up, forward = (numpy.array(camera[axis]) for axis in ("right", "up", "forward"))
    eye = numpy.array(camera["eye"])
    across, down = numpy.meshgrid((numpy.arange(width) + 0.5) / width * 2 - 1, 1 - (numpy.arange(height) + 0.5) / height * 2)
    tangent = math.tan(math.radians(projection["field_of_view_deg"]) / 2)
    rays = forward + (across * tangent * width / height)[..., None] * right + (down * tangent)[..., None] * up
    rows, columns = ground.heights.shape
    low, high = numpy.nanmin(ground.heights), numpy.nanmax(ground.heights)
    # Between the highest and the lowest level a ray is over the ground, if anywhere.
    fall = numpy.where(numpy.abs(rays[..., 2]) > 1e-9, rays[..., 2], -1e-9)
    to_levels = numpy.stack([(high - eye[2]) / fall, (low - 1 - eye[2]) / fall])
    near = numpy.clip(numpy.where(eye[2] > high, to_levels[0], 0), 0, camera["far_m"])
    far = numpy.clip(numpy.where(fall < 0, to_levels[1], camera["far_m"]), 0, camera["far_m"])
    picture = numpy.ones((height, width, 3))
    left = numpy.ones((height, width), bool)
    steps = 900
    for step in range(steps):
        along = near + (far - near) * (step / steps)
        at = eye + rays * along[..., None]
        column = ((at[..., 0] - ground.west) / ground.cell).round().astype(int)
        row = ((ground.north - at[..., 1]) / ground.cell).round().astype(int)
        inside = left & (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        row, column = row.clip(0, rows - 1), column.clip(0, columns - 1)
        hit = inside & (at[..., 2] <= ground.heights[row, column])
        picture[hit] = colors[row[hit], column[hit]]
        left &= ~hit
    return Image.fromarray((picture * 255).round().astype("u1"))


def by_rayshader(ground, camera, size, _out):
    return draped(ground, shaded_by_rays(ground), camera, size)


def by_pyvista(ground, camera, size, out):
    import pyvista

    rows, columns = ground.heights.shape
    x, y = numpy.meshgrid(numpy.arange(columns) * ground.cell, -numpy.arange(rows) * ground.cell)
    heights = numpy.nan_to_num(ground.heights, nan=float(numpy.nanmin(ground.heights)))
    # Points of a structured grid run along columns.
    surface = pyvista.StructuredGrid(x, y, heights)
    surface["tint"] = (ground.colors.transpose(1, 0, 2).reshape(-1, 3) * 255).astype("u1")
    plotter = pyvista.Plotter(off_screen=True, window_size=size, lighting="none")
    plotter.set_background("white")
    plotter.add_mesh(surface, scalars="tint", rgb=True, smooth_shading=True, specular=0)
    azimuth, altitude = math.radians(SUN_AZIMUTH_DEG), math.radians(SUN_ALTITUDE_DEG)
    sun = (math.sin(azimuth) * math.cos(altitude), math.cos(azimuth) * math.cos(altitude), math.sin(altitude))
    plotter.add_light(pyvista.Light(position=sun, light_type="scene light", intensity=0.9))
    plotter.add_light(pyvista.Light(light_type="headlight", intensity=0.25))
    eye = numpy.array(camera["eye"]) - [ground.west, ground.north, 0]
    plotter.camera_position = [eye, eye + numpy.array(camera["forward"]) * 1000, camera["up"]]
    plotter.camera.view_angle = camera["projection"]["field_of_view_deg"]
    plotter.reset_camera_clipping_range()
    plotter.enable_ssao(radius=ground.cell * 20)
    plotter.enable_anti_aliasing("ssaa")
    plotter.screenshot(out)
    return Image.open(out)


def by_cycles(ground, camera, size, out):
    # Blender holds one scene a process.
    job = Path(out).with_suffix(".npz")
    numpy.savez(job, heights=ground.heights, colors=ground.colors, cell=ground.cell,
                eye=numpy.array(camera["eye"]) - [ground.west, ground.north, 0], forward=camera["forward"],
                fov=camera["projection"]["field_of_view_deg"], size=size)
    run(sys.executable, Path(__file__).with_name("cycles_picture.py"), job, out)
    job.unlink()
    return Image.open(out)


def by_gmt(ground, camera, size, out):
    folder = Path(out).with_suffix("")
    folder.mkdir(exist_ok=True)
    grid = folder / "ground.tif"
    rows, columns = ground.heights.shape
    place = from_origin(ground.west - ground.cell / 2, ground.north + ground.cell / 2, ground.cell, ground.cell)
    with rasterio.open(grid, "w", driver="GTiff", width=columns, height=rows, count=1, dtype="float32", transform=place, nodata=numpy.nan) as file:
        file.write(ground.heights.astype("f4"), 1)
    low, high = float(numpy.nanmin(ground.heights)), float(numpy.nanmax(ground.heights))
    at = [low + (high - low) * share for share, _ in RAMP]
    color = ["/".join(map(str, tint)) for _, tint in RAMP]
    palette = "".join(f"{at[i]} {color[i]} {at[i + 1]} {color[i + 1]}\n" for i in range(len(RAMP) - 1))
    (folder / "tint.cpt").write_text(palette)
    forward = camera["forward"]
    # Where the eye stands, seen from the ground.
    azimuth = math.degrees(math.atan2(-forward[0], -forward[1])) % 360
    altitude = math.degrees(math.asin(-forward[2]))
    level = 22 * (high - low) / (columns * ground.cell)
    script = (
        f"gmt grdgradient ground.tif -A{SUN_AZIMUTH_DEG} -Nt0.9 -Glight.nc && gmt begin drawn png E110 && "
        f"gmt grdview ground.tif -Ilight.nc -Ctint.cpt -JX22c/{22 * rows / columns}c -JZ{max(level, 0.2)}c -p{azimuth}/{altitude} "
        f"-Qi200 -N{low}+g120/100/85 && gmt end"
    )
    # Its commands find each other by this name.
    session = {**os.environ, "GMT_SESSION_NAME": folder.name}
    done = subprocess.run(["sh", "-c", script], cwd=folder, env=session, capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr)
    drawn = Image.open(folder / "drawn.png").convert("RGB")
    drawn.thumbnail(size, Image.LANCZOS)
    picture = Image.new("RGB", size, "white")
    picture.paste(drawn, ((size[0] - drawn.width) // 2, (size[1] - drawn.height) // 2))
    return picture


REFERENCES = {"cycles": by_cycles, "pyvista": by_pyvista, "gmt": by_gmt, "rayshader": by_rayshader}


def is_at_hand(reference):
    if reference == "gmt":
        return shutil.which("gmt") is not None
    module = {"cycles": "bpy", "pyvista": "pyvista"}.get(reference)
    return module is None or subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True).returncode == 0


def figures(picture):
    """Lightness of what is not nearly white, mean and deviation, and how far its hues spread: deviations of a* and b*."""
    lab = numpy.asarray(picture.convert("RGB").convert("LAB"), "f4")
    lightness = lab[..., 0] * 100 / 255
    # Pillow keeps a* and b* in signed bytes, read here as unsigned.
    tints = numpy.where(lab[..., 1:] > 127, lab[..., 1:] - 256, lab[..., 1:])
    ground = lightness < 92
    return [lightness[ground].mean(), lightness[ground].std(), tints[ground][:, 0].std(), tints[ground][:, 1].std()]


def beside(ours, other, captions):
    gap, head = 8, 24
    width, height = ours.size
    sheet = Image.new("RGB", (2 * width + gap, height + head), "white")
    for index, (picture, caption) in enumerate(zip((ours, other), captions)):
        sheet.paste(picture.convert("RGB"), (index * (width + gap), head))
        ImageDraw.Draw(sheet).text((index * (width + gap) + 6, 6), caption, fill="black")
    return sheet


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", type=Path)
    parser.add_argument("data", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--place", default=",".join(PLACES))
    parser.add_argument("--reference", default=",".join(REFERENCES))
    parser.add_argument("--size", default="960x540")
    options = parser.parse_args()
    size = tuple(int(side) for side in options.size.split("x"))
    options.out.mkdir(parents=True, exist_ok=True)
    references = [name for name in options.reference.split(",") if is_at_hand(name)]
    for name in set(options.reference.split(",")) - set(references):
        print(f"{name} is not at hand: left out", file=sys.stderr)
    rows = []
    for place in options.place.split(","):
        folder, sidecar = draw_ours(options.program.resolve(), options.data.resolve(), options.out, place, options.size)
        ground = ground_of(options.data.resolve(), place, folder, sidecar)
        ours = Image.open(options.out / f"{place}.png")
        for name in references:
            out = options.out / f"{place}-{name}.png"
            other = REFERENCES[name](ground, sidecar["camera"], size, str(out))
            other.save(out)
            beside(ours, other, (f"{place}: sandtable new", f"{place}: {name}")).save(options.out / f"{place}-beside-{name}.png")
            numbers = [" / ".join(f"{value:.1f}" for value in figures(picture)) for picture in (ours, other)]
            rows.append([place, name, *numbers, *[""] * len(JUDGED)])
            print(f"{place} beside {name}", file=sys.stderr)
    head = ["place", "reference", "ours: L* / its σ / σ of a* / of b*", "reference: the same", *JUDGED]
    table = [head, ["---"] * len(head), *rows]
    (options.out / "pairs.md").write_text("".join(f"| {' | '.join(row)} |\n" for row in table))


if __name__ == "__main__":
    main()
