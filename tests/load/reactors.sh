#!/usr/bin/env bash
# reactors.sh BUILD "REACTORS ..." GENERATORS [SECONDS] - throughput of the daemon by its number of reactors. GENERATORS
# processes ask at the same time, each on 32 connections with 16 requests on their way. Prints, for each kind of
# request and number of reactors, the replies per second and the daemon's processor time per reply.
set -euo pipefail
build=$1
reactors=$2
generators=$3
seconds=${4:-3}
keys=1000000
scratch=$(mktemp -d)
pids=()
trap 'kill "${pids[@]}" 2>/dev/null || true; wait 2>/dev/null || true; rm -rf "$scratch"' EXIT

start() { # OPTION...
    rm -f "$scratch/ready"
    "$build/delaunayd" --port 0 "$@" >"$scratch/ready" &
    pids=($!)
    until [ -s "$scratch/ready" ]; do sleep 0.05; done
    port=$(sed 's/.*://' "$scratch/ready")
}

stop() {
    kill "${pids[@]}"
    wait "${pids[@]}" || true
    pids=()
}

cpu_ticks() { awk '{print $14 + $15}' "/proc/${pids[0]}/stat"; }

# A cell of the table; %g in a flag is the number of the generator.
cell() { # FLAG...
    local before generator=() i
    before=$(cpu_ticks)
    for i in $(seq "$generators"); do
        "$build/load" --port "$port" --connections 32 --pipeline 16 --seconds "$seconds" "${@//%g/$i}" >"$scratch/out.$i" &
        generator+=($!)
    done
    wait "${generator[@]}"
    awk -F'|' -v ticks=$(($(cpu_ticks) - before)) -v seconds="$seconds" '
        {gsub(/ /, "", $3); rate += $3}
        END {printf " %.2f M/s, %d ns |", rate / 1e6, ticks * 1e7 / (rate * seconds)}' "$scratch"/out.*
}

table() { # OPTION... of the daemon
    local n title flags
    for title in "${order[@]}"; do line[$title]="| $title |"; done
    for n in $reactors; do
        start --reactors "$n" "$@"
        "$build/load" --port "$port" --mix nearest --count 1 --points $keys --set live >/dev/null
        for title in "${order[@]}"; do
            read -ra flags <<<"${scenario[$title]}"
            line[$title]+=$(cell "${flags[@]}")
        done
        stop
    done
    for title in "${order[@]}"; do echo "${line[$title]}"; done
}

declare -A scenario=(
    ["PING"]="--mix ping"
    ["LOCATE, of 1e6"]="--mix locate --held $keys --set live"
    ["NEAREST, of 1e6"]="--mix nearest --held $keys --set live"
    ["NEAREST of 32"]="--mix nearest-32 --held $keys --set live"
    ["WITHIN of 100"]="--mix within-100 --held $keys --set live"
    ["NEAREST 9 : ADD 1, one set"]="--mix nearest=9,add=1 --held $keys --set live"
    ["ADD, a set for each generator"]="--mix add --set add%g"
) line=()
order=("PING" "LOCATE, of 1e6" "NEAREST, of 1e6" "NEAREST of 32" "WITHIN of 100" "NEAREST 9 : ADD 1, one set"
    "ADD, a set for each generator")

echo "$generators generators of 32 connections, 16 requests on their way on each; $(nproc) processors. Replies per second, and the"
echo "daemon's processor time for each reply, by the number of reactors:"
echo
printf '| |'
printf ' %s |' $reactors
printf '\n|---|'
printf '%s---|' $(printf '%.0s ' $reactors)
for _ in $reactors; do printf -- '---|'; done
echo
table
echo
echo "with a log, --fsync everysec:"
echo
order=("ADD, a set for each generator")
table --data "$scratch/data" --fsync everysec
