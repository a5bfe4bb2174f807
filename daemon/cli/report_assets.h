/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Files of this folder that become part of the page, embedded while building. */
#ifndef PURSUIT_CLI_REPORT_ASSETS_H
#define PURSUIT_CLI_REPORT_ASSETS_H

extern const char report_page_css[];
extern const char report_viewer_html[];
extern const char report_viewer_js[];

#endif
