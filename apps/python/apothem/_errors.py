"""The exceptions of the module."""

from typing import Optional


class SceneError(ValueError):
    """Bad input: a scene, a file, or a polygon. The message says what would be right.

    reason: the message without the place.
    file: the file, or None. It ends in <dict> if the scene was a dict.
    line: the line in the file, counted from 1, or None.
    pointer: the place in the document as a JSON pointer, as in "/bodies/0/polygon", or None.
    vertex: the vertex of a ring of a polygon, counted from 0, or None.
    hole: the hole of the polygon that this ring is, counted from 0, or None for the outer ring.
    """

    def __init__(self, message: str, reason: Optional[str] = None, file: Optional[str] = None,
                 line: Optional[int] = None, pointer: Optional[str] = None,
                 vertex: Optional[int] = None, hole: Optional[int] = None) -> None:
        super().__init__(message)
        self.reason = message if reason is None else reason
        self.file = file
        self.line = line
        self.pointer = pointer
        self.vertex = vertex
        self.hole = hole


class Unstable(RuntimeError):
    """A run became unstable or left the range of the method: when, where, why and what helps."""
