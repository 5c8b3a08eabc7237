/* SPDX-License-Identifier: BSD-3-Clause */
/* Lights at known directions: environment images and points of light in between.
 *
 * Angles in the camera frame (x right, y down, z forward), seen from the scene: azimuth 0 is the way the camera looks, 90 degrees
 * is right, 180 is towards the camera; elevation is up. A latitude-longitude image has azimuth -180..180 degrees from left to
 * right and elevation 90..-90 degrees from top to bottom, so its centre lies behind the scene as the camera sees it:
 *
 *     toward(azimuth, elevation) = (sin az cos el, -sin el, cos az cos el)
 */
#include "capture/light_spec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static void toward_of(double azimuth, double elevation, double t[3])
{
	t[0] = sin(azimuth) * cos(elevation);
	t[1] = -sin(elevation);
	t[2] = cos(azimuth) * cos(elevation);
}

static double cosine(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Angle between unit vectors; exact for small ones, where acos() isn't. */
static double angle(const double a[3], const double b[3])
{
	const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
	return 2 * asin(fmin(1, 0.5 * sqrt(cosine(d, d))));
}

static optla_status need_directions(optla_ctx *ctx, const optla_light_layout *lights, const char *form)
{
	OPTLA_CHECK(ctx, lights->direction, OPTLA_ERR_UNSUPPORTED,
	            "'%s' needs the direction of each light, and the rig gives none: name lights by number (light:7) instead", form);
	return OPTLA_OK;
}

static int ascending(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

optla_status optla_light_reach_(optla_ctx *ctx, const optla_light_layout *lights, double *reach_rad)
{
	const size_t n = lights->nlights;
	*reach_rad = pi;
	if (n < 2) return OPTLA_OK;
	double *nearest = optla_array_(ctx, n, sizeof *nearest);
	if (!nearest) return OPTLA_ERR_NOMEM;
#pragma omp parallel for num_threads(optla_ctx_threads(ctx)) schedule(static)
	for (size_t i = 0; i < n; i++) {
		nearest[i] = pi;
		for (size_t j = 0; j < n; j++)
			if (j != i) nearest[i] = fmin(nearest[i], angle(lights->direction + 3 * i, lights->direction + 3 * j));
	}
	qsort(nearest, n, sizeof *nearest, ascending);
	*reach_rad = fmin(pi, 2 * nearest[n / 2]);
	optla_free(ctx, nearest);
	return OPTLA_OK;
}

/* ---- a point of light ---- */

enum { NEIGHBOURS = 3 };

typedef struct {
	size_t light[NEIGHBOURS], count;
	double angle[NEIGHBOURS];
} neighbours;

static void neighbours_insert(neighbours *near, size_t light, double a)
{
	size_t at = near->count;
	while (at > 0 && near->angle[at - 1] > a) at--;
	if (at == NEIGHBOURS) return;
	if (near->count < NEIGHBOURS) near->count++;
	for (size_t k = near->count - 1; k > at; k--) {
		near->light[k] = near->light[k - 1];
		near->angle[k] = near->angle[k - 1];
	}
	near->light[at] = light;
	near->angle[at] = a;
}

optla_status optla_light_toward_(optla_ctx *ctx, const optla_light_layout *lights, const double toward[3], size_t exclude,
                                 double *p)
{
	double reach;
	OPTLA_TRY(need_directions(ctx, lights, "point:"));
	OPTLA_TRY(optla_light_reach_(ctx, lights, &reach));
	neighbours near = {.count = 0};
	for (size_t n = 0; n < lights->nlights; n++)
		if (n != exclude) neighbours_insert(&near, n, angle(lights->direction + 3 * n, toward));
	OPTLA_CHECK(
	    ctx, near.count && near.angle[0] <= reach, OPTLA_ERR_ARG,
	    "no light within %.3g degrees (twice the usual distance of neighbours) of that direction; the nearest, light %zu, is "
	    "%.3g degrees away",
	    reach * 180 / pi, near.count ? near.light[0] : 0, near.count ? near.angle[0] * 180 / pi : 180.0);
	memset(p, 0, lights->nlights * sizeof *p);
	/* nearer than a microradian is that light: below the accuracy of any measured direction, and it keeps 1/angle finite */
	if (near.angle[0] < 1e-6) {
		p[near.light[0]] = 1;
		return OPTLA_OK;
	}
	double sum = 0;
	for (size_t k = 0; k < near.count; k++) sum += 1 / near.angle[k];
	for (size_t k = 0; k < near.count; k++) p[near.light[k]] = 1 / near.angle[k] / sum;
	return OPTLA_OK;
}

optla_status optla_light_point_(optla_ctx *ctx, const optla_light_layout *lights, double azimuth_deg, double elevation_deg,
                                double *p)
{
	double t[3];
	toward_of(azimuth_deg * pi / 180, elevation_deg * pi / 180, t);
	return optla_light_toward_(ctx, lights, t, lights->nlights, p);
}

/* ---- an environment ---- */

static size_t nearest_light(const optla_light_layout *lights, const double t[3])
{
	size_t best = 0;
	double c = -2;
	for (size_t n = 0; n < lights->nlights; n++) {
		const double cn = cosine(lights->direction + 3 * n, t);
		if (cn > c) c = cn, best = n;
	}
	return best;
}

/* Light of each pixel, nlights where none is in reach: one row of the image. */
static void assign_row(const optla_light_layout *lights, size_t width, double elevation, double reach_rad, uint32_t *owner)
{
	for (size_t x = 0; x < width; x++) {
		double t[3];
		toward_of(2 * pi * ((double)x + 0.5) / (double)width - pi, elevation, t);
		const size_t n = nearest_light(lights, t);
		owner[x] = (uint32_t)(angle(lights->direction + 3 * n, t) <= reach_rad ? n : lights->nlights);
	}
}

static double sample(const optla_image *e, size_t at, size_t channel, size_t channels)
{
	const float *v = e->data + at * e->channels;
	if (e->channels < 3) return (double)v[0];
	return 3 == channels ? (double)v[channel] : ((double)v[0] + (double)v[1] + (double)v[2]) / 3;
}

static optla_status check_samples(optla_ctx *ctx, const optla_image *e, const char *path)
{
	const size_t colours = e->channels < 3 ? 1 : 3;
	for (size_t at = 0; at < e->width * e->height; at++)
		for (size_t c = 0; c < colours; c++) {
			const double v = (double)e->data[at * e->channels + c];
			OPTLA_CHECK(ctx, isfinite(v) && v >= 0, OPTLA_ERR_INPUT,
			            "%s: pixel (%zu, %zu), channel %zu is %g: light can't be negative or not a number", path, at % e->width,
			            at / e->width, c, v);
		}
	return OPTLA_OK;
}

/* p[n] = integral of radiance over the cell of light n = (mean radiance) x (solid angle of the cell). */
optla_status optla_light_environment_(optla_ctx *ctx, const optla_light_layout *lights, const optla_image *e, const char *path,
                                      size_t channels, double *p)
{
	double reach;
	OPTLA_TRY(need_directions(ctx, lights, "env:"));
	OPTLA_TRY(check_samples(ctx, e, path));
	OPTLA_TRY(optla_light_reach_(ctx, lights, &reach));
	uint32_t *owner = optla_array_(ctx, e->width * e->height, sizeof *owner);
	if (!owner) return OPTLA_ERR_NOMEM;
	const double step = pi / (double)e->height;
#pragma omp parallel for num_threads(optla_ctx_threads(ctx)) schedule(static)
	for (size_t y = 0; y < e->height; y++)
		assign_row(lights, e->width, pi / 2 - ((double)y + 0.5) * step, reach, owner + y * e->width);
	memset(p, 0, channels * lights->nlights * sizeof *p);
	for (size_t y = 0; y < e->height; y++) {
		/* exact solid angle of a pixel: (2 pi / width) (sin of its upper edge - sin of its lower edge) */
		const double upper = pi / 2 - (double)y * step;
		const double solid_angle_sr = 2 * pi / (double)e->width * (sin(upper) - sin(upper - step));
		for (size_t x = 0; x < e->width; x++) {
			const size_t at = y * e->width + x, n = owner[at];
			if (n == lights->nlights) continue;
			for (size_t c = 0; c < channels; c++) p[c * lights->nlights + n] += solid_angle_sr * sample(e, at, c, channels);
		}
	}
	optla_free(ctx, owner);
	return OPTLA_OK;
}
