"""The exception and the warning of the package."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from . import Finding


class SandtableError(Exception):
    """What the library refuses, with the file and the place where it knows them.

    Attributes
    ----------
    file : str or None
        The file that is wrong; ``<scene>`` for the text of a scene that is made in Python, as ``Scene.toml`` gives it.
    line, column : int or None
        The place in a scene file, both from 1; the column in characters.
    findings : tuple of Finding
        All errors of a scene file, each with its place.
    """

    def __init__(
        self,
        message: str,
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
        findings: Sequence[Finding] = (),
    ) -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.column = column
        self.findings = tuple(findings)


class SandtableWarning(UserWarning):
    """Something in a scene that somebody should look at.

    Attributes
    ----------
    finding : Finding
        Its code, message, remedy and place: ``<scene>`` is the text of a scene that is made in Python, as ``Scene.toml``
        gives it.
    """

    def __init__(self, finding: Finding) -> None:
        place = "" if finding.file is None else f"{finding.file}:{finding.line}:{finding.column}: "
        remedy = "" if finding.help is None else f"; {finding.help}"
        super().__init__(f"{place}{finding.message}{remedy} [{finding.code}]")
        self.finding = finding
