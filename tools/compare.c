/* SPDX-License-Identifier: BSD-3-Clause */
/* optla compare: how far is A from B? Images, arrays, HDF5 files; of two models the matrices that they stand for. */
#include "h5_list.h"
#include "inputs.h"
#include "verbs.h"

#include "optla/op.h"
#include "optla/relight.h"

#include "base/base_impl.h"

#include <math.h>
#include <string.h>

typedef struct {
	size_t size;
	double max_rel_error;
} compare_options;

static const compare_options compare_defaults = {sizeof compare_defaults, INFINITY};
static const optla_option options[] = {
    {"max-rel-error", offsetof(compare_options, max_rel_error), OPTLA_OPTION_DOUBLE, "", 0, INFINITY, NULL,
     "Exit with status 1 when the relative error is larger than this."},
};
static const optla_option_table table = {"compare", sizeof(compare_options), &compare_defaults, options, CLI_COUNT(options)};

/* Sums over samples, a beside b. */
typedef struct {
	size_t count, not_finite;
	double sum_d2, sum_b2, max_error, peak;
} difference;

static void add(difference *d, double a, double b)
{
	d->count++;
	if (!isfinite(a) || !isfinite(b)) {
		if (a == b || (isnan(a) && isnan(b))) return; /* the same on both sides */
		d->not_finite++;
		d->max_error = d->sum_d2 = INFINITY;
		return;
	}
	const double e = a - b;
	d->sum_d2 += e * e;
	d->sum_b2 += b * b;
	d->max_error = fmax(d->max_error, fabs(e));
	d->peak = fmax(d->peak, fabs(b));
}

/* ||A - B|| / ||B|| */
static double relative(const difference *d) { return d->sum_d2 > 0 ? sqrt(d->sum_d2 / d->sum_b2) : 0; }

/* Peak signal to noise ratio in decibels. */
static double psnr_db(const difference *d, double peak) { return 10 * log10(peak * peak * (double)d->count / d->sum_d2); }

static void report(cli_run *run, const char *kind, const difference *d, double peak)
{
	const double psnr = psnr_db(d, peak);
	cli_text(run, "kind", kind);
	cli_number(run, "samples", (double)d->count);
	cli_number(run, "relative_error", relative(d));
	cli_number(run, "max_error", d->max_error);
	cli_number(run, "psnr_db", psnr);
	cli_number(run, "not_finite", (double)d->not_finite);
	cli_say(run, "%s, %zu samples\n", kind, d->count);
	cli_say(run, "relative error   %.6g\n", relative(d));
	cli_say(run, "largest error    %.6g\n", d->max_error);
	cli_say(run, "PSNR             %.4g dB (peak %.4g)\n", psnr, peak);
	if (d->not_finite) cli_say(run, "not finite       %zu samples in one of the two\n", d->not_finite);
}

static void judge(cli_run *run, double error)
{
	const compare_options *o = run->options;
	run->failed = !(error <= o->max_rel_error);
	if (!cli_given(run, "max-rel-error")) return;
	cli_number(run, "max_rel_error", o->max_rel_error);
	json_object_set_new(run->numbers, "within", json_boolean(!run->failed));
	cli_say(run, "limit            %.6g: %s%s\n", o->max_rel_error, run->failed ? "exceeded" : "met",
	        error < 0.1 * o->max_rel_error ? " (more than ten times over: a loose limit)" : "");
	if (run->failed) optla_log_(run->ctx, 0, "relative error %.6g is over the limit of %.6g", error, o->max_rel_error);
}

static optla_status compare_images(cli_run *run, const char *a_path, const char *b_path)
{
	optla_image *a = NULL, *b = NULL;
	optla_status status = optla_image_load(run->ctx, a_path, &a);
	if (!status) status = optla_image_load(run->ctx, b_path, &b);
	if (!status && (a->width != b->width || a->height != b->height || a->channels != b->channels))
		status = cli_fail(run, OPTLA_ERR_SHAPE,
		                  "'%s' is %zu x %zu x %zu, '%s' is %zu x %zu x %zu: only images of one size can be compared", a_path,
		                  a->width, a->height, a->channels, b_path, b->width, b->height, b->channels);
	if (!status && a->kind != b->kind)
		status = cli_fail(run, OPTLA_ERR_SHAPE, "'%s' is %s, '%s' is %s: only images of one kind can be compared", a_path,
		                  optla_image_kind_name(a->kind), b_path, optla_image_kind_name(b->kind));
	if (!status) {
		difference d = {0};
		const size_t n = a->width * a->height * a->channels;
		for (size_t k = 0; k < n; k++) add(&d, a->data[k], b->data[k]);
		const double peak = b->kind == OPTLA_IMAGE_DISPLAY                     ? 1
		                    : b->kind == OPTLA_IMAGE_RAW_DN && b->white_dn > 0 ? b->white_dn
		                                                                       : d.peak;
		char kind[64];
		snprintf(kind, sizeof kind, "images (%s)", optla_image_kind_name(b->kind));
		report(run, kind, &d, peak);
		judge(run, relative(&d));
	}
	optla_image_destroy(&a);
	optla_image_destroy(&b);
	return status;
}

static double sample(const optla_array *a, size_t k)
{
	return a->type == OPTLA_F32 || a->type == OPTLA_C32 ? (double)((const float *)a->data)[k] : ((const double *)a->data)[k];
}

static bool is_complex(const optla_array *a) { return a->type == OPTLA_C32 || a->type == OPTLA_C64; }

/* Numbers of one array beside another's into d; sizes must agree. */
static optla_status add_arrays(const cli_run *run, const char *a_path, const char *b_path, difference *d)
{
	optla_array *a = NULL, *b = NULL;
	optla_status status = optla_array_load(run->ctx, a_path, &a);
	if (!status) status = optla_array_load(run->ctx, b_path, &b);
	size_t n = 1;
	if (!status) {
		char a_size[128], b_size[128];
		cli_array_size(a, a_size, sizeof a_size);
		cli_array_size(b, b_size, sizeof b_size);
		if (strcmp(a_size, b_size) || is_complex(a) != is_complex(b))
			status = cli_fail(run, OPTLA_ERR_SHAPE, "'%s' is %s%s, '%s' is %s%s: only arrays of one size can be compared", a_path,
			                  a_size, is_complex(a) ? " complex" : "", b_path, b_size, is_complex(b) ? " complex" : "");
	}
	if (!status) {
		for (size_t k = 0; k < a->ndim; k++) n *= a->dims[k];
		if (is_complex(a)) n *= 2; /* real and imaginary parts are samples of their own */
		for (size_t k = 0; k < n; k++) add(d, sample(a, k), sample(b, k));
	}
	optla_array_destroy(&a);
	optla_array_destroy(&b);
	return status;
}

static optla_status compare_arrays(cli_run *run, const char *a_path, const char *b_path)
{
	difference d = {0};
	OPTLA_TRY(add_arrays(run, a_path, b_path, &d));
	report(run, "arrays", &d, d.peak);
	judge(run, relative(&d));
	return OPTLA_OK;
}

static optla_status model_operator(optla_ctx *ctx, const char *path, optla_op **op)
{
	optla_model *m = NULL;
	OPTLA_TRY(optla_model_load(ctx, path, &m));
	const size_t nrows = m->npixels * m->channels;
	const optla_cblock d = {m->photos, nrows, m->rank, nrows, OPTLA_F32},
	                   p = {m->illuminations, m->nlights, m->rank, m->nlights, OPTLA_F32};
	const optla_status status = optla_op_lowrank(ctx, d, p, op);
	optla_model_destroy(&m);
	return status;
}

/* ||D Pᵀ of A - D Pᵀ of B||_F / ||D Pᵀ of B||_F: the factors of one T may differ, T may not. */
static optla_status compare_models(cli_run *run, const char *a_path, const char *b_path)
{
	optla_op *a = NULL, *b = NULL;
	double error = 0;
	optla_status status = model_operator(run->ctx, a_path, &a);
	if (!status) status = model_operator(run->ctx, b_path, &b);
	if (!status && (optla_op_nrows(a) != optla_op_nrows(b) || optla_op_ncols(a) != optla_op_ncols(b)))
		status = cli_fail(run, OPTLA_ERR_SHAPE, "'%s' is %zu x %zu, '%s' is %zu x %zu: only models of one size can be compared",
		                  a_path, optla_op_nrows(a), optla_op_ncols(a), b_path, optla_op_nrows(b), optla_op_ncols(b));
	if (!status) status = optla_relative_error(a, b, &error);
	if (!status) {
		cli_text(run, "kind", "models");
		cli_number(run, "samples", (double)optla_op_nrows(a) * (double)optla_op_ncols(a));
		cli_number(run, "relative_error", error);
		cli_say(run, "models of a matrix of %zu x %zu\nrelative error   %.6g (Eq. 2.11)\n", optla_op_nrows(a), optla_op_ncols(a),
		        error);
		judge(run, error);
	}
	optla_op_unref(&a);
	optla_op_unref(&b);
	return status;
}

static bool is_numeric(const cli_h5_dataset *d) { return strcmp(d->type, "text") && strcmp(d->type, "other"); }

static optla_status compare_datasets(cli_run *run, const char *a_path, const char *b_path, const cli_h5_list *a,
                                     const cli_h5_list *b)
{
	double worst = 0;
	json_t *sets = json_object();
	optla_status status = OPTLA_OK;
	if (a->ndatasets != b->ndatasets)
		status =
		    cli_fail(run, OPTLA_ERR_SHAPE, "'%s' has %zu datasets, '%s' has %zu", a_path, a->ndatasets, b_path, b->ndatasets);
	for (size_t k = 0; !status && k < a->ndatasets; k++) {
		const char *name = a->datasets[k].name; /* both lists are in the order of names */
		if (strcmp(name, b->datasets[k].name)) {
			status = cli_fail(run, OPTLA_ERR_SHAPE, "'%s' has a dataset '%s' where '%s' has '%s'", a_path, name, b_path,
			                  b->datasets[k].name);
			break;
		}
		if (!is_numeric(&a->datasets[k])) continue;
		char a_name[1024], b_name[1024];
		snprintf(a_name, sizeof a_name, "%s:%s", a_path, name);
		snprintf(b_name, sizeof b_name, "%s:%s", b_path, name);
		difference d = {0};
		status = add_arrays(run, a_name, b_name, &d);
		if (status) break;
		cli_say(run, "%-24s relative error %.6g, largest %.6g\n", name, relative(&d), d.max_error);
		cli_json_number(sets, name, relative(&d));
		worst = fmax(worst, relative(&d));
	}
	json_object_set_new(run->numbers, "datasets", sets);
	if (status) return status;
	cli_text(run, "kind", "datasets");
	cli_number(run, "relative_error", worst);
	cli_say(run, "relative error   %.6g (the worst)\n", worst);
	judge(run, worst);
	return OPTLA_OK;
}

static optla_status compare_h5(cli_run *run, const char *a_path, const char *b_path)
{
	cli_h5_list a = {0}, b = {0};
	optla_status status = cli_h5_read_list(run, a_path, &a);
	if (!status) status = cli_h5_read_list(run, b_path, &b);
	if (!status) {
		const cli_h5_attribute *a_kind = cli_h5_find_attribute(&a, "optla_kind"),
		                       *b_kind = cli_h5_find_attribute(&b, "optla_kind");
		const char *ak = a_kind && a_kind->text ? a_kind->text : "", *bk = b_kind && b_kind->text ? b_kind->text : "";
		if (strcmp(ak, bk))
			status = cli_fail(run, OPTLA_ERR_SHAPE, "'%s' holds '%s', '%s' holds '%s'", a_path, *ak ? ak : "data", b_path,
			                  *bk ? bk : "data");
		else if (!strcmp(ak, "model"))
			status = compare_models(run, a_path, b_path);
		else
			status = compare_datasets(run, a_path, b_path, &a, &b);
	}
	cli_h5_list_clear(&a);
	cli_h5_list_clear(&b);
	return status;
}

static optla_status run_compare(cli_run *run)
{
	const char *a = run->arguments[0], *b = run->arguments[1];
	cli_input a_is, b_is;
	OPTLA_TRY(cli_input_of(run, a, &a_is));
	OPTLA_TRY(cli_input_of(run, b, &b_is));
	cli_text(run, "a", a);
	cli_text(run, "b", b);
	/* A 2- or 3-D .npy may be either: beside a picture it is one. */
	const bool a_npy = a_is == CLI_INPUT_NPY, b_npy = b_is == CLI_INPUT_NPY;
	if ((a_is == CLI_INPUT_IMAGE || a_npy) && (b_is == CLI_INPUT_IMAGE || b_npy) && !(a_npy && b_npy))
		return compare_images(run, a, b);
	if ((a_is == CLI_INPUT_ARRAY || a_npy) && (b_is == CLI_INPUT_ARRAY || b_npy)) return compare_arrays(run, a, b);
	if (a_is == CLI_INPUT_HDF5 && b_is == CLI_INPUT_HDF5) return compare_h5(run, a, b);
	return cli_fail(run, OPTLA_ERR_SHAPE, "'%s' is %s and '%s' is %s: compare takes two images, two arrays or two HDF5 files", a,
	                cli_input_name(a_is), b, cli_input_name(b_is));
}

static const cli_argument arguments[] = {{"A", "File to judge.", false, false}, {"B", "File to judge it by.", false, false}};
static const cli_group groups[] = {{&table, 0, NULL, "Options"}};
static const cli_example examples[] = {
    {"optla compare relit.exr photo.exr", "Prints relative error, largest error and PSNR of two images."},
    {"optla compare a.h5 b.h5 --max-rel-error 1e-6", "Do two models stand for the same matrix? Exit status 1 if they don't."},
    {"optla compare run.h5:photos photos.npy", "One dataset of an HDF5 file beside a NumPy array."},
};

const cli_verb cli_verb_compare = {
    .name = "compare",
    .summary = "tell how far one file is from another",
    .description = "Compares two images of one size and kind, two arrays (.npy, .npz:NAME, .h5:DATASET), or two HDF5 files, "
                   "dataset by dataset; of "
                   "two models it compares the matrices that they stand for.\n\n"
                   "Prints the relative error ||A - B|| / ||B|| (for models Eq. 2.11), the largest error of one sample and the "
                   "peak signal to noise "
                   "ratio. Files that can't be compared - another size, another kind - are wrong input: exit status 2.",
    .arguments = arguments,
    .narguments = CLI_COUNT(arguments),
    .options_size = sizeof(compare_options),
    .groups = groups,
    .ngroups = CLI_COUNT(groups),
    .examples = examples,
    .nexamples = CLI_COUNT(examples),
    .run = run_compare,
};
