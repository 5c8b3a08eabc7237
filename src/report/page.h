/* SPDX-License-Identifier: BSD-3-Clause */
/* The page: a section for each figure in DIR/ID/section.html, and DIR/index.html put together from all of them. */
#ifndef OPTLA_PAGE_H
#define OPTLA_PAGE_H

#include "report/figure.h"

/* Heading, how it was made, the figure's body, and the table of its numbers beside the thesis'. */
optla_status optla_page_save_section_(optla_figure *figure, double wall_s);

typedef struct {
	const char *id, *title;
} optla_page_entry;

/* index.html of those of the entries that have a section in out_dir. title, intro_html: trusted HTML. */
optla_status optla_page_save_(optla_ctx *ctx, const char *out_dir, const char *title, const char *intro_html,
                              const optla_page_entry *entries, size_t count);
/* index.html of every figure that has a section in out_dir, in the order of the registry; sections of earlier runs stay. */
optla_status optla_page_save_index_(optla_ctx *ctx, const char *out_dir);

#endif
