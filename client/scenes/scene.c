/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "stage.h"

static const struct stage_kind *const kinds[] = {&scene_colonnade, &scene_tower, &scene_fan, &scene_trees,
												 &scene_creature,  &scene_rings, &scene_hud, &scene_still};

enum { KIND_COUNT = sizeof(kinds) / sizeof(kinds[0]) };

static const struct scene_info infos[KIND_COUNT + 1] = {
	{"colonnade", "a walk through a sunny arcade with fine stone"},
	{"tower", "an orbit around a lattice tower: many occlusions"},
	{"fan", "fast blades before a still wall"},
	{"trees", "a birch wood passing by: many thin layers"},
	{"creature", "a walking animal: heterogeneous motion"},
	{"rings", "the task: open and closed rings fly by; keys o and c"},
	{"hud", "a flight through a city under a dense user interface"},
	{"still", "a still life: nothing moves"},
	{NULL, NULL},
};

const struct scene_info *scene_list(void)
{
	return infos;
}

static const struct stage_kind *find_kind(const char *name)
{
	for (int i = 0; name && i < KIND_COUNT; i++) {
		if (strcmp(kinds[i]->name, name) == 0)
			return kinds[i];
	}
	return NULL;
}

bool scene_exists(const char *name)
{
	return find_kind(name) != NULL;
}

void stage_begin(struct scene *scene, const struct mesh *mesh, uint32_t range)
{
	scene->ranges[range].first = (uint32_t)mesh->index_count;
}

void stage_end(struct scene *scene, const struct mesh *mesh, uint32_t range)
{
	scene->ranges[range].count = (uint32_t)mesh->index_count - scene->ranges[range].first;
}

struct stage_draw *stage_draw(struct stage_plan *plan, enum stage_program program, uint32_t range, uint32_t part,
							  uint32_t id_base)
{
	static _Thread_local struct stage_draw spare;
	struct stage_draw *draw = plan->draw_count < STAGE_DRAWS ? &plan->draws[plan->draw_count++] : &spare;
	*draw = (struct stage_draw){.program = program, .range = range, .part = part, .id_base = id_base};
	return draw;
}

static bool create_content(struct scene *scene, char *error, size_t error_size)
{
	struct mesh mesh;
	mesh_init(&mesh);
	scene->kind->build(scene, &mesh);
	bool ok = !mesh.failed;
	if (!ok)
		snprintf(error, error_size, "not enough memory for the triangles of the scene %s", scene->kind->name);
	ok = ok && stage_create_buffers(scene, &mesh, error, error_size);
	mesh_finish(&mesh);
	return ok;
}

static bool is_size(uint32_t width, uint32_t height, char *error, size_t error_size)
{
	if (width >= 1 && height >= 1 && width <= 16384 && height <= 16384)
		return true;
	snprintf(error, error_size, "the size of a scene is 1 to 16384, not %ux%u", width, height);
	return false;
}

struct scene *scene_create(const char *name, uint32_t width, uint32_t height, scene_gl_lookup lookup, char *error,
						   size_t error_size)
{
	char unused[1];
	if (!error) {
		error = unused;
		error_size = sizeof(unused);
	}
	const struct stage_kind *kind = find_kind(name);
	if (!kind) {
		snprintf(error, error_size, "there is no scene \"%s\"", name ? name : "");
		return NULL;
	}
	if (!is_size(width, height, error, error_size))
		return NULL;
	struct scene *scene = calloc(1, sizeof(*scene));
	if (!scene || !scene_gl_init(&scene->gl, lookup, error, error_size)) {
		if (!scene)
			snprintf(error, error_size, "not enough memory for the scene %s", name);
		free(scene);
		return NULL;
	}
	scene->kind = kind;
	scene->width = width;
	scene->height = height;
	if (!stage_create_programs(scene, error, error_size) || !create_content(scene, error, error_size) ||
		!stage_create_targets(scene, error, error_size))
		scene_destroy(&scene);
	return scene;
}

void scene_destroy(struct scene **scene_pointer)
{
	struct scene *scene = *scene_pointer;
	if (!scene)
		return;
	stage_destroy_targets(scene);
	stage_destroy_buffers(scene);
	for (int i = 0; i < STAGE_PROGRAMS; i++)
		scene->gl.DeleteProgram(scene->programs[i]);
	overlay_finish(&scene->overlay);
	free(scene->answers);
	free(scene);
	*scene_pointer = NULL;
}

bool scene_resize(struct scene *scene, uint32_t width, uint32_t height, char *error, size_t error_size)
{
	char unused[1];
	if (!error) {
		error = unused;
		error_size = sizeof(unused);
	}
	stage_destroy_targets(scene);
	if (!is_size(width, height, error, error_size))
		return false;
	scene->width = width;
	scene->height = height;
	return stage_create_targets(scene, error, error_size);
}

/* Beyond this a double has no fractions of a second left; the scenes stand still there. */
static const double last_time = 1e12;

static double usable(double time)
{
	return fmax(-last_time, fmin(last_time, time));
}

static void pose(const struct scene *scene, double time, struct stage_pose *out)
{
	/* Whole, so that equal moments are equal bits. */
	memset(out, 0, sizeof(*out));
	out->view = mat4_identity();
	for (int i = 0; i < STAGE_PARTS; i++)
		out->parts[i] = mat4_identity();
	scene->kind->pose(scene, time, &scene->plan, out);
}

static void fill_camera(const struct scene *scene, struct scene_camera *camera)
{
	struct mat4 projection = stage_projection(scene);
	struct mat4 now = mat4_multiply(projection, scene->now.view);
	struct mat4 previous = mat4_multiply(projection, scene->other.view);
	*camera = (struct scene_camera){.near_distance = (float)scene->look.near, .far_distance = (float)scene->look.far};
	for (int i = 0; i < 16; i++) {
		camera->view_projection[i] = (float)now.m[i];
		camera->previous_view_projection[i] = (float)previous.m[i];
	}
}

/* Plans and poses are cleared before they are filled, so that equal ones are equal bytes. */
static bool is_drawn(const struct scene *scene)
{
	return scene->drawn && memcmp(scene->plan.draws, scene->drawn_plan.draws, sizeof(scene->plan.draws)) == 0 &&
		   memcmp(&scene->now, &scene->drawn_now, sizeof(scene->now)) == 0 &&
		   memcmp(&scene->other, &scene->drawn_previous, sizeof(scene->other)) == 0;
}

/* What does not change need not be drawn again: a still scene costs nothing. */
static void render_plan(struct scene *scene)
{
	if (is_drawn(scene))
		return;
	scene->gl.BindFramebuffer(GL_FRAMEBUFFER, scene->frame);
	stage_draw_plan(scene, 1.0);
	scene->drawn = true;
	scene->drawn_plan = scene->plan;
	scene->drawn_now = scene->now;
	scene->drawn_previous = scene->other;
}

static void render_forward(struct scene *scene, double time_next)
{
	pose(scene, time_next, &scene->other);
	scene->gl.BindFramebuffer(GL_FRAMEBUFFER, scene->forward_frame);
	stage_draw_plan(scene, -1.0);
}

static void render_overlay(struct scene *scene, double time)
{
	overlay_begin(&scene->overlay, scene->width, scene->height);
	scene->kind->overlay(scene, time, &scene->overlay);
	stage_draw_overlay(scene);
}

bool scene_render(struct scene *scene, const struct scene_request *request, struct scene_textures *textures,
				  struct scene_camera *camera)
{
	if (!isfinite(request->time) || !isfinite(request->time_previous) ||
		(request->forward && !isfinite(request->time_next)) || !scene->has_targets)
		return false;
	if (request->forward && !stage_create_forward(scene))
		return false;
	double time = usable(request->time);
	memset(&scene->plan, 0, sizeof(scene->plan));
	scene->plan.time = time;
	scene->kind->plan(scene, time, &scene->plan);
	pose(scene, time, &scene->now);
	pose(scene, usable(request->time_previous), &scene->other);
	if (camera)
		fill_camera(scene, camera);
	render_plan(scene);
	scene->has_forward = request->forward;
	if (request->forward)
		render_forward(scene, usable(request->time_next));
	if (scene->kind->overlay)
		render_overlay(scene, time);
	if (textures)
		*textures = (struct scene_textures){.color = scene->targets[0],
											.depth = scene->targets[1],
											.backward = scene->targets[2],
											.object_id = scene->targets[3],
											.forward = request->forward ? scene->targets[4] : 0,
											.ui = scene->ui};
	return true;
}

void scene_key(struct scene *scene, double time, int key)
{
	if (scene->kind->key && isfinite(time))
		scene->kind->key(scene, usable(time), key);
}

bool scene_get_score(const struct scene *scene, double time, struct scene_score *score)
{
	if (!scene->kind->score || !isfinite(time))
		return false;
	*score = (struct scene_score){0};
	scene->kind->score(scene, usable(time), score);
	return true;
}
