#!/usr/bin/env bash
# The replies of a daemon, and what the core computes in process, beside CGAL's.
#
#     cgal.sh BUILD_DIR        prints what failed, and at the end one line: N passed, N failed
. "$(dirname "$0")/common.sh" "$1"

compare_with_cgal() {
    local shard shards=()
    for shard in 0 1; do
        "$build/interop/compare" "$port" "$shard" 2 >"$scratch/shard$shard" 2>&1 &
        shards+=($!)
    done
    wait "${shards[@]}"
    collect "$scratch/shard0"
    collect "$scratch/shard1"
}

# Values, weights and alpha shapes, also after a crash: the log has all edits.
compare_surfaces() {
    start_daemon port --data "$scratch/data"
    "$build/interop/surfaces" "$port" >"$scratch/surfaces" 2>&1
    collect "$scratch/surfaces"
    { kill -KILL "$daemon" && wait "$daemon"; } 2>/dev/null
    start_daemon port --data "$scratch/data"
    "$build/interop/surfaces" "$port" again >"$scratch/surfaces" 2>&1
    collect "$scratch/surfaces"
    count "clean stop after a restart" stops_cleanly
}

constrained_sets() {
    timeout 300 "$build/interop/constrained" 10000 2000 "$(date +%s)"
}

many_small_sets() {
    timeout 120 "$build/interop/small_sets" 20000 "$(date +%s)"
}

start_daemon port
compare_with_cgal
count "constrained sets" constrained_sets
count "many small sets" many_small_sets
count "clean stop on SIGTERM" stops_cleanly
compare_surfaces
result
