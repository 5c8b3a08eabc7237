/* SPDX-License-Identifier: BSD-3-Clause */
/* The analytic corner as plain data: diffuse square walls of one metre, a pinhole camera, and a pinhole projector or a screen.
   World frame: x right, y up, z towards the viewer; the walls are the coordinate planes, all light is at positive coordinates. */
#ifndef OPTLA_CORNER_DESC_H
#define OPTLA_CORNER_DESC_H

#include "base/base_impl.h"

/* floor: y = 0, left: x = 0, back: z = 0; each is the unit square of the other two axes. */
enum { OPTLA_WALL_FLOOR, OPTLA_WALL_LEFT, OPTLA_WALL_BACK, OPTLA_WALLS };

typedef struct {
	double position_m[3], look_at_m[3], up[3];
	double field_of_view_deg; /* across the image's width */
	size_t width, height;     /* pixels */
} optla_pinhole_desc;

/* A back-lit diffuse screen in the plane x = x_m, facing the corner: it emits the same radiance in all directions. Column 0 is at
   z_m[0], row 0 at the top, y_m[1]. */
typedef struct {
	double x_m, y_m[2], z_m[2];
	size_t width, height; /* patches that can be lit one by one */
} optla_screen_desc;

typedef struct {
	const char *where; /* put before messages ("rig.yaml: "); NULL: nothing */
	bool wall[OPTLA_WALLS];
	double albedo[OPTLA_WALLS][3]; /* RGB */
	size_t patches;                /* per side of a wall, for the indirect light */
	optla_pinhole_desc camera, projector;
	double pupil_m; /* diameter of the camera's pupil */
	bool coaxial;   /* the projector is where the camera is, with the same pixels */
	bool screen_given;
	optla_screen_desc screen;
} optla_corner_desc;

/* Three walls, 48 x 48 camera pixels, 32 x 32 projector pixels beside it. */
extern const optla_corner_desc optla_corner_defaults_;

/* Values in range and a camera, projector and screen that stand where the formulas hold; the message says what to move. */
optla_status optla_corner_check_(optla_ctx *ctx, const optla_corner_desc *desc);

#endif
