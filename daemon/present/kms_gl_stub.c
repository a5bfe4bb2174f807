/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/kms_gl.h"

#include <errno.h>
#include <stddef.h>

struct kms_gl *kms_gl_create(int fd, struct error *error)
{
	error_set(error, -ENOTSUP, "kms: built without GBM: pictures come through CPU memory");
	return NULL;
}

void kms_gl_destroy(struct kms_gl **gl)
{
	*gl = NULL;
}

const struct presenter_context *kms_gl_get_context(const struct kms_gl *gl)
{
	return NULL;
}

int kms_gl_create_buffer(struct kms_gl *gl, uint32_t width, uint32_t height, struct kms_gl_buffer *buffer,
						 struct error *error)
{
	return error_set(error, -ENOTSUP, "kms: built without GBM");
}

void kms_gl_blacken(struct kms_gl *gl, const struct kms_gl_buffer *buffer)
{
}

void kms_gl_destroy_buffer(struct kms_gl *gl, struct kms_gl_buffer *buffer)
{
}

int kms_gl_resize(struct kms_gl *gl, struct kms_gl_large *large, uint32_t width, uint32_t height, struct error *error)
{
	return error_set(error, -ENOTSUP, "kms: built without GBM");
}

void kms_gl_shrink(struct kms_gl *gl, const struct kms_gl_large *large, const struct kms_gl_buffer *buffer,
				   const struct rectangle *part)
{
}

bool kms_gl_can_fence(const struct kms_gl *gl)
{
	return false;
}

int kms_gl_fence(struct kms_gl *gl)
{
	return -1;
}

void kms_gl_wait(struct kms_gl *gl)
{
}
