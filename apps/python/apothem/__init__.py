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
                              contact, load, overlap, resume, voronoi)
from apothem._errors import SceneError, Unstable
from apothem._results import InscribedCircle, PairContact, Roof, SingularArea, VoronoiCells

__all__ = ["Bodies", "Elements", "Forces", "InscribedCircle", "Nodes", "PairContact", "Polygon", "Roof",
           "Scene", "SceneError", "Simulation", "SingularArea", "Unstable", "VoronoiCells",
           "__version__", "contact", "load", "overlap", "resume", "voronoi"]
