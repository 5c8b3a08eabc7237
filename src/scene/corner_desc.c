/* SPDX-License-Identifier: BSD-3-Clause */
#include "scene/corner_desc.h"

#include <math.h>
#include <string.h>

/* Nearest distance to a wall or to the image plane at which the sums of closed forms keep their digits. */
#define CLOSEST_M 0.01

const optla_corner_desc optla_corner_defaults_ = {
    .wall = {true, true, true},
    .albedo = {{0.75, 0.75, 0.75}, {0.70, 0.12, 0.08}, {0.80, 0.80, 0.80}},
    .patches = 16,
    .camera = {{1.10, 1.00, 2.10}, {0.40, 0.39, 0.25}, {0, 1, 0}, 33, 48, 48},
    .projector = {{1.90, 1.35, 1.50}, {0.38, 0.40, 0.36}, {0, 1, 0}, 34, 32, 32},
    .pupil_m = 0.025,
};

static const char *const wall_names[OPTLA_WALLS] = {"floor", "left", "back"};
static const int wall_axis[OPTLA_WALLS] = {1, 0, 2};

/* Depth along the optical axis of a world point. */
static double depth(const optla_pinhole_desc *p, const double point[3])
{
	double along = 0, length = 0;
	for (int k = 0; k < 3; k++) {
		const double forward = p->look_at_m[k] - p->position_m[k];
		along += forward * (point[k] - p->position_m[k]);
		length += forward * forward;
	}
	return along / sqrt(length);
}

static optla_status check_pose(optla_ctx *ctx, const char *where, const char *name, const optla_pinhole_desc *p)
{
	double f[3], up = 0, along = 0, length = 0;
	for (int k = 0; k < 3; k++) {
		OPTLA_CHECK(ctx, isfinite(p->position_m[k]) && isfinite(p->look_at_m[k]) && isfinite(p->up[k]), OPTLA_ERR_INPUT,
		            "%s%s: position, look_at and up must be finite", where, name);
		f[k] = p->look_at_m[k] - p->position_m[k];
		length += f[k] * f[k];
		up += p->up[k] * p->up[k];
		along += f[k] * p->up[k];
	}
	OPTLA_CHECK(ctx, length > 1e-12, OPTLA_ERR_INPUT, "%s%s: it looks at its own position (%g, %g, %g)", where, name,
	            p->position_m[0], p->position_m[1], p->position_m[2]);
	OPTLA_CHECK(ctx, length * up - along * along > 1e-9 * length * up, OPTLA_ERR_INPUT,
	            "%s%s: up (%g, %g, %g) is zero or along the line of sight", where, name, p->up[0], p->up[1], p->up[2]);
	OPTLA_CHECK(ctx, p->field_of_view_deg >= 0.1 && p->field_of_view_deg <= 170, OPTLA_ERR_INPUT,
	            "%s%s: field_of_view is %g degrees: allowed is 0.1 to 170", where, name, p->field_of_view_deg);
	OPTLA_CHECK(ctx, p->width >= 1 && p->width <= 4096 && p->height >= 1 && p->height <= 4096, OPTLA_ERR_INPUT,
	            "%s%s: size is %zu x %zu: allowed is 1 to 4096 each", where, name, p->width, p->height);
	return OPTLA_OK;
}

/* In front of every wall, and every corner of every wall in front of it. */
static optla_status check_pinhole(optla_ctx *ctx, const char *name, const optla_corner_desc *d, const optla_pinhole_desc *p)
{
	const char *where = d->where ? d->where : "";
	OPTLA_TRY(check_pose(ctx, where, name, p));
	for (int w = 0; w < OPTLA_WALLS; w++) {
		if (!d->wall[w]) continue;
		const int a = wall_axis[w];
		OPTLA_CHECK(ctx, p->position_m[a] >= CLOSEST_M, OPTLA_ERR_INPUT,
		            "%s%s: %c = %g m is not in front of the wall '%s': at least %g m are needed", where, name, "xyz"[a],
		            p -> position_m[a], wall_names[w], CLOSEST_M);
		for (int corner = 0; corner < 4; corner++) {
			double point[3] = {0, 0, 0};
			point[(a + 1) % 3] = corner & 1;
			point[(a + 2) % 3] = corner >> 1;
			OPTLA_CHECK(ctx, depth(p, point) >= CLOSEST_M, OPTLA_ERR_INPUT,
			            "%s%s: the corner (%g, %g, %g) of the wall '%s' is behind it: move it back or turn it", where, name,
			            point[0], point[1], point[2], wall_names[w]);
		}
	}
	return OPTLA_OK;
}

static optla_status check_walls(optla_ctx *ctx, const optla_corner_desc *d)
{
	const char *where = d->where ? d->where : "";
	int walls = 0;
	for (int w = 0; w < OPTLA_WALLS; w++) {
		if (!d->wall[w]) continue;
		walls++;
		for (int c = 0; c < 3; c++)
			OPTLA_CHECK(ctx, d->albedo[w][c] >= 0 && d->albedo[w][c] <= 1, OPTLA_ERR_INPUT,
			            "%swalls: the albedo of '%s' is %g: allowed is 0 to 1", where, wall_names[w], d->albedo[w][c]);
	}
	OPTLA_CHECK(ctx, walls >= 2, OPTLA_ERR_INPUT, "%swalls: a corner has two or three of floor, left, back, not %d", where,
	            walls);
	OPTLA_CHECK(ctx, d->patches >= 1 && d->patches <= 64, OPTLA_ERR_INPUT, "%spatches is %zu: allowed is 1 to 64", where,
	            d->patches);
	OPTLA_CHECK(ctx, d->pupil_m > 0 && d->pupil_m <= 0.2, OPTLA_ERR_INPUT, "%spupil_m is %g m: allowed is above 0 to 0.2", where,
	            d->pupil_m);
	return OPTLA_OK;
}

static optla_status check_screen(optla_ctx *ctx, const optla_corner_desc *d)
{
	const optla_screen_desc *s = &d->screen;
	const char *where = d->where ? d->where : "";
	OPTLA_CHECK(ctx, !d->coaxial, OPTLA_ERR_INPUT, "%sscreen: a coaxial corner has no screen", where);
	OPTLA_CHECK(ctx, s->x_m >= 1 && s->x_m <= 100, OPTLA_ERR_INPUT,
	            "%sscreen: x is %g m: allowed is 1 (the edge of the walls) to 100", where, s->x_m);
	OPTLA_CHECK(ctx, s->y_m[0] >= 0 && s->y_m[0] < s->y_m[1] && s->y_m[1] <= 100, OPTLA_ERR_INPUT,
	            "%sscreen: y is [%g, %g] m: allowed is 0 <= lower < upper", where, s->y_m[0], s->y_m[1]);
	OPTLA_CHECK(ctx, s->z_m[0] >= 0 && s->z_m[0] < s->z_m[1] && s->z_m[1] <= 100, OPTLA_ERR_INPUT,
	            "%sscreen: z is [%g, %g] m: allowed is 0 <= lower < upper", where, s->z_m[0], s->z_m[1]);
	OPTLA_CHECK(ctx, s->width >= 1 && s->width <= 1024 && s->height >= 1 && s->height <= 1024, OPTLA_ERR_INPUT,
	            "%sscreen: size is %zu x %zu: allowed is 1 to 1024 each", where, s->width, s->height);
	OPTLA_CHECK(ctx, d->camera.position_m[0] < s->x_m, OPTLA_ERR_INPUT,
	            "%scamera: x = %g m is behind the screen at x = %g m, which would hide the corner from it", where,
	            d->camera.position_m[0], s->x_m);
	return OPTLA_OK;
}

optla_status optla_corner_check_(optla_ctx *ctx, const optla_corner_desc *d)
{
	OPTLA_TRY(check_walls(ctx, d));
	OPTLA_TRY(check_pinhole(ctx, "camera", d, &d->camera));
	if (d->screen_given) return check_screen(ctx, d);
	return d->coaxial ? OPTLA_OK : check_pinhole(ctx, "projector", d, &d->projector);
}
