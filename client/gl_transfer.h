/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * How a texture becomes a plane: what glReadPixels is asked for, and what is
 * left to do while copying. Pure.
 *
 * Desktop GL converts to nearly everything, so it is asked for the plane's own
 * format. GLES reads three portable pairs (RGBA bytes, floats or integers, by
 * the kind of the texture) and one of the driver's choice; the driver's choice
 * is taken where it is the plane's format, otherwise the portable one.
 */
#ifndef PURSUIT_CLIENT_GL_TRANSFER_H
#define PURSUIT_CLIENT_GL_TRANSFER_H

#include <stdbool.h>
#include <stdint.h>

#include "client/gl_rows.h"

/* What is known of an attached texture. */
struct shim_gl_source {
	bool es;
	bool is_depth;           /* attached as depth */
	uint32_t component_type; /* as GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE gives it */
	uint32_t red_bits;
	uint32_t driver_format; /* GLES: the driver's pair */
	uint32_t driver_type;
};

struct shim_gl_transfer {
	uint32_t format; /* for glReadPixels */
	uint32_t type;
	uint32_t pixel_bytes; /* in the pixel buffer */
	shim_row row;
	struct shim_row_options options;
};

/* NULL and *transfer filled for a plane of this role and format, or why it cannot be read. */
const char *shim_gl_transfer_choose(struct shim_gl_transfer *transfer, uint32_t role, uint32_t format,
									const struct shim_gl_source *source);

#endif
