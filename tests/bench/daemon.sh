#!/usr/bin/env bash
# The time of TRIANGULATE after LOADB as the daemon reports it (ms= in its reply, wall-clock time), compared with bare CGAL.
# A daemon and a CGAL program have just started, or have built another such set before. Nanoseconds per point, the
# best of ROUNDS, in which runs alternate between all of them.
#
#     daemon.sh BUILD_DIR N ROUNDS FAMILY...
set -euo pipefail
build=$1
n=$2
rounds=$3
shift 3
. "${BASH_SOURCE%/*}/one_daemon.sh"

# Sends FILE... as sets to a daemon of its own, and triangulates and drops each before the next; prints a line of nanoseconds
# per point for each.
by_daemon() { # THREADS FILE...
    local file
    start_daemon --threads "$1"
    shift
    for file; do
        { printf 'LOADB s %s\n' "$n"; cat "$file"; printf 'TRIANGULATE s\nDROP s\n'; } |
            nc -N 127.0.0.1 "$port" | awk -v n="$n" '/ ms=/ {sub(/.* ms=/, ""); print $1 * 1e6 / n}'
    done
    stop_daemon
}

# One round: fresh and used, with one thread, with two, CGAL.
round() { # FAMILY
    by_daemon 1 "$scratch/before" "$scratch/points"
    by_daemon 2 "$scratch/before" "$scratch/points"
    [ ! -x "$build/tests/bench/cgal_speed" ] || for memory in fresh warm; do
        "$build/tests/bench/cgal_speed" "$1" "$n" 1 "$memory" bare | cut -d' ' -f1
    done
}

row() { # FAMILY
    "$build/tests/bench/points" --binary "$1" "$n" 1 >"$scratch/before"
    "$build/tests/bench/points" --binary "$1" "$n" 2 >"$scratch/points"
    for _ in $(seq "$rounds"); do round "$1" | paste -s -d' '; done >"$scratch/ns"
    awk -v family="$1" '
        { for (i = 1; i <= 6; i++) if ($i != "" && (NR == 1 || $i < best[i])) best[i] = $i }
        function ratio(a, b) { return best[b] == "" ? "-" : sprintf("%.2f", best[a] / best[b]) }
        function ns(i) { return best[i] == "" ? "-" : sprintf("%.0f", best[i]) }
        END {
            print "| " family " | " ns(1) " | " ns(3) " | " ns(5) " | " ratio(1, 5) " | " ratio(3, 5) " | " ns(2) " | " ns(4) " | " \
                ns(6) " | " ratio(2, 6) " | " ratio(4, 6) " |"
        }' "$scratch/ns"
}

echo "TRIANGULATE after LOADB of $n points, ns per point by the daemon's own ms, with --threads 1 and 2, beside bare CGAL."
echo
echo '| family | fresh, 1 thread | 2 threads | CGAL | 1 thread / CGAL | 2 threads / CGAL | used, 1 thread | 2 threads | CGAL | 1 thread / CGAL | 2 threads / CGAL |'
echo '|---|---|---|---|---|---|---|---|---|---|---|'
for family; do row "$family"; done
echo
