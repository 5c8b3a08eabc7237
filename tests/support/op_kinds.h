/* SPDX-License-Identifier: BSD-3-Clause */
/* One operator of each kind, with the matrix that it must be, for tests of operators. */
#ifndef OPTLA_TEST_OP_KINDS_H
#define OPTLA_TEST_OP_KINDS_H

#include "base/random.h"
#include "math/dense.h"
#include "near.h"
#include "optla/op.h"

#include <complex.h>

static inline bool kind_is_complex(optla_scalar type) { return type == OPTLA_C32 || type == OPTLA_C64; }
static inline bool kind_is_single(optla_scalar type) { return type == OPTLA_F32 || type == OPTLA_C32; }

static inline double complex block_get(optla_cblock b, size_t i, size_t j)
{
	const size_t k = j * b.ld + i;
	switch (b.type) {
	case OPTLA_F32: return ((const float *)b.data)[k];
	case OPTLA_F64: return ((const double *)b.data)[k];
	case OPTLA_C32: return ((const float complex *)b.data)[k];
	default: return ((const double complex *)b.data)[k];
	}
}

static inline void block_put(optla_block b, size_t i, size_t j, double complex v)
{
	const size_t k = j * b.ld + i;
	switch (b.type) {
	case OPTLA_F32: ((float *)b.data)[k] = (float)creal(v); break;
	case OPTLA_F64: ((double *)b.data)[k] = creal(v); break;
	case OPTLA_C32: ((float complex *)b.data)[k] = (float complex)v; break;
	default: ((double complex *)b.data)[k] = v; break;
	}
}

static inline optla_block block_new(size_t m, size_t n, optla_scalar type)
{
	const optla_block b = optla_block_(calloc(m * n + 1, optla_scalar_bytes(type)), m, n, type);
	ck_assert_ptr_nonnull(b.data);
	return b;
}

/* Normal numbers; with light uniform ones in [0, 1). */
static inline optla_block block_random(size_t m, size_t n, optla_scalar type, uint64_t seed, bool light)
{
	const optla_rand r = {.seed = seed, .stream_hi = OPTLA_RAND_TEST};
	const optla_block b = block_new(m, n, type);
	for (size_t j = 0; j < n; j++)
		for (size_t i = 0; i < m; i++) {
			const double re = light ? optla_rand_u01_(r, j * m + i, 0, 0) : optla_rand_normal_(r, j * m + i, 0, 0);
			const double im = kind_is_complex(type) ? optla_rand_normal_(r, j * m + i, 1, 0) : 0;
			block_put(b, i, j, re + I * im);
		}
	return b;
}

/* The definition: y = T x, Tᵀ x, Tᴴ x, term by term in double. */
static inline optla_block block_product(optla_trans trans, optla_cblock t, optla_cblock x)
{
	const size_t m = trans == OPTLA_FORWARD ? t.nrows : t.ncols;
	const optla_block y = block_new(m, x.ncols, kind_is_complex(t.type) ? OPTLA_C64 : OPTLA_F64);
	for (size_t k = 0; k < x.ncols; k++)
		for (size_t i = 0; i < m; i++) {
			double complex s = 0;
			for (size_t j = 0; j < x.nrows; j++) {
				const double complex v = trans == OPTLA_FORWARD ? block_get(t, i, j) : block_get(t, j, i);
				s += (trans == OPTLA_CONJ_TRANSPOSE ? conj(v) : v) * block_get(x, j, k);
			}
			block_put(y, i, k, s);
		}
	return y;
}

/* Largest |a - b| over the largest |b|. */
static inline double block_error(optla_cblock a, optla_cblock b)
{
	double worst = 0, scale = 0;
	ck_assert(a.nrows == b.nrows && a.ncols == b.ncols);
	for (size_t j = 0; j < a.ncols; j++)
		for (size_t i = 0; i < a.nrows; i++) {
			const double e = cabs(block_get(a, i, j) - block_get(b, i, j));
			worst = isfinite(e) ? fmax(worst, e) : INFINITY;
			scale = fmax(scale, cabs(block_get(b, i, j)));
		}
	return scale > 0 ? worst / scale : worst;
}

/* ---- light with ambient light and noise, as rigs have it ---- */

typedef struct {
	optla_ctx *ctx;
	optla_block t;
	double ambient;   /* at full power 1 */
	double read;      /* standard deviation of a sample at full power 1 */
	double per_light; /* photon noise: variance per unit of y at full power 1 */
	uint64_t seed, photos;
	double noise;
} test_light;

static inline optla_status test_light_expose(void *user, optla_trans trans, optla_cblock x, const double *power, optla_block y)
{
	test_light *l = user;
	OPTLA_TRY(optla_dense_apply_(l->ctx, trans, optla_block_const(l->t), x, y));
	const optla_rand r = {.seed = l->seed, .stream_hi = OPTLA_RAND_TEST};
	for (size_t j = 0; j < y.ncols; j++, l->photos++) {
		double variance = 0;
		for (size_t i = 0; i < y.nrows; i++) {
			const double v = optla_get_(optla_block_const(y), i, j);
			const double var = power[j] * power[j] * l->read * l->read + power[j] * l->per_light * v;
			const double e = var > 0 ? sqrt(var) * optla_rand_normal_(r, l->photos, (uint32_t)i, 0) : 0;
			optla_set_(y, i, j, v + power[j] * l->ambient + e);
			variance += var;
		}
		l->noise = sqrt(variance);
	}
	return OPTLA_OK;
}

static inline void test_light_cost(void *user, optla_op_cost *cost)
{
	const test_light *l = user;
	cost->photos += l->photos;
	cost->exposure_s += 0.25 * (double)l->photos;
}

static inline double test_light_noise(void *user) { return ((const test_light *)user)->noise; }

static inline void test_light_destroy(void *user)
{
	test_light *l = user;
	free(l->t.data);
	free(l);
}

/* The caller may change ambient, read, per_light through *light while the operator lives. */
static inline optla_op *test_light_op(optla_ctx *ctx, optla_block t, test_light **light)
{
	test_light *l = calloc(1, sizeof *l);
	ck_assert_ptr_nonnull(l);
	l->ctx = ctx;
	l->t = t;
	const optla_op_desc d = {.size = sizeof d,
	                         .name = "light",
	                         .nrows = t.nrows,
	                         .ncols = t.ncols,
	                         .type = t.type,
	                         .flags = OPTLA_OP_NONNEGATIVE,
	                         .user = l,
	                         .expose = test_light_expose,
	                         .destroy = test_light_destroy,
	                         .cost = test_light_cost,
	                         .noise = test_light_noise};
	optla_op *op;
	ok(optla_op_create(ctx, &op, &d));
	if (light) *light = l;
	return op;
}

/* ---- kinds ---- */

typedef struct {
	const char *name;
	/* *t: the matrix (C64 or F64 or the type itself), malloc'ed. NULL operator: this kind doesn't have the type. */
	optla_op *(*make)(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t);
} op_kind;

static inline optla_op *make_dense(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t)
{
	optla_op *op;
	*t = block_random(m, n, type, 1, false);
	ok(optla_op_dense(ctx, optla_block_const(*t), true, &op));
	return op;
}

static inline optla_op *make_sparse(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t)
{
	const optla_rand r = {.seed = 2, .stream_hi = OPTLA_RAND_TEST};
	const optla_block numbers = block_random(m * n, 1, type, 3, false);
	uint64_t *start = calloc(m + 1, sizeof *start);
	uint32_t *column = calloc(m * n + 1, sizeof *column);
	optla_block values = block_new(m * n, 1, type);
	size_t count = 0;
	*t = block_new(m, n, type);
	for (size_t i = 0; i < m; i++) {
		for (size_t j = 0; j < n; j++) {
			/* a sixth of the entries; row 1 and column 1 are empty */
			if (i == 1 || j == 1 || optla_rand_u01_(r, i, (uint32_t)j, 0) > 1.0 / 6) continue;
			const double complex v = block_get(optla_block_const(numbers), j * m + i, 0);
			block_put(*t, i, j, v);
			block_put(values, count, 0, v);
			column[count++] = (uint32_t)j;
		}
		start[i + 1] = count;
	}
	values.nrows = values.ld = count;
	optla_op *op;
	ok(optla_op_sparse(ctx, m, n, start, column, optla_block_const(values), &op));
	free(start);
	free(column);
	free(values.data);
	free(numbers.data);
	return op;
}

static inline optla_op *make_lowrank(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t)
{
	const optla_block l = block_random(m, 5, type, 4, false), r = block_random(n, 5, type, 5, false);
	optla_op *op;
	ok(optla_op_lowrank(ctx, optla_block_const(l), optla_block_const(r), &op));
	*t = block_new(m, n, kind_is_complex(type) ? OPTLA_C64 : OPTLA_F64);
	for (size_t i = 0; i < m; i++)
		for (size_t j = 0; j < n; j++) {
			double complex s = 0;
			for (size_t k = 0; k < 5; k++) s += block_get(optla_block_const(l), i, k) * block_get(optla_block_const(r), j, k);
			block_put(*t, i, j, s);
		}
	free(l.data);
	free(r.data);
	return op;
}

static inline optla_op *make_product(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t)
{
	optla_block ta, tb;
	optla_op *a = make_dense(ctx, m, 31, type, &ta), *b = make_sparse(ctx, 31, n, type, &tb), *op;
	ok(optla_op_product(a, b, &op));
	*t = block_product(OPTLA_FORWARD, optla_block_const(ta), optla_block_const(tb));
	optla_op_unref(&a);
	optla_op_unref(&b);
	free(ta.data);
	free(tb.data);
	return op;
}

static inline optla_op *make_adjoint(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t)
{
	optla_block ta;
	optla_op *a = make_dense(ctx, n, m, type, &ta), *op;
	ok(optla_op_adjoint(a, &op));
	*t = block_new(m, n, type);
	for (size_t i = 0; i < m; i++)
		for (size_t j = 0; j < n; j++) block_put(*t, i, j, conj(block_get(optla_block_const(ta), j, i)));
	optla_op_unref(&a);
	free(ta.data);
	return op;
}

static inline optla_op *make_checked(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t)
{
	optla_op *a = make_dense(ctx, m, n, type, t), *op;
	ok(optla_op_checked(a, &op));
	optla_op_unref(&a);
	return op;
}

static inline optla_op *make_light(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t)
{
	if (kind_is_complex(type)) return NULL;
	*t = block_random(m, n, type, 6, true);
	return test_light_op(ctx, block_random(m, n, type, 6, true), NULL);
}

static inline optla_op *make_split(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t, optla_split split)
{
	if (kind_is_complex(type)) return NULL;
	test_light *l;
	*t = block_random(m, n, type, 7, true);
	optla_op *light = test_light_op(ctx, block_random(m, n, type, 7, true), &l), *op;
	l->ambient = 0.5;
	ok(optla_op_signed(light, split, &op));
	optla_op_unref(&light);
	return op;
}

static inline optla_op *make_signed(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t)
{
	return make_split(ctx, m, n, type, t, OPTLA_SPLIT_SIGNED);
}

static inline optla_op *make_offset(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t)
{
	return make_split(ctx, m, n, type, t, OPTLA_SPLIT_OFFSET);
}

static inline optla_op *make_auto(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t)
{
	return make_split(ctx, m, n, type, t, OPTLA_SPLIT_AUTO);
}

/* Writes a matrix as .npy and maps it. */
static inline void write_npy(const char *path, optla_cblock t, bool fortran)
{
	static const char *const types[] = {"<f4", "<f8", "<c8", "<c16"};
	char head[128] = "\x93NUMPY\x01";
	const int n = snprintf(head + 10, sizeof head - 10, "{'descr': '%s', 'fortran_order': %s, 'shape': (%zu, %zu), }",
	                       types[t.type], fortran ? "True" : "False", t.nrows, t.ncols);
	memset(head + 10 + n, ' ', sizeof head - 10 - (size_t)n);
	head[127] = '\n';
	head[8] = 118;
	FILE *f = fopen(path, "wb");
	ck_assert_ptr_nonnull(f);
	fwrite(head, 1, sizeof head, f);
	const size_t bytes = optla_scalar_bytes(t.type), outer = fortran ? t.ncols : t.nrows, inner = fortran ? t.nrows : t.ncols;
	for (size_t a = 0; a < outer; a++)
		for (size_t b = 0; b < inner; b++)
			fwrite((const char *)t.data + (fortran ? a * t.ld + b : b * t.ld + a) * bytes, bytes, 1, f);
	ck_assert_int_eq(fclose(f), 0);
}

static inline optla_op *make_mapped(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t, bool fortran)
{
	char path[] = "/tmp/optla-test-XXXXXX";
	const int fd = mkstemp(path);
	ck_assert_int_ge(fd, 0);
	*t = block_random(m, n, type, 8, false);
	write_npy(path, optla_block_const(*t), fortran);
	optla_op *op;
	ok(optla_op_map(ctx, path, &op));
	remove(path); /* the mapping keeps the pages */
	fclose(fdopen(fd, "r"));
	return op;
}

static inline optla_op *make_map_rows(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t)
{
	return make_mapped(ctx, m, n, type, t, false);
}

static inline optla_op *make_map_columns(optla_ctx *ctx, size_t m, size_t n, optla_scalar type, optla_block *t)
{
	return make_mapped(ctx, m, n, type, t, true);
}

static const op_kind op_kinds[] = {
    {"dense", make_dense},     {"sparse", make_sparse},   {"low rank", make_lowrank},     {"product", make_product},
    {"adjoint", make_adjoint}, {"checked", make_checked}, {"light", make_light},          {"signed", make_signed},
    {"offset", make_offset},   {"auto", make_auto},       {"map by rows", make_map_rows}, {"map by columns", make_map_columns},
};
enum { OP_KINDS = sizeof op_kinds / sizeof *op_kinds };

#endif
