#!/bin/sh
# node.sh FILE... - runs tests of Node and prints their output. Prints a line `SKIP name: reason` for each test that is skipped, and a line
# `FAIL name: first line of the reason` for each that fails.
# The last line is: N passed, N failed; or N passed, N failed, N skipped.
tap=$(mktemp)
trap 'rm -f "$tap"' EXIT
node --test --test-reporter=spec --test-reporter-destination=stdout --test-reporter=tap --test-reporter-destination="$tap" "$@"
status=$?
sed -n 's/^ *ok [0-9]* - \(.*\) # SKIP \(.*\)/SKIP \1: \2/p' "$tap"
awk -v status=$status '
    # A failed test: its name, and below it what failed: a quoted word, or "|-" and lines. A test that only contains failed ones is left out.
    / # TODO/ { next }
    sub(/^ *not ok [0-9]+ - /, "") { name = $0 }
    / failureType: .subtestsFailed/ { name = "" }
    name != "" && (in_lines || sub(/^ *error: /, "")) && !(in_lines = /^\|-?$/ || /^ *$/) {
        gsub(/^ *["\047]?|["\047]$/, "")
        print "FAIL " name ": " $0
        name = ""
    }
    /^# (pass|fail|cancelled|skipped) [0-9]+$/ { n[$2] = $3 }
    END {
        failed = n["fail"] + n["cancelled"]
        if (status != 0 && failed == 0)
            failed = 1
        printf "%d passed, %d failed%s\n", n["pass"], failed, n["skipped"] ? ", " n["skipped"] " skipped" : ""
    }' "$tap"
exit $status
