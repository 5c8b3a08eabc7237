#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# The recorded 96-light ball: the whole way from photos to relit pictures.
. "$(dirname "$0")/lib.sh"

ball=$OPTLA_SOURCE/examples/rigs/diligent-ball.yaml
data=$OPTLA_SHARED_DATA
what="the ball: info, capture, relight, invert, dual"
if ! [ -d "$data/diligent-ball" ]; then
	skip "$what" "no real captures"
	finish
	exit
fi

# The rig file names the sensor of its camera: where the exact numbers are wanted, none is asked for.
info() { works "$OPTLA" info "$ball" --data "$data" --json i.json && holds "$(number i.json nlights) == 96 && $(number i.json nphotos) == 96"; }
run "the ball has 96 photos and lights" info

# An independent calculation on the green channel found the optimal errors 0.1522, 0.1358, 0.1215 and Arnoldi 1.031, 1.057, 1.073
# times those.
green() {
	works "$OPTLA" krylov arnoldi "$ball" --data "$data" --channel green -K 30 --sensor none -o green.h5 --json g.json -q || return 1
	python3 - <<-END
		import json
		e = json.load(open("g.json"))["relative_errors"]
		for k, best in ((10, 0.1522), (20, 0.1358), (30, 0.1215)):
		    assert e[k - 1] <= 1.08 * best, (k, e[k - 1])
	END
}
run "the error of T after 10, 20, 30 iterations is near the best possible" green

colour() {
	works "$OPTLA" krylov arnoldi "$ball" --data "$data" -K 20 --sensor none -o ball.h5 --json c.json -q || return 1
	works "$OPTLA" relight ball.h5 --light light:17 --reference "$ball" --data "$data" -o relit.exr --json r.json || return 1
	works "$OPTLA" relight ball.h5 --light light:17 -o relit.png && works "$OPTLA" info relit.png && says '3 channels' || return 1
	holds "$(number r.json psnr_db) > 25"
}
run "twenty colour photos relight the ball" colour

# Little light: 2 % of the 8-bit camera's range, so that noise soon outweighs what another photo tells.
noisy() {
	dim="--sensor video-8bit --full-scale 0.02 --no-high"
	works "$OPTLA" krylov arnoldi "$ball" --data "$data" -K 25 $dim --noise-stop -o a.h5 --json a.json -q || return 1
	works "$OPTLA" krylov arnoldi "$ball" --data "$data" -K 25 $dim -o b.h5 --json b.json -q || return 1
	grep -q '"stop": "noise"' a.json || { cat a.json; return 1; }
	holds "$(number a.json photos) < $(number b.json photos)" && holds "$(number a.json photos_saved) > 0" || return 1
	python3 - <<-END
		import json
		a, b = (json.load(open(f)) for f in ("a.json", "b.json"))
		best = min(b["relative_errors"])
		assert a["relative_error"] <= 1.05 * best, (a["relative_error"], best)
	END
}
run "in dim light the noise rule saves photos and stops near the best" noisy

hidden() {
	works "$OPTLA" relight "$ball" --data "$data" --light light:17=1,60=0.5 --sensor none -o wanted.exr || return 1
	works "$OPTLA" invert "$ball" --data "$data" --target wanted.exr -K 40 --sensor none -o light.csv --photo made.exr --json v.json || return 1
	holds "$(number v.json relative_error) < 0.1" && [ "$(wc -l <light.csv)" -eq 96 ]
}
run "a photo under two lights is made again" hidden

dual() { works "$OPTLA" dual "$ball" --data "$data" -o dual.csv && works "$OPTLA" dual green.h5 -o dual2.npy; }
run "dual photos" dual

run "photos that aren't there are named" fails 2 "001.png" "$OPTLA" info "$ball" --data /nonexistent

finish
