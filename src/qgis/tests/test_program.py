"""The program is found where the setting, the path and pip have it."""

import os
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from common import PROGRAM
from qgis.core import QgsSettings

from sandtable_qgis.program import SETTING, STEPS, ProgramError, find_program, run


class TestProgram(unittest.TestCase):
    def setUp(self):
        QgsSettings().setValue(SETTING, "")
        self.addCleanup(QgsSettings().setValue, SETTING, PROGRAM)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.base = Path(folder.name)
        # A person who has installed nothing yet.
        for patch in [
            mock.patch.dict(os.environ, {"PATH": str(self.base / "path")}),
            mock.patch("site.getuserbase", return_value=str(self.base / "user")),
            mock.patch("sysconfig.get_path", return_value=str(self.base / "all")),
        ]:
            patch.start()
            self.addCleanup(patch.stop)

    def install(self, folder):
        """A program as pip installs it: a script of Python."""
        (self.base / folder).mkdir(parents=True)
        script = self.base / folder / "sandtable"
        script.write_text(f"#!{sys.executable}\n")
        script.chmod(0o755)
        return str(script)

    def test_pip_s_scripts_for_all_and_for_one_user_are_looked_at_after_the_path(self):
        with self.assertRaisesRegex(ProgramError, "pip install sandtable"):
            find_program()
        for folder in ["user/bin", "all", "path"]:
            script = self.install(folder)
            self.assertEqual(find_program(), script)

    def test_the_setting_comes_first(self):
        self.install("path")
        QgsSettings().setValue(SETTING, "/opt/sandtable")
        self.assertEqual(find_program(), "/opt/sandtable")

    def test_progress_rises_over_steps_that_count_and_steps_that_do_not(self):
        script = self.base / "sandtable"
        lines = ["reading elevation", "drawing", "drawing 50 %", "analyzing 37 %", "annotating"]
        said = "".join(f"print('progress: {line}', file=sys.stderr)\n" for line in lines)
        script.write_text(f"#!{sys.executable}\nimport sys\n{said}")
        script.chmod(0o755)
        QgsSettings().setValue(SETTING, str(script))
        heard = []
        run([], lambda step, percent: heard.append((step, percent)))
        steps = {step: 100 * STEPS.index(step) / len(STEPS) for step in ["reading elevation", "drawing", "annotating"]}
        half = (steps["drawing"] + steps["annotating"]) / 2
        expected = [*steps.items()][:2] + [("drawing", half), ("analyzing", 37), ("annotating", steps["annotating"])]
        self.assertEqual([step for step, _ in heard], [step for step, _ in expected])
        for (_, percent), (_, wanted) in zip(heard, expected):
            self.assertAlmostEqual(percent, wanted)


if __name__ == "__main__":
    unittest.main()
