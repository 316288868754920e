#!/usr/bin/env bash
# The daemon with other programs, and our clients in other languages. These are redis-cli, redis-benchmark, hiredis, redis-py, the
# Node package, an XML parser of the film that `delaunay trace` makes, haproxy with two daemons.
#
#     clients.sh BUILD_DIR        prints what failed, and at the end one line: N passed, N failed
. "$(dirname "$0")/common.sh" "$1"

# ---- Redis's programs ----

cli() { redis-cli -p "$port" "$@"; }

redis_cli_speaks() {
    [ "$(cli PING)" = PONG ] && [ "$(cli -3 PING)" = PONG ] && [ "$(cli ECHO a b)" != "a b" ] &&
        cli ADD r 0 0 4 0 4 4 0 4 2 2 | grep -qx 'OK first=0 added=5 coincident=0 version=[0-9]*' &&
        cli TRIANGULATE r | grep -q '^OK points=5 ' && [ "$(cli LISTS r | head -n 1)" = "4 0 1 2 3" ] &&
        [ "$(cli -3 HULL r | tr '\n' ' ')" = "0 0 0 1 4 0 2 4 4 3 0 4 " ] && cli GET r 9 | grep -q '^NOPOINT ' &&
        printf 'PING\nSTAT r\n' | cli | grep -q '^OK points=5 ' &&
        printf '1 2\n3 4\n' | cli -x LOAD r 2 | grep -qx 'OK first=5 added=2 coincident=0 version=[0-9]*' &&
        printf '*2\r\n$4\r\nTYPE\r\n$1\r\nr\r\n' | cli --pipe | grep -qx 'errors: 0, replies: 1'
}

# The modes of redis-cli that clients/README.md lists.
redis_cli_modes_work() {
    local i stat
    for i in $(seq 40); do cli CREATE "key:$i" >/dev/null; done
    [ "$(cli --scan --pattern 'key:*' | sort -u | wc -l)" -eq 40 ] && [ "$(cli -3 --scan | sort -u | wc -l)" -eq 41 ] &&
        cli --bigkeys | tee "$scratch/big" | grep -q '^41 pointsets with 0 ' && ! grep -i error "$scratch/big" &&
        cli --memkeys | grep -q '^41 pointsets with [1-9][0-9]* bytes' && [ "$(cli KEYS 'key:[1-3]' | wc -l)" -eq 3 ] &&
        [ "$(cli -3 DBSIZE)" = 41 ] && [ "$(cli -3 NEAREST r 1 1 1 | tr '\n' ' ')" = "5 1 2 1 " ] || return 1
    { stdbuf -oL redis-cli -p "$port" --stat || true; } >"$scratch/stat" &
    stat=$!
    timeout 3 redis-cli -p "$port" --latency >"$scratch/latency"
    kill "$stat" "$(pgrep -P "$stat")"
    wait "$stat" 2>/dev/null
    cat "$scratch/stat" "$scratch/latency"
    grep -qE '^41 +[0-9.]+[KM] +[0-9]+ +0 ' "$scratch/stat" && [ -s "$scratch/latency" ] &&
        for i in $(seq 40); do cli DROP "key:$i" >/dev/null || return 1; done
}

redis_benchmark_runs() {
    redis-benchmark -p "$port" -q -n 20000 -P 16 PING >"$scratch/ping" &&
        redis-benchmark -p "$port" -q -n 20000 -r 4 NEAREST r __rand_int__ 1 >"$scratch/nearest" &&
        cat "$scratch/ping" "$scratch/nearest" && ! grep -i 'error\|warn' "$scratch/ping" "$scratch/nearest" &&
        [ "$(cat "$scratch/ping" "$scratch/nearest" | tr '\r' '\n' | grep -c 'requests per second')" -eq 2 ]
}

# Redis's clients for Node, of fixed versions, kept in the build folder.
fetch_node_redis() {
    [ -e "$build/interop/npm_redis/node_modules/ioredis5" ] ||
        timeout 120 npm install --prefix "$build/interop/npm_redis" --no-save --no-package-lock --no-audit --no-fund --ignore-scripts \
            redis@6.3.1 ioredis@6.0.0 redis5@npm:redis@5.12.1 ioredis5@npm:ioredis@5.11.1 >"$scratch/npm" 2>&1
}

# ---- our clients with a million points, and with a daemon that dies meanwhile ----

millions() { # the Python and Node packages have tests of their own for that
    awk 'BEGIN {srand(5); for (i = 0; i < 1000000; i++) print rand(), rand()}' >"$scratch/million.xy"
    ${CC:-cc} -O2 -I"$build/include" clients/examples/bulk.c "$build/lib/libdelaunay.a" -lm -o "$scratch/bulk"
}

by_command_line() {
    local d=("$build/delaunay" -h 127.0.0.1 -p "$port") hull
    "${d[@]}" load m "$scratch/million.xy" | grep -qx 'OK 0 first=0 added=1000000 coincident=[0-9]* version=[0-9]*' &&
        hull=$("${d[@]}" triangulate m | sed -n 's/^OK 0 .* hull=\([0-9]*\) .*/\1/p') && "${d[@]}" export m "$scratch/m.ele" &&
        [ "$(head -n 1 "$scratch/m.ele")" = "$((2 * 1000000 - 2 - hull)) 3 0" ] &&
        [ "$(wc -l <"$scratch/m.ele")" -ge $((2 * 1000000 - 1 - hull)) ] && "${d[@]}" drop m
}

by_c() { "$scratch/bulk" 127.0.0.1 "$port" 1000000 | grep -q '^1999[0-9]* triangles, '; }

# Whether a connection to the port has received bytes that are not read yet.
has_unread_bytes() { # PORT
    awk -v port="$(printf ':%04X$' "$1")" '$2 ~ port && $4 == "01" && $5 !~ /:00000000$/ {found = 1} END {exit !found}' /proc/net/tcp
}

# The daemon stops reading while the client loads, then it is killed: the client reports that and ends.
dies_under() { # STATUS REGEX COMMAND...; the port is appended
    local status=$1 regex=$2 got=0 client
    shift 2
    start_daemon doomed
    kill -STOP "${pids[-1]}"
    timeout 60 "$@" "$doomed" >"$scratch/said" 2>&1 &
    client=$!
    for _ in $(seq 500); do
        ! has_unread_bytes "$doomed" || break
        sleep 0.1
    done
    { kill -KILL "${pids[-1]}" && wait "${pids[-1]}"; } 2>/dev/null
    unset 'pids[-1]'
    wait "$client" || got=$?
    cat "$scratch/said"
    [ "$got" -eq "$status" ] && grep -qE "$regex" "$scratch/said"
}

load_by_cli() { "$build/delaunay" -h 127.0.0.1 -p "$1" load m "$scratch/million.xy"; }
load_by_c() { "$scratch/bulk" 127.0.0.1 "$1" 1000000; }
load_by_python() {
    PYTHONPATH=clients/python "$python" -c '
import sys, delaunayd
try:
    delaunayd.Client("delaunay://127.0.0.1:" + sys.argv[1]).load("m", [(i, i * i) for i in range(1000000)])
except ConnectionError as error:
    sys.exit("lost: %r" % error)' "$1"
}
load_by_node() {
    node --input-type=module -e '
import { connect } from "./clients/js/index.mjs";
const client = await connect("delaunay://127.0.0.1:" + process.argv[1]);
client.load("m", Float64Array.from({ length: 2000000 }, Math.random)).then(
    () => process.exit(0), (error) => { console.log("lost:", error.message); process.exit(1); });' "$1"
}
export build scratch python
export -f load_by_cli load_by_c load_by_python load_by_node

# ---- haproxy ----

through() { printf '%s\n' "$1" | timeout 10 nc -N 127.0.0.1 "$front"; }

await_front() {
    for _ in $(seq 600); do
        through PING 2>/dev/null | grep -qx 'OK 0' && return
        sleep 0.1
    done
    return 1
}

sets_of() { printf 'SETS\n' | nc -N 127.0.0.1 "$1" | sed -n '2,$s/ .*//p'; }

sets_are_shared_out() {
    local i
    for i in $(seq 40); do
        through "ADD shard$i $i 0" | grep -q '^OK 0 first=0' || return 1
    done
    # Requests for the same set in RESP, or with the first line in two pieces, reach the same daemon.
    for i in $(seq 40); do
        redis-cli -p "$front" GET "shard$i" 0 | grep -qx "0 $i 0" || return 1
    done
    { printf 'GET sha'; sleep 0.3; printf 'rd7 0\n'; } | nc -N 127.0.0.1 "$front" | grep -qx '0 7 0' || return 1
    [ "$(sets_of "$first" | wc -l)" -ge 8 ] && [ "$(sets_of "$second" | wc -l)" -ge 8 ] &&
        [ "$({ sets_of "$first"; sets_of "$second"; } | sort -u | grep -c shard)" -eq 40 ]
}

sets_can_be_copied() {
    local set
    set=$(sets_of "$first" | head -n 1)
    "$build/delaunay" copy "$set" "delaunay://127.0.0.1:$first" "delaunay://127.0.0.1:$second" &&
        sets_of "$second" | grep -qx "$set"
}

# The daemon ends; connections for its sets are refused or served by the other one, and the others continue.
the_others_go_on() {
    local set
    set=$(sets_of "$second" | grep shard | tail -n 1)
    kill "$first_pid" && wait "$first_pid"
    sleep 2.5
    through "GET $set 0" | grep -q '^0 ' && through PING | grep -qx 'OK 0'
}

haproxy_shards() {
    start_daemon first
    first_pid=${pids[-1]}
    start_daemon second
    front=$((20000 + RANDOM % 5000)) # followers.sh has others
    DELAUNAY_BIND=127.0.0.1:$front SHARD_A=127.0.0.1:$first SHARD_B=127.0.0.1:$second \
        haproxy -db -f clients/haproxy.cfg >"$scratch/haproxy" 2>&1 &
    pids+=($!)
    count "haproxy passes requests on" await_front
    count "haproxy shares sets out by name in both framings" sets_are_shared_out
    count "sets can be copied from shard to shard" sets_can_be_copied
    count "haproxy leaves out a daemon that has gone" the_others_go_on
}

start_daemon port
count "redis-cli" redis_cli_speaks
count "redis-cli's modes" redis_cli_modes_work
count "redis-benchmark" redis_benchmark_runs
count "hiredis" "$build/interop/hiredis_talk" "$port"
if fetch_node_redis; then
    count "redis and ioredis for Node" timeout 120 node tests/interop/redis/node.mjs "$port" "$build/interop/npm_redis"
else
    skip "redis and ioredis for Node" "npm cannot fetch packages here"
fi
count "redis-py" "$python" tests/interop/redis/redis_py.py "$port"
if php -m 2>/dev/null | grep -qx redis; then
    count "phpredis" timeout 60 php tests/interop/redis/phpredis.php "$port"
else
    skip "phpredis" "the Debian packages php-cli and php-redis are missing"
fi
if perl -MRedis -e 1 2>/dev/null; then
    count "Redis.pm" timeout 60 perl tests/interop/redis/perl.pl "$port"
else
    skip "Redis.pm" "the Debian package libredis-perl is missing"
fi
count "the film of the algorithm" "$python" tests/interop/trace.py "$build/delaunay" "$port"
# node/package.sh runs d3.test.mjs, beside the published d3-delaunay.
DELAUNAYD=$build/delaunayd tests/node.sh $(ls clients/js/test/*.test.mjs | grep -v /d3.test) >"$scratch/node" 2>&1
collect "$scratch/node"
count "triangles in process of all families are those of the daemon" node tests/interop/node/families.mjs "$build/tests/bench/points" "delaunay://127.0.0.1:$port"
millions
count "a million points by the command line" by_command_line
count "a million points by the C library" by_c
count "the command line notices a daemon that dies" dies_under 3 'connection was lost' bash -c 'load_by_cli "$0"'
count "the C library notices a daemon that dies" dies_under 1 'connection was lost' bash -c 'load_by_c "$0"'
count "the Python package notices a daemon that dies" dies_under 1 '^lost: ' bash -c 'load_by_python "$0"'
count "the Node package notices a daemon that dies" dies_under 1 '^lost: ' bash -c 'load_by_node "$0"'
count "the Dockerfile" tests/interop/image.sh "$1"
haproxy_shards
result
