#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Each public header compiles alone, twice over, as strict C17 and as C++17. Speaks TAP.
#
#   headers.sh SOURCE_ROOT CC...     the C compiler; it is asked for C++ as well (g++ or clang++ must be installed for that)
set -u
cd "$1" || exit 2
shift
case_=0 failed=0
one() { # language standard header
	case_=$((case_ + 1))
	if message=$(printf '#include "optla/%s"\n#include "optla/%s"\n' "$3" "$3" |
		"$cc" -x "$1" -std="$2" -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror -Iinclude -fsyntax-only - 2>&1); then
		echo "ok $case_ - $3 as $2"
	else
		printf '%s\n' "$message" | sed 's/^/# /'
		echo "not ok $case_ - $3 as $2"
		failed=1
	fi
}
cc=$(mktemp) || exit 2
trap 'rm -f "$cc"' EXIT
printf '#!/bin/sh\nexec %s "$@"\n' "$*" >"$cc"
chmod +x "$cc"
for header in include/optla/*.h; do
	one c c17 "$(basename "$header")"
	one c++ c++17 "$(basename "$header")"
done
echo "1..$case_"
exit $failed
