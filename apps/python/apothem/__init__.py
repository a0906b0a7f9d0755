"""Apothem: distance-potential finite-discrete element method in two dimensions.

For example::

    import apothem
    sim = apothem.Simulation(apothem.load("scene.json"))
    sim.run()
    print(sim.bodies.position)

Scenes are JSON files or dicts with the same keys, see docs/scene-format.md. All quantities are in SI
units, angles in radians. The method: doi:10.1007/s00466-020-01913-2.
"""

from apothem._apothem import (Bodies, Elements, Forces, Nodes, Polygon, Scene, Simulation, __version__,
                              boolean, contact, load, overlap, repair, resume, voronoi)
from apothem._arguments import explain_arguments
from apothem._errors import SceneError, Unstable
from apothem._results import (InscribedCircle, PairContact, PolygonWithHoles, Repaired, Roof,
                              SingularArea, Skeleton, VoronoiCells)

__all__ = ["Bodies", "Elements", "Forces", "InscribedCircle", "Nodes", "PairContact", "Polygon",
           "PolygonWithHoles", "Repaired", "Roof", "Scene", "SceneError", "Simulation", "SingularArea",
           "Skeleton", "Unstable", "VoronoiCells", "__version__", "boolean", "contact", "load",
           "overlap", "repair", "resume", "voronoi"]

boolean, contact, load, overlap, repair, resume, voronoi = explain_arguments(
    boolean, contact, load, overlap, repair, resume, voronoi)
explain_arguments(Polygon, Scene, Simulation)
del explain_arguments
