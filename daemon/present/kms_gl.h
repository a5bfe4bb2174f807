/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Scan-out buffers that GL draws into: buffers of the display controller's own
 * driver (GBM), each a texture of a context that its GPU gives (EGL). A stub
 * where GBM is not built in; where it does not work, pictures come through CPU
 * memory as before.
 *
 * kms_gl_create() and kms_gl_destroy() on main, the others on the render thread
 * with the context current.
 */
#ifndef PURSUIT_KMS_GL_H
#define PURSUIT_KMS_GL_H

#include <stdint.h>

#include "daemon/error.h"
#include "daemon/present/presenter.h"

struct kms_gl;

/* A buffer of XRGB8888, black. Zeroed: none. */
struct kms_gl_buffer {
	uint32_t texture; /* row 0 on top */
	uint32_t handle;  /* the kernel's, of the device that was given */
	uint32_t stride;  /* bytes */
	void *bo, *image;
};

/* fd: of the display controller, open for as long. NULL with a sentence. */
struct kms_gl *kms_gl_create(int fd, struct error *error);
/* Its context is current nowhere, its buffers were destroyed. NULL accepted. */
void kms_gl_destroy(struct kms_gl **gl);

/* Lives as long. */
const struct presenter_context *kms_gl_get_context(const struct kms_gl *gl);

/* 0 or a negative errno with a sentence. */
int kms_gl_create_buffer(struct kms_gl *gl, uint32_t width, uint32_t height, struct kms_gl_buffer *buffer,
						 struct error *error);
/* Makes all of it black. */
void kms_gl_blacken(struct kms_gl *gl, const struct kms_gl_buffer *buffer);
/* Also on main, once the context is current nowhere; then the texture goes with the context. */
void kms_gl_destroy_buffer(struct kms_gl *gl, struct kms_gl_buffer *buffer);

#endif
