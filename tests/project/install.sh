#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs into an empty folder and uses only what lies there, found by pkg-config alone: examples/first.c against the shared and the
# static library, a C++ program, the command, the manual pages. Speaks TAP.
#
#   install.sh SOURCE_ROOT BUILD_ROOT PREFIX LIBDIR VERSION CFLAGS CC...
set -u
source=$1 build=$2 prefix=$3 libdir=$4 version=$5 cflags=$6
shift 6
tmp=$(mktemp -d) || exit 2
trap 'rm -rf "$tmp"' EXIT
at=$tmp/root$prefix
case_=0 failed=0
try() { # name command...: TAP line by the command's exit status
	name=$1
	shift
	case_=$((case_ + 1))
	if "$@" >"$tmp/log" 2>&1; then
		echo "ok $case_ - $name"
	else
		sed 's/^/# /' "$tmp/log"
		echo "not ok $case_ - $name"
		failed=1
	fi
}
pc() { PKG_CONFIG_PATH=$at/$libdir/pkgconfig pkg-config --define-variable=prefix="$at" "$@" optla; }

run() { # program folder-of-the-library: the installed rig, judged as the example in the build folder
	LD_LIBRARY_PATH=$2 sh "$source/tests/project/example.sh" first "$tmp/$1" "$at/share/optla/rigs/corner-screen.yaml" >"$tmp/$1.out"
	cat "$tmp/$1.out"
	grep -q '^ok 1' "$tmp/$1.out"
}

try "meson install" meson install -C "$build" --no-rebuild --destdir "$tmp/root"
try "pkg-config finds it, with the version of the project" sh -c "test \"\$(PKG_CONFIG_PATH=$at/$libdir/pkgconfig pkg-config --modversion optla)\" = $version"
try "all public headers lie there, and no others" sh -c "cd '$source/include/optla' && ls *.h >'$tmp/a' && cd '$at/include/optla' && ls >'$tmp/b' && diff '$tmp/a' '$tmp/b'"
for exported in $(nm -D --defined-only "$at/$libdir/liboptla.so" | awk '$2 ~ /[TDBRV]/ { print $3 }'); do
	case $exported in
	__odr_asan*) ;; # the address sanitizer's own
	optla_*_ | [!o]* | o[!p]*) echo "$exported" ;;
	esac
done >"$tmp/leaked"
try "the shared library shows names that start with optla_ only, internal ones not" sh -c "cat '$tmp/leaked'; test ! -s '$tmp/leaked'"

try "examples/first.c compiles against the shared library" "$@" $cflags "$source/examples/first.c" -o "$tmp/first" $(pc --cflags --libs)
try "it runs" run first "$at/$libdir"
printf '#include <optla/optla.h>\n#include <cstring>\nint main() { return std::strcmp(optla_version(), "%s"); }\n' "$version" >"$tmp/version.cpp"
try "a C++ program compiles" "$@" $cflags "$tmp/version.cpp" -o "$tmp/version" $(pc --cflags --libs) -lstdc++
try "it runs and sees the version" env LD_LIBRARY_PATH="$at/$libdir" "$tmp/version"
try "the command runs from there" sh -c "'$at/bin/optla' --version | grep -qF $version"
try "its manual page lies there" sh -c "ls '$at'/share/man/man1/optla.1*"

rm -f "$at/$libdir"/liboptla.so*
try "examples/first.c compiles against the static library" "$@" $cflags "$source/examples/first.c" -o "$tmp/first_static" $(pc --static --cflags --libs)
try "it runs without the shared one" run first_static /nowhere
try "both say the same to the last digit" cmp "$tmp/first.out" "$tmp/first_static.out"
echo "1..$case_"
exit $failed
