/* SPDX-License-Identifier: BSD-3-Clause */
/* The header of a .npy file: magic, version, length, and a Python dictionary with exactly the keys descr, fortran_order and shape.
   Only that dictionary's grammar is understood; anything else is an error, so no bytes lead outside of the buffer. */
#include "io/npy.h"

#include <string.h>

typedef struct {
	optla_ctx *ctx;
	const char *name;
	const char *p, *end;
} cursor;

static void skip_space(cursor *c)
{
	while (c->p < c->end && (*c->p == ' ' || *c->p == '\n' || *c->p == '\t')) c->p++;
}

static bool take(cursor *c, char wanted)
{
	skip_space(c);
	if (c->p == c->end || *c->p != wanted) return false;
	c->p++;
	return true;
}

static bool take_word(cursor *c, const char *word)
{
	const size_t n = strlen(word);
	skip_space(c);
	if ((size_t)(c->end - c->p) < n || memcmp(c->p, word, n) != 0) return false;
	c->p += n;
	return true;
}

static bool take_string(cursor *c, char *text, size_t bytes)
{
	skip_space(c);
	if (c->p == c->end || (*c->p != '\'' && *c->p != '"')) return false;
	const char quote = *c->p++;
	size_t n = 0;
	while (c->p < c->end && *c->p != quote) {
		if (n + 1 == bytes || *c->p < ' ' || *c->p > '~') return false;
		text[n++] = *c->p++;
	}
	text[n] = '\0';
	return c->p < c->end && *c->p++ == quote;
}

static bool take_size(cursor *c, size_t *value)
{
	skip_space(c);
	size_t v = 0;
	const char *start = c->p;
	for (; c->p < c->end && *c->p >= '0' && *c->p <= '9'; c->p++) {
		const size_t digit = (size_t)(*c->p - '0');
		if (v > (SIZE_MAX - digit) / 10) return false;
		v = v * 10 + digit;
	}
	*value = v;
	if (c->p == start) return false;
	if (c->p < c->end && *c->p == 'L') c->p++; /* long integers of Python 2 */
	return true;
}

static bool known_type(char kind, size_t bytes)
{
	switch (kind) {
	case 'f': return bytes == 2 || bytes == 4 || bytes == 8;
	case 'c': return bytes == 8 || bytes == 16;
	case 'u':
	case 'i': return bytes == 1 || bytes == 2 || bytes == 4 || bytes == 8;
	case 'b': return bytes == 1;
	default: return false;
	}
}

static optla_status parse_descr(cursor *c, optla_npy_header *h)
{
	char descr[16];
	OPTLA_CHECK(c->ctx, take_string(c, descr, sizeof descr), OPTLA_ERR_UNSUPPORTED,
	            "%s: the NPY header's descr is no plain type; allowed are bool, integers, floats and complex numbers", c->name);
	const bool ordered = descr[0] && strchr("<>|=", descr[0]) && descr[1];
	const char *digits = ordered ? descr + 2 : "";
	size_t bytes = 0;
	for (const char *p = digits; *p && bytes < 100; p++) bytes = *p >= '0' && *p <= '9' ? bytes * 10 + (size_t)(*p - '0') : 100;
	OPTLA_CHECK(c->ctx, ordered && *digits != '0' && known_type(descr[1], bytes), OPTLA_ERR_UNSUPPORTED,
	            "%s: NPY type '%s'; allowed are b1, u1, i1 ... u8, i8, f2, f4, f8, c8, c16 with a byte order", c->name, descr);
	const uint16_t one = 1;
	const bool machine_is_big = *(const unsigned char *)&one == 0;
	h->kind = descr[1];
	h->item_bytes = bytes;
	h->big_endian = descr[0] == '>' || (descr[0] == '=' && machine_is_big);
	return OPTLA_OK;
}

static optla_status parse_order(cursor *c, optla_npy_header *h)
{
	h->fortran_order = take_word(c, "True");
	OPTLA_CHECK(c->ctx, h->fortran_order || take_word(c, "False"), OPTLA_ERR_INPUT,
	            "%s: fortran_order in the NPY header is neither True nor False", c->name);
	return OPTLA_OK;
}

static optla_status parse_shape(cursor *c, optla_npy_header *h)
{
	OPTLA_CHECK(c->ctx, take(c, '('), OPTLA_ERR_INPUT, "%s: the NPY header's shape is no tuple", c->name);
	while (!take(c, ')')) {
		OPTLA_CHECK(c->ctx, h->ndims < OPTLA_NPY_DIMS, OPTLA_ERR_UNSUPPORTED, "%s: NPY array of more than %d dimensions", c->name,
		            OPTLA_NPY_DIMS);
		OPTLA_CHECK(c->ctx, take_size(c, &h->shape[h->ndims]), OPTLA_ERR_INPUT,
		            "%s: size %zu of the NPY header's shape is no number", c->name, h->ndims);
		h->ndims++;
		if (take(c, ',')) continue;
		OPTLA_CHECK(c->ctx, take(c, ')'), OPTLA_ERR_INPUT, "%s: the NPY header's shape lacks ')'", c->name);
		break;
	}
	return OPTLA_OK;
}

static optla_status parse_dictionary(cursor *c, optla_npy_header *h)
{
	static const struct {
		const char *key;
		optla_status (*parse)(cursor *, optla_npy_header *);
	} known[] = {{"descr", parse_descr}, {"fortran_order", parse_order}, {"shape", parse_shape}};
	bool seen[3] = {false, false, false};
	OPTLA_CHECK(c->ctx, take(c, '{'), OPTLA_ERR_INPUT, "%s: the NPY header is no dictionary", c->name);
	while (!take(c, '}')) {
		char key[32];
		OPTLA_CHECK(c->ctx, take_string(c, key, sizeof key) && take(c, ':'), OPTLA_ERR_INPUT,
		            "%s: malformed key in the NPY header", c->name);
		size_t k = 0;
		while (k < 3 && strcmp(key, known[k].key)) k++;
		OPTLA_CHECK(c->ctx, k < 3 && !seen[k], OPTLA_ERR_INPUT,
		            "%s: key '%s' in the NPY header; needed are descr, fortran_order and shape, each once", c->name, key);
		seen[k] = true;
		OPTLA_TRY(known[k].parse(c, h));
		if (take(c, ',')) continue;
		OPTLA_CHECK(c->ctx, take(c, '}'), OPTLA_ERR_INPUT, "%s: the NPY header's dictionary lacks '}'", c->name);
		break;
	}
	skip_space(c);
	OPTLA_CHECK(c->ctx, c->p == c->end, OPTLA_ERR_INPUT, "%s: text after the NPY header's dictionary", c->name);
	for (size_t k = 0; k < 3; k++)
		OPTLA_CHECK(c->ctx, seen[k], OPTLA_ERR_INPUT, "%s: the NPY header lacks %s", c->name, known[k].key);
	return OPTLA_OK;
}

optla_status optla_npy_header_parse_(optla_ctx *ctx, const char *name, const void *bytes, size_t nbytes, optla_npy_header *out)
{
	const unsigned char *b = bytes;
	memset(out, 0, sizeof *out);
	OPTLA_CHECK(ctx, nbytes >= 10 && !memcmp(b, "\x93NUMPY", 6), OPTLA_ERR_INPUT,
	            "%s: not an NPY file (no \\x93NUMPY at its start)", name);
	OPTLA_CHECK(ctx, b[6] >= 1 && b[6] <= 3 && b[7] == 0, OPTLA_ERR_UNSUPPORTED,
	            "%s: NPY version %d.%d; allowed are 1.0, 2.0, 3.0", name, b[6], b[7]);
	const size_t start = b[6] == 1 ? 10 : 12;
	OPTLA_CHECK(ctx, nbytes >= start, OPTLA_ERR_INPUT, "%s: truncated NPY header: %zu bytes", name, nbytes);
	size_t length = b[8] | (size_t)b[9] << 8;
	if (start == 12) length |= (size_t)b[10] << 16 | (size_t)b[11] << 24;
	OPTLA_CHECK(ctx, length <= nbytes - start, OPTLA_ERR_INPUT, "%s: NPY header of %zu bytes, but only %zu follow", name, length,
	            nbytes - start);
	cursor c = {ctx, name, (const char *)bytes + start, (const char *)bytes + start + length};
	OPTLA_TRY(parse_dictionary(&c, out));
	out->data_offset = start + length;
	out->count = 1;
	size_t total;
	for (size_t k = 0; k < out->ndims; k++)
		OPTLA_CHECK(ctx, optla_size_mul_(out->count, out->shape[k], &out->count), OPTLA_ERR_INPUT,
		            "%s: the NPY array's shape is beyond the address space", name);
	OPTLA_CHECK(ctx, optla_size_mul_(out->count, out->item_bytes, &total), OPTLA_ERR_INPUT,
	            "%s: the NPY array's size is beyond the address space", name);
	return OPTLA_OK;
}
