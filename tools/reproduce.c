/* SPDX-License-Identifier: BSD-3-Clause */
/* optla reproduce: figures and tables of the thesis, one after the other. */
#include "verbs.h"

#include "optla/report.h"

#include "base/base_impl.h"

#include <string.h>

static optla_status run_reproduce(cli_run *run)
{
	const char *dir = run->shared.out ? run->shared.out : "out/reproduce";
	enum { MOST = 256 };
	const char *ids[MOST];
	size_t count = 0, failed = 0;
	for (size_t k = 0; k < run->narguments; k++) {
		if (strcmp(run->arguments[k], "all")) {
			if (count < MOST) ids[count++] = run->arguments[k];
			continue;
		}
		for (size_t i = 0; optla_reproduce_id(i, NULL) && count < MOST; i++) ids[count++] = optla_reproduce_id(i, NULL);
	}
	const optla_reproduce_options options = {
	    .size = sizeof options, .out_dir = dir, .data_dir = run->shared.data, .seed = run->shared.seed};
	OPTLA_TRY(optla_reproduce(run->ctx, ids, count, &options, &failed));
	json_t *list = json_array();
	for (size_t k = 0; k < count; k++) json_array_append_new(list, json_string(ids[k]));
	json_object_set_new(run->numbers, "ids", list);
	cli_number(run, "not_ok", (double)failed);
	cli_text(run, "page", dir);
	cli_say(run, "%zu of %zu figures and tables have all numbers within their range: %s/index.html\n", count - failed, count,
	        dir);
	run->failed = failed > 0;
	if (failed) optla_log_(run->ctx, 0, "%zu of %zu have a number that isn't ok", failed, count);
	return OPTLA_OK;
}

static const cli_argument arguments[] = {{"ID", "Figure or table, see the list; 'all': each of them.", false, true}};
static const cli_topic topics[] = {{"Figures and tables", optla_reproduce_id}};
static const cli_example examples[] = {
    {"optla reproduce all -o out/thesis", "Every figure and table on one page."},
    {"optla reproduce fig2.9 --data ../shared/data", "The error curves, on real photos too."},
};

const cli_verb cli_verb_reproduce = {
    .name = "reproduce",
    .summary = "run the experiments of the thesis again",
    .description =
        "Runs figures and tables of 'Optical Linear Algebra for Computational Light Transport' and writes for each a section of "
        "DIR/index.html - what was done, pictures, our numbers beside the thesis' - and DIR/ID/numbers.json.\n\n"
        "Exit status 1 if any number is outside the range that is allowed for it.",
    .out = "Folder of the page (default: out/reproduce). Sections of earlier runs stay.",
    .arguments = arguments,
    .narguments = CLI_COUNT(arguments),
    .topics = topics,
    .ntopics = CLI_COUNT(topics),
    .examples = examples,
    .nexamples = CLI_COUNT(examples),
    .run = run_reproduce,
};
