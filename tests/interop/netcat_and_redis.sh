#!/usr/bin/env bash
# Starts a daemon and replays the conversations of tests/interop/scripts with netcat, and others with redis-cli and redis-benchmark.
#
#     netcat_and_redis.sh BUILD_DIR        prints what failed, and at the end one line: N passed, N failed
. "$(dirname "$0")/common.sh" "$1"

# Times and versions of sets vary, and so may the message after an error's code; comments may precede the reply to a slow request.
normalised() {
    sed -E '/^# progress /d; s/ ms=[0-9.e-]+/ ms=/; s/ version=[0-9]{10,}//; s/^(ERR [A-Z]+).*/\1/'
}

# ---- netcat: all requests are carried out after the half-close, and every reply is complete ----

talk() {
    timeout 30 nc -N 127.0.0.1 "$port"
}

drop_sets() {
    printf 'SETS\n' | talk | sed -n '2,$s/^\([^ ]*\) .*/DROP \1/p' | talk >/dev/null
}

with_lf() { cat "$1"; }
with_crlf() { sed 's/$/\r/' "$1"; }
without_last_lf() { head -c -1 "$1"; }
in_small_pieces() {
    local text rest
    rest=$(cat "$1"; echo .)
    rest=${rest%.}
    while [ -n "$rest" ]; do
        text=${rest:0:7}
        rest=${rest:7}
        printf '%s' "$text"
        sleep 0.003
    done
}

conversation() { # SCRIPT HOW
    drop_sets
    "$2" "$1" | talk | normalised | diff "${1%.nc}.out" - >"$scratch/diff" || { cat "$scratch/diff"; false; }
}

cpu_ticks() {
    awk '{print $14 + $15}' "/proc/$daemon/stat"
}

# A reply of some 20 MB to a client that has half-closed and reads nothing for two seconds.
load_big_set() {
    { echo 'LOAD big'; "$build/tests/bench/points" uniform 430000; echo .; echo 'TRIANGULATE big'; } | talk |
        tail -n 1 | grep -q '^OK 0 points=430000 '
}

slow_reader_gets_all() {
    local slow fast ticks
    printf 'LISTS big\n' | talk | { sleep 2; cat; } >"$scratch/slow" &
    slow=$!
    sleep 1
    ticks=$(cpu_ticks)
    printf 'PING\n' | timeout 1 nc -N 127.0.0.1 "$port" | grep -q '^OK 0' || { echo "another client waits"; return 1; }
    sleep 0.7
    ticks=$(($(cpu_ticks) - ticks))
    wait "$slow"
    printf 'LISTS big\n' | talk >"$scratch/fast"
    fast=$(wc -c <"$scratch/fast")
    echo "a reply of $fast bytes; while its reader slept, the daemon used $ticks ticks of 10 ms"
    [ "$fast" -gt 19000000 ] && [ "$(wc -l <"$scratch/fast")" -eq 430001 ] && [ "$ticks" -lt 30 ] &&
        cmp "$scratch/slow" "$scratch/fast"
}

a_client_that_goes_away_harms_nobody() {
    printf 'LISTS big\n' | timeout 5 nc 127.0.0.1 "$port" | head -c 100000 >/dev/null
    printf 'PING\nDROP big\n' | talk | grep -c '^OK 0' | grep -qx 2
}

# ---- Redis's tools, which send the same commands in RESP ----

redis_cli_converses() {
    drop_sets
    printf '%s\n' PING 'ADD t 0 0 4 0 4 4 0 4 2 2' 'TRIANGULATE t' 'LISTS t' 'LOCATE t 9 9' 'GET t 7' |
        redis-cli -p "$port" | normalised | grep . >"$scratch/redis"
    diff "$scratch/redis" - <<'END'
PONG
OK first=0 added=5 coincident=0
OK points=5 coincident=0 triangles=4 edges=8 hull=4 ms=
4 0 1 2 3
0 1 4 3
1 2 4 0
2 3 4 1
3 0 4 2
OK where=outside
NOPOINT there is no point 7
END
}

redis_benchmark_finishes() {
    timeout 60 redis-benchmark -p "$port" -n 50000 -P 16 -c 20 -q NEAREST t 1 1 | tr '\r' '\n' | grep 'requests per second'
}

netcat_conversations() {
    local script how
    for script in tests/interop/scripts/*.nc; do
        for how in with_lf with_crlf without_last_lf in_small_pieces; do
            count "$(basename "$script") $how" conversation "$script" "$how"
        done
    done
    count "load a big set as text" load_big_set
    count "slow reader after half-close" slow_reader_gets_all
    count "client that goes away" a_client_that_goes_away_harms_nobody
}

start_daemon port
netcat_conversations
count "redis-cli" redis_cli_converses
count "redis-benchmark" redis_benchmark_finishes
count "clean stop on SIGTERM" stops_cleanly
result
