/* SPDX-License-Identifier: BSD-3-Clause */
/* The verbs, one file each. */
#ifndef OPTLA_VERBS_H
#define OPTLA_VERBS_H

#include "cli.h"

extern const cli_verb cli_verb_compare, cli_verb_demo, cli_verb_dual, cli_verb_info, cli_verb_invert, cli_verb_krylov,
    cli_verb_relight, cli_verb_reproduce;

#endif
