#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The demonstration and the page of figures.
. "$(dirname "$0")/lib.sh"

demo() {
	works "$OPTLA" demo -o out/demo --json demo.json || return 1
	[ -s out/demo/index.html ] || { echo "no page"; return 1; }
	# every picture of the page is there and is one
	grep -o 'src="[^"]*"' out/demo/index.html | cut -d'"' -f2 | sort -u >pictures
	[ "$(wc -l <pictures)" -ge 5 ] || { cat pictures; return 1; }
	while read -r picture; do works "$OPTLA" info "out/demo/$picture" || return 1; done <pictures
	holds "$(number demo.json not_ok) == 0"
}
run "the demonstration writes its page and all pictures" demo

reproduce() {
	works "$OPTLA" reproduce fig2.2 -o out/thesis --json r.json -q || return 1
	grep -q '"id": *"fig2.2"' out/thesis/fig2.2/numbers.json && [ -s out/thesis/index.html ] && grep -q '"ok": *true' out/thesis/fig2.2/numbers.json
}
run "a figure is reproduced with its numbers" reproduce

run "demo where nothing can be written" fails 1 "/proc/x" "$OPTLA" demo -o /proc/x

finish
