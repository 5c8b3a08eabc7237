#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Builds with the address, leak and undefined-behaviour sanitizers and passes the quick tests under them.
#
#   scripts/asan.sh [BUILD [arguments of meson test]]
set -u
cd "$(dirname "$0")/.." || exit 2
build=${1-build-asan}
[ $# -gt 0 ] && shift
[ -f "$build/build.ninja" ] || meson setup "$build" -Db_sanitize=address,undefined -Dbuildtype=debugoptimized || exit 1
ninja -C "$build" || exit 1
# An allocation that is too large must be answered as malloc does, by NULL. A first undefined behaviour ends the test.
export ASAN_OPTIONS=detect_leaks=1:allocator_may_return_null=1 UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
# Check has time limits of its own for each case
export CK_TIMEOUT_MULTIPLIER=6
export LSAN_OPTIONS="suppressions=$PWD/tests/support/lsan.supp:print_suppressions=0"
exec scripts/run_tests.sh "$build" quick --timeout-multiplier 6 "$@"
