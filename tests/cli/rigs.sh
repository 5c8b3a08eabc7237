# SPDX-License-Identifier: BSD-3-Clause
# Small rigs for the tests of the command.

# corner FILE CAMERA PROJECTOR: three walls lit by a projector
corner() {
	cat >"$1" <<-END
		kind: analytic
		name: corner
		patches: 4
		camera: {size: [$2, $2]}
		projector: {size: [$3, $3]}
	END
}

# screen FILE CAMERA SCREEN: the same lit by a diffusing screen
screen() {
	cat >"$1" <<-END
		kind: analytic
		name: screen
		patches: 4
		camera: {size: [$2, $2]}
		screen: {x_m: 1.5, size: [$3, $3]}
	END
}

# coaxial FILE SIZE: camera and projector in one place
coaxial() {
	cat >"$1" <<-END
		kind: analytic
		name: coaxial
		patches: 4
		coaxial: true
		camera: {size: [$2, $2]}
	END
}

# recorded DIR: DIR/rig.yaml with nine photos of a 12 x 12 camera, DIR/photo0.exr .. photo8.exr, one light each
recorded() {
	mkdir -p "$1" || return 1
	screen "$1/made.yaml" 12 3
	for k in 0 1 2 3 4 5 6 7 8; do
		"$OPTLA" relight "$1/made.yaml" --light light:$k -o "$1/photo$k.exr" -q || return 1
	done
	rm "$1/made.yaml"
	cat >"$1/rig.yaml" <<-END
		kind: recorded
		name: nine photos
		lights: {count: 9, grid: [3, 3]}
		photos: {pattern: photo%d.exr, first: 0, count: 9}
	END
}

# nan_pfm FILE: a 2 x 2 picture with a NaN
nan_pfm() { printf 'Pf\n2 2\n-1.0\n\000\000\200\077\000\000\300\177\000\000\200\077\000\000\200\077' >"$1"; }
# grey_pfm FILE: a 2 x 2 picture of ones
grey_pfm() { printf 'Pf\n2 2\n-1.0\n\000\000\200\077\000\000\200\077\000\000\200\077\000\000\200\077' >"$1"; }
