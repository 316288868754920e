#!/usr/bin/env bash
# From a text file of points to a text of their triangulation: through the daemon and loopback TCP, by a local CGAL
# program, and by qdelaunay (Debian's qhull-bin). Wall-clock seconds, the best of three. Then the cost of a row of each whole
# table, with ids at random in the plane, and with ids of neighbours close to each other.
#
#     end_to_end.sh BUILD_DIR N
set -euo pipefail
build=$1
n=$2
. "${BASH_SOURCE%/*}/one_daemon.sh"

best_of_three() { # COMMAND...
    local best= start t
    for _ in 1 2 3; do
        start=$EPOCHREALTIME
        "$@"
        t=$(echo "$start $EPOCHREALTIME" | awk '{print $2 - $1}')
        best=$(echo "${best:-$t} $t" | awk '{print $1 < $2 ? $1 : $2}')
    done
    echo "$best"
}

through_daemon() { # ROWS
    { printf 'LOAD s\n'; cat "$scratch/points"; printf '.\nTRIANGULATE s\n%s s\nDROP s\n' "$1"; } |
        nc -N 127.0.0.1 "$port" >"$scratch/out"
    tail -n 1 "$scratch/out" | grep -q '^OK 0'
}

ask() { # REQUEST: a whole table of the set t
    printf '%s t\n' "$1" | nc -N 127.0.0.1 "$port" >"$scratch/out"
    head -n 1 "$scratch/out" | grep -q '^OK '
}

# Loads FILE as t; then a line for each table: nanoseconds a row.
time_tables() { # FILE
    local table seconds rows
    { printf 'LOAD t\n'; cat "$1"; printf '.\nTRIANGULATE t\n'; } | nc -N 127.0.0.1 "$port" >"$scratch/out"
    for table in LISTS TRIANGLES EDGES POINTS; do
        seconds=$(best_of_three ask "$table")
        rows=$(($(wc -l <"$scratch/out") - 1))
        echo "$seconds $rows" | awk '{printf "%.0f\n", $1 / $2 * 1e9}'
    done
    printf 'DROP t\n' | nc -N 127.0.0.1 "$port" >"$scratch/out"
}

by_cgal() { "$build/tests/bench/cgal_text" <"$scratch/points" >"$scratch/out"; }
by_qdelaunay() { { echo 2; echo "$n"; cat "$scratch/points"; } | qdelaunay Qt i >"$scratch/out"; }

"$build/tests/bench/points" uniform "$n" >"$scratch/points"
start_daemon

echo "$n uniform points, text in, text out; wall-clock seconds."
echo
echo '| program | s | daemon, LISTS / this |'
echo '|---|---|---|'
lists=$(best_of_three through_daemon LISTS)
row() { # NAME SECONDS
    echo "$1 | $2 | $lists" | awk -F' [|] ' '{printf "| %s | %.2f | %.2f |\n", $1, $2, $3 / $2}'
}
row "daemon over TCP: LOAD, TRIANGULATE, LISTS" "$lists"
row "daemon over TCP: LOAD, TRIANGULATE, TRIANGLES" "$(best_of_three through_daemon TRIANGLES)"
[ ! -x "$build/tests/bench/cgal_text" ] || row "local CGAL program" "$(best_of_three by_cgal)"
! command -v qdelaunay >/dev/null || row "qdelaunay" "$(best_of_three by_qdelaunay)"

# Strips of the unit square, each from one end to the other.
awk '{printf "%d %s\n", $1 * 500, $0}' "$scratch/points" | sort -k1,1n -k3,3g | cut -d' ' -f2- >"$scratch/strips"
time_tables "$scratch/points" >"$scratch/random_ns"
time_tables "$scratch/strips" >"$scratch/strips_ns"
echo
echo "The whole table of $n points over TCP, nanoseconds a row on the wall."
echo
echo '| request | ids at random | ids in strips |'
echo '|---|---|---|'
printf '%s\n' LISTS TRIANGLES EDGES POINTS | paste -d'|' - "$scratch/random_ns" "$scratch/strips_ns" |
    sed 's/|/ | /g; s/^/| /; s/$/ |/'
