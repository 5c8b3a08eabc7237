/* SPDX-License-Identifier: BSD-3-Clause */
/* Help and man pages: two renderings of the same tables. */
#include "cli.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <string.h>
#include <time.h>

enum { WIDTH = 92, COLUMN = 28 };

static const char about[] =
    "Optla (OPTical Linear Algebra) treats a scene lit by a projector and seen by a camera as a matrix T that multiplies: a "
    "pattern "
    "of light p gives the photo T p. It captures T from few photos with Krylov methods, relights a scene from them, finds the "
    "illumination that makes a wanted photo, and makes the photo that the projector would take.\n\n"
    "A rig is a YAML file: photos on disk with the illumination that each was taken under, or an analytic scene whose T is known "
    "exactly. What a file is, is found from its content. Output files appear whole or not at all and say how they were made.";

static const struct {
	const char *code, *what;
} exits[] = {{"0", "done"},
             {"1", "could not be done: disk, memory, a photo the rig can't take, stopped by Ctrl-C; or the answer of compare and "
                   "reproduce is no"},
             {"2", "the command line or an input file is wrong"}};

/* ---- what an option's line says ---- */

static bool is_wide(const optla_option *o) { return o->upper >= 1e15; }

static const char *placeholder(const optla_option *o)
{
	switch (o->type) {
	case OPTLA_OPTION_STRING: return *o->unit ? o->unit : "TEXT";
	case OPTLA_OPTION_ENUM: return "WORD";
	case OPTLA_OPTION_DOUBLE: return "X";
	case OPTLA_OPTION_INT:
	case OPTLA_OPTION_U64: return "N";
	case OPTLA_OPTION_BOOL: break;
	}
	return "";
}

/* "-K, --iterations N" */
static void option_head(const optla_option *o, const void *defaults, char *text, size_t bytes)
{
	const char *alias = cli_option_alias(o->name);
	const bool on = o->type == OPTLA_OPTION_BOOL && *(const bool *)((const char *)defaults + o->offset);
	const char *value = placeholder(o);
	if (alias && !alias[1])
		snprintf(text, bytes, "-%s, --%s%s%s", alias, o->name, *value ? " " : "", value);
	else
		snprintf(text, bytes, "--%s%s%s%s", on ? "[no-]" : "", o->name, *value ? " " : "", value);
}

/* "1 to 1000 s; default 20" */
static void option_range(const optla_option *o, const void *defaults, char *text, size_t bytes)
{
	char value[128], choices[256];
	optla_option_format(o, defaults, value, sizeof value);
	size_t used = 0;
	*text = 0;
	switch (o->type) {
	case OPTLA_OPTION_BOOL: snprintf(text, bytes, "%s", !strcmp(value, "true") ? "default: yes" : ""); return;
	case OPTLA_OPTION_STRING:
		if (*value) snprintf(text, bytes, "default: %s", value);
		return;
	case OPTLA_OPTION_ENUM:
		for (const char *c = o->choices; *c && used + 3 < sizeof choices; c++) {
			if (*c == '|')
				choices[used++] = ',', choices[used++] = ' ';
			else
				choices[used++] = *c;
		}
		choices[used] = 0;
		snprintf(text, bytes, "one of %s; default: %s", choices, value);
		return;
	case OPTLA_OPTION_INT:
	case OPTLA_OPTION_U64:
	case OPTLA_OPTION_DOUBLE: break;
	}
	const char *unit = *o->unit ? " " : "";
	if (!strcmp(value, "inf")) snprintf(value, sizeof value, "none");
	if (is_wide(o))
		snprintf(text, bytes, "%.10g%s%s or more; default: %s", o->lower, unit, o->unit, value);
	else
		snprintf(text, bytes, "%.10g to %.10g%s%s; default: %s", o->lower, o->upper, unit, o->unit, value);
}

/* The sentence, with a capital and a full stop, and the range in brackets. */
static void option_text(const cli_verb *verb, const optla_option *o, const void *defaults, char *text, size_t bytes)
{
	const char *help = verb && verb->out && !strcmp(o->name, "out") ? verb->out : o->help;
	char range[512];
	option_range(o, defaults, range, sizeof range);
	const size_t n = strlen(help);
	const char *stop = n && (help[n - 1] == '.' || help[n - 1] == ')') ? "" : ".";
	if (*range)
		snprintf(text, bytes, "%s%s (%s)", help, stop, range);
	else
		snprintf(text, bytes, "%s%s", help, stop);
	text[0] = (char)toupper((unsigned char)text[0]);
}

static void usage(FILE *file, const cli_verb *verb)
{
	fprintf(file, "optla %s", verb->name);
	for (size_t k = 0; k < verb->narguments; k++) {
		const cli_argument *a = &verb->arguments[k];
		fprintf(file, a->optional ? " [%s%s]" : " %s%s", a->name, a->repeated ? "..." : "");
	}
	fprintf(file, "%s [options]", verb->out_required ? " -o PATH" : "");
}

/* ---- text ---- */

/* Words filled up to WIDTH columns, later lines indented; column: where the cursor stands. */
static void fill(FILE *file, const char *text, size_t column, size_t indent)
{
	while (*text) {
		if (text[0] == '\n' && text[1] == '\n') {
			fprintf(file, "\n\n%*s", (int)indent, "");
			column = indent;
			text += 2;
			continue;
		}
		const size_t n = strcspn(text, " \n");
		if (column + n > WIDTH && column > indent) {
			fprintf(file, "\n%*s", (int)indent, "");
			column = indent;
		}
		fprintf(file, "%.*s", (int)n, text);
		column += n;
		text += n;
		if (*text == ' ' || (*text == '\n' && text[1] != '\n')) {
			text++;
			if (column + 1 + strcspn(text, " \n") <= WIDTH)
				fputc(' ', file), column++;
			else
				fprintf(file, "\n%*s", (int)indent, ""), column = indent;
		}
	}
	fputc('\n', file);
}

static void item(FILE *file, const char *head, const char *text)
{
	const int column = fprintf(file, "  %s", head);
	if (column < COLUMN - 1)
		fprintf(file, "%*s", COLUMN - column, "");
	else
		fprintf(file, "\n%*s", COLUMN, "");
	fill(file, text, COLUMN, COLUMN);
}

static void text_option(FILE *file, const cli_verb *verb, const optla_option *o, const void *defaults)
{
	char head[128], text[1536];
	option_head(o, defaults, head, sizeof head);
	option_text(verb, o, defaults, text, sizeof text);
	item(file, head, text);
}

static void text_shared(FILE *file, const cli_verb *verb)
{
	fprintf(file, "\nOptions of every verb:\n");
	for (size_t k = 0; k < cli_shared_table.count; k++)
		if (!verb || cli_verb_offers(verb, &cli_shared_table.options[k]))
			text_option(file, verb, &cli_shared_table.options[k], cli_shared_table.defaults);
}

static void text_command(FILE *file)
{
	fprintf(file, "Usage: optla VERB INPUT [options]\n       optla help [VERB]\n       optla --version\n\n");
	fill(file, about, 0, 0);
	fprintf(file, "\nVerbs:\n");
	for (size_t k = 0; k < cli_verbs_count; k++) item(file, cli_verbs[k]->name, cli_verbs[k]->summary);
	text_shared(file, NULL);
	fprintf(file, "\nExit status:\n");
	for (size_t k = 0; k < CLI_COUNT(exits); k++) item(file, exits[k].code, exits[k].what);
	fprintf(file, "\nStart with 'optla demo'; 'optla help VERB' shows examples of each verb.\n");
}

static void text_verb(FILE *file, const cli_verb *verb)
{
	fprintf(file, "Usage: ");
	usage(file, verb);
	fprintf(file, "\n\n");
	fill(file, verb->description, 0, 0);
	if (verb->narguments) fprintf(file, "\nArguments:\n");
	for (size_t k = 0; k < verb->narguments; k++) item(file, verb->arguments[k].name, verb->arguments[k].help);
	for (size_t g = 0; g < verb->ngroups; g++) {
		fprintf(file, "\n%s:\n", verb->groups[g].title);
		for (size_t k = 0; k < verb->groups[g].table->count; k++)
			if (cli_group_offers(&verb->groups[g], &verb->groups[g].table->options[k]))
				text_option(file, verb, &verb->groups[g].table->options[k], verb->groups[g].table->defaults);
	}
	text_shared(file, verb);
	for (size_t t = 0; t < verb->ntopics; t++) {
		const char *help = "", *name;
		fprintf(file, "\n%s:\n", verb->topics[t].title);
		for (size_t k = 0; (name = verb->topics[t].item(k, &help)); k++) item(file, name, help);
	}
	fprintf(file, "\nExamples:\n");
	for (size_t k = 0; k < verb->nexamples; k++) {
		fprintf(file, "  %s\n      ", verb->examples[k].command);
		fill(file, verb->examples[k].what, 6, 6);
	}
}

void cli_print_help(FILE *file, const cli_verb *verb)
{
	if (verb)
		text_verb(file, verb);
	else
		text_command(file);
}

/* ---- man ---- */

/* Escapes what troff would take for a command; a paragraph break becomes .PP. */
static void troff(FILE *file, const char *text)
{
	bool start = true;
	for (const char *c = text; *c; c++) {
		if (c[0] == '\n' && c[1] == '\n') {
			fputs("\n.PP\n", file);
			c++;
			start = true;
			continue;
		}
		if (start && (*c == '.' || *c == '\'')) fputs("\\&", file);
		start = *c == '\n';
		if (*c == '\\')
			fputs("\\e", file);
		else if (*c == '-')
			fputs("\\-", file);
		else
			fputc(*c, file);
	}
	fputc('\n', file);
}

static void man_item(FILE *file, const char *head, const char *text)
{
	fputs(".TP\n.B ", file);
	troff(file, head);
	troff(file, text);
}

static void man_option(FILE *file, const cli_verb *verb, const optla_option *o, const void *defaults)
{
	char head[128], text[1536];
	option_head(o, defaults, head, sizeof head);
	option_text(verb, o, defaults, text, sizeof text);
	man_item(file, head, text);
}

static void man_title(FILE *file, const char *name, const char *summary)
{
	char upper[64] = {0};
	for (size_t k = 0; name[k] && k + 1 < sizeof upper; k++) upper[k] = (char)toupper((unsigned char)name[k]);
	fprintf(file, ".TH %s 1 \"\" \"optla %s\" \"Optla\"\n.SH NAME\n%s \\- ", upper, optla_version(), name);
	troff(file, summary);
}

static void man_shared(FILE *file, const cli_verb *verb)
{
	fputs(".SH OPTIONS OF EVERY VERB\n", file);
	for (size_t k = 0; k < cli_shared_table.count; k++)
		if (!verb || cli_verb_offers(verb, &cli_shared_table.options[k]))
			man_option(file, verb, &cli_shared_table.options[k], cli_shared_table.defaults);
	fputs(".SH EXIT STATUS\n", file);
	for (size_t k = 0; k < CLI_COUNT(exits); k++) man_item(file, exits[k].code, exits[k].what);
}

static void man_command(FILE *file)
{
	man_title(file, "optla", "optical linear algebra for computational light transport");
	fputs(".SH SYNOPSIS\n.B optla\n.I VERB INPUT\n[options]\n.br\n.B optla help\n[\\-\\-man]\n[\n.I VERB\n]\n.br\n.B optla "
	      "\\-\\-version\n"
	      ".SH DESCRIPTION\n",
	      file);
	troff(file, about);
	fputs(".SH VERBS\n", file);
	for (size_t k = 0; k < cli_verbs_count; k++) man_item(file, cli_verbs[k]->name, cli_verbs[k]->summary);
	man_shared(file, NULL);
	fputs(".SH ENVIRONMENT\n", file);
	man_item(file, "SOURCE_DATE_EPOCH", "Seconds since 1970 that output files carry as their date, in place of now.");
	fputs(".SH SEE ALSO\n", file);
	for (size_t k = 0; k < cli_verbs_count; k++)
		fprintf(file, ".BR optla\\-%s (1)%s\n", cli_verbs[k]->name, k + 1 < cli_verbs_count ? "," : "");
}

static void man_verb(FILE *file, const cli_verb *verb)
{
	char page[64];
	snprintf(page, sizeof page, "optla-%s", verb->name);
	man_title(file, page, verb->summary);
	fputs(".SH SYNOPSIS\n.B ", file);
	usage(file, verb);
	fputs("\n.SH DESCRIPTION\n", file);
	troff(file, verb->description);
	if (verb->narguments) fputs(".SH ARGUMENTS\n", file);
	for (size_t k = 0; k < verb->narguments; k++) man_item(file, verb->arguments[k].name, verb->arguments[k].help);
	if (verb->ngroups) fputs(".SH OPTIONS\n", file);
	for (size_t g = 0; g < verb->ngroups; g++) {
		fprintf(file, ".SS %s\n", verb->groups[g].title);
		for (size_t k = 0; k < verb->groups[g].table->count; k++)
			if (cli_group_offers(&verb->groups[g], &verb->groups[g].table->options[k]))
				man_option(file, verb, &verb->groups[g].table->options[k], verb->groups[g].table->defaults);
	}
	for (size_t t = 0; t < verb->ntopics; t++) {
		const char *help = "", *name;
		fprintf(file, ".SH %s\n", verb->topics[t].title);
		for (size_t k = 0; (name = verb->topics[t].item(k, &help)); k++) man_item(file, name, help);
	}
	man_shared(file, verb);
	fputs(".SH EXAMPLES\n", file);
	for (size_t k = 0; k < verb->nexamples; k++) man_item(file, verb->examples[k].command, verb->examples[k].what);
	fputs(".SH SEE ALSO\n.BR optla (1)\n", file);
}

void cli_print_man(FILE *file, const cli_verb *verb)
{
	if (verb)
		man_verb(file, verb);
	else
		man_command(file);
}
