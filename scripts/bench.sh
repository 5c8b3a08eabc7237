#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Builds and runs the benchmarks of a build folder one after the other; their JSON lines are kept in BUILD/bench/NAME.jsonl.
#
#   scripts/bench.sh [BUILD [NAME...]]
set -u
build=${1-build}
[ $# -gt 0 ] && shift
cd "$(dirname "$0")/.." || exit 2
[ $# -gt 0 ] || set -- $(ninja -C "$build" -t targets all | sed -n 's|^bench/bench_\([a-z0-9_]*\): .*|\1|p' | sort -u)
[ $# -gt 0 ] || { echo "no benchmark in $build" >&2; exit 1; }
failed=0
for name; do
	echo "== $name"
	if ninja -C "$build" --quiet "bench/bench_$name" && "$build/bench/bench_$name" >"$build/bench/$name.tmp"; then
		mv "$build/bench/$name.tmp" "$build/bench/$name.jsonl"
		cat "$build/bench/$name.jsonl"
	else
		echo "bench_$name failed" >&2
		[ ! -f "$build/bench/$name.tmp" ] || cat "$build/bench/$name.tmp"
		failed=1
	fi
done
exit $failed
