"""The recipes of README.md about polygons and breaklines run."""

import contextlib
import importlib.util
import io
import os
import re
import tempfile
import unittest
from pathlib import Path

from .test_geometries import area, geopandas, matplotlib, numpy, shapely

README = Path(__file__).resolve().parent.parent / "README.md"


def recipes(heading):
    """The indented code of a section."""
    section = README.read_text().split("\n## %s\n" % heading)[1].split("\n## ")[0]
    return "\n".join(line[4:] for line in section.splitlines() if re.match(" {4}|$", line))


@unittest.skipIf(None in (numpy, shapely, geopandas, matplotlib), "NumPy, shapely, GeoPandas or Matplotlib is missing")
class Recipes(unittest.TestCase):
    def test_polygons_and_breaklines(self):
        self.assertIn("DELAUNAYD", os.environ)
        said, names = io.StringIO(), {}
        with contextlib.redirect_stdout(said):
            exec(compile(recipes("Polygons and breaklines"), "README.md", "exec"), names)
        self.assertEqual(area(names["points"], names["triangles"]), 8)
        self.assertEqual(sorted(set(names["d"].region.tolist())), [0, 1])
        self.assertEqual(int((~names["mesh"].mask).sum()), 4)
        lines = said.getvalue().splitlines()
        self.assertTrue(lines[1].startswith("20.0 ["))
        self.assertAlmostEqual(float(lines[2].strip("[]")), 120 - 90 * 0.5 / 7)
        self.assertEqual(lines[3], "[0 1 2 3 4]")
        self.assertTrue(lines[4].startswith("36.0 [(0,), (0, 1)] [["))


@unittest.skipIf(numpy is None or importlib.util.find_spec("distributed") is None, "NumPy or distributed is missing")
class Laptop(unittest.TestCase):
    def test_more_points_than_memory(self):
        said, names, before = io.StringIO(), {}, os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            self.addCleanup(os.chdir, before)
            with contextlib.redirect_stdout(said):
                exec(compile(recipes("More points than memory"), "README.md", "exec"), names)
            triangles = numpy.load("triangles.npy")
            os.chdir(before)
        from delaunayd.spatial import Delaunay

        d = Delaunay(names["points"])
        ordered = triangles[numpy.lexsort(triangles.T[::-1])]
        self.assertTrue(numpy.array_equal(ordered, d.simplices))
        lines = said.getvalue().splitlines()
        self.assertTrue(lines[0].startswith("{'points': 100000, 'coincident': 0, 'triangles': %d, 'tiles': 5, " % len(triangles)))
        self.assertEqual(lines[1], "[[0.275 0.425 0.575 0.725]")
        self.assertTrue(lines[-1].endswith("%d False" % len(d._now.triangulation.hull())))


if __name__ == "__main__":
    unittest.main()
