/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The page's viewer: two methods at the same place with an edge between them,
 * one picture after the other. report_viewer.html, .js and report_page.css are
 * what a browser runs; what is shown lies in the page as JSON.
 */
#ifndef PURSUIT_CLI_REPORT_VIEWER_H
#define PURSUIT_CLI_REPORT_VIEWER_H

#include "report.h"

/* Beginning of the ids of the pictures that the pursuit camera saw of a work; a method or "truth" follows. */
void viewer_seen_id(char id[REPORT_NAME], uint32_t work);

/* Bytes of the page after which it gets no more pictures; tables and plots are not counted out. */
#define VIEWER_MOST_BYTES (16L << 20)

/* The page has so many bytes already. */
bool viewer_is_full(FILE *out);

/* The place where it is seen. */
void viewer_write(FILE *out);

/* Pictures and program, once, at the end of the page. */
void viewer_write_data(const struct report *report, FILE *out);

#endif
