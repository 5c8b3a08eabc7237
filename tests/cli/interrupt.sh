#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Ctrl-C, limits of the disk, and outputs that can't be written: nothing half-written stays.
. "$(dirname "$0")/lib.sh"
. "$HERE/rigs.sh"

screen screen.yaml 16 8
corner big.yaml 40 30

# stop_after SECONDS COMMAND...: Ctrl-C after that time; status in $status. A shell starts background jobs with SIGINT ignored, which
# the command respects: env undoes it.
stop_after() {
	pause=$1
	shift
	env --default-signal=INT "$@" >.o 2>.e &
	pid=$!
	sleep "$pause"
	kill -INT $pid
	wait $pid
	status=$?
}

stopped() { # stopped in the middle, the photos are kept and the run goes on to the same end
	for pause in 0.5 1 2 4 8 16; do # until the machine was quick enough for the first iterations
		stop_after $pause "$OPTLA" krylov arnoldi big.yaml -K 900 --split signed --state run.h5 -o never.h5 --no-truth
		[ $status -eq 1 ] || { echo "status $status"; cat .e; return 1; }
		[ -e run.h5 ] && break
	done
	grep -q "kept in 'run.h5'" .e && grep -q 'optla: stopped' .e || { cat .e; return 1; }
	missing never.h5 || return 1
	done_=$("$OPTLA" info run.h5 --json - | sed -n 's/.*"iterations": \([0-9]*\).*/\1/p' | head -n 1)
	[ -n "$done_" ] && [ "$done_" -gt 0 ] || { echo "no iterations in the state"; return 1; }
	more=$((done_ + 3))
	works "$OPTLA" krylov arnoldi big.yaml -K $more --split signed --resume run.h5 --state run.h5 -o m.h5 --no-truth -q || return 1
	works "$OPTLA" krylov arnoldi big.yaml -K $more --split signed --state other.h5 -o n.h5 --no-truth -q || return 1
	works "$OPTLA" compare run.h5 other.h5 --max-rel-error 0
}
run "Ctrl-C keeps the state, and --resume ends where an uninterrupted run does" stopped

nothing() { # without --state nothing is left
	mkdir clean || return 1
	stop_after 1 "$OPTLA" krylov arnoldi big.yaml -K 900 -o clean/m.h5 --json clean/j.json --no-truth
	[ $status -eq 1 ] || { echo "status $status"; cat .e; return 1; }
	[ -z "$(ls -A clean)" ] || { ls -A clean; return 1; }
}
run "Ctrl-C without --state leaves no file behind" nothing

works "$OPTLA" krylov arnoldi screen.yaml -K 8 -q -o m.h5 || exit 1

limit() { # the file size limit acts like a full disk: blocks of 512 bytes
	mkdir -p full || return 1
	fails 1 "$2" sh -c 'ulimit -f 1; exec "$0" "$@"' "$OPTLA" $1 || return 1
	[ -z "$(ls -A full)" ] || { ls -A full; return 1; }
}
for f in exr tif pfm npy png; do
	run "a full disk while $f is written: status 1, nothing left" limit "relight m.h5 --light all -o full/a.$f" "full/a.$f"
done
run "a full disk while a model is written" limit "krylov arnoldi screen.yaml -K 8 -o full/m.h5 -q" "full/m.h5"
run "a full disk while a state is written" limit "krylov arnoldi screen.yaml -K 8 --state full/s.h5 -q" "full/s.h5"
run "a full disk while numbers are written" limit "info m.h5 --json full/n.json" "full/n.json"

keeps_old() { # a failed writer leaves the old file as it was
	mkdir -p old && works "$OPTLA" relight m.h5 --light all -o old/a.exr && cp old/a.exr copy.exr || return 1
	ends 1 sh -c 'ulimit -f 1; exec "$0" "$@"' "$OPTLA" relight m.h5 --light light:3 -o old/a.exr || return 1
	cmp old/a.exr copy.exr && [ "$(ls -A old)" = a.exr ]
}
run "a failed write keeps the file that was there" keeps_old

run "output folder missing: said before the work" fails 1 "directory 'nowhere': No such file" "$OPTLA" krylov arnoldi screen.yaml -o nowhere/m.h5
run "numbers' folder missing" fails 1 "directory 'nowhere'" "$OPTLA" info m.h5 --json nowhere/n.json
run "output is a directory" fails 1 "is a directory" "$OPTLA" krylov arnoldi screen.yaml -o old
forbidden() {
	mkdir -p locked && chmod 555 locked || return 1
	fails 1 "locked" "$OPTLA" relight m.h5 --light all -o locked/a.exr
	result=$?
	chmod 755 locked
	return $result
}
if [ "$(id -u)" = 0 ]; then # root may write everywhere: a folder in /proc refuses root too
	run "a folder that can't be written to" fails 1 "/proc/a.exr" "$OPTLA" relight m.h5 --light all -o /proc/a.exr
else
	run "a folder that can't be written to" forbidden
fi

finish
