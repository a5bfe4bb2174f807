/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Pictures of a report in the order in which they are displayed, for its
 * viewer: of each method the part of the gallery (report_gallery.h), a few
 * real frames long. In DIR/pictures, one PNG for the truth, its pictures one
 * below the other, and one for each method. That one holds how far each
 * picture is above the one that it is most like (of the truth, of an earlier
 * method, its own before), and below those how far they are below it: most of
 * that is black, pictures that are the same take nothing, and nothing is lost.
 */
#ifndef PURSUIT_CLI_REPORT_FRAMES_H
#define PURSUIT_CLI_REPORT_FRAMES_H

#include "report.h"

/* The name of the truth where a method's would stand. */
#define FRAMES_TRUTH "truth"

/* Chooses the pictures and writes those of the truth; after gallery_begin(). 0 or a negative errno with a sentence. */
int frames_begin(const struct report *report, struct report_gallery *gallery, const struct clip *clip,
				 struct error *error);

/* Writes those of a method, clip_play()'s. 0 or a negative errno with a sentence. */
int frames_add(const struct report *report, struct report_gallery *gallery, const struct report_variant *variant,
			   const struct clip *clip, uint8_t *const *pictures, struct error *error);

/* No method follows: what was kept to compare with is freed. */
void frames_end(struct report_gallery *gallery);

/* The file of a method, or of FRAMES_TRUTH, in DIR/pictures. */
void frames_name(char name[4 * REPORT_NAME], const struct report *report, const struct report_gallery *gallery,
				 const char *method);

#endif
