"""The tutorial runs in Jupyter's kernel, and the pictures of the book's chapter are those that it shows."""

import base64
import io
import os
import sysconfig

import numpy as np
import pytest
from conftest import ROOT

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")
pytest.importorskip("geopandas")
pytest.importorskip("matplotlib")
Image = pytest.importorskip("PIL.Image")

NOTEBOOK = ROOT / "src/python/notebooks/tutorial.ipynb"
PICTURES = ROOT / "src/book/notebook"
# Cells whose picture the book shows. Those of scenes have the same pixels on every machine.
BY_MATPLOTLIB = ["relief", "sight"]
OF_SCENES = ["scene", "view"]


@pytest.fixture(scope="module")
def executed():
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    client = nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(NOTEBOOK.parent)}})
    with pytest.MonkeyPatch.context() as patch:
        # As in an environment that is active, with the backend of notebooks.
        patch.setenv("PATH", sysconfig.get_path("scripts"), prepend=os.pathsep)
        patch.delenv("MPLBACKEND", raising=False)
        # An exception of a cell ends it with the cell's traceback.
        cells = client.execute()["cells"]
    return {cell["id"]: cell for cell in cells if cell["cell_type"] == "code"}


def picture_of(cell):
    shown = [output["data"]["image/png"] for output in cell["outputs"] if "image/png" in output.get("data", {})]
    assert len(shown) == 1, cell["outputs"]
    return base64.b64decode(shown[0])


@pytest.mark.parametrize("name", BY_MATPLOTLIB + OF_SCENES)
def test_the_pictures_of_the_book_are_those_of_the_notebook(executed, name):
    made, path = Image.open(io.BytesIO(picture_of(executed[name]))).convert("RGB"), PICTURES / f"{name}.png"
    if name in OF_SCENES:
        # The book is narrower than a notebook.
        made = made.reduce(2)
    if "SANDTABLE_BLESS" in os.environ:
        path.parent.mkdir(exist_ok=True)
        made.save(path, optimize=True)
    assert path.exists(), f"{path} is missing: run this with SANDTABLE_BLESS=1, and look at it"
    differ = f"{path} is not what the notebook shows: run this with SANDTABLE_BLESS=1, and look at it"
    old, new = (np.asarray(picture, float) for picture in [Image.open(path).convert("RGB"), made])
    if name in OF_SCENES:
        assert np.array_equal(old, new), differ
        return
    # matplotlib's letters move by parts of pixels from release to release.
    assert all(abs(a - b) <= 4 for a, b in zip(old.shape, new.shape)), differ
    rows, columns = (min(a, b) for a, b in zip(old.shape[:2], new.shape[:2]))
    assert abs(old[:rows, :columns] - new[:rows, :columns]).mean() < 4, differ


def test_the_numbers_of_the_notebook_are_right(executed):
    heights = executed["heights"]["outputs"][0]["data"]["text/plain"]
    assert "LaFollette" in heights and "NaN" not in heights
    warned = "".join(output.get("text", "") for output in executed["scene"]["outputs"])
    assert "SandtableWarning" in warned and "[river-uphill]" in warned
    assert "[[road]]" in executed["file"]["outputs"][0]["text"]
    assert picture_of(executed["program"]).startswith(b"\x89PNG")


def test_the_notebook_is_kept_without_outputs():
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbformat.validate(notebook)
    for cell in notebook["cells"]:
        assert not cell.get("outputs") and cell.get("execution_count") is None, cell["id"]
