#!/usr/bin/env bash
# From a text file of points to a text of their triangulation: through the daemon and loopback TCP, by a local CGAL
# program, and by qdelaunay (Debian's qhull-bin). Wall-clock seconds, the best of three.
#
#     end_to_end.sh BUILD_DIR N
set -euo pipefail
build=$1
n=$2
scratch=$(mktemp -d)
daemon=
stop() {
    [ -z "$daemon" ] || kill "$daemon"
    rm -rf "$scratch"
}
trap stop EXIT

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

by_cgal() { "$build/tests/bench/cgal_text" <"$scratch/points" >"$scratch/out"; }
by_qdelaunay() { { echo 2; echo "$n"; cat "$scratch/points"; } | qdelaunay Qt i >"$scratch/out"; }

"$build/tests/bench/points" uniform "$n" >"$scratch/points"
"$build/delaunayd" --port 0 >"$scratch/ready" &
daemon=$!
for _ in $(seq 50); do
    port=$(sed -n 's/^ready on .*:\([0-9]*\)$/\1/p' "$scratch/ready")
    [ -z "$port" ] || break
    sleep 0.1
done

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
