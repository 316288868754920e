#!/usr/bin/env bash
# herd.sh BUILD REACTORS [SECONDS] - how long a stranger's PING takes beside a herd: 1,000 clients that all ask at the same moment,
# again when all of them are answered. PING of another daemon, which is idle, shows how much of that is the machine.
set -euo pipefail
build=$1
reactors=$2
seconds=${3:-5}
keys=1000000
pids=()
scratch=$(mktemp -d)
trap 'kill "${pids[@]}" 2>/dev/null || true; wait 2>/dev/null || true; rm -rf "$scratch"' EXIT

start() { # NAME [OPTION...]
    "$build/delaunayd" --port 0 --reactors "$reactors" "${@:2}" >"$scratch/$1" &
    pids+=($!)
    until [ -s "$scratch/$1" ]; do sleep 0.05; done
    sed 's/.*://' "$scratch/$1"
}

start asked >"$scratch/port"
start logs --data "$scratch/data" --fsync everysec >"$scratch/with_log"
start idle >"$scratch/other"
port=$(<"$scratch/port")
with_log=$(<"$scratch/with_log")
other=$(<"$scratch/other")

ping() { # PORT TITLE
    "$build/load" --port "$1" --title "$2" --mix ping --rate 500 --connections 4 --seconds "$seconds"
}

beside() { # KIND [FLAG...]
    "$build/load" --port "$port" --title "$* $note" --mix "$1" --held $keys --set live --seconds $((seconds + 1)) \
        --connections 1000 "${@:2}" >"$scratch/herd" &
    local herd=$!
    sleep 0.5
    ping "$other" "  beside it PING of another" >"$scratch/idle_row" &
    local second=$!
    ping "$port" "  beside it PING" >"$scratch/row"
    wait "$second" "$herd"
    cat "$scratch/herd" "$scratch/row" "$scratch/idle_row"
}

for p in "$port" "$with_log"; do
    "$build/load" --port "$p" --mix nearest --count 1 --points $keys --set live >/dev/null
done
note=""
"$build/load" --head
ping "$port" "PING"
beside nearest --together
beside nearest-32 --together
beside add --together
beside nearest
beside add
port=$with_log
note="with a log"
beside add --together
