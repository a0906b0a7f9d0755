"""What the functions of geometry return. Lengths in m, areas in m^2; vertices counter-clockwise."""

from typing import Any, List, NamedTuple, Tuple


class InscribedCircle(NamedTuple):
    """A largest inscribed circle.

    radius: m.
    centres: array (k, 2) of the possible centres, m: isolated ones, and the two ends of each segment
    of centres, one after the other.
    """

    radius: float
    centres: Any


class Roof(NamedTuple):
    """The roof over the straight skeleton of a polygon with n vertices.

    height: largest height, m.
    nodes: array (m, 3) of x, y and height, m. The first n are the vertices, of height 0.
    arcs: array (k, 2) of the nodes of each arc. The first n are the edges of the polygon.
    faces: list of n arrays, the nodes of the face over each edge, counter-clockwise.
    """

    height: float
    nodes: Any
    arcs: Any
    faces: List[Any]


class Skeleton(NamedTuple):
    """The straight skeleton of a polygon.

    lines: list of arrays (2, 2), the ends of each inner arc, m.
    edges: list of pairs, the edges of the polygon on whose faces each arc lies: left, right.
    """

    lines: List[Any]
    edges: List[Tuple[int, int]]


class PolygonWithHoles(NamedTuple):
    """A polygon with holes.

    outer: array (k, 2) of the vertices of the outer ring, counter-clockwise, m.
    holes: list of arrays (k, 2), clockwise, m.
    """

    outer: Any
    holes: List[Any]


class Repaired(NamedTuple):
    """An outline after repair.

    polygons: list of PolygonWithHoles.
    faults: what was wrong with the outline, each with its place.
    hausdorff_distance: upper bound of that between the boundaries before and after simplification, m.
    """

    polygons: List[PolygonWithHoles]
    faults: List[str]
    hausdorff_distance: float


class SingularArea(NamedTuple):
    """Where the distance potential is 1 and no contact force acts.

    kind: "none", "point", "segment" or "polygons", of the parts with the highest dimension.
    area: of the polygons, m^2.
    points: array (k, 2) of isolated points, m.
    segments: list of arrays (2, 2) of ends, m.
    polygons: list of arrays (k, 2) of vertices, m. Holes of a part follow it, clockwise.
    """

    kind: str
    area: float
    points: Any
    segments: List[Any]
    polygons: List[Any]


class PairContact(NamedTuple):
    """The contact of two polygons, per metre of thickness.

    method: by which it was computed.
    force: (x, y) on a, N/m.
    moment_a, moment_b: moments on a and b about their own centroids, N.
    loading_point: (x, y) of the point on the line of action at which friction acts, m.
    energy: J/m.
    overlap_area: m^2.
    own_length_a, own_length_b: length of the boundary of a in b, and of b in a, m.
    weight: sum of the sizes of all tractions, N/m, the scale of round-off.
    penetration: largest distance from the boundary of one polygon of a point of it on the boundary of
    the other one, m.
    largest_phi: largest potential on the boundaries.
    """

    method: str
    force: Tuple[float, float]
    moment_a: float
    moment_b: float
    loading_point: Tuple[float, float]
    energy: float
    overlap_area: float
    own_length_a: float
    own_length_b: float
    weight: float
    penetration: float
    largest_phi: float


class VoronoiCells(NamedTuple):
    """A mesh of Voronoi cells that share their nodes.

    points: array (m, 2) of the nodes, m.
    cells: list of n or more arrays of the nodes of each cell, counter-clockwise; cell i < n is that of site i.
    sites: array (n, 2), m.
    """

    points: Any
    cells: List[Any]
    sites: Any
