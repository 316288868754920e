#!/usr/bin/env bash
# A leader and a follower behind haproxy with clients/haproxy-followers.cfg, and promotions by clients/promote.sh while a client writes;
# former leaders that come back.
#
#     followers.sh BUILD_DIR        prints what failed, and at the end one line: N passed, N failed
. "$(dirname "$0")/common.sh" "$1"
export DELAUNAY=$build/delaunay
unset pids
declare -A pids # of common.sh, by name

base=$((25000 + RANDOM % 5000)) # clients.sh has others
ports=([a]=$base [b]=$((base + 1)) [write]=$((base + 2)) [read]=$((base + 3)) [relay]=$((base + 4)))

start() { # NAME OPTION...
    local name=$1
    shift
    "$build/delaunayd" --port "${ports[$name]}" --data "$scratch/$name" "$@" >/dev/null 2>>"$scratch/log.$name" &
    pids[$name]=$!
}

stop() { { kill -KILL "${pids[$1]}" && wait "${pids[$1]}"; } 2>/dev/null || true; } # NAME
stop_b() { stop b; }

start_haproxy() {
    WRITE_BIND=127.0.0.1:${ports[write]} READ_BIND=127.0.0.1:${ports[read]} DAEMON_A=127.0.0.1:${ports[a]} \
        DAEMON_B=127.0.0.1:${ports[b]} haproxy -db -f clients/haproxy-followers.cfg >>"$scratch/haproxy" 2>&1 &
    pids[haproxy]=$!
}

url() { echo "delaunay://127.0.0.1:${ports[$1]}"; }
is() { [ "$(fact "$1" "$2")" = "$3" ]; } # NAME KEY VALUE
goes_to() { [ "$(fact "$1" role)" = "$2" ]; }
equal() { # all sets of both daemons, and their logs
    [ "$(fact a log_digest)" = "$(fact b log_digest)" ] && [ "$(say a 'DIGEST t')" = "$(say b 'DIGEST t')" ]
}

# Writes points (i, 0) through haproxy, one by one, and keeps the acknowledged points in the file `acknowledged`.
write_on() {
    local i=0 reply
    while [ ! -e "$scratch/enough" ]; do
        i=$((i + 1))
        reply=$(printf 'ADD t %s 0\n' "$i" | timeout 3 nc -N 127.0.0.1 "${ports[write]}" 2>/dev/null) # at first it may go to a frozen leader
        case $reply in "OK 0 first="*) echo "$i" >>"$scratch/acknowledged" ;; *) sleep 0.05 ;; esac
    done
}

write_some() { # at least N more points are acknowledged
    local have
    have=$(wc -l <"$scratch/acknowledged")
    await eval "[ \$(wc -l <'$scratch/acknowledged') -ge $((have + $1)) ]"
}

nothing_is_missing() { # NAME: of what is acknowledged by now
    sort "$scratch/acknowledged" >"$scratch/needed"
    say "$1" 'POINTS t' | awk 'NR > 1 {print $2}' | sort >"$scratch/have"
    comm -23 "$scratch/needed" "$scratch/have" >"$scratch/missing"
    echo "missing on $1: $(head "$scratch/missing")"
    [ -s "$scratch/needed" ] && [ ! -s "$scratch/missing" ]
}

begin() {
    : >"$scratch/acknowledged"
    start a
    await is a role leader && start b --follow "127.0.0.1:${ports[a]}" && await is b link receiving
    start_haproxy
    await goes_to write leader && await goes_to read follower
}

leader_serves_reads_alone() {
    stop_b
    await goes_to read leader && start b && await goes_to read follower
}

planned() {
    write_some 20 && clients/promote.sh --from "$(url a)" "$(url b)" && is b role leader && is a role follower &&
        is a min_followers 0 && write_some 20 && await goes_to read follower && nothing_is_missing b
}

# b leads; its machine is lost, with its data.
unplanned() {
    say b 'CONFIG SET min-followers 1' && write_some 20 && stop_b && mv "$scratch/b" "$scratch/lost" &&
        clients/promote.sh "$(url a)" && is a role leader && nothing_is_missing a && await goes_to write leader && write_some 20
}

# It comes back as the leader that it was.
former_leader_refuses() {
    mv "$scratch/lost" "$scratch/b" && start b && await is b role fenced && say b 'ADD t 0.5 0.5' | grep '^ERR READONLY' && write_some 20
}

former_leader_follows() {
    touch "$scratch/enough" && wait "$writer"
    say b "FOLLOW 127.0.0.1 ${ports[a]}" && sleep 1
    is b link receiving || say b "FOLLOW 127.0.0.1 ${ports[a]} CONFIRM" # it may have a change that was not acknowledged
    await is b link receiving && await equal && nothing_is_missing b
}

wrong_promotions_change_nothing() {
    ! clients/promote.sh --from "$(url b)" "$(url a)" && ! clients/promote.sh "$(url a)" && ! clients/promote.sh &&
        ! SECONDS_TO_WAIT=2 clients/promote.sh --from "$(url a)" delaunay://127.0.0.1:1 &&
        is a role leader && is b role follower && is a min_followers 0
}

# The follower is stopped, so it does not answer: the leader accepts changes again.
planned_promotion_that_fails() {
    kill -STOP "${pids[b]}"
    ! SECONDS_TO_WAIT=3 timeout 20 clients/promote.sh --from "$(url a)" "$(url b)"
    local failed=$?
    kill -CONT "${pids[b]}"
    [ "$failed" -eq 0 ] && is a role leader && is a min_followers 0 && await eval "say a 'ADD t 7.5 7.5' | grep -q '^OK 0'"
}

# ---- former leaders that come back ----

write_in_background() {
    rm -f "$scratch/enough"
    write_on &
    writer=$!
}

end_writing() { touch "$scratch/enough" && wait "$writer"; }

# A follower is promoted while its leader LEADER does not run, and gets changes; then the former leader comes back, as COMMAND says.
# It gets none of them, and follows.
replace() { # LEADER FOLLOWER COMMAND...
    local old=$1 new=$2 before
    shift 2
    await is "$old" settled 1 && await equal && before=$(say "$old" 'DIGEST t') && [ -n "$before" ] &&
        is "$old" min_followers 0 && "$1" "$old" && clients/promote.sh "$(url "$new")" && write_in_background && write_some 10 &&
        "$2" "$old" && await is "$old" role fenced && write_some 20
    local failed=$?
    end_writing
    [ "$failed" -eq 0 ] && [ "$(say "$old" 'DIGEST t')" = "$before" ] && nothing_is_missing "$new" &&
        say "$old" "FOLLOW 127.0.0.1 ${ports[$new]}" && await equal
}

restart_haproxy_and_start() {
    stop haproxy
    start "$1"
    start_haproxy
}
freeze() { kill -STOP "${pids[$1]}"; }
go_on() { kill -CONT "${pids[$1]}"; }

both_directions() { replace a b "$@" && replace b a "$@"; } # HOW_IT_ENDS HOW_IT_COMES_BACK

# The follower reaches its leader through a relay.
start_relay() { # PORT
    printf 'defaults\n mode tcp\n timeout connect 1s\n timeout client 1h\n timeout server 1h\nlisten relay\n bind 127.0.0.1:%s\n server s 127.0.0.1:%s\n' \
        "${ports[relay]}" "$1" >"$scratch/relay.cfg"
    haproxy -db -f "$scratch/relay.cfg" >>"$scratch/relay" 2>&1 &
    pids[relay]=$!
}

# The relay is stopped, the follower is promoted, and the former leader runs on without knowing that.
partition() { # LEADER FOLLOWER
    local old=$1 new=$2 before
    start_relay "${ports[$old]}" && say "$new" "FOLLOW 127.0.0.1 ${ports[relay]}" && await is "$new" link receiving && await equal &&
        stop relay && before=$(say "$old" 'DIGEST t') && clients/promote.sh "$(url "$new")" &&
        await eval "[ \"\$(fact write history)\" = '$(fact "$new" history)' ]" && write_in_background && write_some 20
    local failed=$?
    is "$old" role leader && stop haproxy && start_haproxy && write_some 20 || failed=1
    end_writing
    [ "$failed" -eq 0 ] && is "$old" role leader && [ "$(say "$old" 'DIGEST t')" = "$before" ] && nothing_is_missing "$new" &&
        start_relay "${ports[$old]}" && await is "$old" role fenced && stop relay &&
        say "$old" "FOLLOW 127.0.0.1 ${ports[$new]}" && await equal
}

# With --min-followers 1 the former leader refuses changes by itself, although haproxy is stopped and clients find it first.
with_min_followers() {
    say a 'CONFIG SET min-followers 1' && await equal && stop a && clients/promote.sh "$(url b)" && start a --min-followers 1 &&
        await is a role leader && say a 'ADD t 0.25 0.25' | grep '^ERR NOFOLLOWERS' && await is a role fenced &&
        say a "FOLLOW 127.0.0.1 ${ports[b]}" && sleep 1
    is a link receiving || say a "FOLLOW 127.0.0.1 ${ports[b]} CONFIRM"
    await equal
}

count "haproxy sends changes to the leader and reads to the follower" begin
count "haproxy sends reads to the leader while there is no follower" leader_serves_reads_alone
write_on &
writer=$!
count "a planned promotion loses nothing" planned
count "with --min-followers 1 an unplanned promotion loses nothing, the leader's directory deleted" unplanned
count "a former leader that comes back refuses changes" former_leader_refuses
count "it follows, and is equal" former_leader_follows
count "wrong promotions change nothing" wrong_promotions_change_nothing
count "a planned promotion of a follower that does not catch up changes nothing" planned_promotion_that_fails
count "a former leader that was killed gets no changes when it comes back, in either direction" both_directions stop start
count "nor if haproxy was restarted meanwhile" both_directions stop restart_haproxy_and_start
count "nor if it was frozen" both_directions freeze go_on
count "nor if the new leader cannot reach it" partition a b
count "nor in the other direction" partition b a
count "with --min-followers 1 a former leader refuses changes by itself" with_min_followers
result
