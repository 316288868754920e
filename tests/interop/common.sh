# common.sh BUILD_DIR - to be sourced: enters the root of the repository and provides $build, a folder $scratch, daemons, requests, and a
# count of tests: passed, failed, skipped. Scratch and processes end with the script.
set -u
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=$(realpath "$1")
scratch=$(mktemp -d)
passed=0
failed=0
skipped=0
python=/usr/bin/python3 # Debian's, which sees Debian's packages
pids=() # of processes that must not outlive the script

leave() {
    [ ${#pids[@]} -eq 0 ] || { kill -KILL "${pids[@]}"; wait "${pids[@]}"; } 2>/dev/null
    rm -rf "$scratch"
}
trap leave EXIT

# Runs the command as one test, and shows its time if that exceeds a second. If the test fails, shows the end of what it prints, and of
# what the shell has carried out: some failures come once in fifty runs.
count() { # NAME COMMAND...
    local name=$1 status=0 TIMEFORMAT='%R %U %S'
    shift
    exec 9>"$scratch/trace"
    BASH_XTRACEFD=9
    set -x
    { time "$@" >"$scratch/out" 2>&1; } 2>"$scratch/time" || status=1
    { set +x; } 2>/dev/null
    exec 9>&-
    if [ "$status" -eq 0 ]; then
        passed=$((passed + 1))
        tail -n 1 "$scratch/time" | awk -v name="$name" '$1 > 1 { printf "ok   %s (%.1f s, %.1f s of processors)\n", name, $1, $2 + $3 }'
    else
        failed=$((failed + 1))
        echo "FAIL $name"
        tail -n 30 "$scratch/out"
        tail -n 30 "$scratch/trace"
    fi
}

# A test that cannot be run here counts as skipped, and its reason is shown.
skip() { # NAME REASON
    skipped=$((skipped + 1))
    echo "SKIP $1: $2"
}

# Adds the counts of another program's last line, and shows its other lines.
collect() { # FILE
    local p f s
    grep -v ' passed, ' "$1"
    read -r p f s < <(sed -nE 's/^([0-9]+) passed, ([0-9]+) failed(, ([0-9]+) skipped)?$/\1 \2 \4/p' "$1" | tail -n 1)
    if [ -z "${f:-}" ]; then
        echo "FAIL $(basename "$1") broke off"
        p=0 f=1
    fi
    passed=$((passed + p))
    failed=$((failed + f))
    skipped=$((skipped + ${s:-0}))
}

# The last line of a script: the exit status is 0 if nothing failed.
result() {
    [ "$skipped" -eq 0 ] && echo "$passed passed, $failed failed" || echo "$passed passed, $failed failed, $skipped skipped"
    [ "$failed" -eq 0 ]
}

# Ends the daemon that was started last.
stops_cleanly() {
    local status
    kill -TERM "$daemon"
    wait "$daemon"
    status=$?
    cat "$scratch/log.port"
    [ "$status" -eq 0 ]
}

# Starts a daemon; its port goes to the variable of this name, its number as a process to $daemon, its log to $scratch/log.VARIABLE.
start_daemon() { # VARIABLE OPTION...
    local variable=$1 found= ready=$scratch/ready.$1
    shift
    rm -f "$ready" # which may name the port of a daemon that has stopped
    "$build/delaunayd" --port 0 "$@" >"$ready" 2>"$scratch/log.$variable" &
    daemon=$!
    pids+=("$daemon")
    for _ in $(seq 600); do
        found=$(sed -n 's/^ready on .*:\([0-9]*\)$/\1/p' "$ready" 2>/dev/null)
        [ -z "$found" ] || break
        sleep 0.1
    done
    if [ -z "$found" ]; then
        echo "the daemon did not say that it is ready"
        cat "$scratch/log.$variable"
        exit 1
    fi
    printf -v "$variable" %s "$found"
}

declare -A ports # of daemons, by name

say() { printf '%s\n' "$2" | timeout 20 nc -N 127.0.0.1 "${ports[$1]}" 2>/dev/null; } # NAME REQUEST
fact() { say "$1" 'INFO replication' | sed -n "s/^$2://p"; }                          # NAME KEY

# Repeats the command until it succeeds, for 30 seconds.
await() { # COMMAND...
    local i
    for ((i = 0; i < 300; i++)); do
        "$@" && return
        sleep 0.1
    done
    echo "in vain: $*"
    cat "$scratch"/log.*
    false
}
