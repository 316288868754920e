"""The recipes of README.md about polygons and breaklines run."""

import contextlib
import io
import os
import re
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


if __name__ == "__main__":
    unittest.main()
