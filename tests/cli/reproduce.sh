#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Every figure and table of the thesis: all their numbers are within the ranges that they state.
. "$(dirname "$0")/lib.sh"

data=$OPTLA_SHARED_DATA
[ -d "$data" ] || data=

all() {
	works "$OPTLA" reproduce all -o page ${data:+--data "$data"} --json run.json || return 1
	[ -s page/index.html ] || { echo "no page"; return 1; }
	holds "$(number run.json not_ok) == 0"
}
run "reproduce all: every number is ok, status 0" all

# What the files say, read by something else than the command that wrote them; null: no bound on that side.
numbers() {
	python3 - <<-'END'
		import glob, json, math
		ids = json.load(open("run.json"))["ids"]
		files = glob.glob("page/*/numbers.json")
		assert len(ids) > 1 and sorted(f.split("/")[1] for f in files) == sorted(ids), (ids, files)
		for name in files:
		    with open(name) as f:
		        numbers = json.load(f)["numbers"]
		    assert numbers, name + " has no numbers"
		    for n in numbers:
		        low = -math.inf if n["low"] is None else n["low"]
		        high = math.inf if n["high"] is None else n["high"]
		        assert n["ok"] is True and low <= n["value"] <= high, (name, n)
	END
}
run "each numbers.json holds numbers, all of them in range" numbers

finish
