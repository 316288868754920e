#!/usr/bin/env bash
# A rolling upgrade of a leader and a follower, as the manual describes it, with two builds. One is this build, the other has the
# same sources, but its files have the next version of the format.
#
#     rolling_upgrade.sh BUILD_DIR        prints what failed, and at the end one line: N passed, N failed
. "$(dirname "$0")/common.sh"

# Objects that do not depend on the version of the format need not be compiled again, the others without optimisation.
build_next() {
    local tree=$scratch/tree header=proto/records/record.h version
    mkdir -p "$tree/build" && cp -a Makefile core proto server "$tree" && cp -a --parents clients/rules.mk tests/rules.mk tests/*/rules.mk "$tree" &&
        cp -a "$build"/{core,proto,server} "$tree/build" || return
    version=$(sed -n 's/^ *RECORD_VERSION = \([0-9]*\),$/\1/p' $header)
    # All its files have that version, also those that need no later one today.
    sed -i -E "s/RECORD_VERSION([A-Z_]*) = [0-9]+,/RECORD_VERSION\\1 = $((version + 1)),/" "$tree/$header"
    ! cmp -s "$header" "$tree/$header" && make -s -C "$tree" build/delaunayd CFLAGS=-O0 && mv "$tree/build/delaunayd" "$scratch/next"
}

ports=([a]=0 [b]=0)
declare -A pid program=([old]=$build/delaunayd [new]=$scratch/next)

# A daemon that has run before gets the port that it had.
start() { # old|new NAME
    local daemon
    rm -f "$scratch/ready.$2"
    "${program[$1]}" --port "${ports[$2]}" --data "$scratch/$2" --keep-log 1 >"$scratch/ready.$2" 2>>"$scratch/log.$2" &
    daemon=$!
    pid[$2]=$daemon
    pids+=("$daemon")
    await grep -qs '^ready on' "$scratch/ready.$2" && ports[$2]=$(sed -n 's/^ready on .*:\([0-9]*\)$/\1/p' "$scratch/ready.$2")
}

end() { { kill -TERM "${pid[$1]}" && wait "${pid[$1]}"; } 2>/dev/null; } # NAME

succeeds() { say "$1" "$2" | grep -q '^OK'; } # NAME REQUEST
follow() { succeeds "$1" "FOLLOW 127.0.0.1 ${ports[$2]}"; } # FOLLOWER LEADER
has() { fact "$1" link_error | grep -q "$2"; } # NAME WORDS
equal() { [ "$(fact a log_digest)" = "$(fact b log_digest)" ] && [ "$(say a 'DIGEST t')" = "$(say b 'DIGEST t')" ]; }

new_follower_of_an_old_leader() {
    start old a && start old b && succeeds a 'ADD t 0 0 4 0 4 4 0 4 2 2' && succeeds a 'FSET t z 0 1.5' && follow b a && await equal &&
        succeeds a 'TRIANGULATE t' && end b && succeeds a 'ADD t 7 1' && start new b && await equal &&
        succeeds a 'MOVE t 4 1 2' && await equal
}

new_follower_gets_a_snapshot_of_an_old_leader() {
    end b && for _ in 1 2 3; do
        succeeds a 'ADD t 8 8' && succeeds a SNAPSHOT && sleep 0.5
    done
    start new b && await equal && ls "$scratch"/b/snapshot.* >/dev/null
}

old_daemon_refuses_what_a_new_leader_sends() {
    succeeds b 'FOLLOW NONE' && await grep -qs 'newer history' "$scratch/log.a" && succeeds b 'ADD t 9 1' && follow a b &&
        await has a 'it was written by a later version of delaunayd' && [ "$(say a 'STAT t' | cut -d' ' -f1-3)" = 'OK 0 points=9' ]
}

upgraded_daemon_continues() {
    end a && start new a && await equal && succeeds b 'DEL t 0' && await equal
}

old_program_refuses_the_files_of_a_new_one() {
    end a && timeout 60 "${program[old]}" --port 0 --data "$scratch/a" 2>"$scratch/refusal" </dev/null
    grep -q 'later version' "$scratch/refusal"
}

count "the next version can be built" build_next
count "a follower of the next version has what its leader has" new_follower_of_an_old_leader
count "a follower of the next version gets a snapshot" new_follower_gets_a_snapshot_of_an_old_leader
count "an old follower of a leader of the next version keeps what it has, and says why" old_daemon_refuses_what_a_new_leader_sends
count "the former leader follows after its upgrade" upgraded_daemon_continues
count "the old program does not use the files of the next version" old_program_refuses_the_files_of_a_new_one
result
