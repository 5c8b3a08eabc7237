/* SPDX-License-Identifier: BSD-3-Clause */
/* Small pictures and files for the tests of image files. */
#ifndef OPTLA_TEST_PICTURES_H
#define OPTLA_TEST_PICTURES_H

#include "near.h"
#include "optla/image.h"

/* A name for a file of this process; the last four given out stay valid. */
static inline const char *temporary(const char *name)
{
	static char paths[4][512];
	static int next;
	const char *dir = getenv("TMPDIR");
	char *path = paths[next++ % 4];
	snprintf(path, sizeof paths[0], "%s/optla-%ld-%s", dir ? dir : "/tmp", (long)getpid(), name);
	return path;
}

/* Samples that each format of this kind holds exactly. */
static inline optla_image *picture(optla_ctx *ctx, size_t w, size_t h, size_t c, optla_image_kind kind)
{
	optla_image *m;
	ok(optla_image_create(ctx, w, h, c, kind, &m));
	uint32_t v = 12345;
	for (size_t k = 0; k < w * h * c; k++) {
		v = v * 1664525u + 1013904223u;
		const bool alpha = 0 == c % 2 && k % c == c - 1;
		if (OPTLA_IMAGE_RAW_DN == kind)
			m->data[k] = alpha ? (float)(v >> 16) / 65535 : (float)(v >> 16);
		else if (OPTLA_IMAGE_DISPLAY == kind || alpha)
			m->data[k] = (float)(v >> 24) / 255;
		else
			m->data[k] = ((float)(v >> 8) - 3e6f) * 1e-5f;
	}
	if (OPTLA_IMAGE_RAW_DN == kind) m->white_dn = 4095;
	return m;
}

static inline void *whole_file(const char *path, size_t *count)
{
	FILE *f = fopen(path, "rb");
	ck_assert_msg(NULL != f, "%s can't be opened", path);
	ck_assert_int_eq(fseek(f, 0, SEEK_END), 0);
	const long n = ftell(f);
	rewind(f);
	void *bytes = malloc((size_t)n + 1);
	ck_assert_uint_eq(fread(bytes, 1, (size_t)n, f), (size_t)n);
	fclose(f);
	*count = (size_t)n;
	return bytes;
}

static inline void *golden(const char *name, size_t *count)
{
	char path[1024];
	snprintf(path, sizeof path, "%s/tests/golden/%s", OPTLA_SOURCE_ROOT, name);
	return whole_file(path, count);
}

#endif
