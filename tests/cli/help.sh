#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Help, man pages, version, and what a wrong command line is answered.
. "$(dirname "$0")/lib.sh"

verbs=$("$OPTLA" help | sed -n '/^Verbs:/,/^$/s/^  \([a-z]*\) .*/\1/p')

every_verb_is_listed() {
	for verb in demo krylov relight invert dual reproduce info compare; do
		echo "$verbs" | grep -qx "$verb" || { echo "'optla help' lacks $verb"; return 1; }
	done
}
run "help lists every verb" every_verb_is_listed

version() { works "$OPTLA" --version && grep -qxE 'optla [0-9]+\.[0-9]+\.[0-9]+' .out; }
run "--version prints name and version" version

no_verb() { ends 2 "$OPTLA" && grep -q '^Usage: optla' .err; }
run "without a verb the usage goes to standard error, status 2" no_verb

verb_help() {
	works "$OPTLA" "$1" --help || return 1
	cp .out long
	works "$OPTLA" help "$1" && cmp .out long || return 1
	sed -n '/^Examples:/,$p' long | grep -q "^  optla $1" || { echo "no example"; return 1; }
	# commands of examples stay on one line; all else is filled
	sed '/^  optla/d' long | awk 'length > 92 { print FILENAME ": too wide: " $0; bad = 1 } END { exit bad }'
}
verb_man() {
	works "$OPTLA" help --man "$1" || return 1
	cp .out page
	grep -q '^\.SH EXAMPLES' page || { echo "no examples"; return 1; }
	# every option of the help is in the page
	"$OPTLA" help "$1" | grep -oE '^  (-[a-zA-Z], )?--[][a-z-]+' | grep -oE -- '--[][a-z-]+' | while read -r option; do
		tr -d '\\' <page | grep -qF -- "$option" || { echo "the man page lacks $option"; exit 1; }
	done || return 1
	if command -v groff >/dev/null; then
		groff -man -Tutf8 -ww page 2>warnings >/dev/null
		! [ -s warnings ] || { cat warnings; return 1; }
	fi
}
for verb in $verbs; do
	run "$verb --help shows usage and an example" verb_help "$verb"
	run "$verb has a man page with all options" verb_man "$verb"
done

main_man() { works "$OPTLA" help --man && grep -q '^\.TH OPTLA 1' .out && grep -q 'EXIT STATUS' .out; }
run "the command has a man page" main_man

# the help prints defaults; given as they are, they must be accepted
run "unknown verb: nearest is suggested" fails 2 "did you mean 'krylov'" "$OPTLA" krilov
run "unknown verb far from all: no suggestion" fails 2 "there is no verb 'xyzzy' (" "$OPTLA" xyzzy
run "unknown option: nearest is suggested" fails 2 "did you mean '--max-rel-error'" "$OPTLA" compare a b --max-rel-eror 1
run "unknown short option" fails 2 "has no option '-Z'" "$OPTLA" info -Z a
run "missing argument" fails 2 "'compare' needs B" "$OPTLA" compare a
run "argument too many" fails 2 "'c' is one too many" "$OPTLA" compare a b c
run "missing value" fails 2 "needs a value" "$OPTLA" info a --json
run "empty value" fails 2 "empty value" "$OPTLA" info a --json=
run "a number that is none" fails 2 "'x' is not a whole number" "$OPTLA" info a --threads x
run "a number out of range" fails 2 "'-1' is not a whole number from 0 to 4096" "$OPTLA" info a --threads -1
run "a word that isn't a choice" fails 2 "'neither' is not one of signed|offset|auto" "$OPTLA" krylov arnoldi r.yaml -o m.h5 --split neither
run "K = 0" fails 2 "'0' is not a whole number from 1" "$OPTLA" krylov arnoldi r.yaml -K 0 -o m.h5
run "unknown method" fails 2 "did you mean 'arnoldi'" "$OPTLA" krylov arnoldy r.yaml -o m.h5
run "no output asked for" fails 2 "nothing would be kept" "$OPTLA" krylov arnoldi r.yaml
run "verb without its output" fails 2 "needs '-o PATH'" "$OPTLA" relight m.h5 --light all
run "-o where nothing is written" fails 2 "has no option '-o'" "$OPTLA" info a -o b
run "unknown sensor: the known ones are named" fails 2 "dslr-14bit" "$OPTLA" krylov arnoldi r.yaml --sensor mine -o m.h5
run "gmres without a target" fails 2 "--target IMAGE" "$OPTLA" krylov gmres r.yaml -o p.csv
run "a target where none is used" fails 2 "belongs to gmres" "$OPTLA" krylov arnoldi r.yaml --target a.exr -o m.h5
run "relight without light" fails 2 "--light SPEC" "$OPTLA" relight m.h5 -o a.png
run "picture of unknown ending" fails 2 "a picture is written as" "$OPTLA" relight m.h5 --light all -o a.jpg
run "unknown figure: the known ones are named" fails 2 "fig2.9" "$OPTLA" reproduce fig7.7 -o out
run "an unknown figure after a known one: nothing is begun" fails 2 "'nosuch' is not a figure" "$OPTLA" reproduce fig2.2 nosuch -o out
run "no page of an unknown figure" missing out
run "help for an unknown verb" fails 2 "there is no verb" "$OPTLA" help nosuch

closed_pipe() { # a reader that has seen enough is no error message
	{ "$OPTLA" help 2>.err; echo $? >.status; } | :
	! [ -s .err ] || { cat .err; return 1; }
}
run "a closed pipe is no noise" closed_pipe

full_disk() { ends 1 sh -c '"$0" help >/dev/full' "$OPTLA" && grep -q 'could not write standard output' .err; }
if [ -c /dev/full ]; then run "standard output on a full disk: status 1" full_disk; else skip "full disk" "no /dev/full"; fi

finish
