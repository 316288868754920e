"""Terrain models in rational arithmetic: the points that `delaunay run` reads from ASCII grids and GeoTIFF of random places, steps and values,
and the light mesh that `--error` makes of them: every cell is within the error of it.

    terrain.py BUILD_DIR [SEED [ROUNDS]]
"""

import math
import os
import random
import shutil
import struct
import subprocess
import sys
import tempfile
from fractions import Fraction

NODATA = -9999.0
KINDS = {"Float64": ("d", 8), "Float32": ("f", 4), "Int16": ("h", 2)}


class Model:
    """Of random numbers. `place`: x = place[0] + column place[1] + row place[2], y = place[3] + ..., of the corners of cells."""

    def __init__(self, rng, turned):
        self.columns, self.rows = rng.randint(1, 12), rng.randint(1, 12)
        step = rng.choice([1.0, 30.0, 0.1, 1 / 3600, 0.5])
        left, top = rng.choice([0.0, -6.2501388888888888, 482000.25]), rng.choice([0.0, 53.0001388888888889, 5905000.5])
        self.place = [left, step, 0.0, top, 0.0, -step]
        if turned:
            self.place = [left, step, step / 4, top, step / 8, rng.choice([-step, step])]
        self.kind = rng.choice(list(KINDS))
        self.scale, self.offset = (0.1, 5.0) if self.kind == "Int16" else (1.0, 0.0)
        self.raw = [self.value(rng, row, column) for row in range(self.rows) for column in range(self.columns)]

    def value(self, rng, row, column):
        if rng.random() < 0.1:
            return NODATA
        slope = 3 * row - 2 * column
        if self.kind == "Int16":
            return slope + rng.randint(0, 9)
        v = slope + rng.choice([0, rng.random(), rng.random() * 1e-7])
        return struct.unpack("f", struct.pack("f", v))[0] if self.kind == "Float32" else v

    def points(self):
        """Of all cells with values: the exact place of the centre, and the value as a double."""
        place = [Fraction(v) for v in self.place]
        for i, raw in enumerate(self.raw):
            row, column = divmod(i, self.columns)
            c, r = column + Fraction(1, 2), row + Fraction(1, 2)
            if raw != NODATA:
                yield place[0] + c * place[1] + r * place[2], place[3] + c * place[4] + r * place[5], raw * self.scale + self.offset

    def write_tiff(self, folder):
        letter, size = KINDS[self.kind]
        with open(folder + "/a.raw", "wb") as f:
            f.write(struct.pack("<%d%s" % (len(self.raw), letter), *(int(v) if letter == "h" else v for v in self.raw)))
        with open(folder + "/a.vrt", "w") as f:
            f.write(
                f'<VRTDataset rasterXSize="{self.columns}" rasterYSize="{self.rows}"><GeoTransform>{", ".join(map(repr, self.place))}'
                f'</GeoTransform><VRTRasterBand dataType="{self.kind}" band="1" subClass="VRTRawRasterBand"><SourceFilename '
                f'relativeToVRT="1">a.raw</SourceFilename><PixelOffset>{size}</PixelOffset><LineOffset>{size * self.columns}</LineOffset>'
                f'<ByteOrder>LSB</ByteOrder><NoDataValue>{NODATA:g}</NoDataValue><Scale>{self.scale}</Scale><Offset>{self.offset}</Offset>'
                "</VRTRasterBand></VRTDataset>"
            )
        subprocess.run(["gdal_translate", "-q", folder + "/a.vrt", folder + "/a.tif"], check=True)

    def write_grid(self, folder):
        """Without a scale and an offset; the grid begins at the lower left."""
        self.place[3] = 53.125  # so that the upper edge, which `place` has, is exact
        bottom = Fraction(self.place[3]) + self.rows * Fraction(self.place[5])
        corner = float(bottom)
        self.exact_bottom = Fraction(corner)
        with open(folder + "/a.asc", "w") as f:
            f.write(f"NCOLS {self.columns}\r\nNROWS {self.rows}\r\nXLLCORNER {self.place[0]!r}\r\nYLLCORNER {corner!r}\r\n")
            f.write(f"CELLSIZE {self.place[1]!r}\r\nNODATA_VALUE {NODATA:g}\r\n")
            for row in range(self.rows):
                f.write(" ".join(repr(v) for v in self.raw[row * self.columns : (row + 1) * self.columns]) + "\r\n")

    def grid_points(self):
        step = Fraction(self.place[1])
        for i, raw in enumerate(self.raw):
            row, column = divmod(i, self.columns)
            if raw != NODATA:
                yield Fraction(self.place[0]) + (column + Fraction(1, 2)) * step, self.exact_bottom + (self.rows - row - Fraction(1, 2)) * step, float(raw)


def run(build, *words):
    done = subprocess.run([build + "/delaunay", *words], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def near(got, want, turned):
    """The double nearest to the exact number; of turned rasters within a last place of the larger summand."""
    return float(want) == got or (turned and abs(Fraction(got) - want) <= 2 * Fraction(math.ulp(max(abs(got), 6e6))))


def compare(build, path, want, turned):
    status, out, said = run(build, "run", path, "-", "-f", "node")
    if not want:
        assert status == 1 and "there are no points" in said, (path, said)
        return
    rows = [line.split() for line in out.splitlines()[1:]]
    assert status == 0 and len(rows) == len(want), (path, said, len(rows), len(want))
    for row, (x, y, z) in zip(rows, want):
        assert near(float(row[1]), x, turned) and near(float(row[2]), y, turned), (path, row, float(x), float(y))
        assert float(row[3]) == z, (path, row, z)


def cross(a, b, c):
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def surface_at(q, triangles):
    for a, b, c in triangles:
        area = cross(a, b, c)
        weights = cross(q, b, c) / area, cross(q, c, a) / area, cross(q, a, b) / area
        if min(weights) >= 0:
            return sum(w * p[2] for w, p in zip(weights, (a, b, c)))
    return None


def compare_light(build, path, error, scratch):
    """Every point of the model is within the error of the mesh, exactly."""
    _, out, _ = run(build, "run", path, "-", "-f", "node")
    points = [tuple(Fraction(float(w)) for w in line.split()[1:4]) for line in out.splitlines()[1:]]
    if not points or len({cross(points[0], p, q) == 0 for p in points[1:2] for q in points} - {True}) == 0:
        return 0
    mesh = scratch + "/light.obj"
    status, _, said = run(build, "run", path, mesh, "--error", repr(error), "--force")
    assert status == 0, said
    lines = [line.split() for line in open(mesh)]
    corners = [tuple(Fraction(float(w)) for w in words[1:4]) for words in lines if words and words[0] == "v"]
    triangles = [tuple(corners[int(w.split("/")[0]) - 1] for w in words[1:4]) for words in lines if words and words[0] == "f"]
    for p in points:
        z = surface_at(p, triangles)
        assert z is not None and abs(z - p[2]) <= Fraction(error), (path, error, list(map(float, p)), z and float(z))
    return len(corners) < len(points)


def main():
    build = os.path.realpath(sys.argv[1])
    seed, rounds = (int(sys.argv[2]) if len(sys.argv) > 2 else 1), (int(sys.argv[3]) if len(sys.argv) > 3 else 40)
    os.environ["DELAUNAYD"] = build + "/delaunayd"
    rng = random.Random(seed)
    gdal, lighter = shutil.which("gdal_translate") is not None, 0
    with tempfile.TemporaryDirectory() as scratch:
        for i in range(rounds):
            model = Model(rng, turned=i % 3 == 2)
            path = scratch + "/a.tif"
            if i % 2 == 0 or not gdal:
                model.write_grid(scratch)
                path = scratch + "/a.asc"
                compare(build, path, list(model.grid_points()), False)
            else:
                model.write_tiff(scratch)
                compare(build, path, list(model.points()), i % 3 == 2)
            lighter += compare_light(build, path, rng.choice([0.0, 0.5, 3.0, 20.0]), scratch)
    assert lighter > rounds / 4, lighter
    print(f"seed {seed}: {rounds} models, {lighter} lighter meshes" + ("" if gdal else ", none through GDAL, which is missing"))


if __name__ == "__main__":
    main()
