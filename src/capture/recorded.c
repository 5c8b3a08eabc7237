/* SPDX-License-Identifier: BSD-3-Clause */
/* A rig of recorded photos. */
#include "capture/recorded_impl.h"
#include "io/number_text.h"
#include "io/whole_file.h"
#include "math/dense.h"

#include <math.h>
#include <string.h>

/* A table of the manifest with one row for each light; the caller frees *values. */
static optla_status read_table(const optla_recorded *r, const char *name, const char *key, size_t least, size_t most,
                               double **values, size_t *columns)
{
	char *path = optla_recorded_path_(r, name);
	if (!path) return OPTLA_ERR_NOMEM;
	size_t count;
	optla_status status = optla_read_numbers_(r->ctx, path, values, &count, columns);
	if (!status &&
	    (count != *columns * r->m->nlights || *columns < least || *columns > most || (*columns != least && *columns != most)))
		status = optla_yaml_fail_(r->m->doc, r->m->lights_node, "'%s': '%s' is %zu x %zu numbers, wanted are %zu lights x %zu",
		                          key, name, count / *columns, *columns, r->m->nlights, most);
	if (status) {
		optla_free(r->ctx, *values);
		*values = NULL;
	}
	optla_free(r->ctx, path);
	return status;
}

/* Unit vectors, turned from the file's axes to the camera's. */
static optla_status convert_directions(const optla_recorded *r, const double *file, double *out)
{
	for (size_t n = 0; n < r->m->nlights; n++) {
		double v[3] = {0, 0, 0}, length = 0;
		for (int i = 0; i < 3; i++)
			for (int k = 0; k < 3; k++) v[k] += file[3 * n + (size_t)i] * r->m->axes[i][k];
		for (int k = 0; k < 3; k++) length += v[k] * v[k];
		if (!(length > 0))
			return optla_yaml_fail_(r->m->doc, r->m->lights_node, "'%s': the direction of light %zu is zero", r->m->directions,
			                        n);
		for (int k = 0; k < 3; k++) out[3 * n + (size_t)k] = v[k] / sqrt(length);
	}
	return OPTLA_OK;
}

static optla_status read_directions(optla_recorded *r)
{
	if (!r->m->directions) return OPTLA_OK;
	double *file;
	size_t columns;
	OPTLA_TRY(read_table(r, r->m->directions, "directions", 3, 3, &file, &columns));
	optla_rig *rig = r->rig;
	rig->light_direction = optla_array_(r->ctx, r->m->nlights, 3 * sizeof *rig->light_direction);
	const optla_status status = rig->light_direction ? convert_directions(r, file, rig->light_direction) : OPTLA_ERR_NOMEM;
	rig->info.light_direction = rig->light_direction;
	optla_free(r->ctx, file);
	return status;
}

/* Columns of T for lights of the same strength: T / intensity, channel by channel. */
static optla_status divide_intensities(const optla_recorded *r, const double *intensity, size_t columns)
{
	const optla_transport *t = r->rig->transport;
	for (size_t n = 0; n < t->nlights; n++)
		for (size_t c = 0; c < t->channels; c++) {
			const double v = intensity[n * columns + (columns == 1 ? 0 : c)];
			if (!(v > 0))
				return optla_yaml_fail_(r->m->doc, r->m->lights_node,
				                        "'%s': the intensity of light %zu is %g: allowed is a number > 0", r->m->intensities, n,
				                        v);
			float *row = (float *)t->t.data + n * t->t.nrows + c * t->npixels;
			for (size_t m = 0; m < t->npixels; m++) row[m] = (float)((double)row[m] / v);
		}
	return OPTLA_OK;
}

static optla_status read_intensities(optla_recorded *r)
{
	if (!r->m->intensities) return OPTLA_OK;
	double *file;
	size_t columns;
	OPTLA_TRY(read_table(r, r->m->intensities, "intensities", 1, r->channels, &file, &columns));
	const optla_status status = r->m->divide_intensities ? divide_intensities(r, file, columns) : OPTLA_OK;
	optla_free(r->ctx, file);
	return status;
}

optla_status optla_recorded_lights_(optla_recorded *r)
{
	r->rig->info.light_width = r->m->grid[0];
	r->rig->info.light_height = r->m->grid[1];
	OPTLA_TRY(read_directions(r));
	return read_intensities(r);
}

/* data_dir, or the manifest's data_root from the manifest's folder. */
static optla_status find_root(optla_recorded *r, const char *data_dir, const char *path)
{
	if (data_dir) {
		r->root = optla_strdup_(r->ctx, data_dir);
		return r->root ? OPTLA_OK : OPTLA_ERR_NOMEM;
	}
	char *folder = optla_path_dir_(r->ctx, path);
	if (folder) r->root = optla_path_join_(r->ctx, folder, r->m->data_root);
	optla_free(r->ctx, folder);
	return r->root ? OPTLA_OK : OPTLA_ERR_NOMEM;
}

static optla_status build(optla_recorded *r, const char *data_dir, const char *path)
{
	OPTLA_TRY(find_root(r, data_dir, path));
	OPTLA_TRY(optla_recorded_check_files_(r));
	if (!r->m->nlights)
		return optla_yaml_fail_(r->m->doc, r->m->photos_node,
		                        "the number of lights is not known: give the key count in 'lights'");
	OPTLA_TRY(optla_recorded_frame_(r));
	OPTLA_TRY(optla_recorded_photos_(r));
	OPTLA_TRY(optla_recorded_solve_(r));
	return optla_recorded_lights_(r);
}

optla_status optla_rig_from_photos_(optla_ctx *ctx, const optla_manifest *manifest, const char *data_dir,
                                    const optla_rig_labels *labels, optla_rig **out)
{
	*out = NULL;
	optla_recorded r = {.ctx = ctx, .m = manifest};
	OPTLA_TRY(optla_rig_create_(ctx, labels->name, labels->path, labels->sensor, &r.rig));
	const optla_status status = build(&r, data_dir, labels->path);
	optla_free(ctx, r.y);
	optla_free(ctx, r.dark);
	optla_free(ctx, r.root);
	if (status) optla_rig_destroy(&r.rig);
	*out = r.rig;
	return status;
}
