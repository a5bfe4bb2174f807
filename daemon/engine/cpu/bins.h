/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Makes a scene ready to be drawn: displaces the vertices, sorts the triangles into tiles. */
#ifndef PURSUIT_ENGINE_CPU_BINS_H
#define PURSUIT_ENGINE_CPU_BINS_H

#include "daemon/engine/cpu/scene.h"
#include "daemon/error.h"

/*
 * Displaces the vertices of the mesh and fills the bins; mesh (sorted for the phase), phase and size are set. Memory
 * grows and stays. 0 or -ENOMEM with a sentence.
 */
int scene_prepare(struct scene *scene, struct error *error);
/* Memory that it holds. */
uint64_t scene_bytes(const struct scene *scene);
void scene_finish(struct scene *scene);

static inline uint32_t scene_tiles(const struct scene *scene)
{
	return scene->bins.columns * scene->bins.rows;
}

#endif
