#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The order of folders in src/meson.build is the law: a folder includes itself and folders before it, nothing else; public headers
# belong to a folder each and obey the same order; public headers include public headers only; each source is built. Speaks TAP.
#
#   scripts/check_layers.sh [SOURCE_ROOT]
set -u
cd "${1:-$(dirname "$0")/..}" || exit 2

order=$(sed -n "s/^folders = \[\(.*\)\]/\1/p" src/meson.build | tr -d "',")
[ -n "$order" ] || { echo "1..1"; echo "not ok 1 - src/meson.build has no line folders = [...]"; exit 1; }

rank() { # position of a folder in the order; nothing for one that isn't in it
	n=0
	for f in $order; do
		n=$((n + 1))
		[ "$f" = "$1" ] && echo $n && return
	done
}

# Folder of a public header. op.h also declares the blocks of columns, which the kernels in math/ work on: it counts as base.
home() {
	case $1 in
	base | op) echo base ;;
	sensor | rig) echo capture ;;
	optla) echo report ;;
	*) echo "$1" ;;
	esac
}

breaches=''
say() { breaches="$breaches# $1
"; }
case_=0 failed=0
finish() { # name of the case that ends here
	case_=$((case_ + 1))
	if [ -n "$breaches" ]; then
		printf '%snot ok %d - %s\n' "$breaches" $case_ "$1"
		failed=1
	else
		echo "ok $case_ - $1"
	fi
	breaches=''
}

for folder in src/*/; do
	folder=$(basename "$folder")
	[ -n "$(rank "$folder")" ] || say "src/$folder is not in the order of src/meson.build"
done
finish "every folder of src/ has its place in the order"

tmp=$(mktemp) || exit 2
trap 'rm -f "$tmp"' EXIT
find src -name '*.c' -o -name '*.h' | sort | xargs -r grep -Ho '^[[:space:]]*#[[:space:]]*include[[:space:]]*["<][^">]*[">]' | sed -E 's/:[[:space:]]*#[[:space:]]*include[[:space:]]*/ /' >"$tmp"
while read -r file what; do
	folder=${file#src/}; folder=${folder%%/*}
	case $what in
	\"optla/*) # a public header stands for its folder
		header=${what#\"optla/}; header=${header%.h\"}
		target=$(home "$header")
		[ "$header" != optla ] || say "$file includes all public headers at once"
		[ -f "include/optla/$header.h" ] || say "$file includes \"optla/$header.h\", which isn't there" ;;
	\<optla/* | \"../*) say "$file: include $what by its name below include/ or src/"; continue ;;
	\"*/*) target=${what#\"}; target=${target%%/*} ;;
	*) continue ;; # own folder or system
	esac
	mine=$(rank "$folder") its=$(rank "$target")
	if [ -z "$its" ]; then
		say "$file includes $what: no such folder in the order"
	elif [ -n "$mine" ] && [ "$its" -gt "$mine" ]; then
		say "$file ($folder) includes $what ($target), which comes later: $order"
	fi
done <"$tmp"
finish "a folder includes only folders before it"

grep -Ho '^[[:space:]]*#[[:space:]]*include[[:space:]]*["<][^">]*[">]' include/optla/*.h | sed -E 's/:[[:space:]]*#[[:space:]]*include[[:space:]]*/ /' >"$tmp"
while read -r file what; do
	name=$(basename "$file" .h)
	case $what in
	\"optla/*)
		header=${what#\"optla/}; header=${header%.h\"}
		[ -f "include/optla/$header.h" ] || say "$file includes $what, which is not public"
		its=$(rank "$(home "$header")") mine=$(rank "$(home "$name")")
		[ -n "$mine" ] && [ -n "$its" ] || { say "$file: $name or $header belongs to no folder of the order"; continue; }
		[ "$its" -le "$mine" ] || say "$file includes $what, which belongs to a later folder" ;;
	\"*) say "$file includes $what: public headers include public headers only" ;;
	\<std*.h\> | \<math.h\> | \<complex.h\>) ;;
	*) say "$file includes $what: only headers of the C standard" ;;
	esac
done <"$tmp"
finish "public headers include public headers and the C standard only"

for header in include/optla/*.h; do
	name=$(basename "$header")
	grep -q "'$name'" include/optla/meson.build || say "$header is not in include/optla/meson.build: it won't be installed"
	[ "$name" = optla.h ] || grep -q "\"optla/$name\"" include/optla/optla.h || say "$header is missing in optla.h"
done
finish "every public header is installed and in optla.h"

for source in src/*/*.c; do
	grep -q "'$(basename "$source")'" "$(dirname "$source")/meson.build" || say "$source is not in its meson.build: nobody builds it"
done
finish "every source is built"

grep -Ho '#[[:space:]]*include[[:space:]]*"[^"]*"' examples/*.c 2>/dev/null | grep -v '"optla/' >"$tmp"
while read -r line; do say "$line: examples use the public headers only"; done <"$tmp"
finish "examples use the public headers only"

echo "1..$case_"
exit $failed
