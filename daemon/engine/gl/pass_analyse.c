/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Depth and motion to the plan where that is asked of the GPU (docs/method.md, 12): planes up and a dispatch, by bands
 * of rows, so that little memory does for them; vertices back; the triangles are the CPU's. Where GL cannot, it is the
 * CPU's all.
 */
#include "daemon/engine/gl/executor_gl.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/engine/analysis/job.h"
#include "daemon/engine/pass.h"
#include "shaders/limits.h"

_Static_assert(PLAN_TILE_SIDE == PLAN_TILE, "the shader's tiles are the plan's");
_Static_assert(sizeof(struct plan_vertex) == 24, "the shader writes six words a vertex");

/* The block `job` of shaders/analyse.comp, std140. */
struct shader_job {
	int32_t picture[4], planes[4], kinds[4];
	float scale[4], range[4];
	int32_t band[4];
};

/* Rows of the picture, about; more where a cell has more. */
#define BAND_ROWS 32u

/* Some rows of vertices and the rows of the planes that these are made of. */
struct band {
	uint32_t first, count; /* of vertices */
	struct band_rows {
		uint32_t first, count;
	} motion, depth;
};

struct plane_kind {
	GLenum internal, format, type;
	uint32_t bytes;
};

static struct plane_kind kind_of(uint32_t format)
{
	switch (format) {
	case PURSUIT_FORMAT_RG32F:
		return (struct plane_kind){GL_RG32UI, GL_RG_INTEGER, GL_UNSIGNED_INT, 8};
	case PURSUIT_FORMAT_DEPTH16:
		return (struct plane_kind){GL_R16UI, GL_RED_INTEGER, GL_UNSIGNED_SHORT, 2};
	default:
		return (struct plane_kind){GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4};
	}
}

void analysis_finish(struct analysis *analysis, const struct gl *gl)
{
	gl->DeleteTextures(1, &analysis->motion.texture);
	gl->DeleteTextures(1, &analysis->depth.texture);
	gl->DeleteBuffers(1, &analysis->job);
	free(analysis->nothing);
	*analysis = (struct analysis){0};
}

static uint64_t plane_bytes(const struct analysis_plane *plane)
{
	uint64_t bytes = plane->internal == GL_RG32UI ? 8 : plane->internal == GL_R16UI ? 2 : 4;
	return plane->texture ? bytes * plane->width * plane->height : 0;
}

uint64_t analysis_bytes(const struct analysis *analysis)
{
	return plane_bytes(&analysis->motion) + plane_bytes(&analysis->depth) +
		   (analysis->job ? sizeof(struct shader_job) : 0);
}

/* ---- up ---- */

/* With room for that many rows at least. */
static int make_texture(struct analysis_plane *texture, const struct gl *gl, const struct plane_kind *kind,
						uint32_t width, uint32_t rows, struct error *error)
{
	if (texture->internal == kind->internal && texture->width == width && texture->height >= rows)
		return 0;
	gl->DeleteTextures(1, &texture->texture);
	*texture = (struct analysis_plane){0, kind->internal, width, rows};
	while (gl->GetError() != GL_NO_ERROR)
		continue;
	gl->GenTextures(1, &texture->texture);
	gl->BindTexture(GL_TEXTURE_2D, texture->texture);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	gl->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
	gl->TexImage2D(GL_TEXTURE_2D, 0, (GLint)kind->internal, (GLsizei)width, (GLsizei)rows, 0, kind->format, kind->type,
				   NULL);
	if (gl->GetError() == GL_NO_ERROR)
		return 0;
	gl->DeleteTextures(1, &texture->texture);
	*texture = (struct analysis_plane){0};
	return error_set(error, -ENOMEM, "the renderer has no room for %u rows of a plane of %u pixels", rows, width);
}

/* Rows begin at multiples of four bytes, as GL takes them if it is told nothing else. */
static int send(struct engine *engine, struct analysis_plane *texture, int index, struct band_rows part,
				struct error *error)
{
	const struct gl *gl = table_of(engine);
	struct stream *stream = &gl_of(engine)->stream;
	const struct pursuit_plane *plane = &engine->job.frame->header.planes[index];
	const uint8_t *data = engine->job.frame->planes[index] + part.first * plane->stride;
	const struct plane_kind kind = kind_of(plane->format);
	const size_t bytes = (size_t)kind.bytes * plane->width, row_bytes = (bytes + 3) / 4 * 4;
	int result = make_texture(texture, gl, &kind, plane->width, part.count, error);
	const uint32_t block = stream_rows(row_bytes);
	for (uint32_t y = 0; y < part.count && result == 0; y += block) {
		uint32_t rows = part.count - y < block ? part.count - y : block;
		uint8_t *to = stream_begin(stream, gl, rows * row_bytes, error);
		if (!to)
			return -ENOMEM;
		for (uint32_t i = 0; i < rows; i++)
			memcpy(to + i * row_bytes, data + (y + i) * plane->stride, bytes);
		const struct stream_target target = {0, (GLint)y, (GLsizei)plane->width, (GLsizei)rows, kind.format, kind.type};
		result = stream_send(stream, gl, &target, 1, error);
		engine->report.bytes_up += rows * row_bytes;
	}
	return result;
}

static int send_planes(struct engine *engine, const struct plan_job *job, const struct band *band, struct error *error)
{
	struct executor_gl *executor = gl_of(engine);
	const struct gl *gl = table_of(engine);
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_MOTION);
	gl->BindTexture(GL_TEXTURE_2D, executor->analysis.motion.texture);
	int result = send(engine, &executor->analysis.motion, job->motion_plane, band->motion, error);
	gl->ActiveTexture(GL_TEXTURE0 + UNIT_DEPTH);
	gl->BindTexture(GL_TEXTURE_2D, executor->analysis.depth.texture);
	if (result == 0 && job->depth_plane >= 0)
		result = send(engine, &executor->analysis.depth, job->depth_plane, band->depth, error);
	return result;
}

static int32_t depth_bits(const struct plan_job *job)
{
	if (job->depth_plane < 0)
		return DEPTH_BITS_NONE;
	return job->depth.format == PURSUIT_FORMAT_DEPTH16   ? DEPTH_BITS_16
		   : job->depth.format == PURSUIT_FORMAT_DEPTH24 ? DEPTH_BITS_24
														 : DEPTH_BITS_32F;
}

static int32_t depth_map(const struct plan_job *job)
{
	static const int32_t maps[] = {
		[PLAN_DEPTH_AS_IS] = DEPTH_MAP_AS_IS, [PLAN_DEPTH_REVERSED] = DEPTH_MAP_REVERSED,
		[PLAN_DEPTH_RANGE] = DEPTH_MAP_RANGE, [PLAN_DEPTH_INFINITE] = DEPTH_MAP_INFINITE,
		[PLAN_DEPTH_OPEN] = DEPTH_MAP_OPEN,
	};
	return maps[job->depth.map];
}

static size_t first_vertex(const struct plan_job *job)
{
	return FOUND_HEAD + job->tiles;
}

static size_t found_bytes(const struct plan_job *job)
{
	return 4 * first_vertex(job) + sizeof(struct plan_vertex) * job->columns * job->rows;
}

static void send_job(struct engine *engine, const struct plan_job *job, const struct band *band)
{
	struct analysis *analysis = &gl_of(engine)->analysis;
	const struct gl *gl = table_of(engine);
	const struct pursuit_plane *planes = engine->job.frame->header.planes;
	const struct pursuit_plane none = {0}, *motion = &planes[job->motion_plane];
	const struct pursuit_plane *depth = job->depth_plane < 0 ? &none : &planes[job->depth_plane];
	const struct shader_job words = {
		{(int32_t)job->width, (int32_t)job->height, (int32_t)job->cell, (int32_t)job->tile_columns},
		{(int32_t)motion->width, (int32_t)motion->height, (int32_t)depth->width, (int32_t)depth->height},
		{depth_bits(job), depth_map(job), motion->format == PURSUIT_FORMAT_RG16F, (int32_t)first_vertex(job)},
		{job->scale.ratio, job->scale.degrees, job->least, 0.0f},
		{job->depth.near_distance, job->depth.range, 0.0f, 0.0f},
		{(int32_t)band->first, (int32_t)job->rows, (int32_t)band->motion.first, (int32_t)band->depth.first},
	};
	if (!analysis->job) {
		gl->GenBuffers(1, &analysis->job);
		gl->BindBuffer(GL_UNIFORM_BUFFER, analysis->job);
		gl->BufferData(GL_UNIFORM_BUFFER, sizeof(words), &words, GL_DYNAMIC_DRAW);
	}
	gl->BindBufferBase(GL_UNIFORM_BUFFER, 0, analysis->job);
	gl->BufferSubData(GL_UNIFORM_BUFFER, 0, sizeof(words), &words);
}

/* ---- there and back ---- */

static int reserve_nothing(struct analysis *analysis, size_t bytes, struct error *error)
{
	if (bytes <= analysis->nothing_bytes)
		return 0;
	free(analysis->nothing);
	analysis->nothing = calloc(1, bytes);
	analysis->nothing_bytes = analysis->nothing ? bytes : 0;
	return analysis->nothing ? 0 : error_set(error, -ENOMEM, "out of memory for %zu bytes of tiles", bytes);
}

static int make_room(struct engine *engine, const struct plan_job *job, struct error *error)
{
	struct analysis *analysis = &gl_of(engine)->analysis;
	struct warp_buffers *buffers = &gl_of(engine)->buffers;
	const struct gl *gl = table_of(engine);
	const size_t bytes = found_bytes(job);
	int result = reserve_nothing(analysis, 4 * first_vertex(job), error);
	if (result < 0)
		return result;
	/* The vertices of the frame before, which nothing more is drawn of, make room for those to be found. */
	buffers->begun = 0;
	dynamic_reserve(&buffers->vertices, gl, GL_SHADER_STORAGE_BUFFER, bytes, bytes);
	gl->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers->vertices.id);
	gl->BufferSubData(GL_SHADER_STORAGE_BUFFER, 0, (GLsizeiptr)(4 * first_vertex(job)), analysis->nothing);
	return 0;
}

static int take_found(struct engine *engine, const struct plan_job *job, struct error *error)
{
	const struct gl *gl = table_of(engine);
	const size_t bytes = found_bytes(job);
	gl->MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
	const uint32_t *words = gl->MapBufferRange(GL_SHADER_STORAGE_BUFFER, 0, (GLsizeiptr)bytes, GL_MAP_READ_BIT);
	if (!words)
		return error_set(error, -EIO, "the renderer does not give back what the analysis found");
	const struct plan_found found = {
		.moves = words[0] != 0,
		.invalid_pixels = words[1],
		.invalid_tiles = words + FOUND_HEAD,
		.vertices = (const struct plan_vertex *)(const void *)(words + first_vertex(job)),
	};
	int result = plan_job_end(&engine->plan, engine->job.frame, job, &found, error);
	if (!gl->UnmapBuffer(GL_SHADER_STORAGE_BUFFER) && result == 0)
		result = error_set(error, -EIO, "the renderer lost what the analysis found");
	engine->report.bytes_down += bytes;
	return result;
}

/* The rows of a plane that show rows `first` to `last` of the picture. */
static struct band_rows rows_of(const struct engine *engine, const struct plan_job *job, int index, uint32_t first,
								uint32_t last)
{
	if (index < 0)
		return (struct band_rows){0, 0};
	const uint64_t height = engine->job.frame->header.planes[index].height, whole = 2 * (uint64_t)job->height;
	const uint32_t from = (uint32_t)((2 * (uint64_t)first + 1) * height / whole);
	return (struct band_rows){from, (uint32_t)((2 * (uint64_t)last + 1) * height / whole) - from + 1};
}

/* Vertex row i is that of the row of cells i - 1, whose last pixels look at the ones below them. */
static struct band band_at(const struct engine *engine, const struct plan_job *job, uint32_t row)
{
	const uint32_t cells = job->cell < BAND_ROWS ? BAND_ROWS / job->cell : 1, bottom = job->height - 1;
	struct band band = {.first = row, .count = job->rows - row < cells ? job->rows - row : cells};
	uint32_t first = row ? (row - 1) * job->cell : 0, last = (row + band.count - 1) * job->cell;
	first = first < bottom ? first : bottom;
	last = last < bottom ? last : bottom;
	band.motion = rows_of(engine, job, job->motion_plane, first, last);
	band.depth = rows_of(engine, job, job->depth_plane, first, last);
	return band;
}

static int analyse(struct engine *engine, const struct plan_job *job, struct error *error)
{
	const struct gl *gl = table_of(engine);
	struct band band;
	int result = make_room(engine, job, error);
	if (result < 0)
		return result;
	if (!program_use(&gl_of(engine)->programs, gl, PROGRAM_ANALYSE, 0, error))
		return -EIO;
	for (uint32_t row = 0; row < job->rows; row += band.count) {
		band = band_at(engine, job, row);
		result = send_planes(engine, job, &band, error);
		if (result < 0)
			return result;
		send_job(engine, job, &band);
		gl->DispatchCompute(job->columns, band.count, 1);
	}
	return take_found(engine, job, error);
}

/* ---- whose it is ---- */

static bool fits(const struct engine *engine, int index)
{
	const uint32_t most = engine->executor->max_size;
	if (index < 0)
		return true;
	const struct pursuit_plane *plane = &engine->job.frame->header.planes[index];
	return plane->width <= most && plane->height <= most;
}

/* Why the CPU has to do it, NULL if it has not. */
static const char *why_not(const struct engine *engine, const struct plan_job *job)
{
	const struct gl *gl = table_of(engine);
	if (!gl->compute)
		return "no-compute";
	bool small = fits(engine, job->motion_plane) && fits(engine, job->depth_plane);
	return small && found_bytes(job) <= (size_t)gl->max_storage ? NULL : "size";
}

static int run(struct engine *engine, struct error *error)
{
	/* By itself the CPU does it: the planes come in its memory, and it is quicker than the way up and back. */
	if (engine->params.analysis != ENGINE_ANALYSIS_GPU)
		return pass_analyse.run(engine, error);
	const struct plan_params params = analyse_params(engine);
	struct plan_job job;
	int result = 0;
	if (plan_job_begin(&engine->plan, engine->job.frame, &params, &job)) {
		const char *reason = why_not(engine, &job);
		if (reason) {
			report_leave_out(&engine->report, "gpu-analysis", reason);
			return pass_analyse.run(engine, error);
		}
		result = analyse(engine, &job, error);
	}
	return result < 0 ? result : analyse_bend(engine, &params, error);
}

/* The CPU's clock, since it waits for what comes back. */
const struct pass gl_pass_analyse = {.on_cpu = true, .run = run};
