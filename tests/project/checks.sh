#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The checks of the sources must find what they are there for: a small tree with one breach at a time. Speaks TAP.
#
#   checks.sh SOURCE_ROOT
set -u
root=$1
tmp=$(mktemp -d) || exit 2
trap 'rm -rf "$tmp"' EXIT
case_=0 failed=0

tree() { # a sound project of two folders
	rm -rf "$tmp/tree"
	mkdir -p "$tmp/tree/src/base" "$tmp/tree/src/op" "$tmp/tree/include/optla" "$tmp/tree/tools" "$tmp/tree/tests" \
		"$tmp/tree/examples" "$tmp/tree/bench" "$tmp/tree/scripts" "$tmp/tree/docs" || exit 2
	cd "$tmp/tree" || exit 2
	printf "folders = ['base', 'op', 'capture', 'report']\n" >src/meson.build
	printf "optla_sources += files('a.c')\n" >src/base/meson.build
	printf "optla_sources += files('b.c')\n" >src/op/meson.build
	printf "public_headers = files('base.h', 'optla.h')\n" >include/optla/meson.build
	spdx='/* SPDX-License-Identifier: BSD-3-Clause */'
	printf '%s\n#include <stddef.h>\n' "$spdx" >include/optla/base.h
	printf '%s\n#include "optla/base.h"\n' "$spdx" >include/optla/optla.h
	printf '%s\n#include "optla/base.h"\n' "$spdx" >src/base/a.c
	printf '%s\n#include "base/a.h"\n' "$spdx" >src/op/b.c
	printf '%s\n' "$spdx" >src/base/a.h
	: >Makefile
}

# expect CHECK WORD NAME: the check fails, and a line with WORD says why; WORD empty: the check passes
expect() {
	case_=$((case_ + 1))
	out=$("$root/scripts/check_$1.sh" "$tmp/tree" 2>&1)
	status=$?
	if [ -z "$2" ] && [ $status = 0 ]; then
		echo "ok $case_ - $3"
	elif [ -n "$2" ] && [ $status != 0 ] && printf '%s\n' "$out" | grep '^#' | grep -q -- "$2"; then
		echo "ok $case_ - $3"
	else
		printf '%s\n' "$out" | sed 's/^/# | /'
		echo "not ok $case_ - $3"
		failed=1
	fi
}

tree; expect layers '' "a sound tree passes the check of layers"
tree; expect text '' "a sound tree passes the check of wording"
tree; echo '#include "op/b.h"' >>src/base/a.c; expect layers 'src/base/a.c (base) includes "op/b.h" (op)' "an include against the order"
tree; echo '#  include "optla/rig.h"' >>src/op/b.c; : >include/optla/rig.h; expect layers 'src/op/b.c (op) includes "optla/rig.h" (capture)' "a public header of a later folder"
tree; echo '#include "../op/b.h"' >>src/base/a.c; expect layers 'src/base/a.c: include' "a way around the order"
tree; echo '#include "base/a.h"' >>include/optla/base.h; expect layers 'belongs to no folder\|not public\|public headers include' "a private header in a public one"
tree; echo '#include <png.h>' >>include/optla/base.h; expect layers 'png.h' "another library's header in a public one"
tree; echo '/* SPDX-License-Identifier: BSD-3-Clause */' >src/op/c.c; expect layers 'src/op/c.c is not in its meson.build' "a source that nobody builds"
tree; echo '/* SPDX-License-Identifier: BSD-3-Clause */' >include/optla/new.h; expect layers "new.h is not in include" "a header that isn't installed"
tree; mkdir src/extra; expect layers 'src/extra is not in the order' "a folder without a place"
tree; echo '#include "base/a.h"' >examples/x.c; expect layers 'examples/x.c' "an example that looks inside"
tree; echo 'int x;' >src/op/d.c; expect text 'src/op/d.c has no SPDX' "a source without a licence"
tree; echo 'void f(void) { printf("x"); }' >>src/op/b.c; expect text 'src/op/b.c:3' "printing in the library"
tree; echo 'void f(void) { snprintf(b, 2, "exit(1)"); /* exit(1) */ }' >>src/op/b.c; expect text '' "snprintf, strings and comments are no breach"
tree; echo 'int f(void) { return rand (); }' >>src/op/b.c; expect text 'src/op/b.c:3' "rand in the library"
tree; echo 'void *f(void) { return malloc(1); }' >>src/op/b.c; expect text 'src/op/b.c:3' "malloc past the context"
tree; printf '/* TO%s: later */\n' DO >>src/op/b.c; expect text 'src/op/b.c:3' "work left for later"
tree; printf 'int x; \n' >>src/op/b.c; expect text 'src/op/b.c:3' "a blank at a line's end"
tree; echo "pc_names = ['png']" >meson.build; echo 'libpng-dev pc:png' >scripts/deps.sh; echo '# SPDX-License-Identifier: BSD-3-Clause' >>scripts/deps.sh; expect text '' "a library with its package"
tree; echo "pc_names = ['png']" >meson.build; echo '# SPDX-License-Identifier: BSD-3-Clause' >scripts/deps.sh; expect text "'png'" "a library without its package"

echo "1..$case_"
exit $failed
