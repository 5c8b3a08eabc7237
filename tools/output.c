/* SPDX-License-Identifier: BSD-3-Clause */
/* What a run says: text, errors, numbers as JSON. */
#include "cli.h"

#include "base/base_impl.h"
#include "io/whole_file.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool json_on_stdout(const cli_run *run) { return run->shared.json && !strcmp(run->shared.json, "-"); }

void cli_say(const cli_run *run, const char *format, ...)
{
	if (run->shared.quiet || json_on_stdout(run)) return;
	va_list args;
	va_start(args, format);
	vprintf(format, args);
	va_end(args);
}

optla_status cli_fail(const cli_run *run, optla_status code, const char *format, ...)
{
	char text[1024];
	va_list args;
	va_start(args, format);
	vsnprintf(text, sizeof text, format, args);
	va_end(args);
	return optla_fail_(run->ctx, code, run->verb ? run->verb->name : "optla", "%s", text);
}

void cli_json_number(json_t *object, const char *name, double value)
{
	if (!isfinite(value))
		json_object_set_new(object, name, json_null());
	else if (value == floor(value) && fabs(value) < 0x1p53)
		json_object_set_new(object, name, json_integer((json_int_t)value));
	else
		json_object_set_new(object, name, json_real(value));
}

void cli_number(cli_run *run, const char *name, double value) { cli_json_number(run->numbers, name, value); }

void cli_text(cli_run *run, const char *name, const char *value)
{
	/* A file name may hold bytes that are no UTF-8: jansson refuses those, and null is the honest answer. */
	json_t *text = value ? json_string(value) : NULL;
	json_object_set_new(run->numbers, name, text ? text : json_null());
}

optla_status cli_write_json(const cli_run *run)
{
	if (!run->shared.json) return OPTLA_OK;
	char *text = json_dumps(run->numbers, JSON_INDENT(2) | JSON_PRESERVE_ORDER | JSON_REAL_PRECISION(15));
	if (!text) return cli_fail(run, OPTLA_ERR_NOMEM, "no memory for the numbers");
	const size_t n = strlen(text);
	text[n] = '\n'; /* in place of the end: the file is written by count */
	optla_status status = OPTLA_OK;
	if (json_on_stdout(run))
		fwrite(text, 1, n + 1, stdout);
	else
		status = optla_write_file_(run->ctx, run->shared.json, text, n + 1);
	free(text);
	return status;
}

optla_status cli_check_output(const cli_run *run, const char *path)
{
	if (!path || !strcmp(path, "-")) return OPTLA_OK;
	struct stat s;
	if (!stat(path, &s) && S_ISDIR(s.st_mode))
		return cli_fail(run, OPTLA_ERR_IO, "'%s' is a directory, not a file to write", path);
	if (!stat(path, &s) && !S_ISREG(s.st_mode))
		return cli_fail(run, OPTLA_ERR_IO, "'%s' is a pipe or a device, so no file can be written there", path);
	char *dir = optla_path_dir_(run->ctx, path);
	if (!dir) return OPTLA_ERR_NOMEM;
	optla_status status = OPTLA_OK;
	if (stat(dir, &s))
		status = cli_fail(run, OPTLA_ERR_IO, "cannot write '%s': directory '%s': %s", path, dir, strerror(errno));
	else if (!S_ISDIR(s.st_mode))
		status = cli_fail(run, OPTLA_ERR_IO, "cannot write '%s': '%s' is not a directory", path, dir);
	else if (access(dir, W_OK | X_OK))
		status = cli_fail(run, OPTLA_ERR_IO, "cannot write '%s': directory '%s': %s", path, dir, strerror(errno));
	optla_free(run->ctx, dir);
	return status;
}
