#!/usr/bin/env python3
"""coastlines.py CLIENT FOLDER CORNERS - from the world's coastlines in GeoJSON to a mesh of the inside, in processor time.
coastlines.py --rings FOLDER WEST SOUTH EAST NORTH - prints the outer rings of the polygons within that box: `>` before each, and lines `x y`.

The file is that of the npm package @geo-maps/earth-lands-1km (OpenStreetMap contributors, ODbL): 19,639 polygons with 1.2 million
corners, some of which cross themselves or touch others. FOLDER keeps it. The first polygons, up to CORNERS corners, become
one file. The area of the mesh is compared with the areas of the polygons, which are not exact: some polygons have holes that overlap,
or are partly outside, and there a place is inside if a path to infinity crosses an odd number of sides.
"""

import json
import os
import resource
import subprocess
import sys
from pathlib import Path

PACKAGE = "@geo-maps/earth-lands-1km"
GOAL_S = 1.5  # of processor time
RUNS = 3


def fetch(folder):
    """The file of the package, from the folder or by npm."""
    path = folder / "package" / "map.geo.json"
    if not path.exists():
        folder.mkdir(parents=True, exist_ok=True)
        try:
            pack = subprocess.run(["npm", "pack", "--silent", PACKAGE], cwd=folder, check=True, capture_output=True, text=True)
            subprocess.run(["tar", "xzf", pack.stdout.split()[-1]], cwd=folder, check=True)
        except (OSError, subprocess.CalledProcessError, IndexError) as why:
            sys.exit(f"coastlines.py: {path} is missing, and npm cannot fetch {PACKAGE}: {why}")
    return path


def polygons(path):
    """The coordinates of each polygon in the file."""
    for geometry in json.loads(path.read_text())["geometries"]:
        yield from geometry["coordinates"] if geometry["type"] == "MultiPolygon" else [geometry["coordinates"]]


def corners(polygon):
    return sum(len(ring) - 1 for ring in polygon)


def area(polygon):
    """The area of the outer ring less the areas of the holes (shoelace formula)."""
    rings = [abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(r, r[1:]))) / 2 for r in polygon]
    return rings[0] - sum(rings[1:])


def choose(path, most):
    """The first polygons that have at most `most` corners together."""
    chosen, n = [], 0
    for polygon in polygons(path):
        if n + corners(polygon) <= most:
            chosen.append(polygon)
            n += corners(polygon)
    return chosen, n


def mesh_area(path):
    """The area of an OBJ file, and the number of its triangles."""
    places, total, n = [], 0, 0
    for line in path.open():
        word = line.split()
        if word and word[0] == "v":
            places.append((float(word[1]), float(word[2])))
        elif word and word[0] == "f":
            a, b, c = (places[int(w.split("/")[0]) - 1] for w in word[1:4])
            total += ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2
            n += 1
    return total, n


def measure(client, source, mesh):
    """The least processor time of some runs, the daemon's time included."""
    best = None
    for _ in range(RUNS):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([client, "run", source, mesh, "--inside", "any", "--split", "--force"], check=True, stdout=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        best = spent if best is None else min(best, spent)
    return best


def print_rings(folder, west, south, east, north):
    for polygon in polygons(fetch(folder)):
        ring = polygon[0][:-1]
        if all(west <= x <= east and south <= y <= north for x, y in ring):
            print(">")
            for x, y in ring:
                print(x, y)


def main():
    if sys.argv[1] == "--rings":
        return print_rings(Path(sys.argv[2]), *map(float, sys.argv[3:7]))
    client, folder, most = os.path.abspath(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3])
    chosen, n = choose(fetch(folder), most)
    source, mesh = folder / "coastlines.geojson", folder / "coastlines.obj"
    source.write_text(json.dumps({"type": "MultiPolygon", "coordinates": chosen}, separators=(",", ":")))
    seconds = measure(client, source, mesh)
    meshed, triangles = mesh_area(mesh)
    expected = sum(map(area, chosen))
    print("| polygons | corners | triangles inside | processor s | goal | area / area of the polygons |")
    print("|---|---|---|---|---|---|")
    print(f"| {len(chosen)} | {n} | {triangles} | {seconds:.2f} | {GOAL_S * n / 477000:.2f} | {meshed / expected:.8f} |")
    if abs(meshed / expected - 1) > 1e-3:
        sys.exit("coastlines.py: the areas differ")


main()
