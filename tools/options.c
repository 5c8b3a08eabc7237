/* SPDX-License-Identifier: BSD-3-Clause */
/* The command line, read by the option tables. */
#include "cli.h"

#include "base/base_impl.h"

#include <stdlib.h>
#include <string.h>

static const cli_shared shared_defaults = {.size = sizeof shared_defaults, .seed = 1};

#define SHARED(n, f, t, u, lo, hi, h)                                    \
	{                                                                    \
		n, offsetof(cli_shared, f), OPTLA_OPTION_##t, u, lo, hi, NULL, h \
	}
static const optla_option shared_options[] = {
    SHARED("out", out, STRING, "PATH", 0, 0, "Where the result goes."),
    SHARED("seed", seed, U64, "", 0, 9223372036854774784.0,
           "Seed of every random number: the same seed gives the same result with any number of threads."),
    SHARED("threads", threads, INT, "", 0, 4096, "Threads to use; 0: as many as there are processors."),
    SHARED("json", json, STRING, "FILE", 0, 0,
           "Writes the numbers of the run as JSON; '-': to standard output, in place of the text."),
    SHARED("data", data, STRING, "DIR", 0, 0, "Folder of recorded photos: replaces the data_root of a rig file."),
    SHARED("quiet", quiet, BOOL, "", 0, 0, "Prints nothing but warnings and errors."),
    SHARED("verbose", verbose, BOOL, "", 0, 0, "Prints details of the work, and in which function an error was found."),
    SHARED("help", help, BOOL, "", 0, 0, "Prints the help of the verb."),
};
const optla_option_table cli_shared_table = {"the command", sizeof(cli_shared), &shared_defaults, shared_options,
                                             CLI_COUNT(shared_options)};

static const struct {
	const char *alias, *name;
} aliases[] = {{"o", "out"}, {"q", "quiet"}, {"v", "verbose"}, {"h", "help"}, {"K", "iterations"}};

const char *cli_option_name(const char *alias)
{
	for (size_t k = 0; k < CLI_COUNT(aliases); k++)
		if (!strcmp(aliases[k].alias, alias)) return aliases[k].name;
	return alias;
}

const char *cli_option_alias(const char *name)
{
	for (size_t k = 0; k < CLI_COUNT(aliases); k++)
		if (!strcmp(aliases[k].name, name)) return aliases[k].alias;
	return NULL;
}

/* Is name one of "a|b|c"? */
static bool listed(const char *list, const char *name)
{
	const size_t n = strlen(name);
	for (const char *c = list; c; c = strchr(c, '|'), c = c ? c + 1 : NULL)
		if (!strncmp(c, name, n) && (c[n] == '|' || !c[n])) return true;
	return false;
}

bool cli_group_offers(const cli_group *group, const optla_option *option)
{
	for (size_t k = 0; k < cli_shared_table.count; k++) /* a field that the shared options set, such as the seed */
		if (!strcmp(cli_shared_table.options[k].name, option->name)) return false;
	return !listed(group->skip, option->name);
}

bool cli_verb_offers(const cli_verb *verb, const optla_option *shared)
{
	return strcmp(shared->name, "out") || (verb && verb->out);
}

/* Where an option is: its table and the struct that it sets. */
typedef struct {
	const optla_option_table *table;
	const optla_option *option;
	void *opts;
} place;

static bool find(const cli_verb *verb, cli_run *run, const char *name, place *out)
{
	for (size_t k = 0; k < cli_shared_table.count; k++) {
		const optla_option *o = &cli_shared_table.options[k];
		if (strcmp(o->name, name) || !cli_verb_offers(verb, o)) continue;
		*out = (place){&cli_shared_table, o, &run->shared};
		return true;
	}
	for (size_t g = 0; g < verb->ngroups; g++) {
		const cli_group *group = &verb->groups[g];
		for (size_t k = 0; k < group->table->count; k++) {
			const optla_option *o = &group->table->options[k];
			if (strcmp(o->name, name) || !cli_group_offers(group, o)) continue;
			*out = (place){group->table, o, (char *)run->options + group->offset};
			return true;
		}
	}
	return false;
}

/* k-th option that a verb has, NULL after the last. */
static const char *option_at(const void *user, size_t k)
{
	const cli_verb *verb = user;
	for (size_t i = 0; i < cli_shared_table.count; i++)
		if (cli_verb_offers(verb, &cli_shared_table.options[i]) && !k--) return cli_shared_table.options[i].name;
	for (size_t g = 0; g < verb->ngroups; g++)
		for (size_t i = 0; i < verb->groups[g].table->count; i++) {
			const optla_option *o = &verb->groups[g].table->options[i];
			if (cli_group_offers(&verb->groups[g], o) && !k--) return o->name;
		}
	return NULL;
}

static optla_status unknown(optla_ctx *ctx, const cli_verb *verb, const char *word, const char *name)
{
	const char *near = cli_nearest(name, option_at, verb);
	if (near)
		return OPTLA_FAIL(ctx, OPTLA_ERR_ARG, "'%s' has no option '%s': did you mean '--%s'? ('optla help %s' lists them)",
		                  verb->name, word, near, verb->name);
	return OPTLA_FAIL(ctx, OPTLA_ERR_ARG, "'%s' has no option '%s' ('optla help %s' lists them)", verb->name, word, verb->name);
}

/* One word that starts with a dash; *k is moved past a value that is a word of its own. */
static optla_status take_option(optla_ctx *ctx, const cli_verb *verb, int argc, char **argv, int *k, cli_run *run)
{
	const char *word = argv[*k];
	char name[64];
	const char *value = NULL;
	if (word[1] == '-') {
		const size_t n = strcspn(word + 2, "=");
		OPTLA_CHECK(ctx, n > 0 && n < sizeof name, OPTLA_ERR_ARG, "'%s' is no option", word);
		memcpy(name, word + 2, n);
		name[n] = 0;
		if (word[2 + n] == '=') value = word + 2 + n + 1;
	} else {
		name[0] = word[1];
		name[1] = 0;
		if (word[2]) value = word + 2 + (word[2] == '=');
	}
	place at;
	const char *full = cli_option_name(name);
	bool negated = false;
	bool known = find(verb, run, full, &at);
	if (!known && !strncmp(full, "no-", 3) && find(verb, run, full + 3, &at) && at.option->type == OPTLA_OPTION_BOOL)
		known = negated = true;
	if (!known) return unknown(ctx, verb, word, name);
	if (at.option->type == OPTLA_OPTION_BOOL) {
		OPTLA_CHECK(ctx, !(negated && value), OPTLA_ERR_ARG, "option '%s' takes no value", word);
		if (!value) value = negated ? "false" : "true";
	} else if (!value) {
		OPTLA_CHECK(ctx, *k + 1 < argc, OPTLA_ERR_ARG, "option '%s' needs a value", word);
		value = argv[++*k];
	}
	OPTLA_CHECK(ctx, at.option->type != OPTLA_OPTION_STRING || *value, OPTLA_ERR_ARG, "option '%s' has an empty value", word);
	run->given[run->ngiven++] = at.option->name;
	return optla_option_set(ctx, at.table, at.opts, at.option->name, value);
}

static optla_status check_arguments(optla_ctx *ctx, const cli_verb *verb, const cli_run *run)
{
	size_t required = 0;
	bool any = false;
	for (size_t k = 0; k < verb->narguments; k++) {
		required += !verb->arguments[k].optional;
		any |= verb->arguments[k].repeated;
	}
	OPTLA_CHECK(ctx, run->narguments >= required, OPTLA_ERR_ARG, "'%s' needs %s: %s ('optla help %s' shows examples)", verb->name,
	            verb->arguments[run->narguments].name, verb->arguments[run->narguments].help, verb->name);
	OPTLA_CHECK(ctx, any || run->narguments <= verb->narguments, OPTLA_ERR_ARG, "'%s' takes %zu argument%s, '%s' is one too many",
	            verb->name, verb->narguments, verb->narguments == 1 ? "" : "s", run->arguments[verb->narguments]);
	OPTLA_CHECK(ctx, !verb->out_required || run->shared.out, OPTLA_ERR_ARG, "'%s' needs '-o PATH': %s", verb->name, verb->out);
	return OPTLA_OK;
}

optla_status cli_parse(optla_ctx *ctx, const cli_verb *verb, int argc, char **argv, cli_run *run)
{
	run->verb = verb;
	run->shared = shared_defaults;
	run->options = calloc(1, verb->options_size + 1);
	run->arguments = calloc((size_t)argc + 1, sizeof *run->arguments);
	run->given = calloc((size_t)argc + 1, sizeof *run->given);
	run->numbers = json_object();
	OPTLA_CHECK(ctx, run->options && run->arguments && run->given && run->numbers, OPTLA_ERR_NOMEM, "no memory");
	for (size_t g = 0; g < verb->ngroups; g++)
		memcpy((char *)run->options + verb->groups[g].offset, verb->groups[g].table->defaults,
		       verb->groups[g].table->struct_size);
	bool only_arguments = false;
	for (int k = 0; k < argc; k++) {
		if (!only_arguments && !strcmp(argv[k], "--"))
			only_arguments = true;
		else if (!only_arguments && argv[k][0] == '-' && argv[k][1])
			OPTLA_TRY(take_option(ctx, verb, argc, argv, &k, run));
		else
			run->arguments[run->narguments++] = argv[k];
	}
	return run->shared.help ? OPTLA_OK : check_arguments(ctx, verb, run);
}

void cli_run_clear(cli_run *run)
{
	free(run->options);
	free(run->arguments);
	free(run->given);
	free(run->command_line);
	json_decref(run->numbers);
	*run = (cli_run){0};
}

bool cli_given(const cli_run *run, const char *option)
{
	for (size_t k = 0; k < run->ngiven; k++)
		if (!strcmp(run->given[k], option)) return true;
	return false;
}

/* Levenshtein distance of words of up to 63 letters, one row at a time. */
static size_t distance(const char *a, const char *b)
{
	size_t row[64];
	const size_t n = strlen(b);
	if (n > 63) return SIZE_MAX;
	for (size_t j = 0; j <= n; j++) row[j] = j;
	for (size_t i = 1; a[i - 1]; i++) {
		size_t diagonal = row[0];
		row[0] = i;
		for (size_t j = 1; j <= n; j++) {
			const size_t replace = diagonal + (a[i - 1] != b[j - 1]);
			diagonal = row[j];
			row[j] = optla_min_(replace, optla_min_(row[j], row[j - 1]) + 1);
		}
	}
	return row[n];
}

const char *cli_nearest(const char *word, const char *(*name)(const void *user, size_t k), const void *user)
{
	const char *best = NULL;
	size_t least = strlen(word) / 3 + 2; /* further away, a suggestion misleads more than it helps */
	for (size_t k = 0; name(user, k); k++) {
		const char *n = name(user, k);
		const bool starts = strlen(word) >= 2 && !strncmp(n, word, strlen(word));
		const size_t d = starts ? 1 : distance(word, n);
		if (d < least) least = d, best = n;
	}
	return best;
}
