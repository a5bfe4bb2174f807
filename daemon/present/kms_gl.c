/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/present/kms_gl.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>
#include <errno.h>
#include <gbm.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Of the extension GL_OES_EGL_image. */
typedef void (*image_target_function)(GLenum target, EGLImageKHR image);

struct kms_gl {
	struct gbm_device *gbm;
	EGLDisplay display;
	EGLContext context;
	struct presenter_context offered;
	GLuint framebuffer, source;

	PFNEGLCREATEIMAGEKHRPROC create_image;
	PFNEGLDESTROYIMAGEKHRPROC destroy_image;
	image_target_function image_target;
	PFNGLGENTEXTURESPROC gen_textures;
	PFNGLDELETETEXTURESPROC delete_textures;
	PFNGLBINDTEXTUREPROC bind_texture;
	PFNGLGENFRAMEBUFFERSPROC gen_framebuffers;
	PFNGLBINDFRAMEBUFFERPROC bind_framebuffer;
	PFNGLFRAMEBUFFERTEXTURE2DPROC framebuffer_texture;
	PFNGLCHECKFRAMEBUFFERSTATUSPROC check_framebuffer_status;
	PFNGLCLEARBUFFERFVPROC clear_buffer;
	PFNGLTEXIMAGE2DPROC tex_image;
	PFNGLTEXPARAMETERIPROC tex_parameter;
	PFNGLGENERATEMIPMAPPROC generate_mipmap;
	PFNGLBLITFRAMEBUFFERPROC blit_framebuffer;
	PFNGLGETERRORPROC get_error;
	PFNGLFLUSHPROC flush;
	PFNGLFINISHPROC finish;

	/* NULL where there are no fences */
	PFNEGLCREATESYNCKHRPROC create_sync;
	PFNEGLDESTROYSYNCKHRPROC destroy_sync;
	PFNEGLDUPNATIVEFENCEFDANDROIDPROC dup_fence;
};

/* ---- the context ---- */

static bool enter(void *data)
{
	const struct kms_gl *gl = data;
	if (eglGetCurrentContext() == gl->context)
		return true;
	return eglBindAPI(EGL_OPENGL_API) && eglMakeCurrent(gl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, gl->context);
}

static void release(void *data)
{
	const struct kms_gl *gl = data;
	eglMakeCurrent(gl->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

const struct presenter_context *kms_gl_get_context(const struct kms_gl *gl)
{
	return &gl->offered;
}

static bool find_functions(struct kms_gl *gl)
{
	static const struct {
		const char *name;
		size_t offset;
	} functions[] = {
		{"eglCreateImageKHR", offsetof(struct kms_gl, create_image)},
		{"eglDestroyImageKHR", offsetof(struct kms_gl, destroy_image)},
		{"glEGLImageTargetTexture2DOES", offsetof(struct kms_gl, image_target)},
		{"glGenTextures", offsetof(struct kms_gl, gen_textures)},
		{"glDeleteTextures", offsetof(struct kms_gl, delete_textures)},
		{"glBindTexture", offsetof(struct kms_gl, bind_texture)},
		{"glGenFramebuffers", offsetof(struct kms_gl, gen_framebuffers)},
		{"glBindFramebuffer", offsetof(struct kms_gl, bind_framebuffer)},
		{"glFramebufferTexture2D", offsetof(struct kms_gl, framebuffer_texture)},
		{"glCheckFramebufferStatus", offsetof(struct kms_gl, check_framebuffer_status)},
		{"glClearBufferfv", offsetof(struct kms_gl, clear_buffer)},
		{"glTexImage2D", offsetof(struct kms_gl, tex_image)},
		{"glTexParameteri", offsetof(struct kms_gl, tex_parameter)},
		{"glGenerateMipmap", offsetof(struct kms_gl, generate_mipmap)},
		{"glBlitFramebuffer", offsetof(struct kms_gl, blit_framebuffer)},
		{"glGetError", offsetof(struct kms_gl, get_error)},
		{"glFlush", offsetof(struct kms_gl, flush)},
		{"glFinish", offsetof(struct kms_gl, finish)},
	};
	for (size_t i = 0; i < sizeof(functions) / sizeof(functions[0]); i++) {
		void (*function)(void) = eglGetProcAddress(functions[i].name);
		if (!function)
			return false;
		memcpy((char *)gl + functions[i].offset, &function, sizeof(function));
	}
	return true;
}

static bool lists(const char *extensions, const char *name)
{
	return extensions && strstr(extensions, name) != NULL;
}

static int open_display(struct kms_gl *gl, struct error *error)
{
	PFNEGLGETPLATFORMDISPLAYEXTPROC get_display =
		(PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
	gl->display = get_display ? get_display(EGL_PLATFORM_GBM_KHR, gl->gbm, NULL) : EGL_NO_DISPLAY;
	if (gl->display == EGL_NO_DISPLAY || !eglInitialize(gl->display, NULL, NULL)) {
		gl->display = EGL_NO_DISPLAY;
		return error_set(error, -ENODEV, "EGL does not work on it (0x%x)", (unsigned)eglGetError());
	}
	const char *extensions = eglQueryString(gl->display, EGL_EXTENSIONS);
	static const char *const needed[] = {"EGL_KHR_image_pixmap", "EGL_KHR_surfaceless_context",
										 "EGL_KHR_no_config_context"};
	for (size_t i = 0; i < sizeof(needed) / sizeof(needed[0]); i++)
		if (!lists(extensions, needed[i]))
			return error_set(error, -ENOTSUP, "EGL lacks %s", needed[i]);
	return 0;
}

static void find_fences(struct kms_gl *gl)
{
	if (!lists(eglQueryString(gl->display, EGL_EXTENSIONS), "EGL_ANDROID_native_fence_sync"))
		return;
	gl->create_sync = (PFNEGLCREATESYNCKHRPROC)eglGetProcAddress("eglCreateSyncKHR");
	gl->destroy_sync = (PFNEGLDESTROYSYNCKHRPROC)eglGetProcAddress("eglDestroySyncKHR");
	if (gl->create_sync && gl->destroy_sync)
		gl->dup_fence = (PFNEGLDUPNATIVEFENCEFDANDROIDPROC)eglGetProcAddress("eglDupNativeFenceFDANDROID");
}

static int open_context(struct kms_gl *gl, struct error *error)
{
	static const EGLint attributes[] = {
		EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
		EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
	if (eglBindAPI(EGL_OPENGL_API))
		gl->context = eglCreateContext(gl->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
	if (gl->context == EGL_NO_CONTEXT)
		return error_set(error, -ENOTSUP, "EGL gives no OpenGL 4.3 (0x%x)", (unsigned)eglGetError());
	find_fences(gl);
	return find_functions(gl) ? 0 : error_set(error, -ENOTSUP, "its GL takes no buffers of others");
}

struct kms_gl *kms_gl_create(int fd, struct error *error)
{
	struct kms_gl *gl = calloc(1, sizeof(*gl));
	struct error why = {"out of memory"};
	if (gl) {
		gl->display = EGL_NO_DISPLAY;
		gl->context = EGL_NO_CONTEXT;
		gl->gbm = gbm_create_device(fd);
		if (!gl->gbm)
			error_set(&why, -ENODEV, "GBM does not know it");
		else if (open_display(gl, &why) == 0 && open_context(gl, &why) == 0) {
			gl->offered = (struct presenter_context){
				.name = "display (GBM)", .enter = enter, .release = release, .find = eglGetProcAddress, .data = gl};
			return gl;
		}
	}
	error_set(error, -ENODEV, "kms: no buffers that GL can draw into: %s", why.text);
	kms_gl_destroy(&gl);
	return NULL;
}

void kms_gl_destroy(struct kms_gl **gl)
{
	struct kms_gl *self = *gl;
	*gl = NULL;
	if (!self)
		return;
	if (self->context != EGL_NO_CONTEXT)
		eglDestroyContext(self->display, self->context);
	if (self->display != EGL_NO_DISPLAY)
		eglTerminate(self->display);
	if (self->gbm)
		gbm_device_destroy(self->gbm);
	free(self);
}

/* ---- buffers ---- */

static bool is_drawable(struct kms_gl *gl, const struct kms_gl_buffer *buffer)
{
	if (!gl->framebuffer)
		gl->gen_framebuffers(1, &gl->framebuffer);
	gl->bind_framebuffer(GL_FRAMEBUFFER, gl->framebuffer);
	gl->framebuffer_texture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, buffer->texture, 0);
	return gl->check_framebuffer_status(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

void kms_gl_blacken(struct kms_gl *gl, const struct kms_gl_buffer *buffer)
{
	static const GLfloat black[4] = {0.0f, 0.0f, 0.0f, 1.0f};
	if (!is_drawable(gl, buffer))
		return;
	gl->clear_buffer(GL_COLOR, 0, black);
}

int kms_gl_create_buffer(struct kms_gl *gl, uint32_t width, uint32_t height, struct kms_gl_buffer *buffer,
						 struct error *error)
{
	struct gbm_bo *bo =
		gbm_bo_create(gl->gbm, width, height, GBM_FORMAT_XRGB8888, GBM_BO_USE_SCANOUT | GBM_BO_USE_RENDERING);
	*buffer = (struct kms_gl_buffer){.bo = bo};
	if (!bo)
		return error_set(error, -errno, "kms: no buffer of %ux%u that GL can draw into: %s", width, height,
						 strerror(errno));
	buffer->handle = gbm_bo_get_handle(bo).u32;
	buffer->stride = gbm_bo_get_stride(bo);
	buffer->image = gl->create_image(gl->display, EGL_NO_CONTEXT, EGL_NATIVE_PIXMAP_KHR, (EGLClientBuffer)bo, NULL);
	if (buffer->image) {
		gl->gen_textures(1, &buffer->texture);
		gl->bind_texture(GL_TEXTURE_2D, buffer->texture);
		gl->image_target(GL_TEXTURE_2D, buffer->image);
		if (is_drawable(gl, buffer)) {
			kms_gl_blacken(gl, buffer);
			return 0;
		}
	}
	kms_gl_destroy_buffer(gl, buffer);
	return error_set(error, -ENOTSUP, "kms: GL does not draw into a buffer of %ux%u", width, height);
}

void kms_gl_destroy_buffer(struct kms_gl *gl, struct kms_gl_buffer *buffer)
{
	if (buffer->texture && eglGetCurrentContext() == gl->context)
		gl->delete_textures(1, &buffer->texture);
	if (buffer->image)
		gl->destroy_image(gl->display, buffer->image);
	if (buffer->bo)
		gbm_bo_destroy(buffer->bo);
	memset(buffer, 0, sizeof(*buffer));
}

/* ---- pictures larger than a buffer ---- */

int kms_gl_resize(struct kms_gl *gl, struct kms_gl_large *large, uint32_t width, uint32_t height, struct error *error)
{
	if (large->width == width && large->height == height)
		return 0;
	if (large->texture)
		gl->delete_textures(1, &large->texture);
	*large = (struct kms_gl_large){0, 0, 0};
	if (width == 0)
		return 0;
	/* A lost context has an error for ever. */
	for (int i = 0; i < 8 && gl->get_error() != 0; i++)
		continue;
	gl->gen_textures(1, &large->texture);
	gl->bind_texture(GL_TEXTURE_2D, large->texture);
	gl->tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
	gl->tex_image(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, (GLsizei)width, (GLsizei)height, 0, GL_BGRA,
				  GL_UNSIGNED_INT_8_8_8_8_REV, NULL);
	if (gl->get_error() != 0) {
		gl->delete_textures(1, &large->texture);
		large->texture = 0;
		return error_set(error, -ENOMEM, "kms: GL has no memory for a picture of %ux%u", width, height);
	}
	large->width = width;
	large->height = height;
	return 0;
}

/* How often it can be halved without getting smaller than this. */
static GLint halvings(const struct kms_gl_large *large, const struct rectangle *part)
{
	GLint level = 0;
	while (large->width >> (level + 1) >= part->width && large->height >> (level + 1) >= part->height)
		level++;
	return level;
}

void kms_gl_shrink(struct kms_gl *gl, const struct kms_gl_large *large, const struct kms_gl_buffer *buffer,
				   const struct rectangle *part)
{
	const GLint level = halvings(large, part);
	const GLint x = (GLint)part->x, y = (GLint)part->y;
	if (!is_drawable(gl, buffer))
		return;
	if (level > 0) {
		gl->bind_texture(GL_TEXTURE_2D, large->texture);
		gl->tex_parameter(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, level);
		gl->generate_mipmap(GL_TEXTURE_2D);
	}
	if (!gl->source)
		gl->gen_framebuffers(1, &gl->source);
	gl->bind_framebuffer(GL_READ_FRAMEBUFFER, gl->source);
	gl->framebuffer_texture(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, large->texture, level);
	gl->blit_framebuffer(0, 0, (GLint)(large->width >> level), (GLint)(large->height >> level), x, y,
						 x + (GLint)part->width, y + (GLint)part->height, GL_COLOR_BUFFER_BIT, GL_LINEAR);
}

/* ---- when it is drawn ---- */

bool kms_gl_can_fence(const struct kms_gl *gl)
{
	return gl->dup_fence != NULL;
}

int kms_gl_fence(struct kms_gl *gl)
{
	const EGLSyncKHR sync = gl->create_sync(gl->display, EGL_SYNC_NATIVE_FENCE_ANDROID, NULL);
	if (sync == EGL_NO_SYNC_KHR)
		return -1;
	/* It is the kernel's only once what stands before it has been sent there. */
	gl->flush();
	const int fence = gl->dup_fence(gl->display, sync);
	gl->destroy_sync(gl->display, sync);
	return fence;
}

void kms_gl_wait(struct kms_gl *gl)
{
	gl->finish();
}
