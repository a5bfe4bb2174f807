/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The part of OpenGL that read-back needs, looked up through the caller, so
 * that the library links no GL and includes no GL header. Values and types
 * are those of the OpenGL registry.
 */
#ifndef PURSUIT_CLIENT_GL_API_H
#define PURSUIT_CLIENT_GL_API_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "client/pursuit.h"

#define SHIM_GL_NONE 0u
#define SHIM_GL_TEXTURE_2D 0x0DE1u
#define SHIM_GL_VERSION 0x1F02u
#define SHIM_GL_EXTENSIONS 0x1F03u
#define SHIM_GL_MAJOR_VERSION 0x821Bu
#define SHIM_GL_MINOR_VERSION 0x821Cu
#define SHIM_GL_NUM_EXTENSIONS 0x821Du

#define SHIM_GL_UNSIGNED_BYTE 0x1401u
#define SHIM_GL_UNSIGNED_SHORT 0x1403u
#define SHIM_GL_INT 0x1404u
#define SHIM_GL_UNSIGNED_INT 0x1405u
#define SHIM_GL_FLOAT 0x1406u
#define SHIM_GL_HALF_FLOAT 0x140Bu
#define SHIM_GL_UNSIGNED_INT_2_10_10_10_REV 0x8368u
#define SHIM_GL_UNSIGNED_NORMALIZED 0x8C17u
#define SHIM_GL_DEPTH_COMPONENT 0x1902u
#define SHIM_GL_RED 0x1903u
#define SHIM_GL_RGBA 0x1908u
#define SHIM_GL_BGRA 0x80E1u
#define SHIM_GL_RG 0x8227u
#define SHIM_GL_RED_INTEGER 0x8D94u
#define SHIM_GL_RGBA_INTEGER 0x8D99u

#define SHIM_GL_PACK_SWAP_BYTES 0x0D00u
#define SHIM_GL_PACK_LSB_FIRST 0x0D01u
#define SHIM_GL_PACK_ROW_LENGTH 0x0D02u
#define SHIM_GL_PACK_SKIP_ROWS 0x0D03u
#define SHIM_GL_PACK_SKIP_PIXELS 0x0D04u
#define SHIM_GL_PACK_ALIGNMENT 0x0D05u
#define SHIM_GL_CLAMP_READ_COLOR 0x891Cu

#define SHIM_GL_PIXEL_PACK_BUFFER 0x88EBu
#define SHIM_GL_PIXEL_PACK_BUFFER_BINDING 0x88EDu
#define SHIM_GL_STREAM_READ 0x88E1u
#define SHIM_GL_MAP_READ_BIT 0x0001u

#define SHIM_GL_READ_FRAMEBUFFER 0x8CA8u
#define SHIM_GL_DRAW_FRAMEBUFFER 0x8CA9u
#define SHIM_GL_READ_FRAMEBUFFER_BINDING 0x8CAAu
#define SHIM_GL_DRAW_FRAMEBUFFER_BINDING 0x8CA6u
#define SHIM_GL_FRAMEBUFFER_COMPLETE 0x8CD5u
#define SHIM_GL_COLOR_ATTACHMENT0 0x8CE0u
#define SHIM_GL_DEPTH_ATTACHMENT 0x8D00u
#define SHIM_GL_ATTACHMENT_RED_SIZE 0x8212u
#define SHIM_GL_ATTACHMENT_COMPONENT_TYPE 0x8211u
#define SHIM_GL_IMPLEMENTATION_COLOR_READ_TYPE 0x8B9Au
#define SHIM_GL_IMPLEMENTATION_COLOR_READ_FORMAT 0x8B9Bu

#define SHIM_GL_SYNC_GPU_COMMANDS_COMPLETE 0x9117u
#define SHIM_GL_SYNC_FLUSH_COMMANDS_BIT 0x0001u
#define SHIM_GL_ALREADY_SIGNALED 0x911Au
#define SHIM_GL_CONDITION_SATISFIED 0x911Cu

/* X(result, name, arguments) for each function. */
#define SHIM_GL_FUNCTIONS(X)                                                                \
	X(const uint8_t *, GetString, (uint32_t))                                               \
	X(const uint8_t *, GetStringi, (uint32_t, uint32_t))                                    \
	X(void, GetIntegerv, (uint32_t, int32_t *))                                             \
	X(void, PixelStorei, (uint32_t, int32_t))                                               \
	X(void, GenFramebuffers, (int32_t, uint32_t *))                                         \
	X(void, DeleteFramebuffers, (int32_t, const uint32_t *))                                \
	X(void, BindFramebuffer, (uint32_t, uint32_t))                                          \
	X(void, FramebufferTexture2D, (uint32_t, uint32_t, uint32_t, uint32_t, int32_t))        \
	X(uint32_t, CheckFramebufferStatus, (uint32_t))                                         \
	X(void, GetFramebufferAttachmentParameteriv, (uint32_t, uint32_t, uint32_t, int32_t *)) \
	X(void, DrawBuffers, (int32_t, const uint32_t *))                                       \
	X(void, ReadBuffer, (uint32_t))                                                         \
	X(void, ReadPixels, (int32_t, int32_t, int32_t, int32_t, uint32_t, uint32_t, void *))   \
	X(void, GenBuffers, (int32_t, uint32_t *))                                              \
	X(void, DeleteBuffers, (int32_t, const uint32_t *))                                     \
	X(void, BindBuffer, (uint32_t, uint32_t))                                               \
	X(void, BufferData, (uint32_t, ptrdiff_t, const void *, uint32_t))                      \
	X(void *, MapBufferRange, (uint32_t, ptrdiff_t, ptrdiff_t, uint32_t))                   \
	X(uint8_t, UnmapBuffer, (uint32_t))                                                     \
	X(void *, FenceSync, (uint32_t, uint32_t))                                              \
	X(void, DeleteSync, (void *))                                                           \
	X(uint32_t, ClientWaitSync, (void *, uint32_t, uint64_t))

struct shim_gl_api {
#define MEMBER(result, name, arguments) result(*name) arguments;
	SHIM_GL_FUNCTIONS(MEMBER)
#undef MEMBER
	void (*ClampColor)(uint32_t, uint32_t); /* desktop only */
	bool es;
	bool float_targets; /* float textures can be attached and read */
};

/* Fills the table from the current context. False if a function is missing or the version is too old. */
bool shim_gl_api_load(struct shim_gl_api *api, pursuit_gl_lookup lookup);

#endif
