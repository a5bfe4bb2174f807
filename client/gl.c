/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Read-back through a ring of pixel buffers. A flight is one frame under way:
 * a buffer for each plane, a fence behind them, and what the caller said of
 * the frame.
 */

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "client/gl_api.h"
#include "client/gl_transfer.h"
#include "client/pursuit.h"
#include "client/stream.h"

/* As many frames as drivers let a game be ahead of its GPU. */
#define FLIGHTS 3
#define FLUSH_NS UINT64_C(1000000000)

struct flight {
	void *fence; /* NULL: not under way */
	struct shim_ticket ticket;
	struct pursuit_frame frame;
	bool bottom_up;
	bool present[PURSUIT_MAX_PLANES];
	uint32_t buffers[PURSUIT_MAX_PLANES];
	size_t buffer_bytes[PURSUIT_MAX_PLANES];
	struct shim_gl_transfer transfers[PURSUIT_MAX_PLANES];
};

struct pursuit_gl {
	struct pursuit_stream *stream;
	struct shim_gl_api api;
	uint32_t plane_count;
	uint32_t framebuffers[PURSUIT_MAX_PLANES];
	uint32_t attached_as[PURSUIT_MAX_PLANES]; /* the attachment point that worked last */
	struct flight flights[FLIGHTS];           /* a ring; the oldest is flights[first] */
	uint32_t first;
	uint32_t count;
};

/* The caller's state that a read-back changes. */
struct saved_state {
	int32_t framebuffer;
	int32_t buffer;
	int32_t pack[6]; /* in the order of pack_names */
	int32_t clamp;
};

/* The last two exist on desktop GL only. */
static const uint32_t pack_names[6] = {SHIM_GL_PACK_ALIGNMENT,   SHIM_GL_PACK_ROW_LENGTH, SHIM_GL_PACK_SKIP_ROWS,
									   SHIM_GL_PACK_SKIP_PIXELS, SHIM_GL_PACK_SWAP_BYTES, SHIM_GL_PACK_LSB_FIRST};

static int pack_count(const struct shim_gl_api *api)
{
	return api->es ? 4 : 6;
}

static void save_state(const struct shim_gl_api *api, struct saved_state *saved)
{
	api->GetIntegerv(SHIM_GL_READ_FRAMEBUFFER_BINDING, &saved->framebuffer);
	api->GetIntegerv(SHIM_GL_PIXEL_PACK_BUFFER_BINDING, &saved->buffer);
	for (int i = 0; i < pack_count(api); i++) {
		api->GetIntegerv(pack_names[i], &saved->pack[i]);
		api->PixelStorei(pack_names[i], i == 0 ? 1 : 0);
	}
	if (api->ClampColor) {
		api->GetIntegerv(SHIM_GL_CLAMP_READ_COLOR, &saved->clamp);
		api->ClampColor(SHIM_GL_CLAMP_READ_COLOR, 0);
	}
}

static void restore_state(const struct shim_gl_api *api, const struct saved_state *saved)
{
	api->BindFramebuffer(SHIM_GL_READ_FRAMEBUFFER, (uint32_t)saved->framebuffer);
	api->BindBuffer(SHIM_GL_PIXEL_PACK_BUFFER, (uint32_t)saved->buffer);
	for (int i = 0; i < pack_count(api); i++) {
		api->PixelStorei(pack_names[i], saved->pack[i]);
	}
	if (api->ClampColor) {
		api->ClampColor(SHIM_GL_CLAMP_READ_COLOR, (uint32_t)saved->clamp);
	}
}

static const struct pursuit_plane *plane_at(const struct pursuit_gl *gl, uint32_t index)
{
	return &shim_stream_layout(gl->stream)->header.planes[index];
}

static bool needs_float(const struct shim_layout *layout)
{
	for (uint32_t i = 0; i < layout->header.plane_count; i++) {
		uint32_t role = layout->header.planes[i].role;
		if (role == PURSUIT_ROLE_DEPTH || role == PURSUIT_ROLE_MOTION) {
			return true;
		}
	}
	return false;
}

/* Before GL 4.1 a framebuffer with a draw buffer that is not attached is incomplete. */
static void create_objects(struct pursuit_gl *gl)
{
	const struct shim_gl_api *api = &gl->api;
	const uint32_t none = SHIM_GL_NONE;
	int32_t draw = 0;

	api->GetIntegerv(SHIM_GL_DRAW_FRAMEBUFFER_BINDING, &draw);
	api->GenFramebuffers((int32_t)gl->plane_count, gl->framebuffers);
	for (uint32_t i = 0; i < gl->plane_count; i++) {
		gl->attached_as[i] = SHIM_GL_COLOR_ATTACHMENT0;
		api->BindFramebuffer(SHIM_GL_DRAW_FRAMEBUFFER, gl->framebuffers[i]);
		api->DrawBuffers(1, &none);
	}
	api->BindFramebuffer(SHIM_GL_DRAW_FRAMEBUFFER, (uint32_t)draw);
	for (uint32_t i = 0; i < FLIGHTS; i++) {
		api->GenBuffers((int32_t)gl->plane_count, gl->flights[i].buffers);
	}
}

struct pursuit_gl *pursuit_gl_create(struct pursuit_stream *stream, pursuit_gl_lookup lookup)
{
	struct pursuit_gl *gl = calloc(1, sizeof(*gl));

	if (!gl) {
		return NULL;
	}
	if (!stream || !lookup) {
		free(gl);
		errno = EINVAL;
		return NULL;
	}
	if (!shim_gl_api_load(&gl->api, lookup) || (!gl->api.float_targets && needs_float(shim_stream_layout(stream)))) {
		free(gl);
		errno = ENOTSUP;
		return NULL;
	}
	gl->stream = stream;
	gl->plane_count = shim_stream_layout(stream)->header.plane_count;
	create_objects(gl);
	return gl;
}

static struct flight *flight_at(struct pursuit_gl *gl, uint32_t index)
{
	return &gl->flights[(gl->first + index) % FLIGHTS];
}

static void drop_flights(struct pursuit_gl *gl, uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		struct flight *flight = flight_at(gl, 0);
		gl->api.DeleteSync(flight->fence);
		flight->fence = NULL;
		gl->first = (gl->first + 1) % FLIGHTS;
		gl->count--;
	}
}

void pursuit_gl_destroy(struct pursuit_gl **gl)
{
	if (!gl || !*gl) {
		return;
	}
	drop_flights(*gl, (*gl)->count);
	for (uint32_t i = 0; i < FLIGHTS; i++) {
		(*gl)->api.DeleteBuffers((int32_t)(*gl)->plane_count, (*gl)->flights[i].buffers);
	}
	(*gl)->api.DeleteFramebuffers((int32_t)(*gl)->plane_count, (*gl)->framebuffers);
	free(*gl);
	*gl = NULL;
}

static struct pursuit_plane_memory memory_of(const struct pursuit_frame *frame, uint32_t role)
{
	switch (role) {
	case PURSUIT_ROLE_COLOR:
		return frame->color;
	case PURSUIT_ROLE_DEPTH:
		return frame->depth;
	case PURSUIT_ROLE_MOTION:
		return frame->motion;
	case PURSUIT_ROLE_UI:
		return frame->ui;
	default:
		return frame->object_id;
	}
}

static void copy_rows(const struct pursuit_plane_memory *to, const uint8_t *from,
					  const struct shim_gl_transfer *transfer, bool bottom_up)
{
	size_t from_stride = (size_t)to->width * transfer->pixel_bytes;

	for (uint32_t y = 0; y < to->height; y++) {
		uint32_t row = bottom_up ? to->height - 1 - y : y;
		transfer->row(to->data + to->stride * row, from + from_stride * y, to->width, &transfer->options);
	}
}

static bool copy_plane(struct pursuit_gl *gl, const struct flight *flight, uint32_t index,
					   const struct pursuit_plane_memory *to)
{
	const struct shim_gl_api *api = &gl->api;
	size_t bytes = (size_t)to->width * to->height * flight->transfers[index].pixel_bytes;

	if (!flight->present[index]) {
		memset(to->data, 0, to->stride * to->height);
		return true;
	}
	api->BindBuffer(SHIM_GL_PIXEL_PACK_BUFFER, flight->buffers[index]);
	const uint8_t *from = api->MapBufferRange(SHIM_GL_PIXEL_PACK_BUFFER, 0, (ptrdiff_t)bytes, SHIM_GL_MAP_READ_BIT);
	if (!from) {
		return false;
	}
	copy_rows(to, from, &flight->transfers[index], flight->bottom_up);
	api->UnmapBuffer(SHIM_GL_PIXEL_PACK_BUFFER);
	shim_stream_count_copied(gl->stream,
							 (uint64_t)to->width * to->height * pursuit_format_bytes(plane_at(gl, index)->format));
	return true;
}

/* What the caller said of the frame, without its planes. */
static void copy_facts(struct pursuit_frame *to, const struct pursuit_frame *from)
{
	to->motion_interval_ns = from->motion_interval_ns;
	to->flags = from->flags;
	to->jitter_x = from->jitter_x;
	to->jitter_y = from->jitter_y;
	to->damage_count = from->damage_count;
	memcpy(to->damage, from->damage, sizeof(to->damage));
	memcpy(to->view_projection, from->view_projection, sizeof(to->view_projection));
	memcpy(to->previous_view_projection, from->previous_view_projection, sizeof(to->previous_view_projection));
}

static bool copy_planes(struct pursuit_gl *gl, const struct flight *flight, struct pursuit_frame *frame)
{
	int32_t bound = 0;
	bool good = true;

	gl->api.GetIntegerv(SHIM_GL_PIXEL_PACK_BUFFER_BINDING, &bound);
	for (uint32_t i = 0; i < gl->plane_count && good; i++) {
		struct pursuit_plane_memory to = memory_of(frame, plane_at(gl, i)->role);
		good = copy_plane(gl, flight, i, &to);
	}
	gl->api.BindBuffer(SHIM_GL_PIXEL_PACK_BUFFER, (uint32_t)bound);
	return good;
}

static uint64_t publish(struct pursuit_gl *gl, const struct flight *flight)
{
	struct pursuit_frame *frame = pursuit_acquire(gl->stream);

	if (!frame) {
		return 0;
	}
	if (!shim_stream_is_attached(gl->stream) || !copy_planes(gl, flight, frame)) {
		pursuit_cancel(gl->stream, frame);
		return 0;
	}
	copy_facts(frame, &flight->frame);
	return shim_stream_publish(gl->stream, frame, &flight->ticket) ? flight->ticket.frame_id : 0;
}

static bool is_done(const struct pursuit_gl *gl, const struct flight *flight, uint64_t wait_ns)
{
	uint32_t result = gl->api.ClientWaitSync(flight->fence, SHIM_GL_SYNC_FLUSH_COMMANDS_BIT, wait_ns);
	return result == SHIM_GL_ALREADY_SIGNALED || result == SHIM_GL_CONDITION_SATISFIED;
}

/* Publishes the newest of the first `done` flights; the daemon would take none of the older ones. */
static uint64_t land(struct pursuit_gl *gl, uint32_t done)
{
	uint64_t id = done ? publish(gl, flight_at(gl, done - 1)) : 0;
	drop_flights(gl, done);
	return id;
}

uint64_t pursuit_gl_update(struct pursuit_gl *gl)
{
	uint32_t done = 0;

	if (!gl) {
		return 0;
	}
	pursuit_update(gl->stream);
	while (done < gl->count && is_done(gl, flight_at(gl, done), 0)) {
		done++;
	}
	return land(gl, done);
}

uint64_t pursuit_gl_flush(struct pursuit_gl *gl)
{
	if (!gl || gl->count == 0) {
		return 0;
	}
	return is_done(gl, flight_at(gl, gl->count - 1), FLUSH_NS) ? land(gl, gl->count) : 0;
}

static uint32_t texture_of(const struct pursuit_gl_textures *textures, uint32_t role)
{
	switch (role) {
	case PURSUIT_ROLE_COLOR:
		return textures->color;
	case PURSUIT_ROLE_DEPTH:
		return textures->depth;
	case PURSUIT_ROLE_MOTION:
		return textures->motion;
	case PURSUIT_ROLE_UI:
		return textures->ui;
	default:
		return textures->object_id;
	}
}

static bool attach_as(const struct pursuit_gl *gl, uint32_t point, uint32_t texture)
{
	const struct shim_gl_api *api = &gl->api;
	uint32_t other = point == SHIM_GL_DEPTH_ATTACHMENT ? SHIM_GL_COLOR_ATTACHMENT0 : SHIM_GL_DEPTH_ATTACHMENT;

	api->FramebufferTexture2D(SHIM_GL_READ_FRAMEBUFFER, other, SHIM_GL_TEXTURE_2D, 0, 0);
	api->FramebufferTexture2D(SHIM_GL_READ_FRAMEBUFFER, point, SHIM_GL_TEXTURE_2D, texture, 0);
	api->ReadBuffer(point == SHIM_GL_DEPTH_ATTACHMENT ? SHIM_GL_NONE : SHIM_GL_COLOR_ATTACHMENT0);
	return api->CheckFramebufferStatus(SHIM_GL_READ_FRAMEBUFFER) == SHIM_GL_FRAMEBUFFER_COMPLETE;
}

/* A texture does not say what it is, but it fits only one of the two attachment points. */
static bool attach_texture(struct pursuit_gl *gl, uint32_t index, uint32_t texture)
{
	gl->api.BindFramebuffer(SHIM_GL_READ_FRAMEBUFFER, gl->framebuffers[index]);
	if (attach_as(gl, gl->attached_as[index], texture)) {
		return true;
	}
	if (plane_at(gl, index)->role != PURSUIT_ROLE_DEPTH) {
		return false;
	}
	gl->attached_as[index] ^= SHIM_GL_COLOR_ATTACHMENT0 ^ SHIM_GL_DEPTH_ATTACHMENT;
	return attach_as(gl, gl->attached_as[index], texture);
}

static struct shim_gl_source describe_source(const struct pursuit_gl *gl, uint32_t point)
{
	const struct shim_gl_api *api = &gl->api;
	struct shim_gl_source source = {.es = api->es, .is_depth = point == SHIM_GL_DEPTH_ATTACHMENT};
	int32_t value = 0;

	if (source.is_depth) {
		return source;
	}
	api->GetFramebufferAttachmentParameteriv(SHIM_GL_READ_FRAMEBUFFER, point, SHIM_GL_ATTACHMENT_COMPONENT_TYPE,
											 &value);
	source.component_type = (uint32_t)value;
	api->GetFramebufferAttachmentParameteriv(SHIM_GL_READ_FRAMEBUFFER, point, SHIM_GL_ATTACHMENT_RED_SIZE, &value);
	source.red_bits = (uint32_t)value;
	if (api->es) {
		api->GetIntegerv(SHIM_GL_IMPLEMENTATION_COLOR_READ_FORMAT, &value);
		source.driver_format = (uint32_t)value;
		api->GetIntegerv(SHIM_GL_IMPLEMENTATION_COLOR_READ_TYPE, &value);
		source.driver_type = (uint32_t)value;
	}
	return source;
}

static void read_into(struct pursuit_gl *gl, struct flight *flight, uint32_t index)
{
	const struct shim_gl_transfer *transfer = &flight->transfers[index];
	const struct pursuit_plane *plane = plane_at(gl, index);
	size_t bytes = (size_t)plane->width * plane->height * transfer->pixel_bytes;

	gl->api.BindBuffer(SHIM_GL_PIXEL_PACK_BUFFER, flight->buffers[index]);
	if (flight->buffer_bytes[index] != bytes) {
		gl->api.BufferData(SHIM_GL_PIXEL_PACK_BUFFER, (ptrdiff_t)bytes, NULL, SHIM_GL_STREAM_READ);
		flight->buffer_bytes[index] = bytes;
	}
	gl->api.ReadPixels(0, 0, (int32_t)plane->width, (int32_t)plane->height, transfer->format, transfer->type, NULL);
}

static const char *role_name(uint32_t role)
{
	static const char *const names[] = {"?", "color", "depth", "motion", "ui", "object_id"};
	return names[role < sizeof(names) / sizeof(*names) ? role : 0];
}

/* Starts the read-back of one plane; false with a message in the status if its texture cannot be read. */
static bool start_plane(struct pursuit_gl *gl, struct flight *flight, uint32_t index,
						const struct pursuit_gl_textures *textures)
{
	const struct pursuit_plane *plane = plane_at(gl, index);
	uint32_t texture = texture_of(textures, plane->role);
	struct shim_gl_transfer *transfer = &flight->transfers[index];
	const char *wrong = "it cannot be attached to a framebuffer";

	flight->present[index] = texture != 0;
	if (!texture) {
		flight->frame.flags |= plane->role == PURSUIT_ROLE_MOTION ? PURSUIT_FLAG_MOTION_INVALID : 0;
		return true;
	}
	if (attach_texture(gl, index, texture)) {
		struct shim_gl_source source = describe_source(gl, gl->attached_as[index]);
		wrong = shim_gl_transfer_choose(transfer, plane->role, plane->format, &source);
	}
	if (wrong) {
		shim_stream_say(gl->stream, "the %s texture %u cannot be read back: %s", role_name(plane->role), texture,
						wrong);
		return false;
	}
	transfer->options.negate_y = plane->role == PURSUIT_ROLE_MOTION && textures->motion_y_up;
	read_into(gl, flight, index);
	return true;
}

static void start_flight(struct pursuit_gl *gl, const struct pursuit_gl_textures *textures,
						 const struct pursuit_frame *frame, const struct shim_ticket *ticket)
{
	struct flight *flight = flight_at(gl, gl->count);
	struct saved_state saved;
	bool good = true;

	flight->frame = *frame;
	flight->ticket = *ticket;
	flight->bottom_up = textures->bottom_up != 0;
	save_state(&gl->api, &saved);
	for (uint32_t i = 0; i < gl->plane_count && good; i++) {
		good = start_plane(gl, flight, i, textures);
	}
	if (good) {
		flight->fence = gl->api.FenceSync(SHIM_GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
		gl->count += flight->fence != NULL;
	}
	restore_state(&gl->api, &saved);
}

uint64_t pursuit_gl_submit(struct pursuit_gl *gl, const struct pursuit_gl_textures *textures,
						   const struct pursuit_frame *frame)
{
	if (!gl || !textures || !frame) {
		return 0;
	}
	uint64_t id = pursuit_gl_update(gl);
	struct shim_ticket ticket = shim_stream_ticket(gl->stream, frame);
	if (shim_stream_is_attached(gl->stream) && gl->count < FLIGHTS && textures->color) {
		start_flight(gl, textures, frame, &ticket);
	}
	return id;
}
