/* SPDX-License-Identifier: BSD-3-Clause */
/* The part of Fig. 2.10 on the recorded ball: lights that were held out. */
#ifndef OPTLA_HELD_OUT_H
#define OPTLA_HELD_OUT_H

#include "report/lab.h"

optla_status optla_figure_held_out_(optla_figure *figure);

#endif
