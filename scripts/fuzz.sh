#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the fuzz targets of tests/fuzz with clang and its sanitizers and runs each for some seconds. One line per target, then
# "N passed, N failed, N skipped"; a failure leaves the input in BUILD_DIR/findings/.
#
#   scripts/fuzz.sh [SECONDS [BUILD_DIR [TARGET...]]]        20 s, build-fuzz, all targets
set -u
cd "$(dirname "$0")/.." || exit 2
seconds=${1:-20} build=${2:-build-fuzz}
shift $(($# < 2 ? $# : 2))

if [ ! -f "$build/build.ninja" ]; then
	CC=clang meson setup "$build" -Dfuzz=true -Db_sanitize=address,undefined -Db_lundef=false -Dbuildtype=debugoptimized || exit 1
fi
ninja -C "$build" fuzz >"$build/fuzz-build.log" 2>&1 || { cat "$build/fuzz-build.log"; exit 1; }
rm -rf "$build/seeds" "$build/findings"
mkdir -p "$build/findings" "$build/logs"
"$build/tests/fuzz/fuzz_seeds" "$build/seeds" || exit 1
# Files of other programs take ways through the readers that ours don't.
add_seeds() { # TARGET FILE...
	local folder=$build/seeds/$1
	mkdir -p "$folder" && cp "${@:2}" "$folder/" || exit 1
}
add_seeds fuzz_manifest examples/rigs/*.yaml
add_seeds fuzz_npy tests/golden/*.npy tests/golden/arrays/*.npy
add_seeds fuzz_npz tests/golden/arrays/*.npz
add_seeds fuzz_h5 tests/golden/arrays/*.h5
add_seeds fuzz_png tests/golden/*.png
add_seeds fuzz_tiff tests/golden/*.tif
add_seeds fuzz_exr tests/golden/*.exr
add_seeds fuzz_pfm tests/golden/*.pfm
add_seeds fuzz_raw tests/golden/*.dng

# OpenMP's threads would only get in each other's way; third-party code may try an allocation that is too large and must survive it.
export OMP_NUM_THREADS=1 ASAN_OPTIONS=allocator_may_return_null=1:detect_leaks=1 UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
export LSAN_OPTIONS=suppressions=$PWD/tests/fuzz/lsan.supp:print_suppressions=0

# run_target BUILD SECONDS NAME
run_target() {
	local build=$1 seconds=$2 name=$3
	local log=$build/logs/$name.log corpus=$build/corpus/$name known=tests/fuzz/known/$name
	mkdir -p "$corpus"
	local folders=("$corpus" "$build/seeds/$name")
	[ -d "$known" ] && folders+=("$known")
	# Files of other programs: compressions and layouts that Optla doesn't write.
	[[ $name =~ ^fuzz_(png|tiff|exr|pfm|raw|npy)$ ]] && folders+=(tests/golden)
	# The corpus of earlier runs is kept in BUILD_DIR/corpus, so that a longer search goes on where the last one ended.
	if "$build/tests/fuzz/$name" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -malloc_limit_mb=1024 -max_len=65536 \
		-print_final_stats=1 -artifact_prefix="$build/findings/$name-" "${folders[@]}" >"$log" 2>&1; then
		echo "ok $name $(sed -n 's/^stat::number_of_executed_units: *//p' "$log") executions," \
			"$(grep -o 'cov: [0-9]*' "$log" | tail -n 1)"
	else
		echo "not ok $name: $(grep -m 1 -E 'SUMMARY|ERROR|runtime error' "$log" || tail -n 1 "$log") (log: $log)"
	fi
}
export -f run_target

if [ $# -gt 0 ]; then targets=("$@"); else
	targets=()
	for t in "$build"/tests/fuzz/fuzz_*; do
		[ -f "$t" ] && [ -x "$t" ] && [ "${t##*/}" != fuzz_seeds ] && targets+=("${t##*/}")
	done
fi
results=$(printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -I{} bash -c 'run_target "$@"' _ "$build" "$seconds" {})
echo "$results" | sort
passed=$(grep -c '^ok ' <<<"$results")
echo "$passed passed, $((${#targets[@]} - passed)) failed, 0 skipped"
[ "$passed" = ${#targets[@]} ]
