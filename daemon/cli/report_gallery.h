/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Pictures of a report that a person looks at: the part of a scene with the most moving detail. */
#ifndef PURSUIT_CLI_REPORT_GALLERY_H
#define PURSUIT_CLI_REPORT_GALLERY_H

#include "report.h"

/* Chooses the part, keeps what is seen of the truth there, begins a contact sheet. 0 or -ENOMEM with a sentence. */
int gallery_begin(struct report_gallery *gallery, const struct report_work *work, const struct clip *clip,
				  struct error *error);

/* A row of the contact sheet: the last scored in-between of the clip, that part of it, twice as large. */
int gallery_add(struct report_gallery *gallery, const struct report_variant *variant, const struct clip *clip,
				uint8_t *const *pictures, struct error *error);

/* Writes the contact sheet among the report's pictures; what cannot be written is named on stderr. */
void gallery_end(struct report_gallery *gallery, const struct report *report);

#endif
