/* SPDX-License-Identifier: BSD-3-Clause */
/* Text that grows. The first failure stays in status and later calls do nothing, so a writer checks once, at its end. */
#ifndef OPTLA_TEXT_H
#define OPTLA_TEXT_H

#include "base/base_impl.h"

typedef struct {
	optla_ctx *ctx;
	char *data; /* always terminated once something was added; freed with optla_free */
	size_t count, room;
	optla_status status;
} optla_text;

/* Formatted text as it is. */
void optla_text_add_(optla_text *text, const char *format, ...) OPTLA_PRINTF(2, 3);
/* Formatted text of which the whole result is escaped for HTML, quotes included: safe in elements and in attributes. */
void optla_text_add_html_(optla_text *text, const char *format, ...) OPTLA_PRINTF(2, 3);
void optla_text_add_html_v_(optla_text *text, const char *format, va_list arguments);
void optla_text_add_bytes_(optla_text *text, const char *bytes, size_t count);
void optla_text_free_(optla_text *text);

/* Length of the UTF-8 sequence that starts at s, 0 if it isn't well formed (overlong, surrogate, cut off). */
size_t optla_utf8_length_(const char *s);

#endif
