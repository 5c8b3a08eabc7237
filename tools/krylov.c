/* SPDX-License-Identifier: BSD-3-Clause */
/* optla krylov: captures light transport, solves for an illumination, or finds the strongest one, by optical Krylov methods. */
#include "h5_list.h"
#include "inputs.h"
#include "krylov_job.h"
#include "verbs.h"

#include "base/base_impl.h"

#include <string.h>

static const krylov_extra_options extra_defaults = {.size = sizeof extra_defaults, .high = true, .truth = true};
static const optla_option extra_fields[] = {
    {"target", offsetof(krylov_extra_options, target), OPTLA_OPTION_STRING, "IMAGE", 0, 0, NULL,
     "GMRES: the photo to be made, an image of the camera's size."},
    {"state", offsetof(krylov_extra_options, state), OPTLA_OPTION_STRING, "FILE", 0, 0, NULL,
     "Writes the run with all its photos (HDF5), at the end and when it is stopped by Ctrl-C, to be continued with --resume."},
    {"resume", offsetof(krylov_extra_options, resume), OPTLA_OPTION_STRING, "FILE", 0, 0, NULL,
     "Continues the run of this state file; -K counts the iterations before it too. Noise of the photos to come is drawn anew."},
    {"high", offsetof(krylov_extra_options, high), OPTLA_OPTION_BOOL, "", 0, 0, NULL,
     "Arnoldi, SVD on a colour camera with --channel grey: keeps all channels of each photo (Eq. 2.10, section 2.4)."},
    {"truth", offsetof(krylov_extra_options, truth), OPTLA_OPTION_BOOL, "", 0, 0, NULL,
     "Compares the result with the exact T of the rig."},
};
static const optla_option_table extra_table = {"krylov verb", sizeof(krylov_extra_options), &extra_defaults, extra_fields,
                                               CLI_COUNT(extra_fields)};

static const char *const methods[] = {"power", "arnoldi", "gmres", "svd"};

static const char *method_at(const void *user, size_t k)
{
	(void)user;
	return k < CLI_COUNT(methods) ? methods[k] : NULL;
}

static optla_status find_method(krylov_job *j, const char *word)
{
	for (size_t k = 0; k < CLI_COUNT(methods); k++)
		if (!strcmp(methods[k], word)) {
			j->method = (optla_krylov_method)k;
			j->method_name = methods[k];
			return OPTLA_OK;
		}
	const char *near = cli_nearest(word, method_at, NULL);
	return cli_fail(j->run, OPTLA_ERR_ARG, "there is no method '%s'%s%s%s: allowed are arnoldi, svd, gmres, power", word,
	                near ? " (did you mean '" : "", near ? near : "", near ? "'?)" : "");
}

static optla_status check_options(krylov_job *j)
{
	const cli_run *run = j->run;
	const krylov_extra_options *e = &j->o.extra;
	if (j->method == OPTLA_KRYLOV_GMRES && !e->target)
		return cli_fail(run, OPTLA_ERR_ARG, "gmres needs '--target IMAGE': the photo that the illumination is to make");
	if (j->method != OPTLA_KRYLOV_GMRES && e->target)
		return cli_fail(run, OPTLA_ERR_ARG, "option 'target' belongs to gmres, not to %s", j->method_name);
	if (!run->shared.out && !e->state)
		return cli_fail(run, OPTLA_ERR_ARG,
		                "'krylov' needs '-o PATH' (the result) or '--state FILE' (the run): nothing would be kept");
	if (krylov_is_capture(j))
		OPTLA_TRY(cli_check_output(run, run->shared.out));
	else
		OPTLA_TRY(cli_check_lights(run, run->shared.out));
	OPTLA_TRY(cli_check_output(run, e->state));
	return cli_take_sensor(run, &j->o.sensor, 0, &j->o.op);
}

static optla_status make_operators(krylov_job *j)
{
	OPTLA_TRY(optla_rig_operator(j->rig, &j->o.op, &j->op));
	if (!krylov_is_capture(j) || !j->o.extra.high || j->o.op.channel != OPTLA_CHANNEL_GREY || j->info.channels < 2)
		return OPTLA_OK;
	optla_rig_operator_options high = j->o.op;
	high.channel = OPTLA_CHANNEL_ALL;
	OPTLA_TRY(cli_take_sensor(j->run, &j->o.sensor, 1, &high));
	OPTLA_TRY(optla_rig_operator(j->rig, &high, &j->high));
	return optla_rig_grey_reduction(j->rig, optla_op_type(j->op), &j->reduce);
}

static optla_status read_target(krylov_job *j)
{
	if (!j->o.extra.target) return OPTLA_OK;
	optla_ctx *ctx = j->run->ctx;
	const size_t n = optla_op_nrows(j->op);
	optla_image *image = NULL;
	double *values = optla_array_(ctx, n, sizeof *values);
	j->target = optla_array_(ctx, n, optla_scalar_bytes(optla_op_type(j->op)));
	optla_status status = values && j->target ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (!status) status = cli_load_linear(j->run, j->o.extra.target, &image);
	if (!status) status = optla_rig_values(j->rig, image, j->o.op.channel, values);
	for (size_t m = 0; !status && m < n; m++) {
		if (optla_op_type(j->op) == OPTLA_F32)
			((float *)j->target)[m] = (float)values[m];
		else
			((double *)j->target)[m] = values[m];
	}
	optla_image_destroy(&image);
	optla_free(ctx, values);
	return status;
}

/* The library takes the method from the file; the command line names it too, and may be mistaken. Photos to come get noise of their own. */
static optla_status check_resumed(krylov_job *j)
{
	cli_h5_list list;
	cli_input input;
	OPTLA_TRY(cli_input_of(j->run, j->o.extra.resume, &input)); /* says so when there is no such file */
	optla_status status = cli_h5_read_list(j->run, j->o.extra.resume, &list);
	const cli_h5_attribute *method = status ? NULL : cli_h5_find_attribute(&list, "method");
	if (method && method->text && strcmp(method->text, j->method_name))
		status = cli_fail(j->run, OPTLA_ERR_INPUT, "'%s' is a run of %s, it can't be resumed as %s", j->o.extra.resume,
		                  method->text, j->method_name);
	const cli_h5_attribute *taken = status ? NULL : cli_h5_find_attribute(&list, "photos_taken");
	if (taken && !taken->text && taken->number >= 0 && taken->number < 0x1p53) j->o.op.first_readout = (uint64_t)taken->number;
	cli_h5_list_clear(&list);
	return status;
}

static optla_status prepare(krylov_job *j)
{
	OPTLA_TRY(cli_open_rig(j->run, j->run->arguments[1], &j->rig));
	optla_rig_get_info(j->rig, &j->info);
	if (j->o.extra.resume) OPTLA_TRY(check_resumed(j));
	cli_default_sensor(&j->info, &j->o.sensor);
	OPTLA_TRY(cli_take_sensor(j->run, &j->o.sensor, 0, &j->o.op));
	if (!cli_given(j->run, "symmetric")) j->o.krylov.symmetric = j->info.symmetric;
	if (!j->o.krylov.symmetric) OPTLA_TRY(cli_check_transpose(j->run, &j->info, j->method_name));
	if (!krylov_is_capture(j)) OPTLA_TRY(cli_check_grid(j->run, j->info.light_width, j->run->shared.out));
	if (!cli_given(j->run, "iterations") && !j->o.extra.resume)
		j->o.krylov.iterations = cli_iterations(&j->info, j->o.krylov.iterations);
	OPTLA_TRY(make_operators(j));
	OPTLA_TRY(read_target(j));
	const optla_krylov_problem problem = {
	    .size = sizeof problem, .op = j->op, .high = j->high, .reduce = j->reduce, .target = j->target};
	if (j->o.extra.resume) return optla_krylov_resume(&problem, &j->o.krylov, j->o.extra.resume, &j->krylov);
	return optla_krylov_create(&problem, j->method, &j->o.krylov, &j->krylov);
}

static optla_status stopped(krylov_job *j)
{
	const optla_krylov_info i = optla_krylov_get_info(j->krylov);
	if (!j->o.extra.state || !i.iterations) {
		optla_log_(j->run->ctx, 0, "stopped after %zu iterations, nothing was written%s", i.iterations,
		           j->o.extra.state ? "" : " (--state FILE would have kept the photos)");
		return OPTLA_ERR_CANCELLED;
	}
	if (OPTLA_OK == optla_krylov_save(j->krylov, j->o.extra.state))
		optla_log_(j->run->ctx, 0, "stopped after %zu iterations and %llu photos, kept in '%s': go on with '--resume %s'",
		           i.iterations, (unsigned long long)i.photos, j->o.extra.state, j->o.extra.state);
	return OPTLA_ERR_CANCELLED;
}

static optla_status work(krylov_job *j)
{
	OPTLA_TRY(find_method(j, j->run->arguments[0]));
	OPTLA_TRY(check_options(j));
	OPTLA_TRY(prepare(j));
	const optla_status status = optla_krylov_run(j->krylov);
	if (status == OPTLA_ERR_CANCELLED) return stopped(j);
	OPTLA_TRY(status);
	const optla_krylov_info info = optla_krylov_get_info(j->krylov);
	krylov_say_info(j, &info);
	cli_text(j->run, "relative_error", NULL);
	if (j->o.extra.state) OPTLA_TRY(optla_krylov_save(j->krylov, j->o.extra.state));
	if (j->o.extra.truth) OPTLA_TRY(optla_rig_truth(j->rig, j->o.op.channel, &j->truth));
	return krylov_save_result(j);
}

static optla_status run_krylov(cli_run *run)
{
	krylov_job j = {.run = run, .o = *(const krylov_verb_options *)run->options};
	const optla_status status = work(&j);
	optla_model_destroy(&j.model);
	optla_krylov_destroy(&j.krylov);
	optla_op_unref(&j.op);
	optla_op_unref(&j.high);
	optla_op_unref(&j.reduce);
	optla_op_unref(&j.truth);
	optla_free(run->ctx, j.target);
	optla_free(run->ctx, j.lights);
	optla_rig_destroy(&j.rig);
	return status;
}

static const cli_argument arguments[] = {{"METHOD",
                                          "arnoldi: captures T, at about its best rank-K approximation (Algorithm 2); svd: its "
                                          "leading singular triplets; gmres: the illumination "
                                          "that makes a target photo (Eq. 2.9); power: the principal eigenvector of a coaxial "
                                          "rig, else the leading singular vector (Algorithm 1).",
                                          false, false},
                                         {"RIG", "Rig file (YAML).", false, false}};
static const cli_group groups[] = {
    {&optla_krylov_table, offsetof(krylov_verb_options, krylov), NULL, "The method"},
    {&extra_table, offsetof(krylov_verb_options, extra), NULL, "Input and output"},
    {&cli_sensor_table, offsetof(krylov_verb_options, sensor), NULL, "How photos are taken"},
    {&optla_rig_operator_table, offsetof(krylov_verb_options, op), NULL, "Exposure"},
    {&cli_picture_table, offsetof(krylov_verb_options, picture), NULL, "Pictures"},
};
static const cli_topic topics[] = {{"Sensors", optla_sensor_preset_name}};
static const cli_example examples[] = {
    {"optla krylov arnoldi corner.yaml -K 20 -o model.h5",
     "Captures the light transport of a rig with 20 Arnoldi iterations, through the sensor that the rig file names."},
    {"optla krylov arnoldi ball.yaml -K 30 --sensor dslr-14bit --noise-stop -o model.h5 --json run.json",
     "The same through a 14-bit camera; stops when more photos can't help; photos, exposure, errors and times as JSON."},
    {"optla krylov svd ball.yaml -K 40 --rank 10 --budget-photos 160 -o model.h5",
     "Ten singular triplets from at most 160 photos."},
    {"optla krylov gmres corner.yaml -K 20 --target photo.exr --nonnegative nnls -o light.exr",
     "The illumination, without negative light, that makes a photo."},
    {"optla krylov arnoldi ball.yaml -K 200 --state run.h5 -o model.h5",
     "Keeps the run; after Ctrl-C go on with 'optla krylov arnoldi ball.yaml -K 200 --resume run.h5 --state run.h5 -o "
     "model.h5'."},
};

const cli_verb cli_verb_krylov = {
    .name = "krylov",
    .summary = "capture or invert light transport from few photos",
    .description = "Runs a Krylov method on the light transport T of a rig. Each product with T is made of photos: signed "
                   "patterns are split into light (two "
                   "photos by sign, or one by offset), each photo goes through the sensor and back.\n\n"
                   "Prints what it cost and how good it is: photos, exposure time, residual recomputed from the photos, and, as "
                   "the exact T of a rig is known, "
                   "the relative error of Eq. 2.11.",
    .out = "Where the result goes: arnoldi, svd: the captured model (.h5), for 'relight' and 'dual'; gmres, power: an "
           "illumination (.csv, .npy, or a "
           "picture when the lights are on a grid).",
    .arguments = arguments,
    .narguments = CLI_COUNT(arguments),
    .options_size = sizeof(krylov_verb_options),
    .groups = groups,
    .ngroups = CLI_COUNT(groups),
    .topics = topics,
    .ntopics = CLI_COUNT(topics),
    .examples = examples,
    .nexamples = CLI_COUNT(examples),
    .run = run_krylov,
};
