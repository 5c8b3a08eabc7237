#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs meson's tests of a build folder and ends with one line: N passed, N failed, N skipped.
#
#   scripts/run_tests.sh BUILD [quick|all] [arguments of meson test]
#
# quick leaves out the suite 'slow' (statistics over many seeds, all figures of the thesis).
set -u
build=$1
what=${2-quick}
[ $# -gt 0 ] && shift
[ $# -gt 0 ] && shift
here=$(dirname "$0")
case $what in
quick) set -- --no-suite slow "$@" ;;
all) ;;
*) echo "run_tests.sh: '$what' is not quick or all" >&2; exit 2 ;;
esac
# Several tests run at once and share the processors: threads that wait must not spin.
export OMP_WAIT_POLICY="${OMP_WAIT_POLICY-passive}"
log=$build/meson-logs/testlog.json
rm -f "$log"
meson test -C "$build" --no-rebuild --print-errorlogs "$@"
status=$?
python3 "$here/summary.py" "$log" --status $status
