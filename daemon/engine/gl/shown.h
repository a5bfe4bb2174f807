/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * What the texture of SHOWN holds, by tiles, from one displayed frame to the next and from one real frame to the next:
 * a tile that rests is copied from the picture that is shown, or left alone where that very tile lies there, with its
 * UI. Which it is, contents.h tells; SHOWN is an image like those of others there.
 */
#ifndef PURSUIT_ENGINE_GL_SHOWN_H
#define PURSUIT_ENGINE_GL_SHOWN_H

#include "daemon/engine/contents.h"
#include "daemon/engine/gl/tile_buffer.h"
#include "daemon/engine/tiles.h"

struct engine;

/* A zeroed one is ready for use. */
struct gl_shown {
	uint64_t number;         /* what contents know it by; 0: nobody knows what it holds */
	uint64_t before;         /* and knew it by, while one is made */
	const uint64_t *numbers; /* of the tiles of the picture made last */
	struct sheet sheet;      /* while one is made */
	struct tiles moving;     /* where the mesh is drawn */
	struct tiles copied;     /* where what rests is copied */
	struct tiles written;    /* one or the other: what has no UI over it yet */
	struct tile_buffer rectangles;
};

/*
 * A picture is made in SHOWN, which has the size of the frame afterwards; no tile is moving, copied or written as yet.
 * 0, or a negative errno with a sentence. Until gl_shown_end() nobody knows what it holds.
 */
int gl_shown_begin(struct engine *engine, struct error *error);
void gl_shown_end(struct engine *engine);

/* Marks as copied the tiles of the picture of that name which are not moving, but for those that are there. */
void gl_shown_keep(struct engine *engine, enum picture_id id);

/* Copies what is marked as copied and not as moving from the picture of that name. 0, or a negative errno. */
int gl_shown_copy(struct engine *engine, enum picture_id id, struct error *error);

void gl_shown_finish(struct gl_shown *shown, const struct gl *gl);

#endif
