# SPDX-License-Identifier: BSD-3-Clause
# What the tests of the command share: cases in TAP, a folder of their own, the command as $OPTLA. Source it: . "$(dirname "$0")/lib.sh"; afterwards
# $HERE is the folder of the tests.
#
# A case is a function; `run NAME FUNCTION` counts it. Inside, the checks below print what was wrong and return 1; with `set -e`
# semantics by hand: chain them with && or `|| return 1`.
: "${OPTLA:?set OPTLA to the command}" "${OPTLA_SOURCE:?set OPTLA_SOURCE to the source tree}"
unset CDPATH
HERE=$(cd "$(dirname "$0")" && pwd) || exit 99
[ -x "$OPTLA" ] || { echo "Bail out! $OPTLA is not there"; exit 99; }
export LC_ALL=C SOURCE_DATE_EPOCH=1700000000
TMP=$(mktemp -d "${TMPDIR:-/tmp}/optla-cli.XXXXXX") || exit 99
trap 'rm -rf "$TMP"' EXIT
trap 'exit 130' INT TERM
cd "$TMP" || exit 99
cases=0 bad=0

# run "what is claimed" function [arguments]: one case
run() {
	claim=$1
	shift
	cases=$((cases + 1))
	if "$@" >"$TMP/.case" 2>&1; then
		echo "ok $cases - $claim"
	else
		echo "not ok $cases - $claim"
		sed 's/^/# /' "$TMP/.case"
		bad=$((bad + 1))
	fi
}

# skip "what is claimed" "why"
skip() {
	cases=$((cases + 1))
	echo "ok $cases - $1 # SKIP $2"
}

finish() {
	echo "1..$cases"
	[ $bad -eq 0 ]
}

# works COMMAND...: exit status 0; stdout in .out, stderr in .err
works() { ends 0 "$@"; }

# ends STATUS COMMAND...
ends() {
	wanted=$1
	shift
	"$@" >"$TMP/.out" 2>"$TMP/.err"
	got=$?
	[ $got -eq "$wanted" ] && return 0
	echo "status $got, wanted $wanted: $*"
	tail -n 20 "$TMP/.out" "$TMP/.err"
	return 1
}

# fails STATUS "text that standard error must hold" COMMAND...
fails() {
	wanted=$1 text=$2
	shift 2
	ends "$wanted" "$@" || return 1
	grep -qF -- "$text" "$TMP/.err" && return 0
	echo "standard error lacks '$text': $*"
	cat "$TMP/.err"
	return 1
}

# says "text that standard output must hold": of the last command
says() {
	grep -qF -- "$1" "$TMP/.out" && return 0
	echo "standard output lacks '$1':"
	cat "$TMP/.out"
	return 1
}

# number FILE KEY: a top-level number of a JSON file written by --json
number() { sed -n "s/^  \"$2\": \(-\{0,1\}[0-9.eE+-]*\),\{0,1\}\$/\1/p" "$1"; }

# holds "EXPRESSION": an awk expression is true
holds() {
	awk "BEGIN { exit !($1) }" && return 0
	echo "not true: $1"
	return 1
}

# missing PATH...: none of these exists, nor a temporary file of them
missing() {
	for path in "$@"; do
		for left in "$path" "$path"?*; do
			[ -e "$left" ] || continue
			echo "'$left' was left behind"
			return 1
		done
	done
}
