#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Runs one example and judges what it prints. Speaks TAP.
#
#   example.sh NAME PROGRAM ARGUMENTS...
set -u
name=$1
shift
echo 1..1
out=$("$@" 2>&1)
status=$?
printf '%s\n' "$out" | sed 's/^/# /'
good=0
if [ $status = 0 ]; then
	case $name in
	# Rank 10 of this T can't be nearer than 0.0510 (Eckart-Young); ten iterations come to 0.0764 with a perfect camera, and the noise of
	# the sensor may add as much again: 0.0764 * sqrt(2) = 0.108. Two photos for T p and two for T' d in each iteration.
	first) printf '%s\n' "$out" | awk '$1 == 40 && $2 == "photos," && $5 > 0.0510 && $5 < 0.108 { good = 1 } END { exit !good }' && good=1 ;;
	# The program's own verdict: singular values to 1e-10, a residual below 0.05.
	own_operator | invert) good=1 ;;
	# T as a whole is 0.0144 away after twenty iterations; a light in the middle of the screen is nearer than the average of all.
	relight)
		printf '%s\n' "$out" | awk '$2 == "photos;" && $NF > 0 && $NF < 0.0144 { good = 1 } END { exit !good }' &&
			[ -s relit.png ] && [ -s model.h5 ] && good=1
		rm -f relit.png model.h5 ;;
	*) echo "# example.sh doesn't know what $name should say" ;;
	esac
fi
if [ $good = 1 ]; then
	echo "ok 1 - $name"
else
	echo "not ok 1 - $name (exit status $status)"
fi
