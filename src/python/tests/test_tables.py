"""The methods of a scene are the tables of the scene file."""

import json
import os

from conftest import ROOT
from tables import module

TABLES = ROOT / "src/python/python/sandtable/_tables.py"


def test_the_methods_are_those_of_the_schema(program):
    made = module(json.loads(program("schema")))
    if "SANDTABLE_BLESS" in os.environ:
        TABLES.write_text(made, encoding="utf-8")
    kept = TABLES.read_text(encoding="utf-8")
    assert kept == made, f"{TABLES} is not of the schema: run again with SANDTABLE_BLESS=1"
