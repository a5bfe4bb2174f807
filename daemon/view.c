/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/view.h"

#include <stdlib.h>
#include <string.h>

#include "daemon/keys.h"
#include "daemon/overlay.h"
#include "daemon/render.h"

#define MESSAGE_NS UINT64_C(2000000000)
#define TEXT_NS UINT64_C(250000000)

void view_finish(struct view *view)
{
	free(view->plain);
	memset(view, 0, sizeof(*view));
}

void view_say(struct view *view, const char *message, uint64_t now_ns)
{
	snprintf(view->message, sizeof(view->message), "%s", message);
	view->message_until_ns = now_ns + MESSAGE_NS;
}

uint64_t view_message_end(const struct view *view)
{
	return view->message_until_ns ? view->message_until_ns : UINT64_MAX;
}

bool view_message_is_over(struct view *view, uint64_t now_ns)
{
	const bool over = now_ns >= view_message_end(view);
	if (over)
		view->message_until_ns = 0;
	return over;
}

/* ---- the right half ---- */

/* The real frame as it came, once a frame. False: there is none. */
static bool make_plain(struct render *render, const struct presenter_image *image)
{
	const struct engine_request request = {.show = ENGINE_SHOW_PLAIN};
	struct view *view = &render->view;
	struct error error;
	if (!render->begun)
		return false;
	if (view->plain_width != image->width || view->plain_height != image->height) {
		free(view->plain);
		view->plain = aligned_alloc(64, ((size_t)image->width * image->height * 4 + 63) / 64 * 64);
		view->plain_width = view->plain ? image->width : 0;
		view->plain_height = image->height;
		view->plain_group = 0;
	}
	if (!view->plain || view->plain_group == render->group)
		return view->plain != NULL;
	struct engine_image target = {.data = view->plain, .stride = (size_t)view->plain_width * 4};
	if (engine_render(render->engine, &request, &target, &error) < 0)
		return false;
	view->plain_group = render->group;
	return true;
}

static void draw_right_half(struct render *render, const struct presenter_image *image, const struct overlay *overlay)
{
	const size_t middle = image->width / 2, bytes = (image->width - middle) * 4;
	if (!make_plain(render, image))
		return;
	for (uint32_t y = 0; y < image->height; y++)
		memcpy(image->data + (size_t)y * image->stride + middle * 4,
			   render->view.plain + ((size_t)y * image->width + middle) * 4, bytes);
	overlay_divide(overlay, (uint32_t)middle);
	overlay_text(overlay, OVERLAY_BOTTOM_LEFT, render->settings->method);
	overlay_text(overlay, OVERLAY_BOTTOM_RIGHT, "real frames only");
}

/* ---- statistics ---- */

static double share(uint64_t part, uint64_t whole)
{
	return whole ? 100.0 * (double)part / (double)whole : 100.0;
}

static void write_text(struct render *render, uint64_t now_ns)
{
	struct view *view = &render->view;
	const struct stats *stats = render->stats;
	const uint64_t active_ns = stats->active_ns - view->text_active_ns;
	const double hz = active_ns ? (double)(stats->displayed_frames - view->text_frames) * 1e9 / (double)active_ns : 0.0;
	const double real_hz = render->pacer.interval_ns ? 1e9 / (double)render->pacer.interval_ns : 0.0;
	uint32_t width = 0, height = 0;
	if (render->begun) /* else it may hold what it was warmed up with */
		engine_get_size(render->engine, &width, &height);
	snprintf(view->text, sizeof(view->text),
			 "%s  %ux%u  %s\n"
			 "%.1f real frames/s, %.1f Hz displayed\n"
			 "display %.2f Hz, N %u, delay %.1f ms\n"
			 "engine %.1f ms, at 99%% %.1f ms\n"
			 "submit to flip %.1f ms, at 99%% %.1f ms\n"
			 "%.2f%% on time, %llu in-betweens late\n"
			 "%llu real frames lost, %llu late",
			 render->settings->method, width, height, render->presenter->impl->name, real_hz, hz,
			 1e9 / grid_period_ns(&render->grid), render->n, (double)render->pacer.delay_ns / 1e6,
			 stats_percentile_ms(&stats->spans.engine, 0.5), stats_percentile_ms(&stats->spans.engine, 0.99),
			 stats_percentile_ms(&stats->spans.submit_to_flip, 0.5),
			 stats_percentile_ms(&stats->spans.submit_to_flip, 0.99), share(stats->vblanks_on_time, stats->vblanks_due),
			 (unsigned long long)stats->late_in_betweens, (unsigned long long)stats->lost_real_frames,
			 (unsigned long long)stats->late_real_frames);
	view->text_ns = now_ns;
	view->text_frames = stats->displayed_frames;
	view->text_active_ns = stats->active_ns;
}

/* ---- all ---- */

bool view_draws(const struct view *view, uint64_t now_ns)
{
	return view->switches != 0 || now_ns < view->message_until_ns;
}

void view_draw(struct render *render, struct presenter_image *image)
{
	struct view *view = &render->view;
	const struct overlay overlay = {image->data, image->stride, image->width, image->height};
	const uint64_t now_ns = clock_now(render->clock);
	if (!image->data || !view_draws(view, now_ns))
		return;
	image->holds = 0;
	if (view->switches & VIEW_SPLIT)
		draw_right_half(render, image, &overlay);
	if (view->switches & VIEW_STATISTICS) {
		if (now_ns - view->text_ns > TEXT_NS)
			write_text(render, now_ns);
		overlay_text(&overlay, OVERLAY_TOP_LEFT, view->text);
	}
	if (view->switches & VIEW_HELP) {
		char help[512];
		keys_describe(help, sizeof(help));
		overlay_text(&overlay, OVERLAY_CENTER, help);
	}
	if (now_ns < view->message_until_ns)
		overlay_text(&overlay, OVERLAY_TOP_RIGHT, view->message);
}
