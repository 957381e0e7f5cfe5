"""The work of the dialog in the background: the picture and the page of a scene, with progress, until it is canceled."""

import os

from qgis.core import QgsTask

from .program import ProgramCanceled, ProgramError, run

# How much of the work the picture is, where a page is made as well.
PICTURE_SHARE = 0.5


class PictureTask(QgsTask):
    """Draws a scene's picture and writes its page. `problem` says what was wrong; `made` lists the files."""

    def __init__(self, scene, size, with_page, on_finished):
        super().__init__("3D picture of the map", QgsTask.CanCancel)
        folder = os.path.dirname(scene)
        size_text = f"{size[0]}x{size[1]}"
        self.steps = [(["render", scene, "--size", size_text], os.path.join(folder, "picture.png"))]
        if with_page:
            self.steps.append((["export", scene], os.path.join(folder, "page.html")))
        self.on_finished = on_finished
        self.made = []
        self.said = []
        self.problem = ""

    def run(self):
        """Runs the program; on a thread of its own."""
        share = 1.0 if len(self.steps) == 1 else PICTURE_SHARE
        begun = 0.0
        try:
            for arguments, output in self.steps:

                def on_progress(text, percent, begun=begun):
                    self.setProgress(100.0 * begun + percent * share)

                self.said.append(run([*arguments, "-o", output], on_progress, self.isCanceled))
                self.made.append(output)
                begun += share
                self.setProgress(100.0 * begun)
        except ProgramCanceled:
            return False
        except ProgramError as error:
            self.problem = str(error)
            return False
        return True

    def finished(self, is_done):
        """Tells the dialog; on the main thread."""
        self.on_finished(self, is_done)
