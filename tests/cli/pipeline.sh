#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Pipelines over a small analytic rig, each ending in 'optla compare' or in numbers that must fit together.
. "$(dirname "$0")/lib.sh"
. "$HERE/rigs.sh"

corner corner.yaml 16 8      # 256 pixels, 64 lights, three channels
screen screen.yaml 16 8      # the same walls lit by a diffusing screen: low rank
coaxial coaxial.yaml 8       # symmetric

# ---- capture and relight ----

# With as many iterations as lights the captured T is T, so relit is photographed. Float models: 64 sums of rounding at 6e-8.
complete() {
	works "$OPTLA" krylov arnoldi corner.yaml -K 64 -o full.h5 --json full.json -q || return 1
	holds "$(number full.json relative_error) < 1e-6" || return 1
	works "$OPTLA" relight corner.yaml --light light:19=1,40=0.5 -o truth.exr || return 1
	works "$OPTLA" relight full.h5 --light light:19=1,40=0.5 -o relit.exr || return 1
	works "$OPTLA" compare relit.exr truth.exr --max-rel-error 1e-5
}
run "64 iterations capture a T of 64 lights: relit is photographed" complete

# An error of the first K that falls with K, and is near the best (svd with the same K and more photos can't be far better).
falls() {
	for k in 4 8 16; do
		works "$OPTLA" krylov arnoldi screen.yaml -K $k -o m$k.h5 --json m$k.json -q || return 1
	done
	holds "$(number m8.json relative_error) < $(number m4.json relative_error)" &&
		holds "$(number m16.json relative_error) < $(number m8.json relative_error)" || return 1
	works "$OPTLA" relight m16.h5 --light light:20 --reference screen.yaml -o r.exr --json r.json || return 1
	holds "$(number r.json relative_error) < 0.2"
}
run "the error falls with K; relight tells its distance to a reference" falls

formats() { # every format holds the same picture
	works "$OPTLA" relight full.h5 --light all -o a.exr || return 1
	for f in pfm tif npy; do
		works "$OPTLA" relight full.h5 --light all -o a.$f && works "$OPTLA" compare a.$f a.exr --max-rel-error 0 || return 1
	done
	works "$OPTLA" relight full.h5 --light all --brightness 0.5 -o a.png && works "$OPTLA" info a.png && says display &&
		says "relight full.h5"
}
run "exr, pfm, tif and npy hold the same values, png a picture" formats

svd() {
	works "$OPTLA" krylov svd screen.yaml -K 16 --rank 6 -o svd.h5 --json svd.json -q || return 1
	holds "$(number svd.json rank) == 6" &&
		holds "$(number svd.json relative_error) < $(number m4.json relative_error)"
}
run "svd keeps the rank asked for" svd

symmetric() { # a coaxial rig needs half the photos
	works "$OPTLA" krylov arnoldi coaxial.yaml -K 8 --split signed -o c.h5 --json c.json -q || return 1
	works "$OPTLA" krylov arnoldi coaxial.yaml -K 8 --split signed --no-symmetric -o n.h5 --json n.json -q || return 1
	grep -q '"symmetric": true' c.json || return 1
	holds "$(number c.json photos) <= $(number n.json photos) / 2 + 2"
}
run "a coaxial rig is found symmetric and takes half the photos" symmetric

split() { # 4K photos by sign, 2K and a constant by offset, the same subspace
	works "$OPTLA" krylov arnoldi screen.yaml -K 10 --split signed --no-high -o s.h5 --json s.json -q || return 1
	works "$OPTLA" krylov arnoldi screen.yaml -K 10 --split offset --no-high -o f.h5 --json f.json -q || return 1
	holds "$(number f.json photos) <= $(number s.json photos) / 2 + 4" || return 1
	works "$OPTLA" compare s.h5 f.h5 --max-rel-error 1e-4
}
run "offset splitting gives the same model from about half the photos" split

budget() {
	works "$OPTLA" krylov arnoldi screen.yaml -K 30 --budget-photos 24 -o b.h5 --json b.json -q || return 1
	holds "$(number b.json photos) <= 24" && grep -q '"stop": "photos"' b.json
}
run "a photo budget is kept" budget

all_lights() { # the corner has more pixels than lights, and each light shows: rank 64
	works "$OPTLA" krylov arnoldi corner.yaml -K 64 --no-high -o k.h5 --json k.json -q || return 1
	holds "$(number k.json iterations) == 64 && $(number k.json rank) == 64 && $(number k.json relative_error) < 1e-6"
}
run "K as large as the number of lights works" all_lights

# K beyond the rank, here the 16 pixels, is no error: the run says that T has no more to give. What it takes for another direction or two
# is rounding of the photos (6e-8), never half of K.
rank_reached() {
	corner low.yaml 4 8
	works "$OPTLA" krylov arnoldi low.yaml -K 64 --no-high -o low.h5 --json low.json -q || return 1
	grep -q '"stop": "breakdown"' low.json || { cat low.json; return 1; }
	holds "$(number low.json rank) >= 16 && $(number low.json iterations) < 32 && $(number low.json relative_error) < 1e-6"
}
run "a run ends at the rank of T" rank_reached

power() {
	works "$OPTLA" krylov power coaxial.yaml -K 500 --tolerance 1e-4 -o v.npy --json v.json -q || return 1
	grep -q '"stop": "tolerance"' v.json && holds "$(number v.json residual) <= 1e-4" && holds "$(number v.json value) > 0" && works "$OPTLA" info v.npy
}
run "power iteration finds an eigenvector" power

# ---- inversion ----

invert() { # the photo of a known light is made again, by a light without negative parts
	works "$OPTLA" relight screen.yaml --light light:9=1,45=0.7 -o wanted.exr || return 1
	works "$OPTLA" invert screen.yaml --target wanted.exr -K 30 -o p.exr --photo made.exr --json i.json || return 1
	works "$OPTLA" compare made.exr wanted.exr --max-rel-error 0.01 || return 1
	works "$OPTLA" invert screen.yaml --target wanted.exr -K 30 --nonnegative nnls -o q.csv --photo made2.exr || return 1
	awk -F, '{ for (i = 1; i <= NF; i++) if ($i < 0) bad = 1 } END { exit bad || NR != 64 || NF != 3 }' q.csv || { cat q.csv; return 1; }
	works "$OPTLA" compare made2.exr wanted.exr --max-rel-error 0.05
}
run "invert: the illumination found makes the wanted photo, in colour" invert

gmres() { # a csv goes round: gmres -> light -> relight
	works "$OPTLA" krylov gmres screen.yaml --target wanted.exr -K 30 --nonnegative nnls -o g.csv --json g.json || return 1
	holds "$(number g.json relative_error) < 0.05" || return 1
	works "$OPTLA" relight screen.yaml --light g.csv -o made3.exr
}
run "gmres: an illumination as csv can be shown again" gmres

# ---- dual ----

dual() { # T'1 photographed is T'1 computed
	works "$OPTLA" dual corner.yaml -o d1.exr || return 1
	works "$OPTLA" krylov arnoldi corner.yaml -K 64 --no-high -o grey.h5 -q || return 1
	works "$OPTLA" dual grey.h5 -o d2.exr && works "$OPTLA" compare d2.exr d1.exr --max-rel-error 1e-5
}
run "dual: from the captured model as photographed" dual

# ---- the same result however it is made ----

threads() {
	for n in 1 2 7; do
		works "$OPTLA" krylov arnoldi screen.yaml -K 12 --sensor ccd-12bit --threads $n -o t$n.h5 --state st$n.h5 -q || return 1
		works "$OPTLA" relight t$n.h5 --light all --threads $n -o t$n.pfm || return 1
	done
	cmp t1.pfm t2.pfm && cmp t1.pfm t7.pfm || return 1
	works "$OPTLA" compare st2.h5 st1.h5 --max-rel-error 0 && works "$OPTLA" compare st7.h5 st1.h5 --max-rel-error 0
}
run "1, 2 and 7 threads give the same bytes, noise included" threads

seeds() {
	works "$OPTLA" krylov arnoldi screen.yaml -K 6 --sensor video-8bit --seed 5 -o e1.h5 -q &&
		works "$OPTLA" krylov arnoldi screen.yaml -K 6 --sensor video-8bit --seed 5 -o e2.h5 -q &&
		works "$OPTLA" krylov arnoldi screen.yaml -K 6 --sensor video-8bit --seed 6 -o e3.h5 -q || return 1
	works "$OPTLA" compare e1.h5 e2.h5 --max-rel-error 0 && ends 1 "$OPTLA" compare e1.h5 e3.h5 --max-rel-error 0
}
run "the seed decides the noise" seeds

sensor() { # the rig file's sensor is used unless another one, or none, is asked for
	{ cat screen.yaml; echo 'sensor: video-8bit'; } >own.yaml
	works "$OPTLA" krylov arnoldi own.yaml -K 4 -o o1.h5 --json o1.json -q && works "$OPTLA" krylov arnoldi own.yaml -K 4 --sensor none -o o2.h5 -q &&
		works "$OPTLA" krylov arnoldi screen.yaml -K 4 -o o3.h5 -q || return 1
	grep -q '"sensor": "video-8bit"' o1.json && works "$OPTLA" compare o2.h5 o3.h5 --max-rel-error 0 && ends 1 "$OPTLA" compare o1.h5 o3.h5 --max-rel-error 0
}
run "a rig file may name its sensor" sensor

resume() { # 12 iterations at once, or 5 and then up to 12
	works "$OPTLA" krylov arnoldi screen.yaml -K 12 --split signed --state whole.h5 -o whole_m.h5 -q || return 1
	works "$OPTLA" krylov arnoldi screen.yaml -K 5 --split signed --state part.h5 -q || return 1
	works "$OPTLA" krylov arnoldi screen.yaml -K 12 --split signed --resume part.h5 --state part.h5 -o part_m.h5 --json part.json -q || return 1
	works "$OPTLA" compare part.h5 whole.h5 --max-rel-error 0 && works "$OPTLA" compare part_m.h5 whole_m.h5 --max-rel-error 0 || return 1
	works "$OPTLA" info part.h5 && says krylov && says illuminations
}
run "a resumed run gives the numbers of an uninterrupted one" resume

# Noise of a photo is decided by its number, and a resumed run counts on. Two states of the same five illuminations, one made of more photos
# than the other: without a sensor both go on to the same model, with one the photos to come have other numbers and so other noise.
resume_noisy() {
	for way in signed offset; do
		works "$OPTLA" krylov arnoldi screen.yaml -K 5 --no-high --split $way --sensor none --state $way.h5 --json $way.json -q || return 1
		works "$OPTLA" krylov arnoldi screen.yaml -K 8 --no-high --split signed --sensor none --resume $way.h5 -o $way-none.h5 -q || return 1
		for time in 1 2; do
			works "$OPTLA" krylov arnoldi screen.yaml -K 8 --no-high --split signed --sensor ccd-12bit --full-scale 0.05 --resume $way.h5 \
				-o $way-$time.h5 --json $way-$time.json -q || return 1
		done
	done
	holds "$(number signed.json photos) == 20 && $(number signed-1.json photos) == 32" || return 1
	holds "$(number offset-1.json photos) == $(number offset.json photos) + 12 && $(number offset.json photos) < 20" || return 1
	works "$OPTLA" compare signed-1.h5 signed-2.h5 --max-rel-error 0 &&
		works "$OPTLA" compare signed-none.h5 offset-none.h5 --max-rel-error 1e-5 &&
		ends 1 "$OPTLA" compare signed-1.h5 offset-1.h5 --max-rel-error 0.05
}
run "a resumed noisy run counts its photos on and repeats no noise" resume_noisy

# ---- what it says ----

json() {
	works "$OPTLA" krylov arnoldi screen.yaml -K 6 --sensor dslr-14bit -o j.h5 --json - || return 1
	for key in photos exposure_s iterations relative_error residual seconds_in_operator seconds_outside; do
		[ -n "$(number .out $key)" ] || { echo "--json lacks $key"; cat .out; return 1; }
	done
	if command -v python3 >/dev/null; then python3 -c 'import json, sys; json.load(open(".out"))'; fi
}
run "--json - prints the numbers and nothing else" json

made() {
	works "$OPTLA" info m8.h5 && says 'optla krylov arnoldi screen.yaml -K 8' && says 'seed: 1' && says '2023-11-14T22:13:20Z' && says 'screen.yaml'
}
run "an output says how it was made" made

quiet() {
	works "$OPTLA" relight m8.h5 --light all -o y.exr -q && ! [ -s .out ] && ! [ -s .err ]
}
run "-q prints nothing" quiet

names() { # blanks, quotes and a dash in names
	mkdir "a b" && cp screen.yaml "a b/it's.yaml" || return 1
	works "$OPTLA" krylov arnoldi "a b/it's.yaml" -K 2 -q -o "a b/-m.h5" || return 1
	works "$OPTLA" info "a b/-m.h5" && says "'a b/it'\\''s.yaml'"
}
run "blanks and quotes in names survive, also in the record" names

finish
