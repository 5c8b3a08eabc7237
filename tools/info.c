/* SPDX-License-Identifier: BSD-3-Clause */
/* optla info: what a file is, its sizes and units, how it was made. */
#include "h5_list.h"
#include "inputs.h"
#include "verbs.h"

#include "optla/rig.h"

#include "base/base_impl.h"

#include <math.h>
#include <string.h>

typedef struct {
	double lowest, highest, sum;
	size_t count, saturated, not_finite;
} spread;

static void add(spread *s, double v, double saturation)
{
	s->count++;
	if (!isfinite(v)) {
		s->not_finite++;
		return;
	}
	if (s->count - s->not_finite == 1) s->lowest = s->highest = v;
	s->lowest = fmin(s->lowest, v);
	s->highest = fmax(s->highest, v);
	s->sum += v;
	s->saturated += v >= saturation;
}

static double mean(const spread *s) { return s->sum / (double)(s->count - s->not_finite); }

static json_t *spread_json(const spread *s)
{
	json_t *j = json_object();
	cli_json_number(j, "min", s->count > s->not_finite ? s->lowest : NAN);
	cli_json_number(j, "mean", mean(s));
	cli_json_number(j, "max", s->count > s->not_finite ? s->highest : NAN);
	cli_json_number(j, "not_finite", (double)s->not_finite);
	return j;
}

/* Lines of text, each indented. */
static void say_lines(const cli_run *run, const char *text)
{
	while (*text) {
		const size_t n = strcspn(text, "\n");
		cli_say(run, "  %.*s\n", (int)n, text);
		text += n + (text[n] == '\n');
	}
}

static optla_status info_image(cli_run *run, const char *path)
{
	optla_image *image = NULL;
	OPTLA_TRY(optla_image_load(run->ctx, path, &image));
	const double saturation = image->kind == OPTLA_IMAGE_DISPLAY                         ? 1
	                          : image->kind == OPTLA_IMAGE_RAW_DN && image->white_dn > 0 ? image->white_dn
	                                                                                     : INFINITY;
	cli_text(run, "type", "image");
	cli_text(run, "kind", optla_image_kind_name(image->kind));
	cli_number(run, "width", (double)image->width);
	cli_number(run, "height", (double)image->height);
	cli_number(run, "channels", (double)image->channels);
	if (image->kind == OPTLA_IMAGE_RAW_DN) cli_number(run, "white_dn", image->white_dn);
	cli_say(run, "%s: image, %zu x %zu, %zu channel%s, %s\n", path, image->width, image->height, image->channels,
	        image->channels == 1 ? "" : "s", optla_image_kind_name(image->kind));
	json_t *channels = json_array();
	for (size_t c = 0; c < image->channels; c++) {
		spread s = {0};
		for (size_t k = 0; k < image->width * image->height; k++) add(&s, image->data[k * image->channels + c], saturation);
		cli_say(run, "  channel %zu: min %.6g, mean %.6g, max %.6g", c, s.lowest, mean(&s), s.highest);
		if (isfinite(saturation))
			cli_say(run, ", saturated (>= %g) %.3g %%", saturation, 100.0 * (double)s.saturated / (double)s.count);
		if (s.not_finite) cli_say(run, ", not finite %zu", s.not_finite);
		cli_say(run, "\n");
		json_t *j = spread_json(&s);
		if (isfinite(saturation)) cli_json_number(j, "saturated", (double)s.saturated);
		json_array_append_new(channels, j);
	}
	json_object_set_new(run->numbers, "samples", channels);
	cli_text(run, "provenance", image->provenance);
	if (image->provenance) {
		cli_say(run, "Made by:\n");
		say_lines(run, image->provenance);
	}
	optla_image_destroy(&image);
	return OPTLA_OK;
}

static const char *scalar_name(optla_scalar type)
{
	switch (type) {
	case OPTLA_F32: return "float32";
	case OPTLA_F64: return "float64";
	case OPTLA_C32: return "complex of two float32";
	case OPTLA_C64: return "complex of two float64";
	}
	return "?";
}

static optla_status info_array(cli_run *run, const char *path)
{
	optla_array *a = NULL;
	OPTLA_TRY(optla_array_load(run->ctx, path, &a));
	char size[128];
	cli_array_size(a, size, sizeof size);
	size_t n = a->type == OPTLA_C32 || a->type == OPTLA_C64 ? 2 : 1;
	json_t *dims = json_array();
	for (size_t k = 0; k < a->ndim; k++) {
		n *= a->dims[k];
		json_array_append_new(dims, json_integer((json_int_t)a->dims[k]));
	}
	spread s = {0};
	for (size_t k = 0; k < n; k++)
		add(&s, a->type == OPTLA_F32 || a->type == OPTLA_C32 ? (double)((const float *)a->data)[k] : ((const double *)a->data)[k],
		    INFINITY);
	cli_text(run, "type", "array");
	cli_text(run, "scalar", scalar_name(a->type));
	json_object_set_new(run->numbers, "dims", dims);
	json_object_set_new(run->numbers, "samples", spread_json(&s));
	cli_say(run, "%s: array, %s, %s\n", path, size, scalar_name(a->type));
	if (n) cli_say(run, "  min %.6g, mean %.6g, max %.6g", s.lowest, mean(&s), s.highest);
	if (s.not_finite) cli_say(run, ", not finite %zu", s.not_finite);
	if (n) cli_say(run, "\n");
	optla_array_destroy(&a);
	return OPTLA_OK;
}

static void say_dataset(cli_run *run, const cli_h5_dataset *d, json_t *datasets)
{
	char size[256] = "1";
	size_t used = 0;
	json_t *dims = json_array();
	for (int k = 0; k < d->ndim && k < 8; k++) {
		used += (size_t)snprintf(size + used, sizeof size - used, "%s%llu", k ? " x " : "", d->dims[k]);
		json_array_append_new(dims, json_integer((json_int_t)d->dims[k]));
	}
	cli_say(run, "  %-22s %-18s %-9s %s%s%s\n", d->name, size, d->type, d->unit && *d->unit ? d->unit : "",
	        d->unit && *d->unit ? "  " : "", d->help ? d->help : "");
	json_t *j = json_object();
	json_object_set_new(j, "name", json_string(d->name));
	json_object_set_new(j, "dims", dims);
	json_object_set_new(j, "type", json_string(d->type));
	if (d->unit) json_object_set_new(j, "unit", json_string(d->unit));
	if (d->help) json_object_set_new(j, "help", json_string(d->help));
	json_array_append_new(datasets, j);
}

static optla_status info_h5(cli_run *run, const char *path)
{
	cli_h5_list list;
	optla_status status = cli_h5_read_list(run, path, &list);
	if (!status) {
		const cli_h5_attribute *kind = cli_h5_find_attribute(&list, "optla_kind"),
		                       *made = cli_h5_find_attribute(&list, "provenance");
		const char *what = kind && kind->text ? kind->text : NULL;
		cli_text(run, "type", "hdf5");
		cli_text(run, "kind", what);
		cli_say(run, "%s: HDF5%s%s, %zu dataset%s\n", path, what ? ", kind " : "", what ? what : "", list.ndatasets,
		        list.ndatasets == 1 ? "" : "s");
		json_t *datasets = json_array(), *attributes = json_object();
		for (size_t k = 0; k < list.ndatasets; k++) say_dataset(run, &list.datasets[k], datasets);
		if (list.nattributes > (size_t)(kind != NULL) + (made != NULL)) cli_say(run, "Attributes:\n");
		for (size_t k = 0; k < list.nattributes; k++) {
			const cli_h5_attribute *a = &list.attributes[k];
			if (a == kind || a == made) continue;
			if (a->text) {
				cli_say(run, "  %-22s %s\n", a->name, a->text);
				json_object_set_new(attributes, a->name, json_string(a->text));
			} else {
				cli_say(run, "  %-22s %.8g\n", a->name, a->number);
				cli_json_number(attributes, a->name, a->number);
			}
		}
		json_object_set_new(run->numbers, "datasets", datasets);
		json_object_set_new(run->numbers, "attributes", attributes);
		cli_text(run, "provenance", made ? made->text : NULL);
		if (made && made->text) {
			cli_say(run, "Made by:\n");
			say_lines(run, made->text);
		}
	}
	cli_h5_list_clear(&list);
	return status;
}

static void rig_numbers(cli_run *run, const optla_rig_info *i)
{
	cli_text(run, "type", "rig");
	cli_text(run, "kind", i->kind == OPTLA_RIG_RECORDED ? "recorded" : "analytic");
	cli_text(run, "name", i->name);
	cli_number(run, "width", (double)i->width);
	cli_number(run, "height", (double)i->height);
	cli_number(run, "channels", (double)i->channels);
	cli_number(run, "npixels", (double)i->npixels);
	cli_number(run, "nlights", (double)i->nlights);
	cli_number(run, "light_width", (double)i->light_width);
	cli_number(run, "light_height", (double)i->light_height);
	json_object_set_new(run->numbers, "light_directions", json_boolean(i->light_direction != NULL));
	json_object_set_new(run->numbers, "transpose", json_boolean(i->has_transpose));
	json_object_set_new(run->numbers, "symmetric", json_boolean(i->symmetric));
	cli_number(run, "nphotos", (double)i->nphotos);
	cli_number(run, "saturated_samples", (double)i->saturated_samples);
	cli_number(run, "exposure_s", i->exposure_s);
	cli_text(run, "sensor", i->sensor);
}

static optla_status info_rig(cli_run *run, const char *path)
{
	optla_rig *rig = NULL;
	OPTLA_TRY(cli_open_rig(run, path, &rig));
	optla_rig_info i;
	optla_rig_get_info(rig, &i);
	rig_numbers(run, &i);
	cli_say(run, "%s: %s rig '%s'\n", path, i.kind == OPTLA_RIG_RECORDED ? "recorded" : "analytic", i.name ? i.name : "");
	cli_say(run, "  camera     %zu x %zu, %zu channel%s; %zu pixels in the mask (%.3g %%)\n", i.width, i.height, i.channels,
	        i.channels == 1 ? "" : "s", i.npixels, 100.0 * (double)i.npixels / ((double)i.width * (double)i.height));
	if (i.light_width)
		cli_say(run, "  lights     %zu, a grid of %zu x %zu\n", i.nlights, i.light_width, i.light_height);
	else
		cli_say(run, "  lights     %zu%s\n", i.nlights, i.light_direction ? ", directions known" : "");
	cli_say(run, "  T          %zu x %zu for one channel; transpose %s%s\n", i.npixels, i.nlights,
	        i.has_transpose ? "can be asked for" : "can't be asked for", i.symmetric ? "; symmetric (coaxial)" : "");
	if (i.kind == OPTLA_RIG_RECORDED)
		cli_say(run, "  photos     %zu; saturated samples in the mask %zu (%.3g %%)\n", i.nphotos, i.saturated_samples,
		        100.0 * (double)i.saturated_samples / ((double)i.npixels * (double)i.channels * (double)i.nphotos));
	cli_say(run, "  exposure   %g s; sensor %s\n", i.exposure_s, i.sensor ? i.sensor : "not named");
	optla_rig_destroy(&rig);
	return OPTLA_OK;
}

static optla_status run_info(cli_run *run)
{
	const char *path = run->arguments[0];
	cli_input input;
	OPTLA_TRY(cli_input_of(run, path, &input));
	cli_text(run, "file", path);
	switch (input) {
	case CLI_INPUT_IMAGE: return info_image(run, path);
	case CLI_INPUT_NPY:
	case CLI_INPUT_ARRAY: return info_array(run, path);
	case CLI_INPUT_HDF5: return info_h5(run, path);
	case CLI_INPUT_YAML: return info_rig(run, path);
	}
	return OPTLA_OK;
}

static const cli_argument arguments[] = {
    {"FILE", "Image, array (.npy, .npz:NAME), HDF5 file (or one dataset of it: FILE:DATASET), or rig file.", false, false}};
static const cli_example examples[] = {
    {"optla info photo.png", "Size, channels, what the samples mean, their range, how many are saturated."},
    {"optla info model.h5", "Datasets with units, and the command that made the file."},
    {"optla info ball.yaml --data ~/DiLiGenT/ball --json -", "Reads all photos of a recorded rig and prints what it is as JSON."},
};

const cli_verb cli_verb_info = {
    .name = "info",
    .summary = "tell what a file is and how it was made",
    .description = "Reads a file whole and tells what it is: an image with the meaning of its samples, an array, an HDF5 file "
                   "with its datasets "
                   "and their units, or a rig with its camera, its lights and its photos.",
    .arguments = arguments,
    .narguments = CLI_COUNT(arguments),
    .examples = examples,
    .nexamples = CLI_COUNT(examples),
    .run = run_info,
};
