#!/bin/sh
# durable.sh BUILD_DIR - the cost of durability: single-point ADD compared with redis SET, LOADB with and without --data,
# restart and snapshot of a large set. For `make bench-durable`; POINTS is the size of that set (default 10000000), DIR the
# folder for the data.
set -eu
build=$1 points=${POINTS:-10000000} seconds=${SECONDS_EACH:-5}
dir=$(mktemp -d "${DIR:-/tmp}/delaunayd-bench-XXXXXX")
pids=
stop()
{
    for p in $pids; do kill "$p" 2>/dev/null || true; done
    wait 2>/dev/null || true
    rm -rf "$dir"
}
trap stop EXIT INT TERM

# daemon ARGUMENTS...: starts one, sets $port and $pid.
daemon()
{
    rm -f "$dir/ready"
    START_NS=$(date +%s%N)
    export START_NS
    "$build/delaunayd" --port 0 "$@" >"$dir/ready" &
    pid=$!
    pids="$pids $pid"
    until port=$(sed -n "s/^ready on .*://p" "$dir/ready" 2>/dev/null) && [ -n "$port" ]; do sleep 0.01; done
}

end()
{
    kill "$1"
    wait "$1" || true
}

client="$build/tests/bench/durable"

echo "## Single-point changes, 50 connections, $seconds s each"
for policy in always everysec; do
    for round in 1 2 3; do
        daemon --data "$dir/$policy$round" --fsync $policy
        "$client" add "$port" 50 "$seconds" "delaunayd ADD, --fsync $policy"
        end "$pid"
        if command -v redis-server >/dev/null; then
            mkdir "$dir/redis"
            redis-server --port 7391 --appendonly yes --appendfsync $policy --save '' --dir "$dir/redis" >/dev/null &
            redis=$!
            pids="$pids $redis"
            until redis-cli -p 7391 ping >/dev/null 2>&1; do sleep 0.05; done
            "$client" set 7391 50 "$seconds" "redis SET, appendfsync $policy"
            end "$redis"
            rm -rf "$dir/redis"
        fi
    done
done

echo "## LOADB of 1000000 points"
for round in 1 2 3; do
    daemon
    "$client" load "$port" 1000000 "in memory"
    end "$pid"
    daemon --data "$dir/load$round"
    "$client" load "$port" 1000000 "--data, --fsync always"
    end "$pid"
    rm -rf "$dir/load$round"
done

echo "## Restart with $points points in a triangulated set, and 1000 in another"
daemon --data "$dir/large"
"$client" build "$port" "$points" "LOADB and TRIANGULATE"
kill -9 "$pid"
wait "$pid" 2>/dev/null || true
daemon --data "$dir/large"
"$client" ready "$port" "restart from the log"
echo "## SNAPSHOT of them"
"$client" snapshot "$port" "$pid" "PING meanwhile"
"$client" edited "$port" "$pid" "$points" "the same, and edits"
end "$pid"
daemon --data "$dir/large"
"$client" ready "$port" "restart from the snapshot"
end "$pid"
