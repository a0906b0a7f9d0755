"""How steep is a heap? The friction of blocks against the angle of repose: python3 repose.py [BLOCKS]

Blocks come to rest between two walls on a plate. Then the walls vanish, and what stays on the plate is
a heap: about a triangle over the whole plate, whose slope follows from its area.
"""
import math
import sys
import tempfile

import apothem

WIDTH, SIZE = 2.0, 0.1  # of the plate, and diameter of the circle with the area of a block, m
BLOCKS = int(sys.argv[1]) if len(sys.argv) > 1 else 120
CORE = apothem.Polygon([[-WIDTH / 4, SIZE], [WIDTH / 4, SIZE], [0, WIDTH / 8]])


def wall(name, x, y, width, height):
    return {"name": name, "material": "rock", "motion": "fixed",
            "polygon": [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]}


def scene(coefficient, seed, walls):
    bodies = [wall("plate", -WIDTH / 2, -0.2, WIDTH, 0.2)]
    if walls:
        bodies += [wall("left", -WIDTH / 2 - 0.2, 0, 0.2, 4), wall("right", WIDTH / 2, 0, 0.2, 4)]
    return apothem.Scene({
        "gravity": [0, -9.81], "materials": {"rock": {"density": 2000}},
        "contact": {"normal_stiffness": 1e7, "friction": {"coefficient": coefficient},
                    "damping": {"model": "viscous", "ratio": 0.3}, "penetration_warning": 1},
        "bodies": bodies,
        "fill": [{"name": "block", "material": "rock", "shapes": [{"quadrilateral": {}}], "diameter": SIZE,
                  "count": BLOCKS, "seed": seed, "velocity": [0, -1],
                  "region": [[-WIDTH / 2, 0.01], [WIDTH / 2, 0.01], [WIDTH / 2, 4], [-WIDTH / 2, 4]]}],
        "world": {"box": [[-WIDTH, -1], [WIDTH, 5]], "outside": "remove"},
        "regions": {"heap": {"polygon": [[-WIDTH / 2, 0], [WIDTH / 2, 0], [WIDTH / 2, 4], [-WIDTH / 2, 4]]}},
        "stop": [{"name": "rest", "region": "heap", "kinetic_per_body": 1e-3, "for": 0.5}],
        "time": {"end": 10, "accuracy": 0.1, "onsets": "plain"}})


def angle_of_repose(coefficient, seed):
    """In degrees."""
    with tempfile.TemporaryDirectory() as folder:
        with apothem.Simulation(scene(coefficient, seed, True), output=folder + "/fill") as filled:
            filled.run()
        heap = apothem.Simulation(scene(coefficient, seed, False), begin_from=folder + "/fill")
        heap.run()
    bodies = heap.bodies
    blocks = [apothem.Polygon(ring) for ring, there, place in
              zip(bodies.outlines()[1:], bodies.present[1:], bodies.position[1:]) if there and place[1] > 0]
    solid = sum(apothem.contact(block, CORE, method="overlap").overlap_area for block in blocks) / CORE.area
    area = sum(block.area for block in blocks) / solid
    return math.degrees(math.atan(4 * area / WIDTH**2))


if __name__ == "__main__":
    print("coefficient   friction angle   angle of repose")
    for mu in [0.1, 0.3, 0.6]:
        angles = [angle_of_repose(mu, seed) for seed in [1, 2]]
        print(f"{mu:11.1f} {math.degrees(math.atan(mu)):15.1f}° {sum(angles) / len(angles):16.1f}°")
