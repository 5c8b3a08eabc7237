/* SPDX-License-Identifier: BSD-3-Clause */
/** @file optla.h All of Optla. */
#ifndef OPTLA_OPTLA_H
#define OPTLA_OPTLA_H
#include "optla/base.h"
#include "optla/image.h"
#include "optla/krylov.h"
#include "optla/op.h"
#include "optla/relight.h"
#include "optla/report.h"
#include "optla/rig.h"
#include "optla/sensor.h"
#endif
