/* SPDX-License-Identifier: BSD-3-Clause */
/* What the verbs that take photos with a rig share. */
#include "rig_run.h"

#include "inputs.h"

#include "base/base_impl.h"
#include "io/whole_file.h"

#include <stdlib.h>
#include <string.h>

static const cli_sensor_options sensor_defaults = {.size = sizeof sensor_defaults};
static const optla_option sensor_fields[] = {
    {"sensor", offsetof(cli_sensor_options, sensor), OPTLA_OPTION_STRING, "NAME", 0, 0, NULL,
     "Sensor that takes the photos, see the list of sensors; 'none': no noise, no limits. Without it: the one that the rig file "
     "names, or none."},
};
const optla_option_table cli_sensor_table = {"sensor", sizeof(cli_sensor_options), &sensor_defaults, sensor_fields,
                                             CLI_COUNT(sensor_fields)};
const cli_topic cli_sensor_topic = {"Sensors", optla_sensor_preset_name};

static const cli_picture_options picture_defaults = {.size = sizeof picture_defaults};
static const optla_option picture_fields[] = {
    {"brightness", offsetof(cli_picture_options, brightness), OPTLA_OPTION_DOUBLE, "", 0, 1e12, NULL,
     "Factor that brings linear values to the 0 to 1 of a .png; 0: so that 0.5 % of the pixels are white. Other formats hold the "
     "values as they "
     "are."},
};
const optla_option_table cli_picture_table = {"picture", sizeof(cli_picture_options), &picture_defaults, picture_fields,
                                              CLI_COUNT(picture_fields)};

void cli_default_sensor(const optla_rig_info *info, cli_sensor_options *sensor)
{
	if (!sensor->sensor) sensor->sensor = info->sensor;
}

optla_status cli_take_sensor(const cli_run *run, const cli_sensor_options *sensor, uint64_t stream,
                             optla_rig_operator_options *options)
{
	/* Streams lie far apart, so that seeds 1, 2, 3 of a user don't meet them. */
	options->seed = run->shared.seed + stream * UINT64_C(0x9e3779b97f4a7c15);
	options->sensor = NULL;
	if (!sensor->sensor || !strcmp(sensor->sensor, "none")) return OPTLA_OK;
	options->sensor = optla_sensor_preset(sensor->sensor);
	if (options->sensor) return OPTLA_OK;
	char names[256] = "none";
	size_t used = strlen(names);
	for (size_t k = 0; optla_sensor_preset_name(k, NULL) && used < sizeof names; k++)
		used += (size_t)snprintf(names + used, sizeof names - used, ", %s", optla_sensor_preset_name(k, NULL));
	return cli_fail(run, OPTLA_ERR_ARG, "option 'sensor': there is no sensor '%s': allowed are %s", sensor->sensor, names);
}

const char *cli_channel_name(optla_channel channel)
{
	static const char *const names[] = {"grey", "red", "green", "blue", "all"};
	return names[channel];
}

static const char *ending(const char *path)
{
	const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
	return dot && (!slash || dot > slash) ? dot : "";
}

static bool one_of(const char *word, const char *const *list)
{
	for (; *list; list++)
		if (!strcmp(word, *list)) return true;
	return false;
}

static const char *const picture_endings[] = {".png", ".tif", ".tiff", ".exr", ".pfm", ".npy", NULL};

optla_status cli_check_picture(const cli_run *run, const char *path)
{
	if (!path) return OPTLA_OK;
	if (!one_of(ending(path), picture_endings))
		return cli_fail(run, OPTLA_ERR_ARG, "'%s': a picture is written as .png, .exr, .tif, .pfm or .npy, not '%s'", path,
		                ending(path));
	return cli_check_output(run, path);
}

optla_status cli_check_lights(const cli_run *run, const char *path)
{
	if (!path) return OPTLA_OK;
	if (!one_of(ending(path), picture_endings) && strcmp(ending(path), ".csv"))
		return cli_fail(run, OPTLA_ERR_ARG, "'%s': an illumination is written as .csv, .npy, .png, .exr, .tif or .pfm, not '%s'",
		                path, ending(path));
	return cli_check_output(run, path);
}

optla_status cli_check_grid(const cli_run *run, size_t light_width, const char *path)
{
	if (!path || light_width || !one_of(ending(path), picture_endings) || !strcmp(ending(path), ".npy")) return OPTLA_OK;
	return cli_fail(run, OPTLA_ERR_ARG, "'%s': the lights of this rig aren't on a grid: write them as .csv or .npy", path);
}

optla_status cli_check_transpose(const cli_run *run, const optla_rig_info *info, const char *method)
{
	if (info->has_transpose) return OPTLA_OK;
	return cli_fail(run, OPTLA_ERR_UNSUPPORTED,
	                "rig '%s' says 'transpose: false', but %s needs light from the camera's side too (Tᵀ r): 'transpose: true' "
	                "lets the recorded photos answer it",
	                info->name, method);
}

int cli_iterations(const optla_rig_info *info, int iterations)
{
	return info->nlights < (size_t)iterations ? (int)info->nlights : iterations;
}

optla_status cli_save_picture(const cli_run *run, const optla_image *image, const cli_picture_options *options, const char *path)
{
	if (strcmp(ending(path), ".png") || image->kind != OPTLA_IMAGE_LINEAR) return optla_image_save(image, path);
	optla_image *shown = NULL;
	OPTLA_TRY(optla_image_copy(image, &shown));
	const double exposure = options->brightness > 0 ? options->brightness : optla_image_auto_exposure(image, 0.995);
	optla_log_(run->ctx, 2, "%s: linear values times %.6g, then the sRGB curve", path, exposure);
	optla_status status = optla_image_to_display(shown, exposure);
	if (!status) status = optla_image_save(shown, path);
	optla_image_destroy(&shown);
	return status;
}

static optla_status save_csv(const cli_run *run, const cli_lights *lights, const double *values, size_t channels,
                             const char *path)
{
	const size_t bytes = lights->n * channels * 26 + 1;
	char *text = optla_alloc_(run->ctx, bytes);
	if (!text) return OPTLA_ERR_NOMEM;
	size_t used = 0;
	for (size_t k = 0; k < lights->n; k++)
		for (size_t c = 0; c < channels; c++)
			used +=
			    (size_t)snprintf(text + used, bytes - used, "%.17g%c", values[c * lights->n + k], c + 1 < channels ? ',' : '\n');
	const optla_status status = optla_write_file_(run->ctx, path, text, used);
	optla_free(run->ctx, text);
	return status;
}

static optla_status save_npy(const cli_run *run, const cli_lights *lights, const double *values, size_t channels,
                             const char *path)
{
	double *data = optla_array_(run->ctx, lights->n * channels, sizeof *data);
	if (!data) return OPTLA_ERR_NOMEM;
	for (size_t k = 0; k < lights->n; k++)
		for (size_t c = 0; c < channels; c++) data[k * channels + c] = values[c * lights->n + k];
	const optla_array array = {
	    .ctx = run->ctx, .ndim = channels > 1 ? 2 : 1, .dims = {lights->n, channels}, .type = OPTLA_F64, .data = data};
	const optla_status status = optla_array_save(&array, path);
	optla_free(run->ctx, data);
	return status;
}

optla_status cli_save_lights(const cli_run *run, const cli_lights *lights, const double *values, size_t channels,
                             const cli_picture_options *options, const char *path)
{
	if (!strcmp(ending(path), ".csv")) return save_csv(run, lights, values, channels, path);
	if (!strcmp(ending(path), ".npy")) return save_npy(run, lights, values, channels, path);
	OPTLA_TRY(cli_check_grid(run, lights->width, path));
	optla_image *image = NULL;
	OPTLA_TRY(optla_image_create(run->ctx, lights->width, lights->height, channels, OPTLA_IMAGE_LINEAR, &image));
	for (size_t k = 0; k < lights->n; k++)
		for (size_t c = 0; c < channels; c++) image->data[k * channels + c] = (float)values[c * lights->n + k];
	const optla_status status = cli_save_picture(run, image, options, path);
	optla_image_destroy(&image);
	return status;
}

optla_status cli_light_channels(const cli_run *run, const char *spec, size_t camera_channels, size_t *channels)
{
	*channels = 1;
	const bool environment = !strncmp(spec, "env:", 4);
	const char *path = environment ? spec + 4 : spec;
	if (camera_channels != 3 || (!environment && !optla_path_exists_(path))) return OPTLA_OK;
	optla_file_type type;
	OPTLA_TRY(optla_file_type_of(run->ctx, path, &type));
	if (type != OPTLA_FILE_PNG && type != OPTLA_FILE_TIFF && type != OPTLA_FILE_EXR && type != OPTLA_FILE_PFM &&
	    type != OPTLA_FILE_RAW)
		return OPTLA_OK;
	optla_image *image = NULL;
	OPTLA_TRY(optla_image_load(run->ctx, path, &image));
	*channels = image->channels >= 3 ? 3 : 1;
	optla_image_destroy(&image);
	return OPTLA_OK;
}

void cli_cost(cli_run *run, uint64_t photos, double exposure_s)
{
	cli_number(run, "photos", (double)photos);
	cli_number(run, "exposure_s", exposure_s);
}
