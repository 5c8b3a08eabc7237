#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs every benchmark of a build folder, one after the other, and keeps its JSON lines in BUILD/bench/NAME.jsonl.
#
#   scripts/bench.sh [BUILD [NAME...]]
set -u
build=${1-build}
[ $# -gt 0 ] && shift
here=$(cd "$(dirname "$0")/.." && pwd)
failed=0
[ $# -gt 0 ] || set -- $(find "$build/bench" -maxdepth 1 -type f -name 'bench_*' -perm -u+x | sort | sed 's|.*/bench_||')
[ $# -gt 0 ] || { echo "no benchmark in $build/bench" >&2; exit 1; }
for name; do
	echo "== $name"
	if (cd "$here" && "$build/bench/bench_$name") >"$build/bench/$name.tmp"; then
		mv "$build/bench/$name.tmp" "$build/bench/$name.jsonl"
		cat "$build/bench/$name.jsonl"
	else
		echo "bench_$name failed" >&2
		cat "$build/bench/$name.tmp"
		failed=1
	fi
done
exit $failed
