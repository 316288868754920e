#!/usr/bin/env bash
# The speed of the command line, of the Python package and of Redis's tools, compared with their alternatives.
#
#     clients.sh BUILD_DIR N      N points; tables in Markdown on the standard output
set -euo pipefail
build=$1
n=$2
python=/usr/bin/python3 # Debian's, which sees Debian's packages
scratch=$(mktemp -d)
pids=()
trap 'kill "${pids[@]}" 2>/dev/null || true; wait 2>/dev/null || true; rm -rf "$scratch"' EXIT

"$build/delaunayd" --port 0 >"$scratch/ready" &
daemon=$!
pids+=("$daemon")
until [ -s "$scratch/ready" ]; do sleep 0.05; done
port=$(sed 's/.*://' "$scratch/ready")
delaunay() { "$build/delaunay" -h 127.0.0.1 -p "$port" "$@"; }

ratio() { awk -v a="$1" -v b="$2" 'BEGIN {printf "%.3f", a / b}'; }

# The wall-clock seconds of the best of three runs, in $best.
best_of_three() { # COMMAND...
    local start t
    best=
    for _ in 1 2 3; do
        start=$EPOCHREALTIME
        "$@"
        t=$(awk -v a="$start" -v b="$EPOCHREALTIME" 'BEGIN {print b - a}')
        best=$(awk -v a="${best:-$t}" -v b="$t" 'BEGIN {print a < b ? a : b}')
    done
}

echo "Machine: $(nproc) x$(sed -n 's/^model name\s*:/ /p;T;q' /proc/cpuinfo), load $(cut -d' ' -f1 /proc/loadavg); $n points."

# ---- files ----

by_command_line() {
    delaunay load s "$scratch/points" >/dev/null
    delaunay triangulate s >/dev/null
    delaunay export s "$scratch/out.ele" >/dev/null
    delaunay drop s >/dev/null
}
by_qdelaunay() { { echo 2; echo "$n"; cat "$scratch/points"; } | qdelaunay Qt i >"$scratch/out"; }

files() {
    "$build/tests/bench/points" uniform "$n" >"$scratch/points"
    printf '\nFrom a file of points to a file of triangles, seconds on the wall, best of three:\n\n'
    printf '| program | s | ratio |\n|---|---|---|\n'
    best_of_three by_command_line
    local ours=$best
    printf '| delaunay load, triangulate, export to .ele, drop | %.2f | |\n' "$ours"
    command -v qdelaunay >/dev/null || { echo '| (no qdelaunay: qhull-bin) | | |'; return 0; }
    best_of_three by_qdelaunay
    printf '| qdelaunay i | %.2f | %s |\n' "$best" "$(ratio "$ours" "$best")"
}

# ---- Python ----

arrays() {
    printf '\nPython in process with NumPy, and SciPy:\n\n'
    "$python" tests/bench/beside_scipy.py "$n" "$port"
}

# ---- framings ----

# The processor seconds of a process and its threads.
cpu_of() { awk -v hz="$(getconf CLK_TCK)" '{sub(/.*\) /, ""); print ($12 + $13) / hz}' "/proc/$1/stat"; }

# Runs a client that prints replies a second; the row shows the cost of a reply for it and for the server.
row() { # TITLE SERVER_PID BASE COMMAND...
    local title=$1 pid=$2 base=$3 before after used replies start=$EPOCHREALTIME
    shift 3
    before=$(cpu_of "$pid")
    TIMEFORMAT='%U %S'
    { time "$@" >"$scratch/rate" 2>"$scratch/noise"; } 2>"$scratch/time"
    after=$(cpu_of "$pid")
    rate=$(tr '\r' '\n' <"$scratch/rate" | sed -nE 's/^\|[^|]*\| *([0-9]+) .*/\1/p; s/.*: ([0-9.]+) requests per second.*/\1/p' | tail -n 1)
    replies=$(awk -v a="$start" -v b="$EPOCHREALTIME" -v r="$rate" 'BEGIN {print r * (b - a)}')
    used=$(awk -v c="$after" -v d="$before" -v n="$replies" '{printf "%.1f | %.1f", 1e6 * (c - d) / n, 1e6 * ($1 + $2) / n}' \
        "$scratch/time")
    printf '| %s | %.0f | %s | %s |\n' "$title" "$rate" "$(ratio "$rate" "${base:-$rate}")" "$used"
}

ours() { "$build/load" --port "$port" --seconds 3 --set live "$@"; }
theirs() { redis-benchmark -p "$1" -q -c 50 -n "$2" -r 1000000 "${@:3}"; }

framings() {
    local pipeline base redis=
    printf '\nReplies a second, 50 connections; x 16: 16 requests on their way on each. What a reply costs in\nmicroseconds of processor time says which side is the limit, and does not depend on what else the machine does.\n\n'
    printf '| client | replies/s | of our generator in lines | server, us | client, us |\n|---|---|---|---|---|\n'
    ours --mix nearest --seconds 0.1 --points 1000000 >/dev/null
    if command -v redis-server >/dev/null; then
        redis=$((20000 + RANDOM % 10000))
        redis-server --port "$redis" --save '' --appendonly no >/dev/null &
        redis_pid=$!
        pids+=("$redis_pid")
        until redis-cli -p "$redis" PING >/dev/null 2>&1; do sleep 0.05; done
    fi
    for pipeline in 1 16; do
        local x=
        [ "$pipeline" = 1 ] || x=" x $pipeline"
        row "PING$x: our generator, lines" "$daemon" '' ours --mix ping --pipeline "$pipeline"
        base=$rate
        row "PING$x: our generator, RESP" "$daemon" "$base" ours --mix ping --pipeline "$pipeline" --resp
        command -v redis-benchmark >/dev/null || continue
        row "PING$x: redis-benchmark" "$daemon" "$base" theirs "$port" $((100000 * pipeline)) -P "$pipeline" PING
        [ -z "$redis" ] ||
            row "PING$x: redis-benchmark, of redis-server" "$redis_pid" "$base" theirs "$redis" $((100000 * pipeline)) -P "$pipeline" PING
    done
    for pipeline in 1 16; do
        local x=
        [ "$pipeline" = 1 ] || x=" x $pipeline"
        row "NEAREST$x: our generator, lines" "$daemon" '' ours --mix nearest --held 1000000 --pipeline "$pipeline"
        base=$rate
        row "NEAREST$x: our generator, RESP" "$daemon" "$base" ours --mix nearest --held 1000000 --pipeline "$pipeline" --resp
        command -v redis-benchmark >/dev/null || continue
        row "NEAREST$x: redis-benchmark" "$daemon" "$base" theirs "$port" $((100000 * pipeline)) -P "$pipeline" \
            NEAREST live __rand_int__ __rand_int__
    done
}

for table in ${TABLES:-files arrays framings}; do "$table"; done
