/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "stage.h"

static void build(struct scene *scene, struct mesh *mesh)
{
	scene->look = (struct stage_look){.fov_y = 1.0, .near = 0.1, .far = 10.0, .haze_distance = 1.0, .cloud_layer = -1};
}

static void plan(const struct scene *scene, double time, struct stage_plan *out)
{
}

static void pose(const struct scene *scene, double time, const struct stage_plan *out, struct stage_pose *pose)
{
}

const struct stage_kind scene_rings = {
	.name = "rings",
	.materials = {MATERIAL_PLAIN},
	.material_count = 1,
	.build = build,
	.plan = plan,
	.pose = pose,
};
