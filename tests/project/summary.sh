#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The counting of test cases: one line of meson's log for each way a test can end. Speaks TAP.
#
#   summary.sh SOURCE_ROOT
set -u
root=$1
tmp=$(mktemp -d) || exit 2
trap 'rm -rf "$tmp"' EXIT
case_=0 failed=0
# expect LINE EXIT NAME [arguments of summary.py]: of the log in $tmp/log
expect() {
	line=$1 status=$2 name=$3
	shift 3
	case_=$((case_ + 1))
	out=$(python3 "$root/scripts/summary.py" "$tmp/log" --data /nowhere "$@")
	got=$?
	if [ "$(printf '%s\n' "$out" | tail -n 1)" = "$line" ] && [ $got = "$status" ]; then
		echo "ok $case_ - $name"
	else
		printf '%s\n' "exit status $got, wanted $status and: $line" "$out" | sed 's/^/# /'
		echo "not ok $case_ - $name"
		failed=1
	fi
}
entry() { printf '{"name": "t", "result": "%s", "stdout": "%s"}\n' "$1" "$2" >>"$tmp/log"; }
new() { : >"$tmp/log"; }

new; entry OK 'ok 1 - a\nok 2 - b\n1..2\n'; expect '2 passed, 0 failed, 0 skipped' 0 'two cases that pass'
new; entry ERROR 'ok 1 - a\nnot ok 2 - b\n1..2\n'; expect '1 passed, 1 failed, 0 skipped' 1 'one passes, one fails'
new; entry OK '# skipped: x needs y\nok 1 - a\nok 2 - b\n1..2\n'; expect '1 passed, 0 failed, 1 skipped' 0 'a case that says it was skipped'
new; entry OK 'ok 1 - a # SKIP no y\nok 2 - b\n1..2\n'; expect '1 passed, 0 failed, 1 skipped' 0 'a skip as TAP says it'
new; entry SKIP '1..0 # SKIP no y\n'; expect '0 passed, 0 failed, 1 skipped' 0 'a whole test that is skipped'
new; entry OK '# skipped: x needs y\nok 1 - a\n1..1\n'; expect '0 passed, 1 failed, 1 skipped' 1 'with the captures present, a skip is a failure' --data "$tmp"
new; entry SKIP '1..0 # SKIP no y\n'; expect '0 passed, 1 failed, 1 skipped' 1 'with the captures present, a whole test too' --data "$tmp"
new; entry TIMEOUT 'ok 1 - a\n1..3\n'; expect '1 passed, 1 failed, 0 skipped' 1 'a time limit'
new; entry ERROR 'ok 1 - a\nok 2 - b\n'; expect '0 passed, 1 failed, 0 skipped' 1 'a crash before the plan'
new; entry ERROR ''; expect '0 passed, 1 failed, 0 skipped' 1 'a crash at once'
new; entry OK 'no TAP'; expect '1 passed, 0 failed, 0 skipped' 0 'a test without cases counts as one'
new; entry FAIL 'no TAP'; expect '0 passed, 1 failed, 0 skipped' 1 'and when it fails'
new; entry OK 'ok 1 - a\n1..1\n'; entry OK 'ok 1 - a\n1..1\n'; expect '2 passed, 0 failed, 0 skipped' 0 'two tests'
new; entry OK 'ok 1 - a\n1..1\n'; expect '1 passed, 1 failed, 0 skipped' 1 'meson fails for a reason of its own' --status 1
new; expect '0 passed, 1 failed, 0 skipped' 1 'no test at all'
rm "$tmp/log"; expect '0 passed, 1 failed, 0 skipped' 1 'no log'
echo "1..$case_"
exit $failed
