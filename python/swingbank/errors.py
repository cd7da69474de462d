"""Exceptions of the package."""
from __future__ import annotations

from typing import Iterable, NamedTuple


class Problem(NamedTuple):
    """One problem of an input: what is wrong, where (file and line, or argument), why, and what to do."""

    what: str
    where: str
    why: str
    do: str

    def __str__(self) -> str:
        return f"{self.what} at {self.where} ({self.why}): {self.do}"


class InputError(ValueError):
    """All problems of one input, in `problems`; the message has one line for each."""

    def __init__(self, problems: Iterable[tuple[str, str, str, str]]) -> None:
        self.problems = [Problem(*problem) for problem in problems]
        super().__init__("\n".join(map(str, self.problems)))

    def __reduce__(self) -> tuple[type[InputError], tuple[list[Problem]]]:
        return type(self), (self.problems,)
