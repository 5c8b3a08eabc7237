#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Wrong input: exit status 2 (1 where the machine or the rig can't), a message that names file, line or field, no output.
. "$(dirname "$0")/lib.sh"
. "$HERE/rigs.sh"

corner corner.yaml 12 6
recorded rec || exit 1
"$OPTLA" krylov arnoldi corner.yaml -K 6 -q -o m.h5 --state s.h5 || exit 1
for f in exr tif pfm npy png; do "$OPTLA" relight m.h5 --light all -q -o p.$f || exit 1; done

works_as_it_is() { works "$OPTLA" info rec/rig.yaml && says 'recorded rig' && works "$OPTLA" krylov arnoldi rec/rig.yaml -K 9 -q -o r.h5; }
run "the rig that is spoilt below works" works_as_it_is

# spoilt "text that the message must hold" SED-EXPRESSION [STATUS]: the recorded rig with its manifest edited
spoilt() {
	text=$1 edit=$2
	sed "$edit" rec/rig.yaml >rec/bad.yaml
	cmp -s rec/rig.yaml rec/bad.yaml && { echo "the edit changed nothing"; return 1; }
	fails "${3:-2}" "$text" "$OPTLA" krylov arnoldi rec/bad.yaml -K 2 -q -o bad.h5 --json bad.json || return 1
	missing bad.h5 bad.json
}
listed() { # as spoilt, with the photos as a list
	text=$1
	shift
	{ sed '/^photos/d' rec/rig.yaml; echo 'photos:'; for line; do echo "  - $line"; done; } >rec/bad.yaml
	fails 2 "$text" "$OPTLA" info rec/bad.yaml
}

run "missing photo: named" spoilt "photo9.exr" 's/first: 0/first: 1/'
run "wrong key: line, and the nearest that is allowed" spoilt "bad.yaml:4: " 's/^photos:/fotos:/'
run "wrong key in a mapping" spoilt "bad.yaml:3: " 's/grid/grit/'
run "a grid that doesn't hold the lights" spoilt "4 x 3" 's/\[3, 3\]/[4, 3]/'
run "a value of the wrong kind" spoilt "bad.yaml:3: " 's/count: 9, grid/count: nine, grid/'
run "unknown kind of rig" spoilt "allowed are recorded, analytic" 's/kind: recorded/kind: recalled/'
run "YAML that is none" spoilt "bad.yaml:3" 's/{count: 9/{count: 9]/'
run "a light listed twice: both photos are named" listed "light 3 is listed twice" '{file: photo0.exr, light: 3}' '{file: photo1.exr, light: 3}'
run "a light that isn't there" listed "'light' is 9" '{file: photo0.exr, light: 9}'
run "a photo without its light" listed "needs one of the keys" '{file: photo0.exr}'
run "an illumination of the wrong length" listed "there are 9 lights" '{file: photo0.exr, illumination: [1, 2]}'

sizes() { # one photo of another size
	"$OPTLA" relight m.h5 --light all -q -o rec/big.exr || return 1
	cp rec/photo4.exr keep.exr
	corner other.yaml 10 6
	"$OPTLA" relight other.yaml --light all -q -o rec/photo4.exr || return 1
	fails 2 "photo4.exr" "$OPTLA" info rec/rig.yaml
	result=$?
	cp keep.exr rec/photo4.exr
	return $result
}
run "photos whose sizes differ" sizes

saturated() { # counts at the saturation level are told, or refused if the manifest says so
	sed '$a saturation_dn: 1.0e-8' rec/rig.yaml >rec/sat.yaml
	works "$OPTLA" info rec/sat.yaml && says 'saturated samples' && grep -q 'satur' .err || return 1
	sed '$a saturated: error' rec/sat.yaml >rec/sat2.yaml
	fails 2 "satur" "$OPTLA" info rec/sat2.yaml
}
run "saturated photos: warned of, or an error when the manifest says so" saturated

nan_photo() {
	cp rec/photo4.exr keep.exr
	nan_pfm rec/nan.pfm
	grey_pfm rec/grey.pfm
	cat >rec/nan.yaml <<-END
		kind: recorded
		photos: [{file: grey.pfm, light: 0}, {file: nan.pfm, light: 1}]
	END
	fails 2 "nan.pfm" "$OPTLA" krylov arnoldi rec/nan.yaml -K 1 -o bad.h5 && missing bad.h5
}
run "a photo with NaN" nan_photo

no_transpose() {
	sed '$a transpose: false' rec/rig.yaml >rec/one.yaml
	works "$OPTLA" info rec/one.yaml && says "can't be asked for" || return 1
	fails 1 "Tᵀ r" "$OPTLA" krylov arnoldi rec/one.yaml -K 2 -q -o bad.h5 && missing bad.h5 || return 1
	fails 1 "dual" "$OPTLA" dual rec/one.yaml -o bad.exr && missing bad.exr
}
run "a rig without transpose asked for one: status 1" no_transpose

run "K larger than T" fails 2 "37" "$OPTLA" krylov arnoldi corner.yaml -K 37 -o bad.h5
run "K larger than T leaves nothing" missing bad.h5

# ---- files ----

truncated() { # each cut of a file is refused by name, and never crashes
	size=$(wc -c <"$1")
	for part in 1 2 3 4 5 6 7 8 9; do
		head -c $((size * part / 10)) "$1" >"cut.$2"
		fails 2 "cut.$2" "$OPTLA" info "cut.$2" || return 1
	done
	: >"cut.$2"
	fails 2 "cut.$2" "$OPTLA" info "cut.$2"
}
for f in png tif exr pfm npy; do run "truncated $f" truncated p.$f $f; done
run "truncated HDF5" truncated m.h5 h5

wrong_model() { # an HDF5 file of another kind
	fails 2 "s.h5" "$OPTLA" relight s.h5 --light all -o bad.exr && missing bad.exr
}
run "a run's state given as a model" wrong_model
run "a model given as a run's state" fails 2 "m.h5" "$OPTLA" krylov arnoldi corner.yaml -K 8 --resume m.h5 -o bad.h5
run "a state of another rig" fails 2 "s.h5" "$OPTLA" krylov arnoldi rec/rig.yaml -K 8 --resume s.h5 -o bad.h5
run "a state of another method" fails 2 "arnoldi" "$OPTLA" krylov svd corner.yaml -K 8 --resume s.h5 -o bad.h5
run "a picture given as a rig" fails 2 "needs a model" "$OPTLA" relight p.exr --light all -o bad.exr
run "a picture given to krylov" fails 2 "p.exr" "$OPTLA" krylov arnoldi p.exr -o bad.h5
run "a file that is nothing" fails 2 "neither an image" "$OPTLA" info /bin/sh
run "a file that isn't there" fails 2 "nosuch.exr" "$OPTLA" info nosuch.exr
run "a folder" fails 2 "is a directory" "$OPTLA" info rec

nan_target() { nan_pfm nan2.pfm && fails 2 "nan2.pfm" "$OPTLA" info rec/nan.yaml; works "$OPTLA" info nan2.pfm && says 'not finite 1'; }
run "info counts what isn't finite" nan_target
target_nan() {
	cat >rec/two.yaml <<-END
		kind: recorded
		photos: [{file: grey.pfm, light: 0}]
	END
	ends 2 "$OPTLA" krylov gmres rec/two.yaml --target nan2.pfm -K 1 -o bad.csv && missing bad.csv
}
run "a target with NaN" target_nan
run "a target of another size" fails 2 "2 x 2" "$OPTLA" krylov gmres corner.yaml --target nan2.pfm -K 2 -o bad.csv
run "a target for looking at is linearised and said so" works "$OPTLA" krylov gmres corner.yaml --target p.png -K 2 -o ok.csv
run "lights that don't exist" fails 2 "36" "$OPTLA" relight m.h5 --light light:36 -o bad.exr
run "a light that is no description" fails 2 "lamp" "$OPTLA" relight m.h5 --light lamp -o bad.exr
run "directions of a rig that has none: status 1" fails 1 "direction of each light" "$OPTLA" relight rec/rig.yaml --light point:10,10 -o bad.exr
bad_csv() { printf '1\n2\nthree\n' >l.csv && fails 2 "l.csv" "$OPTLA" relight m.h5 --light l.csv -o bad.exr && missing bad.exr; }
run "a csv with a word in it" bad_csv

off_grid() { # lights without a grid can't be a picture
	sed 's/, grid: \[3, 3\]//' rec/rig.yaml >rec/off.yaml
	fails 2 "aren't on a grid" "$OPTLA" dual rec/off.yaml -o bad.exr && missing bad.exr && works "$OPTLA" dual rec/off.yaml -o off.csv &&
		[ "$(wc -l <off.csv)" -eq 9 ]
}
run "lights that aren't on a grid are written as numbers" off_grid

huge() { # a matrix bigger than memory, by its header and really there (a sparse file)
	printf '\223NUMPY\001\000\166\000{"descr": "<f8", "fortran_order": False, "shape": (4194304, 262144), }%s\n' "$(printf '%50s' '')" | tr '"' "'" >huge.npy
	fails 2 "its shape needs 8796093022208 bytes of data" "$OPTLA" info huge.npy || return 1
	truncate -s 8T huge.npy && truncate -s +128 huge.npy && fails 1 "are over the memory limit" "$OPTLA" info huge.npy
}
run "a matrix bigger than memory: status 2 if it isn't there, 1 if it is" huge
huge_rig() {
	corner huge.yaml 4000 1000
	fails 1 "GiB" "$OPTLA" krylov arnoldi huge.yaml -K 2 -o bad.h5 && missing bad.h5
}
run "a rig whose T is bigger than memory: status 1" huge_rig

# ---- compare ----

"$OPTLA" relight other.yaml --light all -q -o ten.exr || exit 1
run "images of unlike size can't be compared" fails 2 "only images of one size" "$OPTLA" compare p.exr ten.exr
run "images of unlike kind can't be compared" fails 2 "only images of one kind" "$OPTLA" compare p.png p.exr
run "an image and a model can't be compared" fails 2 "compare takes" "$OPTLA" compare p.exr m.h5
run "a model and a state can't be compared" fails 2 "holds" "$OPTLA" compare m.h5 s.h5
over() {
	"$OPTLA" relight m.h5 --light light:3 -q -o q.exr || return 1
	fails 1 "is over the limit" "$OPTLA" compare q.exr p.exr --max-rel-error 0.01 --json c.json || return 1
	grep -q '"within": false' c.json && works "$OPTLA" compare q.exr p.exr
}
run "over the limit: status 1, with the numbers written" over
unlike_nan() { grey_pfm g.pfm && ends 1 "$OPTLA" compare nan2.pfm g.pfm --max-rel-error 1000 && works "$OPTLA" compare nan2.pfm nan2.pfm --max-rel-error 0; }
run "a NaN on one side is over any limit" unlike_nan

finish
