# one_daemon.sh - to be sourced, with $build set: provides a folder $scratch and one daemon at a time; both are removed at exit.
scratch=$(mktemp -d)
daemon=
stop_daemon() {
    [ -z "$daemon" ] || { kill "$daemon" && wait "$daemon"; } || true
    daemon=
}
trap 'stop_daemon; rm -rf "$scratch"' EXIT

# Sets $port.
start_daemon() { # FLAG...
    : >"$scratch/ready"
    "$build/delaunayd" --port 0 "$@" >"$scratch/ready" &
    daemon=$!
    for _ in $(seq 500); do
        port=$(sed -n 's/^ready on .*:\([0-9]*\)$/\1/p' "$scratch/ready")
        [ -z "$port" ] || return 0
        sleep 0.01
    done
    echo "the daemon did not say that it is ready" >&2
    exit 1
}
