#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What sources must and must not say. Speaks TAP.
#
#   scripts/check_text.sh [SOURCE_ROOT]
set -u
cd "${1:-$(dirname "$0")/..}" || exit 2

files() { find src include tools tests examples bench scripts -type f \( "$@" \) ! -path '*/build*' | sort; }
case_=0 failed=0
tmp=$(mktemp) || exit 2
trap 'rm -f "$tmp"' EXIT
# Breaches are the lines of $tmp; none is good.
finish() {
	case_=$((case_ + 1))
	if [ -s "$tmp" ]; then
		sed 's/^/# /' "$tmp"
		echo "not ok $case_ - $1"
		failed=1
	else
		echo "ok $case_ - $1"
	fi
}

# grep_code REGEX FILE...: matches outside of comments and strings, by name and line; lines keep their numbers
grep_code() {
	regex=$1
	shift
	for file; do
		awk -v regex="$regex" -v file="$file" '
		{
			text = $0
			gsub(/\\["\\]/, "", text)          # escaped quotes
			if (!inside) gsub(/"[^"]*"/, "\"\"", text)
			while (1) {
				if (inside) {
					at = index(text, "*/")
					if (!at) { text = ""; break }
					text = substr(text, at + 2); inside = 0
				}
				at = index(text, "/*")
				if (!at) break
				rest = substr(text, at + 2); close_ = index(rest, "*/")
				if (close_) text = substr(text, 1, at - 1) " " substr(rest, close_ + 2)
				else { kept = substr(text, 1, at - 1); inside = 1; text = kept; break }
			}
			sub(/\/\/.*/, "", text)
			if (text ~ regex) print file ":" FNR ": " $0
		}' "$file"
	done
}

sources=$(files -name '*.c' -o -name '*.h' -o -name '*.in' -o -name '*.sh' -o -name '*.py')
for file in $sources; do
	head -n 3 "$file" | grep -q 'SPDX-License-Identifier: BSD-3-Clause' || echo "$file has no SPDX line in its first three lines"
done >"$tmp"
finish "every source names its licence"

library=$(files -name '*.c' -o -name '*.h' | grep -E '^(src|include)/')
grep_code '(^|[^A-Za-z0-9_])(v?printf|puts|putchar|exit|_exit|abort|rand|srand|random|drand48|system|getenv|setenv|signal|time)[ \t]*\(' $library >"$tmp"
finish "the library doesn't print, end the process, ask the environment or draw unseeded numbers"
grep_code '(^|[^A-Za-z0-9_])(stdout|stderr)([^A-Za-z0-9_]|$)' $library >"$tmp"
finish "the library doesn't write to the standard streams"
grep_code '(^|[^A-Za-z0-9_])(gets|sprintf|vsprintf|strcpy|strcat|strtok|alloca|asctime|ctime|localtime|gmtime)[ \t]*\(' $(files -name '*.c' -o -name '*.h' | grep -v '^tests/') >"$tmp"
finish "no function that can't be used safely"
# base/ makes the context's memory; HDF5 takes and returns the handles of its drivers by malloc and free
grep_code '(^|[^A-Za-z0-9_])(malloc|calloc|realloc|strdup|strndup)[ \t]*\(' $(printf '%s\n' $library | grep -v -e '^src/base/' -e '^src/io/h5_driver.c$') >"$tmp"
finish "memory comes from the context"

words='TO''DO|FIX''ME|XX''X|HA''CK'
grep -nE "(^|[^A-Za-z])($words)([^A-Za-z]|\$)" $sources $(find docs -name '*.md') README.md CONTRIBUTING.md CHANGELOG.md Makefile 2>/dev/null >"$tmp"
finish "nothing is left to be done later"
grep -nE '[[:space:]]+$' $sources Makefile | sed 's/$/ <- blank at the end/' >"$tmp"
finish "no blanks at line ends"
grep -n "$(printf '\r')" $sources >"$tmp"
finish "no carriage returns"
for file in $(files -name '*.c' -o -name '*.h'); do
	lines=$(wc -l <"$file")
	[ "$lines" -le 800 ] || echo "$file has $lines lines: one idea per file"
done >"$tmp"
finish "no source is longer than 800 lines"
for file in include/optla/*.h; do
	lines=$(wc -l <"$file")
	[ "$lines" -le 400 ] || echo "$file has $lines lines"
done >"$tmp"
finish "no public header is longer than 400 lines"

# pc_names may go over several lines
for name in $(sed -n '/^pc_names = /,/]/p' meson.build 2>/dev/null | grep -o "'[^']*'" | tr -d "'"); do
	grep -q "[[:space:]]pc:$name\$" scripts/deps.sh || echo "meson.build needs '$name', scripts/deps.sh installs no package for it"
done >"$tmp"
finish "every library that is linked gets installed by scripts/deps.sh"

echo "1..$case_"
exit $failed
