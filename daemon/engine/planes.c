/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/engine/pass.h"

#include <errno.h>
#include <string.h>

static int find_plane(const struct pursuit_frame_header *header, uint32_t role)
{
	for (uint32_t i = 0; i < header->plane_count && i < PURSUIT_MAX_PLANES; i++)
		if (header->planes[i].role == role)
			return (int)i;
	return -1;
}

static int check_color(const struct engine *engine, const struct pursuit_frame_header *header, int index,
					   struct error *error)
{
	uint32_t most = engine->executor->max_size;
	if (index < 0)
		return error_set(error, -EINVAL, "frame %llu has no colour plane", (unsigned long long)header->frame_id);
	const struct pursuit_plane *plane = &header->planes[index];
	if (plane->width && plane->height && plane->width <= most && plane->height <= most)
		return 0;
	return error_set(error, -EINVAL, "planes[%d] is %u x %u, this renderer takes 1 x 1 to %u x %u", index, plane->width,
					 plane->height, most, most);
}

/* Planes of one kind, wherever their rows lie. */
static bool same_kind(const struct pursuit_plane *a, const struct pursuit_plane *b)
{
	return a->role == b->role && a->format == b->format && a->width == b->width && a->height == b->height &&
		   memcmp(&a->transfer, &b->transfer, sizeof(a->transfer)) == 0;
}

/* Finds out whether the frame's damage counts, and remembers what the next one is compared with. */
static void learn_damage(struct engine *engine, const struct pursuit_plane *color, const struct pursuit_plane *ui)
{
	static const struct pursuit_plane none;
	const struct frame *frame = engine->job.frame;
	const struct pursuit_frame_header *header = &frame->header;
	ui = ui ? ui : &none;
	engine->damage.comparable = frame->stream && frame->stream == engine->stream &&
								same_kind(color, &engine->color_plane) && same_kind(ui, &engine->ui_plane);
	engine->damage.found = false;
	engine->damage.known =
		(header->flags & PURSUIT_FRAME_DAMAGE) && engine->damage.comparable && header->damage_since == engine->frame_id;
	engine->damage.count = header->damage_count < PURSUIT_MAX_DAMAGE ? header->damage_count : PURSUIT_MAX_DAMAGE;
	memcpy(engine->damage.rectangles, header->damage, sizeof(engine->damage.rectangles));
	engine->stream = frame->stream;
	engine->frame_id = header->frame_id;
	engine->color_plane = *color;
	engine->ui_plane = *ui;
	engine->content_before = engine->content;
	if (!engine->damage.known || engine->damage.count)
		engine->content = engine_new_number(engine);
}

bool planes_changed(const struct engine *engine, uint32_t y, uint32_t count)
{
	const struct damage *damage = &engine->damage;
	for (uint32_t i = 0; i < damage->count && damage->known; i++)
		if (damage->rectangles[i].y < y + count && y < damage->rectangles[i].y + damage->rectangles[i].height)
			return true;
	return !damage->known;
}

void planes_find_unchanged(struct engine *engine)
{
	engine->damage.known = engine->damage.found = true;
	engine->damage.count = 0;
	engine->content = engine->content_before;
	report_leave_out(&engine->report, "upload", "unchanged");
}

int planes_prepare(struct engine *engine, int *color, int *ui, struct error *error)
{
	const struct pursuit_frame_header *header = &engine->job.frame->header;
	const struct engine_params *params = &engine->params;
	*color = find_plane(header, PURSUIT_ROLE_COLOR);
	*ui = find_plane(header, PURSUIT_ROLE_UI);
	int result = check_color(engine, header, *color, error);
	if (result < 0)
		return result;
	const struct pursuit_plane *plane = &header->planes[*color];
	engine->width = plane->width;
	engine->height = plane->height;
	convert_prepare(&engine->color_convert, plane->format, &plane->transfer, params->curve, params->gamma);
	learn_damage(engine, plane, *ui < 0 ? NULL : &header->planes[*ui]);
	if (planes_changed(engine, 0, engine->height))
		engine->ui_bounds = (struct bounds){0};
	if (*ui < 0)
		return 0;
	const struct pursuit_plane *layer = &header->planes[*ui];
	if (layer->width != plane->width || layer->height != plane->height)
		return error_set(error, -EINVAL, "the UI plane is %u x %u, must be as large as colour, %u x %u", layer->width,
						 layer->height, plane->width, plane->height);
	convert_prepare(&engine->ui_convert, layer->format, NULL, params->curve, params->gamma);
	return 0;
}
