"""What is said of work while it is done: to a function, on standard error, under the cell of a notebook; and that nothing else is."""

import numpy as np
import pytest
import sandtable as st
from conftest import ROAD, ROOT

SLOW = """
import sys, time
import sandtable as st
from sandtable import _progress

_progress._PATIENCE_S = 0.0
scene = st.Scene("scenes/road.toml")
"""


def test_the_share_of_a_picture_rises_to_all_and_changes_no_pixel():
    shares = []
    scene = st.Scene(ROAD)
    told = scene.render(size=(1280, 720), progress=shares.append)
    assert shares == sorted(shares) and shares[-1] == 1.0 and all(0.0 <= share <= 1.0 for share in shares)
    np.testing.assert_array_equal(told, scene.render(size=(1280, 720), progress=False))


def test_true_prints_steps_and_shares_on_standard_error_alone(capfd, tmp_path):
    scene = st.Scene(ROAD)
    scene.save(tmp_path / "a.png", size=(2560, 1440), progress=True)
    out, err = capfd.readouterr()
    assert out == "" and "\rdrawing" in err and err.endswith("\r")
    for progress in [None, False]:
        scene.save(tmp_path / "a.html", progress=progress)
        scene.show(progress=progress)
        assert capfd.readouterr() == ("", "")


def test_an_exception_of_progress_is_raised():
    def fail(share):
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        st.Scene(ROAD).render(size=(2560, 1440), progress=fail)
    with pytest.raises(TypeError, match="progress is a str"):
        st.Scene(ROAD).render(progress="bar")


def cells(*sources):
    """The outputs of cells in a kernel, and each message that a cell shows."""
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source) for source in sources])
    said = []

    class Client(nbclient.NotebookClient):
        def process_message(self, message, cell, index):
            if message["msg_type"] in ("display_data", "update_display_data"):
                said.append((index, message["content"]["data"].get("text/plain")))
            return super().process_message(message, cell, index)

    Client(notebook, timeout=120, resources={"metadata": {"path": str(ROOT)}}).execute()
    return [cell["outputs"] for cell in notebook["cells"]], said


def test_a_notebook_shows_the_steps_in_one_line_that_is_empty_at_the_end():
    outputs, said = cells(SLOW, "image = scene.render(size=(1920, 1080))", "image = scene.render(size=(640, 360), progress=False)")
    lines = [text for index, text in said if index == 1]
    assert any(text.startswith("drawing") for text in lines) and lines[-1] == "", lines
    (shown,) = outputs[1]
    assert shown["data"] == {"text/plain": ""}
    assert outputs[2] == []


def test_work_of_less_than_a_second_shows_nothing_in_a_notebook():
    outputs, said = cells("import sandtable as st", "st.Scene('scenes/road.toml').render(size=(64, 36)).shape")
    assert said == [] and [output["output_type"] for output in outputs[1]] == ["execute_result"]
