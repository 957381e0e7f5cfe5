"""Military symbols: the pictures of `sandtable symbol`."""

import io
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
import sandtable
from PIL import Image

INFANTRY = "10031000161211000000"


def test_a_symbol_has_the_pixels_and_the_text_of_the_program(program, tmp_path):
    symbol = sandtable.Symbol(INFANTRY, unique_designation="1-12", higher_formation=3)
    fields = ["--fields", "unique_designation=1-12", "higher_formation=3", "--size", "40"]
    for extension in ["png", "svg"]:
        program("symbol", INFANTRY, "-o", tmp_path / f"symbol.{extension}", *fields)
    picture = np.asarray(Image.open(tmp_path / "symbol.png"))
    np.testing.assert_array_equal(symbol.render(40), picture)
    np.testing.assert_array_equal(np.asarray(Image.open(io.BytesIO(symbol.png(size=40)))), picture)
    assert symbol.svg(40) == (tmp_path / "symbol.svg").read_text()
    assert symbol.description == "friend, land unit, infantry" and symbol.notes == []
    assert INFANTRY in repr(symbol) and symbol.code == INFANTRY


def test_a_notebook_shows_a_symbol():
    symbol = sandtable.Symbol("SHGPUCI----D---")
    assert ElementTree.fromstring(symbol._repr_svg_()).tag.endswith("svg")
    assert Image.open(io.BytesIO(symbol._repr_png_())).mode == "RGBA"


def test_wrong_codes_and_fields_are_errors_that_name_them():
    with pytest.raises(ValueError, match="digits 5-6"):
        sandtable.Symbol("10039900161211000000")
    with pytest.raises(ValueError, match="unique_designation"):
        sandtable.Symbol(INFANTRY, unique_designaton="1-12")
    with pytest.raises(ValueError, match="from 8 to 1000"):
        sandtable.Symbol(INFANTRY).png(size=2)
