#!/usr/bin/env bash
# Makes a follower the leader.
#
#     promote.sh --from LEADER FOLLOWER [FOLLOWER ...]    planned: the first follower becomes the leader; nothing is lost
#     promote.sh FOLLOWER [FOLLOWER ...]                  the leader is gone: the follower with most changes becomes the leader
#
# Daemons are URLs: delaunay://[:TOKEN@]ADDRESS[:PORT], with the numeric addresses at which they reach each other. Name all
# followers: each of the others, and the former leader of a planned promotion, follows the new leader.
#
# Planned: the leader stops to acknowledge changes; its clients get NOFOLLOWERS, or wait for about a second. When the followers have
# everything, the first one is promoted. If one does not catch up within $SECONDS_TO_WAIT (30), nothing has changed.
#
# Unplanned: with --min-followers N nothing that was acknowledged is lost if less than N followers are missing here. Without it the
# changes are lost that the leader had acknowledged and no follower has. Make sure that the leader is gone: one that still
# accepts changes refuses them from the moment when it hears of the promotion, and what it accepted until then is not here.
set -u
delaunay=${DELAUNAY:-delaunay}
wait_s=${SECONDS_TO_WAIT:-30}

die() {
    echo "promote.sh: $*" >&2
    exit 1
}

# A daemon may accept a connection and never answer.
ask() { # URL WORD...
    local url=$1
    shift
    timeout "$wait_s" "$delaunay" -u "$url" "$@"
}

fact() { # URL KEY: the value of a line of INFO replication
    ask "$1" info replication | sed -n "s/^$2://p"
}

# The address and port of a URL, as two words.
place() {
    local at=${1#delaunay://}
    at=${at##*@}
    at=${at%%/*}
    case $at in
    \[*\]:*) echo "${at%:*} ${at##*:}" | tr -d '[]' ;;
    \[*) echo "$at 6374" | tr -d '[]' ;;
    *:*) echo "${at%:*} ${at##*:}" ;;
    *) echo "$at 6374" ;;
    esac
}

await() { # COMMAND...: until it succeeds
    local end=$((SECONDS + wait_s))
    until "$@"; do
        [ "$SECONDS" -lt "$end" ] || return 1
        sleep 0.1
    done
}

# Whether a follower has all changes of the leader, which has no more of them than a moment ago.
has_all() { # LEADER FOLLOWER
    local last
    last=$(fact "$1" lsn) && [ -n "$last" ] && [ "$last" = "$(fact "$1" durable_lsn)" ] &&
        [ "$(fact "$2" durable_lsn)" = "$last" ] && [ "$(fact "$2" log_digest)" = "$(fact "$1" log_digest)" ]
}

receives() { [ "$(fact "$1" link)" = receiving ]; }

follow_new() { # URL: lets it follow the new leader; says so if it does not
    # shellcheck disable=SC2046 # two words
    ask "$1" follow $(place "$new") >/dev/null && await receives "$1" ||
        echo "$1 does not follow: $(fact "$1" link_error)" >&2
}

promote() { # URL
    ask "$1" follow none >/dev/null || return 1
    echo "$1 is the leader now, history $(fact "$1" history), lsn $(fact "$1" lsn)"
}

# No set can have this tolerance, so nothing is created.
refuses() { ask "$1" create probe tol -1 2>&1 | grep -q "^ERR NOFOLLOWERS"; }

planned() {
    local follower
    old=$1 # also for the trap
    shift
    new=$1
    [ "$(fact "$old" role)" = leader ] || die "$old is not a leader"
    for follower; do
        [ "$(fact "$follower" role) $(fact "$follower" link)" = "follower receiving" ] || die "$follower is not a follower that receives"
    done
    least=$(fact "$old" min_followers)
    # More than there can be: nothing is acknowledged any more, and after a second nothing is accepted.
    ask "$old" config set min-followers 64 >/dev/null || die "$old: CONFIG SET is refused"
    trap 'ask "$old" config set min-followers "$least" >/dev/null' EXIT
    await refuses "$old" || die "$old still accepts changes"
    for follower; do
        await has_all "$old" "$follower" || die "$follower does not catch up"
    done
    promote "$new" || die "$new cannot be promoted"
    shift
    for follower in "$old" "$@"; do
        follow_new "$follower"
    done
}

# Later generations have more; within one, later changes.
unplanned() {
    local follower generation lsn best=-1 best_generation=-1 origin=
    for follower; do
        [ "$(fact "$follower" role)" = follower ] || die "$follower is not a follower, or does not answer"
        generation=$(fact "$follower" history)
        [ -z "$origin" ] || [ "$origin" = "${generation%%.*}" ] || die "$follower has another origin"
        origin=${generation%%.*}
        generation=$(cut -d. -f2 <<<"$generation")
        lsn=$(fact "$follower" durable_lsn)
        if [ "$generation" -gt "$best_generation" ] || { [ "$generation" -eq "$best_generation" ] && [ "$lsn" -gt "$best" ]; }; then
            new=$follower best=$lsn best_generation=$generation
        fi
    done
    promote "$new" || die "$new cannot be promoted"
    for follower; do
        [ "$follower" = "$new" ] || follow_new "$follower"
    done
}

case ${1:-} in
--from)
    [ $# -ge 3 ] || die "usage: promote.sh [--from LEADER] FOLLOWER [FOLLOWER ...]"
    shift
    planned "$@"
    ;;
'' | -*) die "usage: promote.sh [--from LEADER] FOLLOWER [FOLLOWER ...]" ;;
*) unplanned "$@" ;;
esac
