/* SPDX-License-Identifier: BSD-3-Clause */
/* What yaml_values.c needs of the tree that yaml_doc.c holds. */
#ifndef OPTLA_YAML_IMPL_H
#define OPTLA_YAML_IMPL_H

#include "io/yaml_doc.h"

#include <locale.h>

locale_t optla_yaml_locale_(const optla_yaml *doc);
/* Text of a scalar, NULL for other nodes; quoted: written in quotes or as a block, so never null, a number or a bool by accident. */
const char *optla_yaml_raw_(const optla_yaml *doc, optla_yaml_node node, bool *quoted);
/* "a list", "a mapping", ... for messages */
const char *optla_yaml_kind_(const optla_yaml *doc, optla_yaml_node node);

#endif
