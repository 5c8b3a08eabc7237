#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Sees which of the packages that Optla needs are missing and installs exactly those (Debian 12; any system with apt whose
# packages have the same names). Plain sh: at this point there may be no compiler, no pkg-config and no Python.
#
#   scripts/deps.sh            what building, testing and running need
#   scripts/deps.sh ci         that, and what .ci/run needs besides; bench: and the rivals of `make bench`
#   scripts/deps.sh check [SET]  only says what is missing; exit status 1 if anything is
#   scripts/deps.sh list [SET]   the names, one a line
set -eu

# package and how to see that it is there: cmd:NAME, pc:PKG-CONFIG-MODULE, header:PATH, file:PATH or py:MODULE
base='
gcc                cmd:cc
g++                cmd:c++
libc6-dev          header:stdio.h
pkg-config         cmd:pkg-config
meson              cmd:meson
ninja-build        cmd:ninja
libopenblas-dev    pc:openblas
liblapack-dev      pc:lapack
liblapacke-dev     pc:lapacke
libhdf5-dev        pc:hdf5
libopenexr-dev     pc:OpenEXR
libpng-dev         pc:libpng
libtiff-dev        pc:libtiff-4
libraw-dev         pc:libraw_r
libyaml-dev        pc:yaml-0.1
libjansson-dev     pc:jansson
libcairo2-dev      pc:cairo
librandom123-dev   header:Random123/philox.h
libxxhash-dev      pc:libxxhash
libzip-dev         pc:libzip
check              pc:check
fonts-dejavu-core  file:/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf
'
ci='
clang              cmd:clang
libclang-rt-14-dev file:/usr/lib/llvm-14/lib/clang/*/lib/linux/libclang_rt.fuzzer-*.a
libomp-dev         file:/usr/lib/llvm-14/lib/libomp.so
clang-format       cmd:clang-format
doxygen            cmd:doxygen
mandoc             cmd:mandoc
'
bench='
python3-numpy      py:numpy
python3-scipy      py:scipy
'

there() {
	case $1 in
	cmd:*) command -v "${1#cmd:}" >/dev/null 2>&1 ;;
	pc:*) command -v pkg-config >/dev/null 2>&1 && pkg-config --exists "${1#pc:}" ;;
	header:*) [ -e "/usr/include/${1#header:}" ] || [ -e "/usr/local/include/${1#header:}" ] ;;
	py:*) /usr/bin/python3 -c "import ${1#py:}" >/dev/null 2>&1 ;;
	file:*) ls ${1#file:} >/dev/null 2>&1 ;; # unquoted: may be a pattern
	esac
}

action=install
case ${1-} in check | list) action=$1; shift ;; esac
table=$base
case ${1-} in
'') ;;
ci) table="$base$ci" ;;
bench) table="$base$bench" ;;
*) echo "scripts/deps.sh: unknown set '$1': allowed are ci, bench, or none" >&2; exit 2 ;;
esac

missing='' all=''
set -f # the table's patterns are words here
set -- $table
set +f
while [ $# -gt 1 ]; do
	all="$all $1"
	there "$2" || missing="$missing $1"
	shift 2
done

if [ $action = list ]; then
	printf '%s\n' $all
	exit 0
fi
[ -n "$missing" ] || exit 0
if [ $action = check ]; then
	echo "missing:$missing"
	exit 1
fi

line="apt-get install -y --no-install-recommends$missing"
root=''
if [ "$(id -u)" != 0 ]; then
	if command -v sudo >/dev/null 2>&1 && sudo -n true >/dev/null 2>&1; then
		root='sudo -n'
	else
		echo "Optla needs packages that this account may not install. Run this once, then the same make again:" >&2
		echo "    sudo sh -c 'apt-get update && $line'" >&2
		exit 1
	fi
fi
if ! command -v apt-get >/dev/null 2>&1; then
	echo "There is no apt-get here. Install what Debian 12 calls:$missing" >&2
	exit 1
fi
echo "Installing:$missing"
$root env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 update
$root env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 install -y --no-install-recommends $missing
