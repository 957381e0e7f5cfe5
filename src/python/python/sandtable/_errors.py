"""The exception of the package."""

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
        The file that is wrong.
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
