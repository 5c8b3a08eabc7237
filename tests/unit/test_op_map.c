/* SPDX-License-Identifier: BSD-3-Clause */
/* Matrices mapped from files: NPY in both orders, HDF5, files that are wrong, and one larger than the memory allowed. */
#include "io/h5.h"
#include "op_kinds.h"

#include <fcntl.h>
#include <unistd.h>

enum { M = 37, N = 11 };

typedef struct {
	error_store e;
	optla_ctx *ctx;
	char dir[64], path[128];
} place;

static place setup(const char *name)
{
	place p = {.dir = "/tmp/optla-map-XXXXXX"};
	ck_assert_ptr_nonnull(mkdtemp(p.dir));
	snprintf(p.path, sizeof p.path, "%s/%s", p.dir, name);
	return p;
}

static void teardown(place *p)
{
	optla_ctx_destroy(&p->ctx);
	remove(p->path);
	ck_assert_int_eq(rmdir(p->dir), 0);
}

static void write_bytes(const char *path, const void *bytes, size_t n)
{
	FILE *f = fopen(path, "wb");
	ck_assert_ptr_nonnull(f);
	ck_assert_uint_eq(fwrite(bytes, 1, n, f), n);
	ck_assert_int_eq(fclose(f), 0);
}

static size_t read_bytes(const char *path, char *bytes, size_t room)
{
	FILE *f = fopen(path, "rb");
	ck_assert_ptr_nonnull(f);
	const size_t n = fread(bytes, 1, room, f);
	fclose(f);
	return n;
}

static void product_is(optla_op *op, optla_cblock t)
{
	const optla_block x = block_random(t.ncols, 2, t.type, 2, false), y = block_new(t.nrows, 2, t.type);
	const optla_block want = block_product(OPTLA_FORWARD, t, optla_block_const(x));
	ok(optla_op_apply(op, OPTLA_FORWARD, optla_block_const(x), y));
	ck_assert_double_le(block_error(optla_block_const(y), optla_block_const(want)), kind_is_single(t.type) ? 2e-6 : 4e-15);
	free(x.data);
	free(y.data);
	free(want.data);
}

/* Sum of up to 37 products: rounding far below sqrt(503) eps as in test_op.c, whose tolerance is used here. */
START_TEST(hdf5_rows_are_rows)
{
	place p = setup("t.h5");
	p.ctx = test_ctx(&p.e, 2);
	const optla_block t = block_random(M, N, (optla_scalar)_i, 1, false);
	/* the dataset's rows are the columns of the block that is put */
	const optla_block rows = block_new(N, M, t.type);
	for (size_t i = 0; i < M; i++)
		for (size_t j = 0; j < N; j++) block_put(rows, j, i, block_get(optla_block_const(t), i, j));
	optla_h5 *file;
	ok(optla_h5_create_(p.ctx, p.path, "test", &file));
	ok(optla_h5_put_(file, "first", optla_block_const(t), NULL, NULL));
	ok(optla_h5_put_(file, "matrix", optla_block_const(rows), "1", NULL));
	ok(optla_h5_finish_(&file, true));
	char spec[160];
	snprintf(spec, sizeof spec, "%s:matrix", p.path);
	optla_op *op;
	ok(optla_op_map(p.ctx, spec, &op));
	ck_assert_uint_eq(optla_op_nrows(op), M);
	ck_assert_uint_eq(optla_op_ncols(op), N);
	product_is(op, optla_block_const(t));
	optla_op_unref(&op);
	/* two datasets: one must be named, and it must exist */
	status_is(optla_op_map(p.ctx, p.path, &op), OPTLA_ERR_INPUT);
	ck_assert_ptr_nonnull(strstr(p.e.text, "first"));
	snprintf(spec, sizeof spec, "%s:absent", p.path);
	status_is(optla_op_map(p.ctx, spec, &op), OPTLA_ERR_INPUT);
	ck_assert_ptr_nonnull(strstr(p.e.text, "absent"));
	free(t.data);
	free(rows.data);
	teardown(&p);
}
END_TEST

START_TEST(cut_and_long_files_are_refused)
{
	place p = setup("t.npy");
	p.ctx = test_ctx(&p.e, 1);
	const optla_block t = block_random(4, 3, OPTLA_F32, 1, false);
	write_npy(p.path, optla_block_const(t), true);
	char bytes[1024];
	const size_t n = read_bytes(p.path, bytes, sizeof bytes);
	optla_op *op;
	for (size_t k = 0; k < n; k++) {
		write_bytes(p.path, bytes, k);
		status_is(optla_op_map(p.ctx, p.path, &op), OPTLA_ERR_INPUT);
		ck_assert_ptr_null(op);
	}
	ck_assert_ptr_nonnull(strstr(p.e.text, "truncated: 4 x 3 f32 at byte 128 need 48 bytes, the file has 175"));
	write_bytes(p.path, bytes, n + 1);
	status_is(optla_op_map(p.ctx, p.path, &op), OPTLA_ERR_INPUT);
	ck_assert_ptr_nonnull(strstr(p.e.text, "1 bytes too many"));
	write_bytes(p.path, bytes, n);
	ok(optla_op_map(p.ctx, p.path, &op));
	optla_op_unref(&op);
	free(t.data);
	teardown(&p);
}
END_TEST

START_TEST(other_files_are_refused)
{
	static const struct {
		const char *header, *text;
	} cases[] = {
	    {"{'descr': '>f4', 'fortran_order': True, 'shape': (4, 3), }", "of the other byte order"},
	    {"{'descr': '<i4', 'fortran_order': True, 'shape': (4, 3), }", "can't be mapped; allowed are f4, f8, c8, c16"},
	    {"{'descr': '<f4', 'fortran_order': True, 'shape': (12,), }", "a matrix has 2 dimensions, this array has 1"},
	    {"{'descr': '<f4', 'fortran_order': True, 'shape': (4, 4611686018427387904), }", "beyond the address space"},
	    {"{'descr': '<f4', 'fortran_order': True, 'shape': (4, 3000000000), }", "truncated"},
	    {"{'descr': '<f4', 'fortran_order': Maybe, 'shape': (4, 3), }", "neither True nor False"},
	    {"{'descr': '<f4', 'shape': (4, 3), }", "lacks fortran_order"},
	    {"{'descr': '<f4', 'fortran_order': True, 'shape': (4, -3), }", "no number"},
	    {"{'descr': '<f4', 'fortran_order': True, 'shape': (4, 3), 'shape': (4, 3)}", "each once"},
	    {"{'descr': '<f4', 'fortran_order': True, 'shape': (4, 3)} + 1", "text after"},
	};
	place p = setup("t.npy");
	p.ctx = test_ctx(&p.e, 1);
	optla_op *op;
	for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
		char bytes[256] = "\x93NUMPY\x01";
		memset(bytes + 10, ' ', 246);
		memcpy(bytes + 10, cases[k].header, strlen(cases[k].header));
		bytes[8] = 118;
		write_bytes(p.path, bytes, 128 + 48);
		status_is(optla_op_map(p.ctx, p.path, &op), OPTLA_ERR_INPUT);
		ck_assert_msg(strstr(p.e.text, cases[k].text), "'%s' lacks '%s'", p.e.text, cases[k].text);
	}
	write_bytes(p.path, "nonsense", 8);
	status_is(optla_op_map(p.ctx, p.path, &op), OPTLA_ERR_INPUT);
	write_bytes(p.path, "", 0);
	status_is(optla_op_map(p.ctx, p.path, &op), OPTLA_ERR_INPUT);
	status_is(optla_op_map(p.ctx, p.dir, &op), OPTLA_ERR_INPUT);
	status_is(optla_op_map(p.ctx, "/nowhere/at/all.npy", &op), OPTLA_ERR_INPUT);
	ck_assert_str_eq(p.e.text, "/nowhere/at/all.npy: can't be opened: No such file or directory");
	status_is(optla_op_map(p.ctx, NULL, &op), OPTLA_ERR_ARG);
	teardown(&p);
}
END_TEST

/* 3 GiB that are almost all a hole in the file, and 64 MiB of memory: six columns hold one number each. */
START_TEST(larger_than_memory)
{
	enum { ROWS = 1 << 20, COLUMNS = 768 };
	static const size_t row[] = {0, 5, 4096, 70000, ROWS / 2, ROWS - 1}, column[] = {0, 1, 100, 383, 766, 767};
	place p = setup("big.npy");
	const optla_ctx_desc d = {
	    .size = sizeof d, .error = error_keep, .error_user = &p.e, .threads = 2, .memory_limit_bytes = 64 << 20};
	ok(optla_ctx_create(&p.ctx, &d));
	const bool by_rows = _i;
	char head[129] = {0};
	snprintf(head, sizeof head, "\x93NUMPY\x01%c%c%c%-117s\n", 1, 118, 1,
	         by_rows ? "{'descr': '<f4', 'fortran_order': False, 'shape': (768, 1048576), }"
	                 : "{'descr': '<f4', 'fortran_order': True, 'shape': (1048576, 768), }");
	head[7] = head[9] = 0;
	const int fd = open(p.path, O_RDWR | O_CREAT, 0600);
	ck_assert_int_ge(fd, 0);
	ck_assert_int_eq(ftruncate(fd, 128 + (off_t)ROWS * COLUMNS * 4), 0);
	ck_assert_int_eq(pwrite(fd, head, 128, 0), 128);
	for (size_t k = 0; k < 6; k++) {
		const float v = (float)(k + 1);
		ck_assert_int_eq(pwrite(fd, &v, 4, 128 + 4 * (off_t)(column[k] * ROWS + row[k])), 4);
	}
	close(fd);
	optla_op *op;
	ok(optla_op_map(p.ctx, p.path, &op));
	ck_assert_uint_eq(optla_op_nrows(op), by_rows ? COLUMNS : ROWS);
	float *tall = calloc(ROWS, sizeof *tall), wide[COLUMNS];
	/* stored column times 1: the number at its row; stored row times 1: the number at its column */
	for (size_t j = 0; j < COLUMNS; j++) wide[j] = 1;
	const optla_trans to_tall = by_rows ? OPTLA_TRANSPOSE : OPTLA_FORWARD, to_wide = by_rows ? OPTLA_FORWARD : OPTLA_TRANSPOSE;
	ok(optla_op_apply(op, to_tall, optla_cblock_(wide, COLUMNS, 1, OPTLA_F32), optla_block_(tall, ROWS, 1, OPTLA_F32)));
	double sum = 0;
	for (size_t i = 0; i < ROWS; i++) sum += (double)tall[i];
	ck_assert(sum == 21);
	for (size_t k = 0; k < 6; k++) ck_assert(tall[row[k]] == (float)(k + 1));
	for (size_t i = 0; i < ROWS; i++) tall[i] = 1;
	ok(optla_op_apply(op, to_wide, optla_cblock_(tall, ROWS, 1, OPTLA_F32), optla_block_(wide, COLUMNS, 1, OPTLA_F32)));
	sum = 0;
	for (size_t j = 0; j < COLUMNS; j++) sum += (double)wide[j];
	ck_assert(sum == 21);
	for (size_t k = 0; k < 6; k++) ck_assert(wide[column[k]] == (float)(k + 1));
	optla_op_unref(&op);
	free(tall);
	teardown(&p);
}
END_TEST

int main(void)
{
	Suite *s = suite_create("op_map");
	TCase *t = tcase_create("map");
	tcase_add_loop_test(t, hdf5_rows_are_rows, OPTLA_F32, OPTLA_C64 + 1);
	tcase_add_test(t, cut_and_long_files_are_refused);
	tcase_add_test(t, other_files_are_refused);
	tcase_add_loop_test(t, larger_than_memory, 0, 2);
	tcase_set_timeout(t, 120);
	suite_add_tcase(s, t);
	return run_suite(s);
}
