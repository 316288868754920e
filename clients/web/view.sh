#!/bin/sh
# view.sh DAEMON CLIENT DATA TOWNS BUILD - starts a daemon in memory with the table TOWNS as `ireland`, the demo's places and terrain.
# Starts the gateway and prints the address of the page. Ends both when it is interrupted. The gateway's package is fetched to BUILD once. For `make view`.
set -eu
daemon=$1 client=$2 data=$3 towns=$4 build=$5
here=$(dirname "$0")
tmp=$(mktemp -d)
pid=

stop()
{
    trap - EXIT INT TERM
    [ -z "$pid" ] || kill "$pid" 2>/dev/null || true
    rm -rf "$tmp"
}
trap stop EXIT
trap 'exit 0' INT TERM

mkdir -p "$build"
cp -RL "$here/gateway.mjs" "$here/package.json" "$here/page" "$build/"
cp "$towns" "$build/page/ireland.csv"
[ -d "$build/node_modules/ws" ] || npm install --prefix "$build" --omit=dev --no-audit --no-fund --silent

: >"$tmp/ready"
"$daemon" --port 0 --log-level warning >"$tmp/ready" &
pid=$!
while ! port=$(sed -n 's/^ready on .*:\([0-9]*\)$/\1/p' "$tmp/ready") || [ -z "$port" ]; do
    kill -0 "$pid" || exit 1
    sleep 0.05
done
cut -d , -f 2,3 "$towns" >"$tmp/ireland.csv" # without names
for file in "$tmp/ireland.csv" "$data/cities.xy" "$data/terrain.xyz"; do
    set=$(basename "${file%.*}")
    "$client" -p "$port" load "$set" "$file" >"$tmp/out" 2>&1 || { cat "$tmp/out" >&2; exit 1; }
    "$client" -p "$port" TRIANGULATE "$set" >"$tmp/out"
done
echo "daemon on port $port"
node "$build/gateway.mjs" --daemon "$port" --listen "${VIEW_LISTEN:-127.0.0.1:8080}"
