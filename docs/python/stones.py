"""Stones fall into a box, and a picture of them: python3 stones.py"""
import apothem
from matplotlib import collections, pyplot

box = [[-0.2, 3], [-0.2, -0.2], [2.2, -0.2], [2.2, 3], [2, 3], [2, 0], [0, 0], [0, 3]]
sim = apothem.Simulation(apothem.Scene({
    "gravity": [0, -9.81], "materials": {"rock": {"density": 2000}},
    "contact": {"normal_stiffness": 2e7, "friction": {"coefficient": 0.4}, "damping": {"model": "viscous", "ratio": 0.3}},
    "bodies": [{"name": "box", "material": "rock", "motion": "fixed", "polygon": box}],
    "fill": [{"name": "stone", "material": "rock", "region": [[0, 0.2], [2, 0.2], [2, 3], [0, 3]], "count": 40, "seed": 1,
              "shapes": [{"polygon_random": {"corners": [5, 9]}}], "diameter": {"uniform": [0.15, 0.3]}}],
    "time": {"end": 1.5, "accuracy": 0.1}}))
sim.run()
pyplot.gca().add_collection(collections.PolyCollection(sim.bodies.outlines(), ec="black", fc="tan"))
pyplot.axis("scaled")
pyplot.title(f"{len(sim.contacts())} contacts, fastest stone at {abs(sim.bodies.velocity[1:, :2]).max():.2g} m/s")
pyplot.savefig("stones.png")
