/* SPDX-License-Identifier: BSD-3-Clause */
/* optla invert: the illumination that reproduces a target photo, colour channel by colour channel (sections 2.3 and 2.4). */
#include "inputs.h"
#include "rig_run.h"
#include "verbs.h"

#include "optla/krylov.h"

#include "base/base_impl.h"

#include <math.h>

typedef struct {
	size_t size;
	const char *target, *photo;
} invert_options;

typedef struct {
	invert_options invert;
	optla_krylov_options krylov;
	cli_sensor_options sensor;
	optla_rig_operator_options op;
	cli_picture_options picture;
} invert_verb_options;

static const invert_options invert_defaults = {.size = sizeof invert_defaults};
static const optla_option invert_fields[] = {
    {"target", offsetof(invert_options, target), OPTLA_OPTION_STRING, "IMAGE", 0, 0, NULL,
     "The photo to be made: an image of the camera's size; in colour it is solved channel by channel."},
    {"photo", offsetof(invert_options, photo), OPTLA_OPTION_STRING, "FILE", 0, 0, NULL,
     "Writes the photo of the scene under the illumination found."},
};
static const optla_option_table invert_table = {"invert", sizeof(invert_options), &invert_defaults, invert_fields,
                                                CLI_COUNT(invert_fields)};

typedef struct {
	cli_run *run;
	invert_verb_options o;
	optla_rig *rig;
	optla_rig_info info;
	optla_image *target;
	size_t colours;         /* channels that are solved */
	double *lights, *photo; /* nlights x colours, npixels x colours */
	uint64_t photos, saved;
	double exposure_s, seconds_operator, seconds_total;
	double d2, i2; /* sums over all channels, of the photo found and of the target */
	int iterations;
} job;

static const char *const colour_names[] = {"red", "green", "blue"};

/* One product with the signed operator: a photo under p, which may hold negative light. */
static optla_status photograph(job *j, optla_op *op, const void *p, const double *target, double *photo)
{
	const size_t n = optla_op_ncols(op), m = optla_op_nrows(op);
	const optla_scalar type = optla_op_type(op);
	void *y = optla_array_(j->run->ctx, m, optla_scalar_bytes(type));
	optla_status status = y ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (!status) status = optla_op_apply(op, OPTLA_FORWARD, (optla_cblock){p, n, 1, n, type}, (optla_block){y, m, 1, m, type});
	for (size_t k = 0; !status && k < m; k++) {
		photo[k] = cli_get(y, type, k);
		j->d2 += (photo[k] - target[k]) * (photo[k] - target[k]);
		j->i2 += target[k] * target[k];
	}
	optla_free(j->run->ctx, y);
	return status;
}

static void report_channel(job *j, json_t *list, const char *name, const optla_krylov_info *i, double residual, const double *p,
                           size_t n)
{
	double negative = 0, all = 0;
	for (size_t k = 0; k < n; k++) {
		all += fabs(p[k]);
		negative += fmax(0, -p[k]);
	}
	const double share = all > 0 ? negative / all : 0;
	json_t *object = json_object();
	json_object_set_new(object, "channel", json_string(name));
	cli_json_number(object, "iterations", (double)i->iterations);
	cli_json_number(object, "photos", (double)i->photos);
	cli_json_number(object, "residual", residual);
	cli_json_number(object, "negative_light", share);
	json_object_set_new(object, "stop", json_string(optla_stop_name(i->stop)));
	json_array_append_new(list, object);
	cli_say(j->run, "  %-6s iterations %zu (%s), photos %llu, residual %.4g, negative light %.3g %%\n", name, i->iterations,
	        optla_stop_name(i->stop), (unsigned long long)i->photos, residual, 100 * share);
}

static optla_status solve(job *j, optla_op *op, const void *target, const double *target_values, size_t colour, const char *name,
                          json_t *list)
{
	const size_t n = optla_op_ncols(op);
	const optla_scalar type = optla_op_type(op);
	const optla_krylov_problem problem = {.size = sizeof problem, .op = op, .target = target};
	optla_krylov *krylov = NULL;
	double residual, *lights = j->lights + colour * n;
	void *p = optla_array_(j->run->ctx, n, optla_scalar_bytes(type));
	optla_status status = p ? optla_krylov_create(&problem, OPTLA_KRYLOV_GMRES, &j->o.krylov, &krylov) : OPTLA_ERR_NOMEM;
	if (!status) status = optla_krylov_run(krylov);
	if (!status) status = optla_krylov_solution(krylov, 0, p, &residual);
	if (!status) {
		const optla_krylov_info i = optla_krylov_get_info(krylov);
		for (size_t k = 0; k < n; k++) lights[k] = cli_get(p, type, k);
		report_channel(j, list, name, &i, residual, lights, n);
		j->photos += i.photos;
		j->saved += i.photos_saved;
		j->exposure_s += i.exposure_s;
		j->seconds_operator += i.seconds_operator;
		j->seconds_total += i.seconds_total;
		if ((int)i.iterations > j->iterations) j->iterations = (int)i.iterations;
		status = photograph(j, op, p, target_values, j->photo + colour * j->info.npixels);
	}
	optla_krylov_destroy(&krylov);
	optla_free(j->run->ctx, p);
	return status;
}

static optla_status solve_channel(job *j, size_t colour, json_t *list)
{
	optla_rig_operator_options options = j->o.op;
	if (j->colours == 3) options.channel = (optla_channel)(OPTLA_CHANNEL_RED + colour);
	OPTLA_TRY(cli_take_sensor(j->run, &j->o.sensor, colour, &options));
	optla_op *op = NULL;
	OPTLA_TRY(optla_rig_operator(j->rig, &options, &op));
	const size_t m = optla_op_nrows(op);
	const optla_scalar type = optla_op_type(op);
	double *values = optla_array_(j->run->ctx, m, sizeof *values);
	void *target = optla_array_(j->run->ctx, m, optla_scalar_bytes(type));
	optla_status status = values && target ? optla_rig_values(j->rig, j->target, options.channel, values) : OPTLA_ERR_NOMEM;
	if (!status) {
		for (size_t k = 0; k < m; k++) cli_set(target, type, k, values[k]);
		status = solve(j, op, target, values, colour, j->colours == 3 ? colour_names[colour] : cli_channel_name(options.channel),
		               list);
	}
	optla_free(j->run->ctx, values);
	optla_free(j->run->ctx, target);
	optla_op_unref(&op);
	return status;
}

static optla_status prepare(job *j)
{
	cli_run *run = j->run;
	if (!j->o.invert.target)
		return cli_fail(run, OPTLA_ERR_ARG, "'invert' needs '--target IMAGE': the photo that the illumination is to make");
	if (j->o.op.channel == OPTLA_CHANNEL_ALL)
		return cli_fail(run, OPTLA_ERR_ARG,
		                "option 'channel': invert takes grey or one colour; a colour target is solved channel by channel");
	OPTLA_TRY(cli_check_lights(run, run->shared.out));
	OPTLA_TRY(cli_check_picture(run, j->o.invert.photo));
	OPTLA_TRY(cli_open_rig(run, run->arguments[0], &j->rig));
	optla_rig_get_info(j->rig, &j->info);
	OPTLA_TRY(cli_check_grid(run, j->info.light_width, run->shared.out));
	OPTLA_TRY(cli_load_linear(run, j->o.invert.target, &j->target));
	cli_default_sensor(&j->info, &j->o.sensor);
	if (!cli_given(run, "symmetric")) j->o.krylov.symmetric = j->info.symmetric;
	if (!j->o.krylov.symmetric) OPTLA_TRY(cli_check_transpose(run, &j->info, "gmres"));
	if (!cli_given(run, "iterations")) j->o.krylov.iterations = cli_iterations(&j->info, j->o.krylov.iterations);
	j->colours = j->target->channels == 3 && j->info.channels == 3 && !cli_given(run, "channel") ? 3 : 1;
	j->lights = optla_calloc_(run->ctx, j->info.nlights * j->colours, sizeof *j->lights);
	j->photo = optla_calloc_(run->ctx, j->info.npixels * j->colours, sizeof *j->photo);
	return j->lights && j->photo ? OPTLA_OK : OPTLA_ERR_NOMEM;
}

static void report(job *j)
{
	cli_run *run = j->run;
	const double error = sqrt(j->d2 / j->i2);
	cli_text(run, "rig", run->arguments[0]);
	cli_text(run, "target", j->o.invert.target);
	cli_text(run, "sensor", j->o.sensor.sensor ? j->o.sensor.sensor : "none");
	cli_cost(run, j->photos, j->exposure_s);
	cli_number(run, "iterations", j->iterations);
	cli_number(run, "photos_saved", (double)j->saved);
	cli_number(run, "relative_error", error);
	cli_number(run, "seconds_in_operator", j->seconds_operator);
	cli_number(run, "seconds_outside", j->seconds_total - j->seconds_operator);
	cli_say(run, "  photos %llu, %.4g s of exposure; relative error of the photo made %.4g\n", (unsigned long long)j->photos,
	        j->exposure_s, error);
}

static optla_status work(job *j)
{
	OPTLA_TRY(prepare(j));
	cli_run *run = j->run;
	cli_say(run, "illumination for '%s'\n", j->o.invert.target);
	json_t *list = json_array();
	json_object_set_new(run->numbers, "channels", list);
	for (size_t c = 0; c < j->colours; c++) OPTLA_TRY(solve_channel(j, c, list));
	report(j);
	const cli_lights lights = {j->info.nlights, j->info.light_width, j->info.light_height};
	OPTLA_TRY(cli_save_lights(run, &lights, j->lights, j->colours, &j->o.picture, run->shared.out));
	if (!j->o.invert.photo) return OPTLA_OK;
	optla_image *photo = NULL;
	OPTLA_TRY(optla_rig_image(j->rig, j->photo, j->colours, &photo));
	const optla_status status = cli_save_picture(run, photo, &j->o.picture, j->o.invert.photo);
	optla_image_destroy(&photo);
	return status;
}

static optla_status run_invert(cli_run *run)
{
	job j = {.run = run, .o = *(const invert_verb_options *)run->options};
	const optla_status status = work(&j);
	optla_free(run->ctx, j.lights);
	optla_free(run->ctx, j.photo);
	optla_image_destroy(&j.target);
	optla_rig_destroy(&j.rig);
	return status;
}

static const cli_argument arguments[] = {{"RIG", "Rig file (YAML).", false, false}};
static const cli_group groups[] = {
    {&invert_table, offsetof(invert_verb_options, invert), NULL, "Target"},
    {&optla_krylov_table, offsetof(invert_verb_options, krylov), "rank", "The method"},
    {&cli_picture_table, offsetof(invert_verb_options, picture), NULL, "Pictures"},
    {&cli_sensor_table, offsetof(invert_verb_options, sensor), NULL, "How photos are taken"},
    {&optla_rig_operator_table, offsetof(invert_verb_options, op), NULL, "Exposure"},
};
static const cli_topic topics[] = {{"Sensors", optla_sensor_preset_name}};
static const cli_example examples[] = {
    {"optla invert corner.yaml --target wanted.exr -K 20 -o light.exr",
     "The illumination that makes a photo, negative light allowed."},
    {"optla invert corner.yaml --target wanted.exr -K 20 --nonnegative nnls -o light.png --photo made.png",
     "Light that a projector can show, and the photo that it makes."},
    {"optla invert ball.yaml --target wanted.exr -K 30 --sensor dslr-14bit --noise-stop -o light.csv",
     "From noisy photos, no more of them than help; one line of numbers for each light."},
};

const cli_verb cli_verb_invert = {
    .name = "invert",
    .summary = "find the illumination that makes a wanted photo",
    .description = "Optical GMRES (Eq. 2.9): finds the illumination p whose photo T p is nearest to a target, from photos alone. "
                   "Negative light is "
                   "kept, cut off (clamp), or ruled out by non-negative least squares in the subspace found (nnls).",
    .out = "The illumination: a picture on the projector's grid, or .csv, .npy with a line for each light.",
    .out_required = true,
    .arguments = arguments,
    .narguments = CLI_COUNT(arguments),
    .options_size = sizeof(invert_verb_options),
    .groups = groups,
    .ngroups = CLI_COUNT(groups),
    .topics = topics,
    .ntopics = CLI_COUNT(topics),
    .examples = examples,
    .nexamples = CLI_COUNT(examples),
    .run = run_invert,
};
