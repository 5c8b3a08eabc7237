/* SPDX-License-Identifier: BSD-3-Clause */
/* What a file is, from its content: signatures; for TIFF a look at the first directory, since camera RAW files are TIFFs too. */
#include "io/file_type.h"
#include "io/whole_file.h"

#include <ctype.h>
#include <errno.h>
#include <string.h>
#include <sys/stat.h>

/* Something that bytes can be had from: memory, or a file of which only a few bytes are needed. */
typedef struct {
	const uint8_t *data; /* NULL: file */
	size_t count;
	FILE *file;
} peeked;

/* Up to count bytes at offset; fewer at the end. */
static size_t peek(const peeked *p, uint64_t offset, void *to, size_t count)
{
	if (!p->data) {
		if (offset > INT64_MAX || fseeko(p->file, (off_t)offset, SEEK_SET)) return 0;
		return fread(to, 1, count, p->file);
	}
	if (offset >= p->count) return 0;
	const size_t n = optla_min_(count, p->count - (size_t)offset);
	memcpy(to, p->data + offset, n);
	return n;
}

typedef struct {
	size_t offset;
	const char *bytes;
	size_t count;
	optla_file_type type;
} signature;

#define SIGNATURE(offset, text, type)       \
	{                                       \
		offset, text, sizeof text - 1, type \
	}
static const signature signatures[] = {
    SIGNATURE(0, "\x89PNG\r\n\x1a\n", OPTLA_FILE_PNG),
    SIGNATURE(0, "\x76\x2f\x31\x01", OPTLA_FILE_EXR),
    SIGNATURE(0, "\x93NUMPY", OPTLA_FILE_NPY),
    SIGNATURE(0, "PK\x03\x04", OPTLA_FILE_NPZ),
    SIGNATURE(0, "PK\x05\x06", OPTLA_FILE_NPZ), /* an archive without members */
    SIGNATURE(0, "\x89HDF\r\n\x1a\n", OPTLA_FILE_HDF5),
    SIGNATURE(0, "FUJIFILMCCD-RAW", OPTLA_FILE_RAW),
    SIGNATURE(0, "IIU\0", OPTLA_FILE_RAW), /* Panasonic RW2 */
    SIGNATURE(0, "IIRO", OPTLA_FILE_RAW),  /* Olympus ORF, three variants */
    SIGNATURE(0, "IIRS", OPTLA_FILE_RAW),
    SIGNATURE(0, "MMOR", OPTLA_FILE_RAW),
    SIGNATURE(0, "\0MRM", OPTLA_FILE_RAW),    /* Minolta */
    SIGNATURE(0, "FOVb", OPTLA_FILE_RAW),     /* Sigma X3F */
    SIGNATURE(6, "HEAPCCDR", OPTLA_FILE_RAW), /* Canon CRW */
    SIGNATURE(4, "ftypcrx ", OPTLA_FILE_RAW), /* Canon CR3 */
};

static bool has_pfm_start(const uint8_t *head, size_t count)
{
	return count >= 3 && 'P' == head[0] && ('F' == head[1] || 'f' == head[1]) && isspace(head[2]);
}

static uint32_t number(const uint8_t *p, size_t bytes, bool little)
{
	uint32_t v = 0;
	for (size_t k = 0; k < bytes; k++) v |= (uint32_t)p[little ? k : bytes - 1 - k] << (8 * k);
	return v;
}

/* A TIFF is a camera RAW file if its first directory says DNG (50706) or colour filter array (photometric 32803), or has a camera's
   make (271) and sub-directories (330), in which cameras keep the sensor data; or if it has the mark of Canon's CR2. */
static bool is_tiff_raw(const peeked *p, const uint8_t *head, bool little)
{
	enum { MAKE = 271, PHOTOMETRIC = 262, SUB_IFD = 330, DNG_VERSION = 50706, COLOUR_FILTER_ARRAY = 32803, MOST_ENTRIES = 512 };
	uint8_t entry[12];
	bool make = false, sub = false;
	if ('C' == head[8] && 'R' == head[9]) return true;
	const uint64_t directory = number(head + 4, 4, little);
	if (2 != peek(p, directory, entry, 2)) return false;
	const uint32_t count = number(entry, 2, little);
	for (uint32_t k = 0; k < count && k < MOST_ENTRIES; k++) {
		if (sizeof entry != peek(p, directory + 2 + 12 * (uint64_t)k, entry, sizeof entry)) return false;
		switch (number(entry, 2, little)) {
		case DNG_VERSION: return true;
		case PHOTOMETRIC:
			if (COLOUR_FILTER_ARRAY == number(entry + 8, 2, little)) return true;
			break;
		case MAKE: make = true; break;
		case SUB_IFD: sub = true; break;
		}
	}
	return make && sub;
}

static bool is_tiff(const uint8_t *head, size_t count, bool *little, bool *big)
{
	if (count < 10 || head[0] != head[1] || ('I' != head[0] && 'M' != head[0])) return false;
	*little = 'I' == head[0];
	const uint32_t version = number(head + 2, 2, *little);
	*big = 43 == version;
	return 42 == version || 43 == version;
}

static bool is_text(const uint8_t *head, size_t count)
{
	for (size_t k = 0; k < count; k++)
		if ((head[k] < 0x20 && !strchr("\t\n\r", head[k])) || 0 == head[k] || 0x7f == head[k]) return false;
	return true;
}

/* Text whose first line that is no comment, directive or document mark is "key: ..." or starts with a brace. */
static bool is_yaml(const uint8_t *head, size_t count)
{
	if (!is_text(head, count)) return false;
	const char *line = (const char *)head, *end = line + count;
	while (line < end) {
		const char *next = memchr(line, '\n', (size_t)(end - line)), *stop = next ? next : end;
		while (line < stop && (' ' == *line || '\t' == *line || '\r' == *line)) line++;
		const size_t n = (size_t)(stop - line);
		const bool skip = !n || '#' == *line || '%' == *line || (n >= 3 && !memcmp(line, "---", 3));
		if (!skip) {
			if ('{' == *line) return true;
			for (const char *c = line + 1; c < stop; c++)
				if (':' == *c && (c + 1 == stop || isspace((unsigned char)c[1]))) return true;
			return false;
		}
		line = next ? next + 1 : end;
	}
	return false;
}

static optla_file_type type_of(const peeked *p)
{
	uint8_t head[4096] = {0};
	const size_t count = peek(p, 0, head, sizeof head);
	bool little = false, big = false;
	for (size_t k = 0; k < sizeof signatures / sizeof *signatures; k++) {
		const signature *s = &signatures[k];
		if (count >= s->offset + s->count && !memcmp(head + s->offset, s->bytes, s->count)) return s->type;
	}
	if (has_pfm_start(head, count)) return OPTLA_FILE_PFM;
	if (is_tiff(head, count, &little, &big)) return !big && is_tiff_raw(p, head, little) ? OPTLA_FILE_RAW : OPTLA_FILE_TIFF;
	return is_yaml(head, count) ? OPTLA_FILE_YAML : OPTLA_FILE_UNKNOWN;
}

optla_file_type optla_file_type_of_bytes_(const void *bytes, size_t count)
{
	const peeked p = {.data = count ? bytes : (const uint8_t *)"", .count = count};
	return type_of(&p);
}

optla_status optla_file_type_of(optla_ctx *ctx, const char *path, optla_file_type *type)
{
	*type = OPTLA_FILE_UNKNOWN;
	char text[128];
	struct stat info;
	const int missing = stat(path, &info) ? errno : 0;
	OPTLA_CHECK(ctx, !missing, OPTLA_ERR_INPUT, "%s: %s", path, optla_errno_text_(missing, text, sizeof text));
	OPTLA_CHECK(ctx, S_ISREG(info.st_mode), OPTLA_ERR_INPUT, "%s: is a %s, a file is needed", path,
	            S_ISDIR(info.st_mode) ? "directory" : "pipe or a device");
	FILE *file = fopen(path, "rb");
	OPTLA_CHECK(ctx, file, OPTLA_ERR_IO, "%s: can't be opened: %s", path, optla_errno_text_(errno, text, sizeof text));
	const peeked p = {.file = file};
	*type = type_of(&p);
	const bool failed = ferror(file);
	fclose(file);
	OPTLA_CHECK(ctx, !failed, OPTLA_ERR_IO, "%s: can't be read", path);
	return OPTLA_OK;
}
