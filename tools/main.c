/* SPDX-License-Identifier: BSD-3-Clause */
/* The command: finds the verb, reads its options, makes the context, runs it. */
#include "cli.h"
#include "signals.h"
#include "term.h"
#include "verbs.h"

#include "base/base_impl.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

const cli_verb *const cli_verbs[] = {&cli_verb_demo, &cli_verb_krylov,    &cli_verb_relight, &cli_verb_invert,
                                     &cli_verb_dual, &cli_verb_reproduce, &cli_verb_info,    &cli_verb_compare};
const size_t cli_verbs_count = CLI_COUNT(cli_verbs);

enum { EXIT_DONE, EXIT_NOT_DONE, EXIT_WRONG_INPUT };

static int exit_code(optla_status status)
{
	switch (status) {
	case OPTLA_OK: return EXIT_DONE;
	case OPTLA_ERR_ARG:
	case OPTLA_ERR_SHAPE:
	case OPTLA_ERR_INPUT: return EXIT_WRONG_INPUT;
	case OPTLA_ERR_NOMEM:
	case OPTLA_ERR_UNSUPPORTED:
	case OPTLA_ERR_IO:
	case OPTLA_ERR_DEVICE:
	case OPTLA_ERR_CANCELLED: break;
	}
	return EXIT_NOT_DONE;
}

const cli_verb *cli_find_verb(const char *name)
{
	for (size_t k = 0; k < cli_verbs_count; k++)
		if (!strcmp(cli_verbs[k]->name, name)) return cli_verbs[k];
	return NULL;
}

static const char *verb_at(const void *user, size_t k)
{
	(void)user;
	return k < cli_verbs_count ? cli_verbs[k]->name : k == cli_verbs_count ? "help" : NULL;
}

static int no_such_verb(const char *word)
{
	const char *near = cli_nearest(word, verb_at, NULL);
	fprintf(stderr, "optla: there is no verb '%s'%s%s%s ('optla help' lists them)\n", word, near ? ": did you mean '" : "",
	        near ? near : "", near ? "'?" : "");
	return EXIT_WRONG_INPUT;
}

/* One word for a shell: as it is, or in single quotes. */
static size_t quote(char *out, const char *word)
{
	static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=+./:,@%";
	const size_t n = strlen(word);
	if (n && strspn(word, plain) == n) {
		memcpy(out, word, n);
		return n;
	}
	size_t used = 0;
	out[used++] = '\'';
	for (size_t k = 0; k < n; k++) {
		if (word[k] == '\'') {
			memcpy(out + used, "'\\''", 4);
			used += 4;
		} else
			out[used++] = word[k];
	}
	out[used++] = '\'';
	return used;
}

static char *command_line(int argc, char **argv)
{
	size_t bytes = 1;
	for (int k = 0; k < argc; k++) bytes += 4 * strlen(argv[k]) + 3;
	char *text = malloc(bytes);
	if (!text) return NULL;
	memcpy(text, "optla", 5);
	size_t used = 5;
	for (int k = 1; k < argc; k++) {
		text[used++] = ' ';
		used += quote(text + used, argv[k]);
	}
	text[used] = 0;
	return text;
}

/* ISO 8601 in UTC; SOURCE_DATE_EPOCH (reproducible-builds.org) takes the place of now. */
static void date_now(char *text, size_t bytes)
{
	const char *epoch = getenv("SOURCE_DATE_EPOCH");
	time_t now = epoch && *epoch ? (time_t)strtoll(epoch, NULL, 10) : time(NULL);
	struct tm utc;
	if (!gmtime_r(&now, &utc) || !strftime(text, bytes, "%Y-%m-%dT%H:%M:%SZ", &utc)) *text = 0;
}

static int finish_stdout(int code)
{
	errno = 0;
	if (!fflush(stdout) && !ferror(stdout)) return code;
	/* A reader that has seen enough ('| head') is no error to talk about. */
	if (errno != EPIPE) fprintf(stderr, "optla: could not write standard output: %s\n", strerror(errno));
	return code ? code : EXIT_NOT_DONE;
}

static optla_status run_verb(cli_run *run, optla_term *term, int argc, char **argv)
{
	const optla_ctx_desc desc = {.size = sizeof desc,
	                             .error = optla_term_error,
	                             .error_user = term,
	                             .log = optla_term_log,
	                             .log_user = term,
	                             .progress = optla_term_progress,
	                             .progress_user = term,
	                             .threads = run->shared.threads};
	term->progress = !run->shared.quiet && isatty(STDERR_FILENO);
	term->log_level = run->shared.quiet ? 0 : run->shared.verbose ? 2 : 1;
	term->where = run->shared.verbose;
	OPTLA_TRY(optla_ctx_create(&run->ctx, &desc));
	char date[40];
	date_now(date, sizeof date);
	run->command_line = command_line(argc, argv);
	optla_status status = run->command_line ? OPTLA_OK : OPTLA_ERR_NOMEM;
	if (!status) status = optla_ctx_set_provenance(run->ctx, run->command_line, run->shared.seed, *date ? date : NULL);
	cli_text(run, "command", run->command_line);
	cli_text(run, "version", optla_version());
	cli_text(run, "date", date);
	json_object_set_new(run->numbers, "seed", json_integer((json_int_t)run->shared.seed));
	cli_number(run, "threads", optla_ctx_threads(run->ctx));
	optla_signals_install(run->ctx);
	const double began_s = optla_now_s_();
	if (!status) status = cli_check_output(run, run->shared.json);
	if (!status) status = run->verb->run(run);
	cli_number(run, "wall_s", optla_now_s_() - began_s);
	if (!status) status = cli_write_json(run);
	optla_signals_remove();
	optla_term_clear(term);
	if (status) optla_term_print_errors(term);
	if (status == OPTLA_ERR_CANCELLED) fprintf(stderr, "optla: stopped\n");
	optla_ctx_destroy(&run->ctx);
	return status;
}

static int do_verb(const cli_verb *verb, int argc, char **argv)
{
	cli_run run = {0};
	optla_term term = {0};
	optla_ctx *parsing;
	const optla_ctx_desc desc = {.size = sizeof desc, .error = optla_term_error, .error_user = &term};
	optla_status status = optla_ctx_create(&parsing, &desc);
	if (!status) status = cli_parse(parsing, verb, argc - 2, argv + 2, &run);
	optla_term_print_errors(&term);
	optla_ctx_destroy(&parsing);
	int code;
	if (status)
		code = exit_code(status);
	else if (run.shared.help) {
		cli_print_help(stdout, verb);
		code = EXIT_DONE;
	} else {
		status = run_verb(&run, &term, argc, argv);
		code = status ? exit_code(status) : run.failed ? EXIT_NOT_DONE : EXIT_DONE;
	}
	cli_run_clear(&run);
	return finish_stdout(code);
}

static int do_help(int argc, char **argv)
{
	bool man = false;
	const cli_verb *verb = NULL;
	for (int k = 2; k < argc; k++) {
		if (!strcmp(argv[k], "--man"))
			man = true;
		else if (argv[k][0] == '-' || verb) {
			fprintf(stderr, "optla: usage: optla help [--man] [VERB]\n");
			return EXIT_WRONG_INPUT;
		} else if (strcmp(argv[k], "help") && !(verb = cli_find_verb(argv[k])))
			return no_such_verb(argv[k]);
	}
	(man ? cli_print_man : cli_print_help)(stdout, verb);
	return finish_stdout(EXIT_DONE);
}

int main(int argc, char **argv)
{
	if (argc < 2) {
		cli_print_help(stderr, NULL);
		return EXIT_WRONG_INPUT;
	}
	if (!strcmp(argv[1], "help") || !strcmp(argv[1], "--help") || !strcmp(argv[1], "-h")) return do_help(argc, argv);
	if (!strcmp(argv[1], "--version")) {
		printf("optla %s\n", optla_version());
		return finish_stdout(EXIT_DONE);
	}
	const cli_verb *verb = cli_find_verb(argv[1]);
	return verb ? do_verb(verb, argc, argv) : no_such_verb(argv[1]);
}
