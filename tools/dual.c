/* SPDX-License-Identifier: BSD-3-Clause */
/* optla dual: the photo that the projector would take if the camera shone (Eq. 1.12). */
#include "inputs.h"
#include "rig_run.h"
#include "verbs.h"

#include "optla/relight.h"

#include "base/base_impl.h"

#include <string.h>

typedef struct {
	size_t size;
	const char *light;
} dual_options;

typedef struct {
	dual_options dual;
	cli_sensor_options sensor;
	optla_rig_operator_options op;
	cli_picture_options picture;
} dual_verb_options;

static const dual_options dual_defaults = {.size = sizeof dual_defaults, .light = "all"};
static const optla_option dual_fields[] = {
    {"light", offsetof(dual_options, light), OPTLA_OPTION_STRING, "FILE|all", 0, 0, NULL,
     "What the camera shines: an image of the camera's size (1 channel: white light), or 'all' pixels."},
};
static const optla_option_table dual_table = {"dual", sizeof(dual_options), &dual_defaults, dual_fields, CLI_COUNT(dual_fields)};

static bool is_all(const char *light) { return !strcmp(light, "all"); }

static optla_status negative(const cli_run *run, const char *path)
{
	return cli_fail(run, OPTLA_ERR_INPUT, "%s: holds negative or undefined light", path);
}

/* Rows of a model from an image of its camera. */
static optla_status model_rows(const cli_run *run, const optla_model *m, const char *light, float *r)
{
	const size_t n = m->npixels;
	if (is_all(light)) {
		for (size_t k = 0; k < n * m->channels; k++) r[k] = 1;
		return OPTLA_OK;
	}
	optla_image *image = NULL;
	OPTLA_TRY(cli_load_linear(run, light, &image));
	optla_status status = OPTLA_OK;
	if (image->width != m->width || image->height != m->height || (image->channels != 1 && image->channels != m->channels))
		status =
		    cli_fail(run, OPTLA_ERR_SHAPE, "'%s' is %zu x %zu x %zu, the camera %zu x %zu with %zu channel%s", light,
		             image->width, image->height, image->channels, m->width, m->height, m->channels, m->channels == 1 ? "" : "s");
	for (size_t c = 0; !status && c < m->channels; c++)
		for (size_t k = 0; k < n; k++) {
			const size_t from = image->channels == 1 ? 0 : c;
			r[c * n + k] = image->data[m->pixel[k] * image->channels + from];
			if (!(r[c * n + k] >= 0)) status = negative(run, light);
		}
	optla_image_destroy(&image);
	return status;
}

static optla_status dual_model(cli_run *run, const char *path)
{
	const dual_verb_options *o = run->options;
	optla_ctx *ctx = run->ctx;
	optla_model *m = NULL;
	OPTLA_TRY(optla_model_load(ctx, path, &m));
	float *r = optla_array_(ctx, m->npixels * m->channels, sizeof *r), *s = optla_array_(ctx, m->nlights, sizeof *s);
	double *values = optla_array_(ctx, m->nlights, sizeof *values);
	optla_status status = r && s && values ? model_rows(run, m, o->dual.light, r) : OPTLA_ERR_NOMEM;
	if (!status) status = optla_dual(m, r, s);
	if (!status) {
		const cli_lights lights = {m->nlights, m->light_width, m->light_height};
		for (size_t k = 0; k < m->nlights; k++) values[k] = s[k];
		cli_number(run, "rank", (double)m->rank);
		cli_cost(run, m->photos_taken, m->exposure_s);
		cli_say(run, "dual photo from rank %zu (%llu photos)\n", m->rank, (unsigned long long)m->photos_taken);
		status = cli_save_lights(run, &lights, values, 1, &o->picture, run->shared.out);
	}
	optla_free(ctx, r);
	optla_free(ctx, s);
	optla_free(ctx, values);
	optla_model_destroy(&m);
	return status;
}

/* s = Tᵀ r, photographed from the projector's side. */
static optla_status expose(const cli_run *run, optla_op *op, const double *r, double *s)
{
	const size_t m = optla_op_nrows(op), n = optla_op_ncols(op);
	const optla_scalar type = optla_op_type(op);
	void *x = optla_array_(run->ctx, m, optla_scalar_bytes(type)), *y = optla_array_(run->ctx, n, optla_scalar_bytes(type));
	optla_status status = x && y ? OPTLA_OK : OPTLA_ERR_NOMEM;
	for (size_t k = 0; !status && k < m; k++) cli_set(x, type, k, r[k]);
	if (!status) status = optla_op_apply(op, OPTLA_TRANSPOSE, (optla_cblock){x, m, 1, m, type}, (optla_block){y, n, 1, n, type});
	for (size_t k = 0; !status && k < n; k++) s[k] = cli_get(y, type, k);
	optla_free(run->ctx, x);
	optla_free(run->ctx, y);
	return status;
}

static optla_status rig_rows(const cli_run *run, optla_rig *rig, const dual_verb_options *o, size_t nrows, double *r)
{
	if (is_all(o->dual.light)) {
		for (size_t k = 0; k < nrows; k++) r[k] = 1;
		return OPTLA_OK;
	}
	optla_image *image = NULL;
	OPTLA_TRY(cli_load_linear(run, o->dual.light, &image));
	optla_status status = optla_rig_values(rig, image, o->op.channel, r);
	for (size_t k = 0; !status && k < nrows; k++)
		if (!(r[k] >= 0)) status = negative(run, o->dual.light);
	optla_image_destroy(&image);
	return status;
}

static optla_status dual_rig(cli_run *run, const char *path)
{
	dual_verb_options o = *(const dual_verb_options *)run->options;
	optla_rig *rig = NULL;
	OPTLA_TRY(cli_open_rig(run, path, &rig));
	optla_rig_info info;
	optla_rig_get_info(rig, &info);
	optla_op *op = NULL;
	double *r = NULL, *s = optla_array_(run->ctx, info.nlights, sizeof *s);
	optla_status status = OPTLA_OK;
	if (!info.has_transpose)
		status =
		    cli_fail(run, OPTLA_ERR_UNSUPPORTED,
		             "%s: this rig has no camera on the projector's side ('transpose: false'), it can't take a dual photo", path);
	if (!status) status = cli_check_grid(run, info.light_width, run->shared.out);
	cli_default_sensor(&info, &o.sensor);
	if (!status) status = cli_take_sensor(run, &o.sensor, 0, &o.op);
	if (!status) status = s ? optla_rig_light_operator(rig, &o.op, &op) : OPTLA_ERR_NOMEM;
	if (!status) {
		r = optla_array_(run->ctx, optla_op_nrows(op), sizeof *r);
		status = r ? rig_rows(run, rig, &o, optla_op_nrows(op), r) : OPTLA_ERR_NOMEM;
	}
	if (!status) status = expose(run, op, r, s);
	if (!status) {
		const cli_lights lights = {info.nlights, info.light_width, info.light_height};
		const optla_op_cost cost = optla_op_cost_so_far(op);
		cli_cost(run, cost.photos, cost.exposure_s);
		cli_say(run, "dual photo: %llu photo%s from the projector's side\n", (unsigned long long)cost.photos,
		        cost.photos == 1 ? "" : "s");
		status = cli_save_lights(run, &lights, s, 1, &o.picture, run->shared.out);
	}
	optla_free(run->ctx, r);
	optla_free(run->ctx, s);
	optla_op_unref(&op);
	optla_rig_destroy(&rig);
	return status;
}

static optla_status run_dual(cli_run *run)
{
	OPTLA_TRY(cli_check_lights(run, run->shared.out));
	cli_input input;
	OPTLA_TRY(cli_input_of(run, run->arguments[0], &input));
	if (input == CLI_INPUT_HDF5) return dual_model(run, run->arguments[0]);
	if (input == CLI_INPUT_YAML) return dual_rig(run, run->arguments[0]);
	return cli_fail(run, OPTLA_ERR_INPUT, "'%s' is %s: dual needs a model (.h5) or a rig file", run->arguments[0],
	                cli_input_name(input));
}

static const cli_argument arguments[] = {
    {"MODEL|RIG", "Model that 'krylov' captured, or a rig file: the rig then takes the photo from the projector's side.", false,
     false}};
static const cli_group groups[] = {
    {&dual_table, offsetof(dual_verb_options, dual), NULL, "Light"},
    {&cli_picture_table, offsetof(dual_verb_options, picture), NULL, "Pictures"},
    {&cli_sensor_table, offsetof(dual_verb_options, sensor), NULL, "How a rig takes the photo"},
    {&optla_rig_operator_table, offsetof(dual_verb_options, op), "split", "Exposure of a rig"},
};
static const cli_topic topics[] = {{"Sensors", optla_sensor_preset_name}};
static const cli_example examples[] = {
    {"optla dual model.h5 -o dual.png", "The scene as the projector sees it, lit from where the camera is."},
    {"optla dual model.h5 --light spot.exr -o dual.exr", "The same when the camera shines a picture."},
    {"optla dual corner.yaml --sensor ccd-12bit -o dual.exr", "Photographed by a rig that has a camera on the projector's side."},
};

const cli_verb cli_verb_dual = {
    .name = "dual",
    .summary = "make the photo that the projector would take",
    .description = "Camera and projector swap: the dual photo s = T' r (Eq. 1.12) shows the scene from where the projector is, "
                   "lit from where the "
                   "camera is. It is computed from a captured model, or photographed by a rig that has a camera on both sides.",
    .out = "The dual photo: a picture on the projector's grid, or .csv, .npy with one number per light.",
    .out_required = true,
    .arguments = arguments,
    .narguments = CLI_COUNT(arguments),
    .options_size = sizeof(dual_verb_options),
    .groups = groups,
    .ngroups = CLI_COUNT(groups),
    .topics = topics,
    .ntopics = CLI_COUNT(topics),
    .examples = examples,
    .nexamples = CLI_COUNT(examples),
    .run = run_dual,
};
