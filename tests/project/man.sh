#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Every verb has its manual page, made of its own tables: each option of its help is in it. Speaks TAP.
#
#   man.sh OPTLA FOLDER_OF_PAGES
set -u
optla=$1 pages=$2
case_=0 failed=0
tell() { # passed? name
	case_=$((case_ + 1))
	if [ "$1" = 0 ]; then
		echo "ok $case_ - $2"
	else
		echo "not ok $case_ - $2"
		failed=1
	fi
}
verbs=$("$optla" help | awk '/^Verbs:/ { on = 1; next } on && !NF { exit } on && /^  [a-z]/ { print $1 }')
[ -n "$verbs" ]; tell $? "the command lists its verbs"
for verb in $verbs; do
	page=$pages/optla-$verb.1
	wrong=0
	[ -s "$page" ] || { echo "# $page is missing: add '$verb' to docs/meson.build"; tell 1 "$verb"; continue; }
	grep -q '^\.TH ' "$page" || { echo "# no .TH line"; wrong=1; }
	"$optla" help "$verb" | sed -n 's/^  \(-[A-Za-z], \)*--\([a-z0-9-]*\).*/\2/p' >"$page.options"
	for option in $(cat "$page.options"); do
		grep -q -- "$(printf '%s' "--$option" | sed 's/-/\\\\-/g')" "$page" || { echo "# --$option is not in the page"; wrong=1; }
	done
	[ -s "$page.options" ] || { echo "# its help shows no option"; wrong=1; }
	rm -f "$page.options"
	tell $wrong "$verb"
	grep -q "optla\\\\-$verb" "$pages/optla.1" || { echo "# optla.1 doesn't refer to it"; tell 1 "optla.1 refers to $verb"; }
done
for page in "$pages"/optla-*.1; do
	verb=$(basename "$page" .1)
	echo "$verbs" | grep -qx "${verb#optla-}" || { echo "# $page has no verb"; tell 1 "${verb#optla-} exists"; }
done
echo "1..$case_"
exit $failed
