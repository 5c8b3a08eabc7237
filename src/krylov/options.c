/* SPDX-License-Identifier: BSD-3-Clause */
/* Options of Krylov runs and their names. */
#include "run.h"

#include <limits.h>

const optla_krylov_options optla_krylov_defaults = {.size = sizeof(optla_krylov_options), .iterations = 20};

static const optla_option fields[] = {
    {"iterations", offsetof(optla_krylov_options, iterations), OPTLA_OPTION_INT, "", 1, 1e6, NULL,
     "largest number of iterations, K"},
    {"budget-photos", offsetof(optla_krylov_options, max_photos), OPTLA_OPTION_INT, "photos", 0, INT_MAX, NULL,
     "stop before more photos than this would be taken; 0: no limit"},
    {"rank", offsetof(optla_krylov_options, rank), OPTLA_OPTION_INT, "", 0, 1e6, NULL,
     "keep the best approximation of this rank of what was captured; 0: all iterations"},
    {"symmetric", offsetof(optla_krylov_options, symmetric), OPTLA_OPTION_BOOL, "", 0, 0, NULL,
     "use the form for symmetric T (coaxial rigs): half the photos"},
    {"tolerance", offsetof(optla_krylov_options, tolerance), OPTLA_OPTION_DOUBLE, "", 0, 1, NULL,
     "stop at this relative residual; 0: don't"},
    {"noise-stop", offsetof(optla_krylov_options, noise_stop), OPTLA_OPTION_BOOL, "", 0, 0, NULL,
     "stop when more photos can't help, judged from the sensor's noise"},
    {"nonnegative", offsetof(optla_krylov_options, nonnegative), OPTLA_OPTION_ENUM, "", 0, 0, "none|clamp|nnls",
     "how a solved illumination is kept free of negative light"},
};
const optla_option_table optla_krylov_table = {"optla_krylov_options", sizeof(optla_krylov_options), &optla_krylov_defaults,
                                               fields, sizeof fields / sizeof *fields};

const char *optla_stop_name(optla_stop stop)
{
	switch (stop) {
	case OPTLA_STOP_ITERATIONS: return "iterations";
	case OPTLA_STOP_TOLERANCE: return "tolerance";
	case OPTLA_STOP_PHOTOS: return "photos";
	case OPTLA_STOP_BREAKDOWN: return "breakdown";
	case OPTLA_STOP_NOISE: return "noise";
	case OPTLA_STOP_CANCELLED: return "cancelled";
	case OPTLA_STOP_NONE: return "none";
	}
	return "unknown";
}
