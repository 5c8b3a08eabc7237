/* SPDX-License-Identifier: BSD-3-Clause */
/* The forms of an illumination: "all", "light:...", numbers, an image on the projector's grid, "env:...", "point:...". */
#include "capture/light_spec.h"
#include "io/number_text.h"
#include "io/whole_file.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define FORMS "all, light:N[=POWER],..., point:AZIMUTH,ELEVATION, env:FILE, or a file of numbers (.npy, .csv, .txt) or an image"

static bool starts_with(const char *text, const char *prefix) { return 0 == strncmp(text, prefix, strlen(prefix)); }

static bool ends_with(const char *text, const char *ending)
{
	const size_t n = strlen(text), m = strlen(ending);
	return n >= m && 0 == strcasecmp(text + n - m, ending);
}

/* White light: each channel as the first. */
static void spread(size_t nlights, size_t channels, double *p)
{
	for (size_t c = 1; c < channels; c++) memcpy(p + c * nlights, p, nlights * sizeof *p);
}

static optla_status check_power(optla_ctx *ctx, const char *where, size_t light, double value)
{
	OPTLA_CHECK(ctx, isfinite(value) && value >= 0, OPTLA_ERR_INPUT,
	            "%s: light %zu has power %g: a light's power is a number of at least 0", where, light, value);
	return OPTLA_OK;
}

/* ---- light:7=0.5,9=1 ---- */

static optla_status parse_one_light(optla_ctx *ctx, size_t nlights, const char *spec, const char **at, double *p)
{
	char *end;
	OPTLA_CHECK(ctx, isdigit((unsigned char)**at), OPTLA_ERR_ARG, "'%s': expected the number of a light (0 to %zu) at '%s'", spec,
	            nlights - 1, *at);
	const unsigned long long light = strtoull(*at, &end, 10);
	OPTLA_CHECK(ctx, light < nlights, OPTLA_ERR_ARG, "'%s': there is no light %llu, they are numbered 0 to %zu", spec, light,
	            nlights - 1);
	double power = 1;
	if ('=' == *end) {
		const char *text = end + 1;
		power = optla_strtod_(text, &end);
		OPTLA_CHECK(ctx, end != text, OPTLA_ERR_ARG, "'%s': expected the power of light %llu at '%s'", spec, light, text);
	}
	OPTLA_CHECK(ctx, isfinite(power) && power >= 0, OPTLA_ERR_ARG,
	            "'%s': light %llu has power %g: a light's power is a number of at least 0", spec, light, power);
	OPTLA_CHECK(ctx, p[light] < 0, OPTLA_ERR_ARG, "'%s': light %llu is listed twice", spec, light);
	p[light] = power;
	*at = end;
	return OPTLA_OK;
}

static optla_status parse_lights(optla_ctx *ctx, size_t nlights, const char *spec, double *p)
{
	const char *at = spec + strlen("light:");
	for (size_t n = 0; n < nlights; n++) p[n] = -1; /* not yet listed */
	for (;;) {
		OPTLA_TRY(parse_one_light(ctx, nlights, spec, &at, p));
		if (!*at) break;
		OPTLA_CHECK(ctx, ',' == *at, OPTLA_ERR_ARG, "'%s': expected ',' or the end at '%s'", spec, at);
		at++;
	}
	for (size_t n = 0; n < nlights; n++) p[n] = fmax(p[n], 0);
	return OPTLA_OK;
}

/* ---- point:AZ,EL ---- */

static optla_status parse_point(optla_ctx *ctx, const optla_light_layout *lights, const char *spec, double *p)
{
	const char *azimuth_text = spec + strlen("point:");
	char *comma, *end = NULL;
	const double azimuth_deg = optla_strtod_(azimuth_text, &comma);
	double elevation_deg = 0;
	const bool ok = comma != azimuth_text && ',' == *comma;
	if (ok) elevation_deg = optla_strtod_(comma + 1, &end);
	OPTLA_CHECK(ctx, ok && end != comma + 1 && !*end, OPTLA_ERR_ARG,
	            "'%s': expected point:AZIMUTH,ELEVATION in degrees, as in point:150,30", spec);
	OPTLA_CHECK(ctx, azimuth_deg >= -360 && azimuth_deg <= 360 && elevation_deg >= -90 && elevation_deg <= 90, OPTLA_ERR_ARG,
	            "'%s': azimuth goes from -360 to 360 degrees, elevation from -90 to 90", spec);
	return optla_light_point_(ctx, lights, azimuth_deg, elevation_deg, p);
}

static optla_status colours_apart(optla_ctx *ctx, size_t nlights, double *p)
{
	double *by_light = optla_array_(ctx, 3 * nlights, sizeof *by_light);
	if (!by_light) return OPTLA_ERR_NOMEM;
	memcpy(by_light, p, 3 * nlights * sizeof *p);
	for (size_t n = 0; n < nlights; n++)
		for (size_t c = 0; c < 3; c++) p[c * nlights + n] = by_light[3 * n + c];
	optla_free(ctx, by_light);
	return OPTLA_OK;
}

static optla_status check_count(optla_ctx *ctx, const char *path, size_t nlights, size_t channels, size_t count)
{
	OPTLA_CHECK(ctx, count == nlights || count == channels * nlights, OPTLA_ERR_INPUT, "%s: holds %zu numbers, wanted %zu%s",
	            path, count, nlights, 3 == channels ? " (one for each light) or three times as many (R G B of each light)" : "");
	return OPTLA_OK;
}

/* ---- numbers in text ---- */

/* A file of 3*nlights numbers holds red, green and blue of one light after another. */
static optla_status take_numbers(optla_ctx *ctx, const double *values, size_t count, const char *path, size_t nlights,
                                 size_t channels, double *p)
{
	OPTLA_TRY(check_count(ctx, path, nlights, channels, count));
	const bool coloured = count > nlights;
	for (size_t k = 0; k < count; k++) OPTLA_TRY(check_power(ctx, path, coloured ? k / 3 : k, values[k]));
	memcpy(p, values, count * sizeof *p);
	if (coloured) return colours_apart(ctx, nlights, p);
	spread(nlights, channels, p);
	return OPTLA_OK;
}

static optla_status load_text(optla_ctx *ctx, const char *path, size_t nlights, size_t channels, double *p)
{
	double *values;
	size_t count;
	OPTLA_TRY(optla_read_numbers_(ctx, path, &values, &count, NULL));
	const optla_status s = take_numbers(ctx, values, count, path, nlights, channels, p);
	optla_free(ctx, values);
	return s;
}

/* ---- numbers in arrays ---- */

static double array_at(const optla_array *a, size_t k)
{
	return OPTLA_F32 == a->type ? (double)((const float *)a->data)[k] : ((const double *)a->data)[k];
}

static optla_status take_array(optla_ctx *ctx, const optla_array *a, const char *path, size_t nlights, size_t channels, double *p)
{
	size_t count = 1;
	OPTLA_CHECK(ctx, OPTLA_F32 == a->type || OPTLA_F64 == a->type, OPTLA_ERR_INPUT,
	            "%s: holds complex numbers; a light's power is real", path);
	for (size_t d = 0; d < a->ndim; d++) count *= a->dims[d];
	OPTLA_TRY(check_count(ctx, path, nlights, channels, count));
	const bool coloured = count > nlights;
	OPTLA_CHECK(ctx, !coloured || (2 == a->ndim && (3 == a->dims[0] || 3 == a->dims[1])), OPTLA_ERR_INPUT,
	            "%s: coloured light is an array of %zu x 3 or 3 x %zu numbers", path, nlights, nlights);
	for (size_t k = 0; k < count; k++) {
		OPTLA_TRY(check_power(ctx, path, coloured && 3 == a->dims[1] ? k / 3 : k % nlights, array_at(a, k)));
		p[k] = array_at(a, k);
	}
	if (coloured) return 3 == a->dims[1] ? colours_apart(ctx, nlights, p) : OPTLA_OK;
	spread(nlights, channels, p);
	return OPTLA_OK;
}

static optla_status load_array(optla_ctx *ctx, const char *path, size_t nlights, size_t channels, double *p)
{
	optla_array *a;
	OPTLA_TRY(optla_array_load(ctx, path, &a));
	const optla_status s = take_array(ctx, a, path, nlights, channels, p);
	optla_array_destroy(&a);
	return s;
}

/* ---- images ---- */

optla_status optla_light_linear_(optla_image *image, const char *path)
{
	if (OPTLA_IMAGE_DISPLAY == image->kind) return optla_image_display_to_linear(image);
	if (OPTLA_IMAGE_LINEAR == image->kind) return OPTLA_OK;
	OPTLA_CHECK(image->ctx, image->white_dn > 0, OPTLA_ERR_INPUT, "%s: raw counts without a white count can't be a light's power",
	            path);
	return optla_image_linearize(image, 0, 1 / image->white_dn);
}

static optla_status take_grid_image(optla_ctx *ctx, const optla_light_layout *lights, const optla_image *image, const char *path,
                                    size_t channels, double *p)
{
	OPTLA_CHECK(ctx, lights->grid_width, OPTLA_ERR_UNSUPPORTED,
	            "%s: the lights aren't on a projector's grid, so an image can't set them; did you mean env:%s?", path, path);
	OPTLA_CHECK(ctx, image->width == lights->grid_width && image->height == lights->grid_height, OPTLA_ERR_SHAPE,
	            "%s: is %zu x %zu, the projector has %zu x %zu pixels: resize it first", path, image->width, image->height,
	            lights->grid_width, lights->grid_height);
	for (size_t n = 0; n < lights->nlights; n++) {
		const float *v = image->data + n * image->channels;
		const bool colour = image->channels >= 3;
		for (size_t c = 0; c < channels; c++) {
			const double value = !colour         ? (double)v[0]
			                     : 3 == channels ? (double)v[c]
			                                     : ((double)v[0] + (double)v[1] + (double)v[2]) / 3;
			OPTLA_TRY(check_power(ctx, path, n, value));
			p[c * lights->nlights + n] = value;
		}
	}
	return OPTLA_OK;
}

static optla_status load_image(optla_ctx *ctx, const optla_light_layout *lights, const char *path, bool environment,
                               size_t channels, double *p)
{
	optla_image *image;
	OPTLA_TRY(optla_image_load(ctx, path, &image));
	optla_status s = optla_light_linear_(image, path);
	if (OPTLA_OK == s)
		s = environment ? optla_light_environment_(ctx, lights, image, path, channels, p)
		                : take_grid_image(ctx, lights, image, path, channels, p);
	optla_image_destroy(&image);
	return s;
}

/* ---- which form it is ---- */

static optla_status load_file(optla_ctx *ctx, const optla_light_layout *lights, const char *path, size_t channels, double *p)
{
	optla_file_type type;
	if (ends_with(path, ".csv") || ends_with(path, ".txt")) return load_text(ctx, path, lights->nlights, channels, p);
	/* members of archives are named after a colon, which only the array reader understands */
	if (strstr(path, ".npz:") || strstr(path, ".h5:")) return load_array(ctx, path, lights->nlights, channels, p);
	OPTLA_CHECK(ctx, optla_path_exists_(path), OPTLA_ERR_INPUT, "'%s' is no file and no known light: " FORMS, path);
	OPTLA_TRY(optla_file_type_of(ctx, path, &type));
	switch (type) {
	case OPTLA_FILE_NPY:
	case OPTLA_FILE_NPZ:
	case OPTLA_FILE_HDF5: return load_array(ctx, path, lights->nlights, channels, p);
	case OPTLA_FILE_PNG:
	case OPTLA_FILE_TIFF:
	case OPTLA_FILE_EXR:
	case OPTLA_FILE_PFM:
	case OPTLA_FILE_RAW: return load_image(ctx, lights, path, false, channels, p);
	default: break;
	}
	return OPTLA_FAIL(ctx, OPTLA_ERR_INPUT, "%s: not a kind of file that describes light: " FORMS, path);
}

optla_status optla_light_spec_(optla_ctx *ctx, const optla_light_layout *lights, const char *spec, size_t channels, double *p)
{
	const size_t n = lights->nlights;
	OPTLA_CHECK(ctx, spec && *spec, OPTLA_ERR_ARG, "no light given: " FORMS);
	OPTLA_CHECK(ctx, 1 == channels || 3 == channels, OPTLA_ERR_ARG, "light has 1 or 3 channels, not %zu", channels);
	if (starts_with(spec, "env:")) return load_image(ctx, lights, spec + strlen("env:"), true, channels, p);
	if (0 == strcmp(spec, "all")) {
		for (size_t k = 0; k < n; k++) p[k] = 1;
	} else if (starts_with(spec, "light:")) {
		OPTLA_TRY(parse_lights(ctx, n, spec, p));
	} else if (starts_with(spec, "point:")) {
		OPTLA_TRY(parse_point(ctx, lights, spec, p));
	} else {
		return load_file(ctx, lights, spec, channels, p);
	}
	spread(n, channels, p);
	return OPTLA_OK;
}
