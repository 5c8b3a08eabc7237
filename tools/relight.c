/* SPDX-License-Identifier: BSD-3-Clause */
/* optla relight: the scene under another light, from a captured model or photographed by a rig. */
#include "inputs.h"
#include "rig_run.h"
#include "verbs.h"

#include "optla/relight.h"

#include "base/base_impl.h"

#include <math.h>

typedef struct {
	size_t size;
	const char *light, *reference;
} relight_options;

typedef struct {
	relight_options relight;
	cli_sensor_options sensor;
	optla_rig_operator_options op;
	cli_picture_options picture;
} relight_verb_options;

static const relight_options relight_defaults = {.size = sizeof relight_defaults};
static const optla_option relight_fields[] = {
    {"light", offsetof(relight_options, light), OPTLA_OPTION_STRING, "SPEC", 0, 0, NULL,
     "Which light: 'all'; 'light:7' or 'light:7=0.5,9=1' (from 0); 'point:AZIMUTH,ELEVATION' in degrees as the scene sees it "
     "(azimuth 180 is where the camera is, 90 its right, 0 behind the scene; elevation is up); a file of one number per light "
     "(.npy, "
     ".csv, .txt); a picture of the projector's size; 'env:FILE', a latitude-longitude picture. Pictures in colour give coloured "
     "light."},
    {"reference", offsetof(relight_options, reference), OPTLA_OPTION_STRING, "FILE", 0, 0, NULL,
     "Compares the result with this image, or with what this rig would show under the same light without noise."},
};
static const optla_option_table relight_table = {"relight", sizeof(relight_options), &relight_defaults, relight_fields,
                                                 CLI_COUNT(relight_fields)};

/* y = T_c p_c for each colour through one operator for each, or all channels at once under white light. */
static optla_status expose(const cli_run *run, optla_op *op, const double *p, double *y)
{
	const size_t n = optla_op_ncols(op), m = optla_op_nrows(op);
	const optla_scalar type = optla_op_type(op);
	void *x = optla_array_(run->ctx, n, optla_scalar_bytes(type)), *z = optla_array_(run->ctx, m, optla_scalar_bytes(type));
	optla_status status = x && z ? OPTLA_OK : OPTLA_ERR_NOMEM;
	for (size_t k = 0; !status && k < n; k++) cli_set(x, type, k, p[k]);
	if (!status) status = optla_op_apply(op, OPTLA_FORWARD, (optla_cblock){x, n, 1, n, type}, (optla_block){z, m, 1, m, type});
	for (size_t k = 0; !status && k < m; k++) y[k] = cli_get(z, type, k);
	optla_free(run->ctx, x);
	optla_free(run->ctx, z);
	return status;
}

typedef struct {
	uint64_t photos;
	double exposure_s;
} cost;

/* The photo of a rig under p, through the sensor or (truth) without; npixels * channels values. */
static optla_status photograph(const cli_run *run, optla_rig *rig, const double *p, size_t light_channels, bool truth, double *y,
                               cost *c)
{
	const relight_verb_options *o = run->options;
	optla_rig_info info;
	optla_rig_get_info(rig, &info);
	const size_t colours = light_channels == 3 ? 3 : 1;
	cli_sensor_options sensor = o->sensor;
	cli_default_sensor(&info, &sensor);
	for (size_t k = 0; k < colours; k++) {
		optla_rig_operator_options op_options = o->op;
		op_options.channel = colours == 3 ? (optla_channel)(OPTLA_CHANNEL_RED + k) : OPTLA_CHANNEL_ALL;
		OPTLA_TRY(cli_take_sensor(run, &sensor, k, &op_options));
		optla_op *op = NULL;
		OPTLA_TRY(truth ? optla_rig_truth(rig, op_options.channel, &op) : optla_rig_light_operator(rig, &op_options, &op));
		const optla_status status = expose(run, op, p + k * info.nlights, y + k * info.npixels);
		const optla_op_cost spent = optla_op_cost_so_far(op);
		c->photos += truth ? 0 : spent.photos;
		c->exposure_s += truth ? 0 : spent.exposure_s;
		optla_op_unref(&op);
		OPTLA_TRY(status);
	}
	return OPTLA_OK;
}

static optla_status light_of_rig(const cli_run *run, optla_rig *rig, double **p, size_t *light_channels)
{
	const relight_verb_options *o = run->options;
	optla_rig_info info;
	optla_rig_get_info(rig, &info);
	OPTLA_TRY(cli_light_channels(run, o->relight.light, info.channels, light_channels));
	*p = optla_array_(run->ctx, info.nlights * *light_channels, sizeof **p);
	return *p ? optla_rig_light_vector(rig, o->relight.light, *light_channels, *p) : OPTLA_ERR_NOMEM;
}

static optla_status relight_rig(cli_run *run, const char *path, bool truth, optla_image **image)
{
	optla_rig *rig = NULL;
	OPTLA_TRY(cli_open_rig(run, path, &rig));
	optla_rig_info info;
	optla_rig_get_info(rig, &info);
	double *p = NULL, *y = optla_array_(run->ctx, info.npixels * info.channels, sizeof *y);
	size_t light_channels = 1;
	cost spent = {0};
	optla_status status = y ? light_of_rig(run, rig, &p, &light_channels) : OPTLA_ERR_NOMEM;
	if (!status) status = photograph(run, rig, p, light_channels, truth, y, &spent);
	if (!status) status = optla_rig_image(rig, y, info.channels, image);
	if (!status && !truth) {
		cli_cost(run, spent.photos, spent.exposure_s);
		cli_say(run, "photographed under %s light: %llu photo%s, %.4g s of exposure\n",
		        light_channels == 3 ? "coloured" : "white", (unsigned long long)spent.photos, spent.photos == 1 ? "" : "s",
		        spent.exposure_s);
	}
	optla_free(run->ctx, p);
	optla_free(run->ctx, y);
	optla_rig_destroy(&rig);
	return status;
}

static optla_status relight_model(cli_run *run, const char *path, optla_image **image)
{
	const relight_verb_options *o = run->options;
	optla_ctx *ctx = run->ctx;
	optla_model *model = NULL;
	OPTLA_TRY(optla_model_load(ctx, path, &model));
	size_t light_channels = 1;
	optla_status status = cli_light_channels(run, o->relight.light, model->channels, &light_channels);
	const size_t n = model->nlights * light_channels, m = model->npixels * model->channels;
	double *p = optla_array_(ctx, n, sizeof *p);
	float *x = optla_array_(ctx, n, sizeof *x), *y = optla_array_(ctx, m, sizeof *y);
	if (!status && (!p || !x || !y)) status = OPTLA_ERR_NOMEM;
	if (!status) status = optla_model_light_vector(model, o->relight.light, light_channels, p);
	double seconds = 0;
	if (!status) {
		for (size_t k = 0; k < n; k++) x[k] = (float)p[k];
		const double began_s = optla_now_s_();
		status = optla_relight(model, x, light_channels, y);
		seconds = optla_now_s_() - began_s;
	}
	if (!status) status = optla_model_image(model, y, image);
	if (!status) {
		cli_number(run, "rank", (double)model->rank);
		cli_number(run, "relight_s", seconds);
		cli_cost(run, model->photos_taken, model->exposure_s);
		cli_say(run, "%zu x %zu, %zu channel%s, from rank %zu (%llu photos) under %s light: %.2f ms\n", model->width,
		        model->height, model->channels, model->channels == 1 ? "" : "s", model->rank,
		        (unsigned long long)model->photos_taken, light_channels == 3 ? "coloured" : "white", 1e3 * seconds);
	}
	optla_free(ctx, p);
	optla_free(ctx, x);
	optla_free(ctx, y);
	optla_model_destroy(&model);
	return status;
}

static optla_status compare(cli_run *run, const optla_image *image)
{
	const relight_verb_options *o = run->options;
	cli_input input;
	optla_image *reference = NULL, *grey = NULL;
	OPTLA_TRY(cli_input_of(run, o->relight.reference, &input));
	optla_status status = input == CLI_INPUT_YAML ? relight_rig(run, o->relight.reference, true, &reference)
	                                              : cli_load_linear(run, o->relight.reference, &reference);
	if (!status && image->channels == 1 && reference->channels > 1) {
		status = optla_image_grey(reference, &grey); /* the model was captured in grey */
		if (!status) {
			optla_image_destroy(&reference);
			reference = grey;
		}
	}
	if (!status &&
	    (reference->width != image->width || reference->height != image->height || reference->channels != image->channels))
		status = cli_fail(run, OPTLA_ERR_SHAPE, "'%s' is %zu x %zu x %zu, the relit image %zu x %zu x %zu", o->relight.reference,
		                  reference->width, reference->height, reference->channels, image->width, image->height, image->channels);
	if (!status) {
		double d2 = 0, r2 = 0, peak = 0;
		const size_t n = image->width * image->height * image->channels;
		for (size_t k = 0; k < n; k++) {
			const double r = reference->data[k], e = image->data[k] - r;
			d2 += e * e;
			r2 += r * r;
			peak = fmax(peak, fabs(r));
		}
		const double psnr = 10 * log10(peak * peak * (double)n / d2);
		cli_number(run, "relative_error", sqrt(d2 / r2));
		cli_number(run, "psnr_db", psnr);
		cli_say(run, "beside the reference: relative error %.4g, PSNR %.2f dB\n", sqrt(d2 / r2), psnr);
	}
	optla_image_destroy(&reference);
	return status;
}

static optla_status run_relight(cli_run *run)
{
	const relight_verb_options *o = run->options;
	if (!o->relight.light)
		return cli_fail(run, OPTLA_ERR_ARG, "'relight' needs '--light SPEC': which light to show the scene under");
	OPTLA_TRY(cli_check_picture(run, run->shared.out));
	optla_rig_operator_options unused;
	OPTLA_TRY(cli_take_sensor(run, &o->sensor, 0, &unused)); /* a wrong name is wrong for a model too */
	cli_input input;
	OPTLA_TRY(cli_input_of(run, run->arguments[0], &input));
	optla_image *image = NULL;
	optla_status status;
	if (input == CLI_INPUT_HDF5)
		status = relight_model(run, run->arguments[0], &image);
	else if (input == CLI_INPUT_YAML)
		status = relight_rig(run, run->arguments[0], false, &image);
	else
		status = cli_fail(run, OPTLA_ERR_INPUT, "'%s' is %s: relight needs a model (.h5) or a rig file", run->arguments[0],
		                  cli_input_name(input));
	if (!status && o->relight.reference) status = compare(run, image);
	if (!status) status = cli_save_picture(run, image, &o->picture, run->shared.out);
	optla_image_destroy(&image);
	return status;
}

static const cli_argument arguments[] = {
    {"MODEL|RIG", "Model that 'krylov' captured, or a rig file: the rig then takes a photo under that light.", false, false}};
static const cli_group groups[] = {
    {&relight_table, offsetof(relight_verb_options, relight), NULL, "Light"},
    {&cli_picture_table, offsetof(relight_verb_options, picture), NULL, "Pictures"},
    {&cli_sensor_table, offsetof(relight_verb_options, sensor), NULL, "How a rig takes the photo"},
    {&optla_rig_operator_table, offsetof(relight_verb_options, op), "channel|split", "Exposure of a rig"},
};
static const cli_topic topics[] = {{"Sensors", optla_sensor_preset_name}};
static const cli_example examples[] = {
    {"optla relight model.h5 --light env:sky.exr -o relit.png",
     "The scene under an environment picture, brought to display brightness."},
    {"optla relight model.h5 --light point:30,45 -o relit.exr", "One distant light, linear values as they are."},
    {"optla relight ball.yaml --light light:17 --sensor ccd-12bit -o photo.exr", "A photo that the rig takes with light 17."},
    {"optla relight model.h5 --light light:17 --reference ball.yaml -o relit.png", "How near does the model come to the rig?"},
};

const cli_verb cli_verb_relight = {
    .name = "relight",
    .summary = "show a scene under another light",
    .description = "Combines the photos of a captured model into the photo under any light, i = D (P' p) (Eqs. 2.7 and 2.10), or "
                   "lets a rig take "
                   "that photo.",
    .out = "The picture: .exr, .tif, .pfm, .npy hold linear values, .png a display-referred picture.",
    .out_required = true,
    .arguments = arguments,
    .narguments = CLI_COUNT(arguments),
    .options_size = sizeof(relight_verb_options),
    .groups = groups,
    .ngroups = CLI_COUNT(groups),
    .topics = topics,
    .ntopics = CLI_COUNT(topics),
    .examples = examples,
    .nexamples = CLI_COUNT(examples),
    .run = run_relight,
};
