/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "stage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TARGET_COLOR, TARGET_DEPTH, TARGET_BACKWARD, TARGET_ID, TARGET_FORWARD };

static GLuint create_texture(struct scene *scene, GLenum internal, GLenum format, GLenum type)
{
	const struct scene_gl *gl = &scene->gl;
	GLuint texture = 0;
	gl->GenTextures(1, &texture);
	gl->BindTexture(GL_TEXTURE_2D, texture);
	gl->TexImage2D(GL_TEXTURE_2D, 0, (GLint)internal, (GLsizei)scene->width, (GLsizei)scene->height, 0, format, type,
				   NULL);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
	return texture;
}

static bool finish_frame(const struct scene *scene, const GLuint *textures, GLuint frame)
{
	const struct scene_gl *gl = &scene->gl;
	GLenum buffers[4];
	gl->BindFramebuffer(GL_FRAMEBUFFER, frame);
	for (GLuint i = 0; i < 4; i++) {
		buffers[i] = textures[i] ? GL_COLOR_ATTACHMENT0 + i : GL_NONE;
		gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0 + i, GL_TEXTURE_2D, textures[i], 0);
	}
	gl->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, scene->depth_buffer);
	gl->DrawBuffers(4, buffers);
	return gl->CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

static bool create_ui(struct scene *scene)
{
	const struct scene_gl *gl = &scene->gl;
	const GLenum buffer = GL_COLOR_ATTACHMENT0;
	scene->ui = create_texture(scene, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE);
	gl->GenFramebuffers(1, &scene->ui_frame);
	gl->BindFramebuffer(GL_FRAMEBUFFER, scene->ui_frame);
	gl->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, scene->ui, 0);
	gl->DrawBuffers(1, &buffer);
	return gl->CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

bool stage_create_targets(struct scene *scene, char *error, size_t error_size)
{
	const struct scene_gl *gl = &scene->gl;
	GLint limit = 0;
	gl->GetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
	if ((GLint)scene->width > limit || (GLint)scene->height > limit) {
		snprintf(error, error_size, "the picture is %ux%u, but this GL's textures end at %d", scene->width,
				 scene->height, limit);
		return false;
	}
	scene->targets[TARGET_COLOR] = create_texture(scene, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE);
	scene->targets[TARGET_DEPTH] = create_texture(scene, GL_R32F, GL_RED, GL_FLOAT);
	scene->targets[TARGET_BACKWARD] = create_texture(scene, GL_RG32F, GL_RG, GL_FLOAT);
	scene->targets[TARGET_ID] = create_texture(scene, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT);
	gl->GenRenderbuffers(1, &scene->depth_buffer);
	gl->BindRenderbuffer(GL_RENDERBUFFER, scene->depth_buffer);
	gl->RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, (GLsizei)scene->width, (GLsizei)scene->height);
	gl->GenFramebuffers(1, &scene->frame);
	if (!finish_frame(scene, scene->targets, scene->frame) || (scene->kind->overlay && !create_ui(scene))) {
		snprintf(error, error_size, "this GL cannot render to colour, depth, motion and id of %ux%u at once",
				 scene->width, scene->height);
		return false;
	}
	scene->has_targets = true;
	return true;
}

bool stage_create_forward(struct scene *scene)
{
	if (scene->forward_frame)
		return true;
	scene->targets[TARGET_FORWARD] = create_texture(scene, GL_RG32F, GL_RG, GL_FLOAT);
	scene->gl.GenFramebuffers(1, &scene->forward_frame);
	const GLuint textures[4] = {0, 0, scene->targets[TARGET_FORWARD], 0};
	return finish_frame(scene, textures, scene->forward_frame);
}

void stage_destroy_targets(struct scene *scene)
{
	const struct scene_gl *gl = &scene->gl;
	const GLuint frames[3] = {scene->frame, scene->forward_frame, scene->ui_frame};
	gl->DeleteFramebuffers(3, frames);
	gl->DeleteRenderbuffers(1, &scene->depth_buffer);
	gl->DeleteTextures(STAGE_ATTACHMENTS, scene->targets);
	gl->DeleteTextures(1, &scene->ui);
	memset(scene->targets, 0, sizeof(scene->targets));
	scene->ui = scene->depth_buffer = scene->frame = scene->forward_frame = scene->ui_frame = 0;
	scene->has_targets = scene->has_forward = scene->ui_drawn = scene->drawn = false;
}

/* One kind of picture to read: what is wanted, and its pixels. */
struct read_job {
	GLuint frame;
	GLenum attachment;
	GLenum format, type;
	GLenum wide_format; /* the format that GLES always allows */
	uint32_t channels, channel_size;
	uint8_t *out;
	bool swap; /* red and blue */
};

static void copy_rows(const struct scene *scene, const struct read_job *job, const uint8_t *raw, uint32_t raw_channels)
{
	size_t pixel = (size_t)job->channels * job->channel_size, raw_pixel = (size_t)raw_channels * job->channel_size;
	for (uint32_t y = 0; y < scene->height; y++) {
		const uint8_t *from = raw + (size_t)(scene->height - 1 - y) * scene->width * raw_pixel;
		uint8_t *to = job->out + (size_t)y * scene->width * pixel;
		if (raw_channels == job->channels)
			memcpy(to, from, scene->width * pixel);
		for (uint32_t x = 0; raw_channels != job->channels && x < scene->width; x++)
			memcpy(to + x * pixel, from + x * raw_pixel, pixel);
		for (uint32_t x = 0; job->swap && x < scene->width; x++) {
			uint8_t red = to[x * 4];
			to[x * 4] = to[x * 4 + 2];
			to[x * 4 + 2] = red;
		}
	}
}

static void read_one(const struct scene *scene, const struct read_job *job, uint8_t *raw)
{
	const struct scene_gl *gl = &scene->gl;
	if (!job->out)
		return;
	GLenum format = job->format;
	uint32_t channels = job->channels;
	gl->BindFramebuffer(GL_FRAMEBUFFER, job->frame);
	gl->ReadBuffer(job->attachment);
	if (gl->es && format != job->wide_format) {
		GLint native_format = 0, native_type = 0;
		gl->GetIntegerv(GL_IMPLEMENTATION_COLOR_READ_FORMAT, &native_format);
		gl->GetIntegerv(GL_IMPLEMENTATION_COLOR_READ_TYPE, &native_type);
		if ((GLenum)native_format != format || (GLenum)native_type != job->type) {
			format = job->wide_format;
			channels = 4;
		}
	}
	gl->ReadPixels(0, 0, (GLsizei)scene->width, (GLsizei)scene->height, format, job->type, raw);
	copy_rows(scene, job, raw, channels);
}

bool scene_read(struct scene *scene, const struct scene_pixels *pixels)
{
	const struct scene_gl *gl = &scene->gl;
	if (!scene->has_targets || (pixels->ui && !scene->ui) || (pixels->forward && !scene->has_forward))
		return false;
	uint8_t *raw = malloc((size_t)scene->width * scene->height * 16);
	if (!raw)
		return false;
	const struct read_job jobs[] = {
		{scene->frame, GL_COLOR_ATTACHMENT0, GL_RGBA, GL_UNSIGNED_BYTE, GL_RGBA, 4, 1, pixels->color, true},
		{scene->frame, GL_COLOR_ATTACHMENT1, GL_RED, GL_FLOAT, GL_RGBA, 1, 4, (uint8_t *)pixels->depth, false},
		{scene->frame, GL_COLOR_ATTACHMENT2, GL_RG, GL_FLOAT, GL_RGBA, 2, 4, (uint8_t *)pixels->backward, false},
		{scene->frame, GL_COLOR_ATTACHMENT3, GL_RED_INTEGER, GL_UNSIGNED_INT, GL_RGBA_INTEGER, 1, 4,
		 (uint8_t *)pixels->object_id, false},
		{scene->forward_frame, GL_COLOR_ATTACHMENT2, GL_RG, GL_FLOAT, GL_RGBA, 2, 4, (uint8_t *)pixels->forward, false},
		{scene->ui_frame, GL_COLOR_ATTACHMENT0, GL_RGBA, GL_UNSIGNED_BYTE, GL_RGBA, 4, 1, pixels->ui, true},
	};
	while (gl->GetError() != GL_NO_ERROR)
		;
	gl->BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
	gl->PixelStorei(GL_PACK_ALIGNMENT, 1);
	gl->PixelStorei(GL_PACK_ROW_LENGTH, 0);
	gl->PixelStorei(GL_PACK_SKIP_ROWS, 0);
	gl->PixelStorei(GL_PACK_SKIP_PIXELS, 0);
	for (size_t i = 0; i < sizeof(jobs) / sizeof(jobs[0]); i++)
		read_one(scene, &jobs[i], raw);
	free(raw);
	return gl->GetError() == GL_NO_ERROR;
}

void scene_pixels_finish(struct scene_pixels *pixels)
{
	free(pixels->color);
	free(pixels->depth);
	free(pixels->backward);
	free(pixels->forward);
	free(pixels->object_id);
	free(pixels->ui);
	*pixels = (struct scene_pixels){.color = NULL};
}
