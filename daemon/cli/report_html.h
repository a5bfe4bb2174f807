/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Bits of HTML: text that is safe, files that become part of the page. */
#ifndef PURSUIT_CLI_REPORT_HTML_H
#define PURSUIT_CLI_REPORT_HTML_H

#include <stdbool.h>
#include <stdio.h>

/* Text with & < > " escaped. */
void html_text(FILE *out, const char *text);

/* <img> with the file's bytes in it; false, and nothing written, if there is no such file. */
bool html_image(FILE *out, const char *path, const char *type, const char *description, const char *attributes);

/* The same of an SVG file, as text, which takes less than base64. */
bool html_svg(FILE *out, const char *path, const char *description);

/* `before`, then the file's bytes as a data: address; false, and nothing written, if there is no such file. */
bool html_data(FILE *out, const char *path, const char *type, const char *before);

/* A string of JSON, quotes included, that can stand in a <script>. */
void html_json_text(FILE *out, const char *text);

/* Beginning and end of a table that may be wider than the page; it can be scrolled by keys. `label`: what it shows. */
void html_table_begin(FILE *out, const char *label);
void html_table_end(FILE *out);

/* <td> with a number, a dash if it is not finite; `mark`: class of the cell, may be NULL. */
void html_number(FILE *out, double value, int digits, const char *mark);

/* Beginning of the page, styles included, and its end. */
void html_begin(FILE *out, const char *title);
void html_end(FILE *out);

#endif
