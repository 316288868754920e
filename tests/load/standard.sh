#!/usr/bin/env bash
# standard.sh BUILD POINTS - the standard scenarios of `make load`. The daemon runs alone, compared with redis-server and
# beanstalkd if they are installed, and while another set of POINTS points is triangulated.
# A ratio above 1 is in our favour.
set -euo pipefail
build=$1
points=$2
keys=1000000
pids=()
scratch=$(mktemp -d)
trap 'kill "${pids[@]}" 2>/dev/null || true; wait 2>/dev/null || true; rm -rf "$scratch"' EXIT

free_port() {
    local p
    for _ in $(seq 50); do
        p=$((20000 + RANDOM))
        (exec 3<>"/dev/tcp/127.0.0.1/$p") 2>/dev/null || { echo "$p"; return; }
    done
}

await_port() { # PORT
    for _ in $(seq 100); do
        (exec 3<>"/dev/tcp/127.0.0.1/$1") 2>/dev/null && return
        sleep 0.1
    done
    echo "nothing listens on port $1" >&2
    exit 1
}

# Each daemon is started when it is measured, so that it does not share caches and memory with the others.
"$build/delaunayd" --port 0 >"$scratch/ready" &
pids+=($!)
until [ -s "$scratch/ready" ]; do sleep 0.05; done
ours=$(sed 's/.*://' "$scratch/ready")

load() { "$build/load" --port "$ours" "$@"; }

echo "Machine: $(nproc) x$(sed -n 's/^model name\s*:/ /p;T;q' /proc/cpuinfo), Linux $(uname -r)"
echo
echo "Our generator, 50 connections; 'x 16': 16 requests on their way on each; 'at 2000/s': open loop."
echo
load --head
load --title "PING" --mix ping --seconds 3
load --title "PING x 16" --mix ping --pipeline 16 --seconds 3 --svg "$build/load-ping.svg"
load --title "NEAREST x 16, of 1e6" --mix nearest --pipeline 16 --seconds 3 --points $keys --set live \
    --svg "$build/load-nearest.svg"
load --title "LOCATE x 16" --mix locate --pipeline 16 --seconds 3 --held $keys --set live
load --title "LISTS of one x 16" --mix lists --pipeline 16 --seconds 3 --held $keys --set live
load --title "NEAREST 9 : ADD 1 x 16" --mix nearest=9,add=1 --pipeline 16 --seconds 3 --points $keys --set edited
load --title "PING at 2000/s" --mix ping --rate 2000 --seconds 3
load --title "NEAREST at 2000/s" --mix nearest --rate 2000 --seconds 3 --held $keys --set live

# ---- a triangulation meanwhile ----

load --title "(TRIANGULATE of $points)" --mix triangulate --connections 1 --count 1 --seconds 300 --points "$points" \
    --set big >"$scratch/one"
load --mix triangulate --connections 1 --seconds 8 --set big --title "(TRIANGULATE again, again)" >"$scratch/big" &
heavy=$!
sleep 0.3
load --title "  meanwhile PING at 2000/s" --mix ping --rate 2000 --seconds 3 --svg "$build/load-meanwhile.svg"
load --title "  meanwhile NEAREST 2000/s" --mix nearest --rate 2000 --seconds 3 --held $keys --set live
wait "$heavy"
cat "$scratch/one" "$scratch/big"
printf 'DROP big\nDROP edited\n' | "$build/delaunay" --port "$ours" >/dev/null 2>&1 || true

# ---- beside redis-server, with its own benchmark ----

# bench PORT PIPELINE WORDS...: "requests-per-second p50 p99" of redis-benchmark
bench() {
    local port=$1 pipeline=$2 n=100000
    shift 2
    [ "$pipeline" -eq 1 ] || n=1000000
    redis-benchmark -p "$port" -c 50 -P "$pipeline" -n $n -r $keys --csv "$@" 2>/dev/null |
        awk -F'","' '/^"test"/ {next} {print $2, $5, $7}'
}

compare() { # NAME PIPELINE OURS -- THEIRS: the better of two runs each, in turn
    local name=$1 pipeline=$2 mine=() a b best_a="0 0 0" best_b="0 0 0"
    shift 2
    while [ "$1" != -- ]; do mine+=("$1"); shift; done
    shift
    for _ in 1 2; do
        a=$(bench "$ours" "$pipeline" "${mine[@]}")
        b=$(bench "$redis" "$pipeline" "$@")
        best_a=$(printf '%s\n%s\n' "$a" "$best_a" | sort -rn | head -n 1)
        best_b=$(printf '%s\n%s\n' "$b" "$best_b" | sort -rn | head -n 1)
    done
    echo "$best_a $best_b" | awk -v name="$name" '{
        printf "| %-28s | %11.0f | %11.0f | %5.2f | %9.3f | %9.3f |\n", name, $1, $4, $1 / $4, $3, $6}'
}

if command -v redis-server >/dev/null && command -v redis-benchmark >/dev/null; then
    redis=$(free_port)
    redis-server --port "$redis" --save '' --appendonly no >/dev/null &
    pids+=($!)
    await_port "$redis"
    awk -v n=$keys 'BEGIN {for (i = 0; i < n; i++) printf "SET key:%012d xxx\r\n", i}' |
        redis-cli -p "$redis" --pipe >/dev/null
    echo
    echo "Beside $(redis-server --version | cut -d' ' -f1-3), both asked by redis-benchmark -c 50, Redis's over $keys keys:"
    echo
    printf '| %-28s | %11s | %11s | %5s | %9s | %9s |\n' "scenario" "ours /s" "redis /s" ratio "our p99" "its p99"
    echo "|:-----------------------------|------------:|------------:|------:|----------:|----------:|"
    compare "PING : PING" 1 PING -- PING
    compare "PING : PING, -P 16" 16 PING -- PING
    compare "NEAREST : GET, -P 16" 16 NEAREST live __rand_int__ __rand_int__ -- GET key:__rand_int__
    compare "LISTS of one : GET, -P 16" 16 LISTS live __rand_int__ -- GET key:__rand_int__
fi

# ---- beside beanstalkd, with our generator ----

if command -v beanstalkd >/dev/null; then
    stalk=$(free_port)
    beanstalkd -l 127.0.0.1 -p "$stalk" &
    pids+=($!)
    await_port "$stalk"
    echo
    echo "Beside beanstalkd $(beanstalkd -v | cut -d' ' -f2), our generator, 50 connections (PING : use):"
    echo
    for pipeline in 1 16; do
        load --mix ping --pipeline $pipeline --seconds 2 >"$scratch/a"
        "$build/load" --port "$stalk" --mix beanstalkd-use --pipeline $pipeline --seconds 2 >"$scratch/b"
        paste -d'|' "$scratch/a" "$scratch/b" | awk -F'|' -v p=$pipeline '{
            printf "x %-2d  ours %.0f/s, p99 %s ms; beanstalkd %.0f/s, p99 %s ms; ratio %.2f\n", p, $3, $5 + 0, $12, $14 + 0, $3 / $12}'
    done
fi
