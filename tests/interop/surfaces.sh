#!/usr/bin/env bash
# Replies about surfaces, beside their definitions in rational arithmetic, Matplotlib, SciPy and shapely.
#
#     surfaces.sh BUILD_DIR        prints what failed, and at the end one line: N passed, N failed
. "$(dirname "$0")/common.sh" "$1"

# Outlines that people publish.
fetch_atlas() {
    [ -e "$build/interop/npm_atlas/node_modules/us-atlas" ] ||
        timeout 120 npm install --prefix "$build/interop/npm_atlas" --no-save --no-package-lock --no-audit --no-fund --ignore-scripts \
            world-atlas@2.0.2 us-atlas@3.0.1 >"$scratch/npm" 2>&1
}

start_daemon port
count "weights in rational arithmetic" "$python" tests/interop/weights.py "$port"
count "values in rational arithmetic" "$python" tests/interop/values.py "$port"
count "Voronoi cells in rational arithmetic" "$python" tests/interop/cells.py "$port"
count "surfaces beside Matplotlib and SciPy on all families" "$python" tests/interop/surfaces.py "$build"
count "simplified sets in rational arithmetic on all families" "$python" tests/interop/simplify.py "$build"
count "refined meshes in rational arithmetic on all families" "$python" tests/interop/refine.py "$build"
count "volumes in rational arithmetic on all families" "$python" tests/interop/volumes.py "$build"
count "missing values that are skipped, beside sets that never had these points" "$python" tests/interop/fields/missing.py "$build"
count "several fields of one request, beside each alone" "$python" tests/interop/fields/several.py "$build"
count "gradients and profiles in rational arithmetic on all families" "$python" tests/interop/slopes.py "$build"
count "terrain models in rational arithmetic" "$python" tests/interop/terrain.py "$build" 5 40
count "angles in rational arithmetic on all families" "$python" tests/interop/angles.py "$build"
count "bands in rational arithmetic on all families" "$python" tests/interop/bands.py "$build"
if fetch_atlas; then
    count "outlines of countries and counties in process beside shapely" "$python" tests/interop/outlines.py \
        "$build"/interop/npm_atlas/node_modules/{world-atlas/countries-50m,world-atlas/land-10m,us-atlas/counties-10m}.json
else
    skip "outlines of countries and counties in process beside shapely" "npm cannot fetch packages here"
fi
result
