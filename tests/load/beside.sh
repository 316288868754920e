#!/usr/bin/env bash
# beside.sh BUILD OTHER [ROUNDS] - throughput of the daemon beside the program of an earlier version. Runs of a few
# seconds alternate between the two, on the same points. Prints, for each kind of request, the medians of the
# replies per second and of the daemon's processor time per reply, and their ratios, this daemon's over the other's.
set -euo pipefail
build=$1
other=$2
rounds=${3:-7}
keys=1000000
scratch=$(mktemp -d)
pids=()
trap 'kill "${pids[@]}" 2>/dev/null || true; wait 2>/dev/null || true; rm -rf "$scratch"' EXIT

# start NAME PROGRAM [OPTION...]: sets pid and port of NAME.
declare -A pid port
start() {
    rm -f "$scratch/$1.ready"
    "$2" --port 0 "${@:3}" >"$scratch/$1.ready" &
    pid[$1]=$!
    pids+=($!)
    until [ -s "$scratch/$1.ready" ]; do sleep 0.05; done
    port[$1]=$(sed 's/.*://' "$scratch/$1.ready")
}

cpu_ticks() { awk '{print $14 + $15}' "/proc/${pid[$1]}/stat"; }

# measure NAME FLAG...: appends `replies/s` and `processor time per reply in ns` to NAME's file.
measure() {
    local name=$1 before rate seconds=2
    shift
    before=$(cpu_ticks "$name")
    rate=$("$build/load" --port "${port[$name]}" --seconds $seconds "$@" | awk -F'|' '{gsub(/ /, "", $3); print $3}')
    echo "$rate $(((($(cpu_ticks "$name") - before) * 10000000) / (rate * seconds)))" >>"$scratch/$name.figures"
}

median() { sort -n | awk '{v[NR] = $1} END {print v[int((NR + 1) / 2)]}'; }

row() { # TITLE FLAG...
    local title=$1 rate=() cpu=() name
    shift
    rm -f "$scratch"/*.figures
    for _ in $(seq "$rounds"); do
        for name in ours other; do measure $name "$@"; done
    done
    for name in ours other; do
        rate+=("$(cut -d' ' -f1 "$scratch/$name.figures" | median)")
        cpu+=("$(cut -d' ' -f2 "$scratch/$name.figures" | median)")
    done
    awk -v t="$title" -v a="${rate[0]}" -v b="${rate[1]}" -v c="${cpu[0]}" -v d="${cpu[1]}" \
        'BEGIN {printf "| %s | %d | %d | %.2f | %d | %d | %.2f |\n", t, a, b, a / b, c, d, c / d}'
}

table() { # TITLE
    echo "| $1 | replies/s | the other's | ratio | processor time, ns | the other's | ratio |"
    echo "|---|---|---|---|---|---|---|"
}

start ours "$build/delaunayd"
start other "$other"
for name in ours other; do
    "$build/load" --port "${port[$name]}" --mix nearest --count 1 --points $keys --set live >"$scratch/load"
done
table "in memory, 50 connections, 16 requests on their way on each"
row "PING" --mix ping --pipeline 16
row "NEAREST of 1e6" --mix nearest --pipeline 16 --held $keys --set live
row "ADD" --mix add --pipeline 16 --set new
row "NEAREST 9 : ADD 1" --mix nearest=9,add=1 --pipeline 16 --held $keys --set live
kill "${pids[@]}"
wait
echo
start ours "$build/delaunayd" --data "$scratch/ours.data" --fsync always
start other "$other" --data "$scratch/other.data" --fsync always
table "--fsync always, in $(df --output=fstype "$scratch" | tail -1)"
row "ADD, 50 connections" --mix add --set t
row "ADD x 16" --mix add --pipeline 16 --set u
row "PING x 16" --mix ping --pipeline 16
