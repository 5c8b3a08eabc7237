#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# What README.md tells people to type works as it stands there: the first five minutes, a rig of their own. Speaks TAP.
#
#   readme.sh SOURCE_ROOT BUILD_ROOT
set -u
root=$1 build=$2
tmp=$(mktemp -d) || exit 2
trap 'rm -rf "$tmp"' EXIT
case_=0 failed=0
try() { # name command...
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
section() { sed -n "/^## $1/,/^## /p" "$root/README.md"; } # indented lines of a section are what one types
typed() { section "$1" | sed -n 's/^    \(optla .*\)/\1/p'; }
export PATH="$build/tools:$PATH"

mkdir -p "$tmp/clone/out"
ln -s "$root/examples" "$tmp/clone/examples"
cd "$tmp/clone/out" || exit 2
typed 'The first five minutes' >"$tmp/commands"
while read -r command; do
	try "$command" sh -c "$command </dev/null"
done <"$tmp/commands"
try "pictures came of it" sh -c 'test -s one.png && test -s pattern.png'

mkdir "$tmp/mine" && cd "$tmp/mine" || exit 2
section 'Your own photos' | sed -n '/^    kind:/,/^$/s/^    //p' >my-rig.yaml
# A Lambertian ball before a dark ground under 24 lights, black level 100, in 16 bit
python3 - <<'PYTHON' || exit 2
import math, struct, zlib
W = H = 24
def png(name, rows):
    def chunk(kind, data):
        return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
    raw = b''.join(b'\0' + struct.pack('>%dH' % W, *row) for row in rows)
    with open(name, 'wb') as f:
        f.write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', W, H, 16, 0, 0, 0, 0)) + chunk(b'IDAT', zlib.compress(raw)) + chunk(b'IEND', b''))
lights = []
for k in range(24):
    azimuth, height = math.radians(15 + 360 * (k % 8) / 8), math.radians(25 + 22 * (k // 8))
    lights.append((math.cos(height) * math.cos(azimuth), math.cos(height) * math.sin(azimuth), math.sin(height)))
with open('directions.txt', 'w') as f:
    f.writelines('%.6f %.6f %.6f\n' % l for l in lights)
for k, l in enumerate(lights):
    rows = []
    for j in range(H):
        row = []
        for i in range(W):
            x, y = (i - 11.5) / 11, (11.5 - j) / 11
            z2 = 1 - x * x - y * y
            n = (x, y, math.sqrt(z2)) if z2 > 0 else (0, 0, 0.05)
            row.append(100 + round(30000 * max(0, sum(a * b for a, b in zip(n, l)))))
        rows.append(row)
    png('light_%02d.png' % (k + 1), rows)
for k in 1, 2:
    png('dark_%d.png' % k, [[100] * W] * H)
PYTHON
typed 'Your own photos' >"$tmp/commands"
while read -r command; do
	try "$command" sh -c "$command </dev/null"
done <"$tmp/commands"
try "a picture came of it" test -s relit.png

sed -n '/^```c$/,/^```$/p' "$root/README.md" | sed '1d;$d' >"$tmp/readme.c"
sed -n '/^#include/,$p' "$root/examples/first.c" >"$tmp/first.c"
try "the C program is examples/first.c" diff "$tmp/first.c" "$tmp/readme.c"
optla help | awk '/^Verbs:/ { on = 1; next } on && !NF { exit } on && /^  [a-z]/ { print $1 }' | sort >"$tmp/verbs"
section 'The first five minutes' | sed -n 's/^| `\([a-z]*\)` |.*/\1/p' | sort >"$tmp/listed"
try "its table has every verb" diff "$tmp/verbs" "$tmp/listed"
grep -o '([a-zA-Z0-9_/.-]*)\|`[a-zA-Z0-9_/-]*\.\(md\|c\|yaml\|png\)`' "$root/README.md" | tr -d '()`' | grep '[/.]' | sort -u >"$tmp/names"
while read -r name; do
	case $name in rigs.md | files.md | threads.md) name=docs/$name ;; out/* | relit.png) continue ;; esac
	[ -e "$root/$name" ] || echo "$name"
done <"$tmp/names" >"$tmp/gone"
try "the files it names are there" sh -c "cat '$tmp/gone'; test ! -s '$tmp/gone'"
echo "1..$case_"
exit $failed
