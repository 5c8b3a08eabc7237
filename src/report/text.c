/* SPDX-License-Identifier: BSD-3-Clause */
/* Growing text and HTML escaping. */
#include "report/text.h"

#include <string.h>

static bool reserve(optla_text *text, size_t more)
{
	if (OPTLA_OK != text->status) return false;
	if (text->room - text->count > more) return true;
	const size_t room = 2 * (text->count + more) + 256;
	void *data = text->data;
	text->status = optla_grow_(text->ctx, &data, text->count, room, 1);
	if (OPTLA_OK != text->status) return false;
	text->data = data;
	text->room = room;
	return true;
}

void optla_text_add_bytes_(optla_text *text, const char *bytes, size_t count)
{
	if (!reserve(text, count)) return;
	memcpy(text->data + text->count, bytes, count);
	text->count += count;
	text->data[text->count] = 0;
}

static void add_v(optla_text *text, const char *format, va_list arguments)
{
	va_list again;
	va_copy(again, arguments);
	const int count = vsnprintf(NULL, 0, format, again);
	va_end(again);
	if (count < 0 || !reserve(text, (size_t)count + 1)) return;
	vsnprintf(text->data + text->count, (size_t)count + 1, format, arguments);
	text->count += (size_t)count;
}

void optla_text_add_(optla_text *text, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	add_v(text, format, arguments);
	va_end(arguments);
}

size_t optla_utf8_length_(const char *s)
{
	const unsigned char *u = (const unsigned char *)s;
	if (u[0] < 0x80) return 1;
	const size_t n = u[0] >= 0xc2 && u[0] <= 0xdf ? 2 : (u[0] & 0xf0) == 0xe0 ? 3 : u[0] >= 0xf0 && u[0] <= 0xf4 ? 4 : 0;
	for (size_t k = 1; k < n; k++)
		if ((u[k] & 0xc0) != 0x80) return 0;
	/* overlong forms, surrogates, and code points over U+10FFFF */
	if ((u[0] == 0xe0 && u[1] < 0xa0) || (u[0] == 0xed && u[1] > 0x9f)) return 0;
	if ((u[0] == 0xf0 && u[1] < 0x90) || (u[0] == 0xf4 && u[1] > 0x8f)) return 0;
	return n;
}

static void add_escaped(optla_text *text, const char *s)
{
	while (*s) {
		const size_t n = optla_utf8_length_(s);
		const bool control = n == 1 && (unsigned char)*s < 0x20 && *s != '\n' && *s != '\t';
		const char *name = !n || control ? "\xef\xbf\xbd" : *s == '&' ? "&amp;" : *s == '<' ? "&lt;" : NULL;
		if (!name) name = *s == '>' ? "&gt;" : *s == '"' ? "&quot;" : *s == '\'' ? "&#39;" : NULL;
		if (name)
			optla_text_add_bytes_(text, name, strlen(name));
		else
			optla_text_add_bytes_(text, s, n);
		s += n ? n : 1;
	}
}

void optla_text_add_html_v_(optla_text *text, const char *format, va_list arguments)
{
	optla_text plain = {.ctx = text->ctx};
	add_v(&plain, format, arguments);
	if (OPTLA_OK == text->status) text->status = plain.status;
	if (OPTLA_OK == text->status && plain.data) add_escaped(text, plain.data);
	optla_text_free_(&plain);
}

void optla_text_add_html_(optla_text *text, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	optla_text_add_html_v_(text, format, arguments);
	va_end(arguments);
}

void optla_text_free_(optla_text *text)
{
	optla_free(text->ctx, text->data);
	text->data = NULL;
	text->count = text->room = 0;
}
