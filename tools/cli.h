/* SPDX-License-Identifier: BSD-3-Clause */
/* The frame of the command: a verb is a table - arguments, option tables, examples - and a function. Parsing, --help and the man
   pages are made from the tables, so that an option is described once, where its struct is. */
#ifndef OPTLA_CLI_H
#define OPTLA_CLI_H

#include "optla/base.h"

#include <jansson.h>
#include <stdio.h>

typedef struct cli_run cli_run;

typedef struct {
	const char *name; /* "RIG", "A" */
	const char *help;
	bool optional, repeated; /* repeated: the last argument only */
} cli_argument;

/* Options of one struct inside the verb's options struct. */
typedef struct {
	const optla_option_table *table;
	size_t offset;
	const char *skip;  /* "a|b": options of the table that this verb doesn't offer; NULL: none */
	const char *title; /* heading in the help */
} cli_group;

typedef struct {
	const char *command, *what;
} cli_example;

/* A list that the library knows: sensors, figures. item: k-th name and what it is, NULL after the last. */
typedef struct {
	const char *title;
	const char *(*item)(size_t k, const char **help);
} cli_topic;

typedef struct {
	const char *name, *summary;
	const char *description; /* paragraphs separated by an empty line */
	const char *out;         /* what -o is for; NULL: the verb writes no file */
	bool out_required;
	const cli_argument *arguments;
	size_t narguments;
	size_t options_size; /* of the verb's options struct; 0: none */
	const cli_group *groups;
	size_t ngroups;
	const cli_topic *topics;
	size_t ntopics;
	const cli_example *examples;
	size_t nexamples;
	optla_status (*run)(cli_run *run);
} cli_verb;

#define CLI_COUNT(array) (sizeof(array) / sizeof *(array))

/* Options of every verb. */
typedef struct {
	size_t size;
	const char *out, *json, *data;
	uint64_t seed;
	int threads;
	bool quiet, verbose, help;
} cli_shared;
extern const optla_option_table cli_shared_table;

/* One invocation. */
struct cli_run {
	const cli_verb *verb;
	optla_ctx *ctx;
	cli_shared shared;
	void *options; /* the verb's struct, defaults and then what was given */
	const char **arguments;
	size_t narguments;
	const char **given; /* names of the options that were given */
	size_t ngiven;
	json_t *numbers;    /* what --json writes */
	char *command_line; /* quoted for a shell */
	bool failed;        /* the work was done, and its answer is no: exit 1 */
};

extern const cli_verb *const cli_verbs[];
extern const size_t cli_verbs_count;
const cli_verb *cli_find_verb(const char *name);
/* Nearest of the names by edits (for "did you mean"); NULL when none is near. */
const char *cli_nearest(const char *word, const char *(*name)(const void *user, size_t k), const void *user);

/* ---- options.c: the command line -> cli_run; messages go to ctx's error handler ---- */

optla_status cli_parse(optla_ctx *ctx, const cli_verb *verb, int argc, char **argv, cli_run *run);
void cli_run_clear(cli_run *run);
bool cli_given(const cli_run *run, const char *option);
/* One-letter and second names: "K" -> "iterations"; the name itself if it is none. */
const char *cli_option_name(const char *alias);
/* The letter or second name that stands for an option, NULL if none. */
const char *cli_option_alias(const char *name);
bool cli_group_offers(const cli_group *group, const optla_option *option);
/* As cli_group_offers for the shared options. */
bool cli_verb_offers(const cli_verb *verb, const optla_option *shared);

/* ---- help.c ---- */

void cli_print_help(FILE *file, const cli_verb *verb); /* verb NULL: the command */
void cli_print_man(FILE *file, const cli_verb *verb);

/* ---- output.c ---- */

/* Text for a person on standard output; silent with -q or when the numbers go there (--json -). */
void cli_say(const cli_run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Raises an error through the context's handler. */
optla_status cli_fail(const cli_run *run, optla_status code, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* Numbers for --json. A number that isn't finite becomes null. */
void cli_number(cli_run *run, const char *name, double value);
void cli_text(cli_run *run, const char *name, const char *value);
void cli_json_number(json_t *object, const char *name, double value);
optla_status cli_write_json(const cli_run *run);
/* Fails before the work when a file could not be written there after it: missing or forbidden directory. NULL and "-" are fine. */
optla_status cli_check_output(const cli_run *run, const char *path);

#endif
