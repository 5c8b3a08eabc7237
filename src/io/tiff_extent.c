/* SPDX-License-Identifier: BSD-3-Clause */
/* LibRaw takes half a sample at the end of a file for a whole one, and rows that are missing for black in some formats. A DNG says where
   its strips and tiles are (TIFF 6.0, section 2; DNG 1.4, chapter 2), so that a cut one can be told without LibRaw. */
#include "io/tiff_extent.h"

enum {
	MOST_DIRECTORIES = 32,
	DNG_VERSION = 50706,
	SUB_IFD = 330,
	STRIP_OFFSETS = 273,
	STRIP_COUNTS = 279,
	TILE_OFFSETS = 324,
	TILE_COUNTS = 325
};

typedef struct {
	const uint8_t *data;
	size_t count;
	bool little, broken, dng;
	uint32_t todo[MOST_DIRECTORIES];
	size_t ntodo;
} walk;

typedef struct {
	uint64_t at; /* of the first value */
	uint32_t count;
	uint16_t type;
} field;

/* 0 and broken outside of the file. */
static uint32_t number(walk *w, uint64_t at, size_t bytes)
{
	uint32_t v = 0;
	if (at > w->count || w->count - at < bytes) {
		w->broken = true;
		return 0;
	}
	for (size_t k = 0; k < bytes; k++) v |= (uint32_t)w->data[at + (w->little ? k : bytes - 1 - k)] << (8 * k);
	return v;
}

static size_t bytes_of(const field *f) { return 3 == f->type ? 2 : 4; /* SHORT, else LONG or IFD */ }

static uint32_t value(walk *w, const field *f, uint32_t k) { return number(w, f->at + (uint64_t)k * bytes_of(f), bytes_of(f)); }

static field read_field(walk *w, uint64_t entry)
{
	field f = {.type = (uint16_t)number(w, entry + 2, 2), .count = number(w, entry + 4, 4)};
	f.at = (uint64_t)f.count * bytes_of(&f) <= 4 ? entry + 8 : number(w, entry + 8, 4);
	return f;
}

static void push(walk *w, uint32_t directory)
{
	for (size_t k = 0; k < w->ntodo; k++)
		if (w->todo[k] == directory) return; /* a loop ends here */
	if (directory && w->ntodo < MOST_DIRECTORIES) w->todo[w->ntodo++] = directory;
}

static void check_data(walk *w, const field *offsets, const field *counts)
{
	for (uint32_t k = 0; !w->broken && k < offsets->count && k < counts->count; k++) {
		const uint64_t end = (uint64_t)value(w, offsets, k) + value(w, counts, k);
		w->broken = w->broken || end > w->count;
	}
}

static void read_directory(walk *w, uint32_t at)
{
	field offsets = {0}, counts = {0};
	const uint32_t entries = number(w, at, 2);
	for (uint32_t k = 0; !w->broken && k < entries; k++) {
		const uint64_t entry = at + 2 + 12 * (uint64_t)k;
		const field f = read_field(w, entry);
		switch (number(w, entry, 2)) {
		case DNG_VERSION: w->dng = true; break;
		case STRIP_OFFSETS:
		case TILE_OFFSETS: offsets = f; break;
		case STRIP_COUNTS:
		case TILE_COUNTS: counts = f; break;
		case SUB_IFD:
			for (uint32_t i = 0; !w->broken && i < f.count && i < MOST_DIRECTORIES; i++) push(w, value(w, &f, i));
			break;
		}
	}
	check_data(w, &offsets, &counts);
	if (!w->broken) push(w, number(w, at + 2 + 12 * (uint64_t)entries, 4));
}

bool optla_dng_is_whole_(const uint8_t *data, size_t count)
{
	walk w = {.data = data, .count = count, .little = count && 'I' == data[0]};
	if (42 != number(&w, 2, 2) || w.broken) return true;
	push(&w, number(&w, 4, 4));
	for (size_t k = 0; k < w.ntodo && !w.broken; k++) read_directory(&w, w.todo[k]);
	return !w.dng || !w.broken;
}
