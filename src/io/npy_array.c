/* SPDX-License-Identifier: BSD-3-Clause */
/* The data of a .npy file: any of NumPy's plain types, in either byte order and either order of indices, as one of our scalars in C
   order. */
#include "io/npy.h"

#include <math.h>
#include <string.h>

static bool machine_is_big(void)
{
	const uint16_t one = 1;
	return 0 == *(const unsigned char *)&one;
}

static optla_scalar scalar_of(const optla_npy_header *h)
{
	if ('c' == h->kind) return 8 == h->item_bytes ? OPTLA_C32 : OPTLA_C64;
	return 'f' == h->kind && h->item_bytes <= 4 ? OPTLA_F32 : OPTLA_F64;
}

/* ---- one number ---- */

/* IEEE 754 binary16: 1 sign, 5 exponent (bias 15), 10 mantissa bits. */
static double from_half(uint16_t bits)
{
	const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
	const double sign = bits >> 15 ? -1 : 1;
	if (31 == exponent) return mantissa ? (double)NAN : sign * (double)INFINITY;
	if (0 == exponent) return sign * ldexp(mantissa, -24);
	return sign * ldexp(1024 + mantissa, exponent - 25);
}

static uint64_t bits_at(const unsigned char *p, size_t bytes, bool big)
{
	uint64_t bits = 0;
	for (size_t k = 0; k < bytes; k++) bits |= (uint64_t)p[big ? bytes - 1 - k : k] << 8 * k;
	return bits;
}

static double float_of(uint64_t bits, size_t bytes)
{
	if (2 == bytes) return from_half((uint16_t)bits);
	if (4 == bytes) {
		const uint32_t narrow = (uint32_t)bits;
		float f;
		memcpy(&f, &narrow, sizeof f);
		return f;
	}
	double d;
	memcpy(&d, &bits, sizeof d);
	return d;
}

/* The number at p of the kinds f (also a part of c), i, u and b. */
static double number_at(const unsigned char *p, char kind, size_t bytes, bool big)
{
	const uint64_t bits = bits_at(p, bytes, big);
	if ('f' == kind || 'c' == kind) return float_of(bits, bytes);
	if ('b' == kind) return bits ? 1 : 0;
	const uint64_t sign = (uint64_t)1 << (8 * bytes - 1);
	if ('u' == kind || !(bits & sign)) return (double)bits;
	return -(double)(((~bits) & (sign - 1)) + 1);
}

/* ---- all of them ---- */

/* Items first, first + step, ... of the file to count places in a row. */
typedef struct {
	const optla_npy_header *h;
	const unsigned char *from;
	char *to;
	optla_scalar type;
	bool as_is; /* the file's bytes are the scalar's */
} converter;

static void convert_row(const converter *c, size_t to_item, size_t first, size_t step, size_t count)
{
	const optla_npy_header *h = c->h;
	const size_t item = h->item_bytes, parts = 'c' == h->kind ? 2 : 1, bytes = item / parts, out = optla_scalar_bytes(c->type);
	const bool single = OPTLA_F32 == c->type || OPTLA_C32 == c->type;
	char *to = c->to + to_item * out;
	for (size_t k = 0; k < count; k++, to += out) {
		const unsigned char *from = c->from + (first + k * step) * item;
		if (c->as_is) {
			memcpy(to, from, item);
			continue;
		}
		for (size_t part = 0; part < parts; part++) {
			const double x = number_at(from + part * bytes, h->kind, bytes, h->big_endian);
			if (single)
				((float *)to)[part] = (float)x;
			else
				((double *)to)[part] = x;
		}
	}
}

/* Fortran order: index k has the step product(shape[0..k)). Rows of the last index are gathered; index runs as an odometer over
   the others. */
static void convert_fortran(const converter *c)
{
	const optla_npy_header *h = c->h;
	const size_t last = h->ndims - 1, row = h->shape[last];
	size_t step[OPTLA_NPY_DIMS], index[OPTLA_NPY_DIMS] = {0}, first = 0;
	step[0] = 1;
	for (size_t k = 1; k <= last; k++) step[k] = step[k - 1] * h->shape[k - 1];
	for (size_t done = 0; done < h->count; done += row) {
		convert_row(c, done, first, step[last], row);
		for (size_t k = last; k-- > 0;) {
			first += step[k];
			if (++index[k] < h->shape[k]) break;
			first -= index[k] * step[k];
			index[k] = 0;
		}
	}
}

optla_status optla_npy_decode_(optla_ctx *ctx, const char *name, const void *bytes, size_t nbytes, optla_array *out)
{
	optla_npy_header h;
	OPTLA_TRY(optla_npy_header_parse_(ctx, name, bytes, nbytes, &h));
	const size_t needed = h.count * h.item_bytes, there = nbytes - h.data_offset;
	OPTLA_CHECK(ctx, needed <= there, OPTLA_ERR_INPUT, "%s: truncated NPY file: its shape needs %zu bytes of data, %zu are there",
	            name, needed, there);
	const optla_scalar type = scalar_of(&h);
	void *data = optla_array_(ctx, h.count, optla_scalar_bytes(type));
	if (!data) return OPTLA_ERR_NOMEM;
	const bool native =
	    ('f' == h.kind || 'c' == h.kind) && h.item_bytes == optla_scalar_bytes(type) && h.big_endian == machine_is_big();
	const converter c = {&h, (const unsigned char *)bytes + h.data_offset, data, type, native};
	if (h.count && h.fortran_order && h.ndims > 1)
		convert_fortran(&c);
	else if (native)
		memcpy(data, c.from, needed);
	else
		convert_row(&c, 0, 0, 1, h.count);
	*out = (optla_array){.ctx = ctx, .ndim = h.ndims, .type = type, .data = data};
	memcpy(out->dims, h.shape, sizeof out->dims);
	return OPTLA_OK;
}

/* ---- writing ---- */

size_t optla_npy_header_make_(const optla_array *array, char header[OPTLA_NPY_HEADER_BYTES])
{
	static const char *const codes[] = {"f4", "f8", "c8", "c16"};
	char *dictionary = header + 10;
	const size_t room = OPTLA_NPY_HEADER_BYTES - 10;
	size_t n = (size_t)snprintf(dictionary, room, "{'descr': '%c%s', 'fortran_order': False, 'shape': (",
	                            machine_is_big() ? '>' : '<', codes[array->type]);
	/* 8 dimensions of at most 20 digits: under 180 characters */
	for (size_t k = 0; k < array->ndim; k++)
		n += (size_t)snprintf(dictionary + n, room - n, "%s%zu%s", k ? " " : "", array->dims[k],
		                      k + 1 < array->ndim || !k ? "," : "");
	n += (size_t)snprintf(dictionary + n, room - n, "), }");
	const size_t total = (10 + n + 1 + 63) / 64 * 64;
	memset(dictionary + n, ' ', total - 10 - n);
	header[total - 1] = '\n';
	memcpy(header, "\x93NUMPY\x01\0", 8);
	header[8] = (char)((total - 10) & 255);
	header[9] = (char)((total - 10) >> 8);
	return total;
}
