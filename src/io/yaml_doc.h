/* SPDX-License-Identifier: BSD-3-Clause */
/* YAML with errors that name file, line, key, the value found and what is allowed (over libyaml's document tree). */
#ifndef OPTLA_YAML_DOC_H
#define OPTLA_YAML_DOC_H

#include "base/base_impl.h"

typedef struct optla_yaml optla_yaml;
typedef int optla_yaml_node; /* 0: none */

/* One document; a second one, nesting over 64 levels, a key given twice, a zero byte, more than 32 MiB are errors. */
optla_status optla_yaml_parse_(optla_ctx *ctx, const void *bytes, size_t count, const char *name, optla_yaml **out);
void optla_yaml_destroy_(optla_yaml **doc);

optla_yaml_node optla_yaml_root_(const optla_yaml *doc);
int optla_yaml_line_(const optla_yaml *doc, optla_yaml_node node);
/* OPTLA_ERR_INPUT with "FILE:LINE: " before the message. */
optla_status optla_yaml_fail_(const optla_yaml *doc, optla_yaml_node node, const char *format, ...) OPTLA_PRINTF(3, 4);

bool optla_yaml_is_map_(const optla_yaml *doc, optla_yaml_node node);
bool optla_yaml_is_list_(const optla_yaml *doc, optla_yaml_node node);
bool optla_yaml_is_scalar_(const optla_yaml *doc, optla_yaml_node node);
/* The node must be a mapping that has only keys of "a|b|c", none twice; the error names the nearest allowed key. */
optla_status optla_yaml_check_keys_(const optla_yaml *doc, optla_yaml_node map, const char *allowed);
/* Value of a key, 0 if absent. */
optla_yaml_node optla_yaml_get_(const optla_yaml *doc, optla_yaml_node map, const char *key);
/* As get, but absence is an error that names the map's line and the key. */
optla_status optla_yaml_require_(const optla_yaml *doc, optla_yaml_node map, const char *key, optla_yaml_node *node);
/* Number of keys of a mapping (0 for other nodes) and the k-th of them, in the order of the file. */
size_t optla_yaml_pairs_(const optla_yaml *doc, optla_yaml_node map);
optla_yaml_node optla_yaml_key_(const optla_yaml *doc, optla_yaml_node map, size_t k);
size_t optla_yaml_count_(const optla_yaml *doc, optla_yaml_node list);
optla_yaml_node optla_yaml_item_(const optla_yaml *doc, optla_yaml_node list, size_t k);

/* Readers of values; what names the key in messages. NaN and text are errors; range ends are included, so .inf passes where
   an end is infinite. Numbers are read in the C locale. The value is set on success alone. */
optla_status optla_yaml_number_(const optla_yaml *doc, optla_yaml_node node, const char *what, double lower, double upper,
                                double *value);
optla_status optla_yaml_int_(const optla_yaml *doc, optla_yaml_node node, const char *what, int lower, int upper, int *value);
optla_status optla_yaml_bool_(const optla_yaml *doc, optla_yaml_node node, const char *what, bool *value);
/* Text lives as long as the document. */
optla_status optla_yaml_text_(const optla_yaml *doc, optla_yaml_node node, const char *what, const char **value);
/* List of exactly count numbers. */
optla_status optla_yaml_numbers_(const optla_yaml *doc, optla_yaml_node node, const char *what, size_t count, double *values);

#endif
