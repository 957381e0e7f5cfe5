"""Sheets of our pictures beside those that other programs make of the same ground, to be judged by eye.

    python3 tests/tools/picture_sheets.py PROGRAM PLACES REFERENCES OUT

Draws the demonstration (its view, its overview and a plan of it) and two real places as `new` frames them, and sets each
picture beside all of REFERENCES that are named after it: `SHEET-PROGRAM.png`, such as `view-cycles.png` or
`crater_lake-gmt.png`. PLACES holds the folders `crater_lake_bt` and `swellendam_za`. OUT receives a sheet of each, our
pictures in full, and beside them their sidecars: whoever makes a reference finds the camera there. A sheet without
references holds our picture alone.

Needs Pillow.
"""

import subprocess
import sys
from pathlib import Path

from PIL import Image, ImageDraw

ROOT = Path(__file__).resolve().parents[2]
PLACES = {
    "crater_lake": ("crater_lake_bt", "crater.bt", []),
    "swellendam": ("swellendam_za", "dem_srtm_utm33s_i16.tif", ["rivers.shp", "water.shp", "places.shp"]),
}
PLAN = '\n[[camera]]\nname = "plan"\nprojection = "plan"\n'
CELL_HEIGHT = 720
CAPTION = 28
GAP = 8


def run(*command):
    subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL)


def draw(program, scene, camera, folder, out):
    run(program, "render", scene, "--camera", camera, "--allow", folder, "--sidecar", "-o", out)


def ours(program, places, out):
    """Our pictures by the name of their sheet."""
    pictures = {}
    text = (ROOT / "scenes/jacksboro.toml").read_text(encoding="utf-8")
    demonstration = out / "demonstration.toml"
    demonstration.write_text(text.replace('"../assets', f'"{ROOT}/assets') + PLAN, encoding="utf-8")
    for sheet, camera in [("view", "main"), ("overview", "overview"), ("plan", "plan")]:
        pictures[sheet] = out / f"{sheet}.png"
        draw(program, demonstration, camera, ROOT, pictures[sheet])
    for sheet, (folder, elevation, vectors) in PLACES.items():
        folder, made = places / folder, out / sheet
        layers = ["--vectors", *(folder / layer for layer in vectors)] if vectors else []
        if not made.exists():
            run(program, "new", "--dem", folder / elevation, *layers, "--", made)
        pictures[sheet] = out / f"{sheet}.png"
        draw(program, made / "scene.toml", "overview", folder, pictures[sheet])
    return pictures


def cell(picture, caption):
    """A picture of the height of a row under its caption."""
    shown = Image.open(picture).convert("RGB")
    width = round(shown.width * CELL_HEIGHT / shown.height)
    whole = Image.new("RGB", (width, CELL_HEIGHT + CAPTION), (24, 24, 24))
    whole.paste(shown.resize((width, CELL_HEIGHT), Image.Resampling.LANCZOS), (0, CAPTION))
    ImageDraw.Draw(whole).text((8, 8), caption, fill=(255, 255, 255))
    return whole


def sheet(cells, columns=2):
    rows = [cells[first : first + columns] for first in range(0, len(cells), columns)]
    width = max(sum(each.width + GAP for each in row) for row in rows) - GAP
    height = sum(row[0].height + GAP for row in rows) - GAP
    whole, y = Image.new("RGB", (width, height), (255, 255, 255)), 0
    for row in rows:
        x = 0
        for each in row:
            whole.paste(each, (x, y))
            x += each.width + GAP
        y += row[0].height + GAP
    return whole


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    program, places, references, out = (Path(argument).resolve() for argument in sys.argv[1:])
    out.mkdir(parents=True, exist_ok=True)
    for name, picture in ours(program, places, out).items():
        others = sorted(references.glob(f"{name}-*.png"))
        cells = [cell(picture, "sandtable")]
        cells += [cell(other, other.stem.removeprefix(f"{name}-")) for other in others]
        target = out / f"sheet-{name}.png"
        sheet(cells).save(target)
        print(f"{target}: ours and {len(others)} others")


if __name__ == "__main__":
    main()
