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
#include "daemon/present/rectangle.h"

struct kms_gl;

/* A buffer of XRGB8888, black. Zeroed: none. */
struct kms_gl_buffer {
	uint32_t texture; /* row 0 on top */
	uint32_t handle;  /* the kernel's, of the device that was given */
	uint32_t stride;  /* bytes */
	void *bo, *image;
};

/* A texture for a picture that is larger than such a buffer. Zeroed: none; it goes with the context. */
struct kms_gl_large {
	uint32_t texture; /* row 0 on top */
	uint32_t width, height;
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
/* Both 0: gives its memory back. */
int kms_gl_resize(struct kms_gl *gl, struct kms_gl_large *large, uint32_t width, uint32_t height, struct error *error);
/* Draws it into this part of the buffer, which is smaller: halved by the mean light, then by the mean of neighbours. */
void kms_gl_shrink(struct kms_gl *gl, const struct kms_gl_large *large, const struct kms_gl_buffer *buffer,
				   const struct rectangle *part);

/* Is there EGL_ANDROID_native_fence_sync? */
bool kms_gl_can_fence(const struct kms_gl *gl);
/* A descriptor (sync file), the caller's, that signals when all is drawn that was asked for by now. -1: there is none.
 */
int kms_gl_fence(struct kms_gl *gl);
/* Waits for that. */
void kms_gl_wait(struct kms_gl *gl);

/* Also on main, once the context is current nowhere; then the texture goes with the context. */
void kms_gl_destroy_buffer(struct kms_gl *gl, struct kms_gl_buffer *buffer);

#endif
