/* SPDX-License-Identifier: BSD-3-Clause */
/* A rig file as plain data, checked (docs/rigs.md lists the keys). Nothing here touches a photo. */
#ifndef OPTLA_MANIFEST_H
#define OPTLA_MANIFEST_H

#include "io/yaml_doc.h"
#include "scene/corner_desc.h"

typedef struct {
	char *file;
	optla_yaml_node node;          /* for messages */
	size_t light;                  /* index, or SIZE_MAX: see illumination */
	double *illumination;          /* nlights numbers, NULL: see file */
	const char *illumination_file; /* NULL: given above */
	double exposure_s;
} optla_manifest_photo;

/* Counts to numbers proportional to energy. */
typedef enum { OPTLA_RESPONSE_LINEAR, OPTLA_RESPONSE_SRGB, OPTLA_RESPONSE_GAMMA, OPTLA_RESPONSE_TABLE } optla_response_kind;

typedef struct {
	optla_response_kind kind;
	double gamma; /* linear = (dn / white)^gamma */
	size_t count; /* table: ascending counts, linear values that don't fall */
	double *dn, *linear;
} optla_response;

typedef struct {
	optla_ctx *ctx;
	optla_yaml *doc; /* texts below live in it; messages name its lines */
	const char *name, *data_root, *sensor;
	bool analytic;
	optla_corner_desc corner; /* analytic */
	double exposure_s;

	/* recorded */
	optla_manifest_photo *photos;
	size_t nphotos, nlights;
	optla_yaml_node photos_node, lights_node;
	const char *mask; /* NULL: all pixels */
	size_t crop[4];   /* x, y, width, height; width 0: none */
	const char **dark;
	size_t ndark;
	double black_level_dn;      /* when there are no dark frames */
	optla_yaml_node black_node; /* where it is given */
	optla_response response;
	double saturation_dn; /* 0: the photo's white level */
	bool saturated_is_error;
	const char *directions, *intensities; /* files, NULL: not given */
	double axes[3][3];                    /* rows: the file's x, y, z axes in the camera's frame (right, down, away) */
	bool divide_intensities;
	size_t grid[2]; /* 0: not on a grid */
	bool transpose;
} optla_manifest;

/* Any bytes give a manifest or an error that says line and key. name: of the file, for messages. */
optla_status optla_manifest_parse_(optla_ctx *ctx, const void *bytes, size_t count, const char *name, optla_manifest **out);
void optla_manifest_destroy_(optla_manifest **manifest);

/* The two kinds, used by optla_manifest_parse_(). */
optla_status optla_manifest_recorded_(optla_manifest *m, optla_yaml_node root);
optla_status optla_manifest_photos_(optla_manifest *m, optla_yaml_node root);
optla_status optla_manifest_corner_(optla_manifest *m, optla_yaml_node root);

/* [w, h], whole numbers from 1 to limit. */
optla_status optla_manifest_size_(const optla_yaml *doc, optla_yaml_node node, const char *what, size_t limit, size_t size[2]);
/* Reads map's key if it is there; *value keeps its default otherwise. */
optla_status optla_manifest_number_(const optla_yaml *doc, optla_yaml_node map, const char *key, double lower, double upper,
                                    double *value);
optla_status optla_manifest_text_(const optla_yaml *doc, optla_yaml_node map, const char *key, const char **value);
optla_status optla_manifest_bool_(const optla_yaml *doc, optla_yaml_node map, const char *key, bool *value);

#endif
