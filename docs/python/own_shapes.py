"""Shapes of other libraries in contact: Shapely, meshio and Matplotlib. python3 own_shapes.py [PICTURE]"""
import sys
import tempfile

import apothem
import matplotlib
matplotlib.use("Agg")
import meshio
import numpy
from matplotlib import collections, path, pyplot, textpath
from shapely import affinity, geometry, ops

# Shapely: a disc with a bite. A ring without holes is a polygon.
bitten = geometry.Point(0, 2).buffer(0.5, 8).difference(geometry.Point(0.4, 2.3).buffer(0.35, 8))
# Matplotlib: the outline of a letter, which has curves.
letter = textpath.TextPath((1.2, 1.2), "S", size=1.2).interpolated(1).to_polygons()[0]
letter = geometry.Polygon(letter).simplify(0.005)
star = affinity.translate(geometry.Polygon(path.Path.unit_regular_star(5, 0.4).to_polygons()[0]), 3, 2)

# meshio: the boundary of a mesh of two triangles, as a wedge below.
points = numpy.array([[-1.0, -0.5], [4.0, -0.5], [4.0, 0.0], [-1.0, 0.8]])
with tempfile.NamedTemporaryFile(suffix=".vtk") as file:
    meshio.write(file.name, meshio.Mesh(numpy.c_[points, 0 * points[:, 0]],
                                        [("triangle", [[0, 1, 2], [0, 2, 3]])]))
    mesh = meshio.read(file.name)
cells = mesh.cells_dict["triangle"]
wedge = ops.unary_union([geometry.Polygon(mesh.points[cell, :2]) for cell in cells])


def body(name, shape, **others):
    """A rigid body with the outline of a polygon of Shapely."""
    return {"name": name, "material": "rock", "polygon": numpy.array(shape.exterior.coords)[:-1], **others}


sim = apothem.Simulation(apothem.Scene({
    "gravity": [0, -9.81],
    "materials": {"rock": {"density": 2000}},
    "contact": {"normal_stiffness": 1e8, "friction": {"coefficient": 0.5, "tangential_stiffness": 5e7},
                "damping": {"model": "viscous", "ratio": 0.3}},
    "bodies": [body("wedge", wedge, motion="fixed"), body("bitten", bitten), body("letter", letter),
               body("star", star)],
    "time": {"end": 2, "accuracy": 0.1}}))
sim.run()

# The outlines now, and back to Shapely: who touches whom, by a method of its own.
outlines = sim.bodies.outlines()
shapes = [geometry.Polygon(ring) for ring in outlines]
names = sim.bodies.names
for contact in sim.contacts():
    a, b = int(contact["body_a"]), int(contact["body_b"])
    area = shapes[a].intersection(shapes[b]).area
    print(f"{names[a]} and {names[b]}: {numpy.hypot(*contact['normal']):.0f} N at "
          f"({contact['point'][0]:.3f}, {contact['point'][1]:.3f}) m, overlap {area:.2g} m^2")

axes = pyplot.figure(figsize=(7, 4)).add_subplot(aspect="equal", xlabel="x (m)", ylabel="y (m)")
axes.add_collection(collections.PolyCollection(outlines, ec="black", fc=["0.8", "tan", "skyblue", "khaki"]))
axes.autoscale_view()
picture = sys.argv[1] if len(sys.argv) > 1 else "own_shapes.png"
pyplot.savefig(picture, dpi=150)
