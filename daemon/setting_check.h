/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Settings that mean something only together with what is linked in or with this machine: methods, presenters, formats
 * of files. Users and groups are looked up where they are needed (admission.h).
 */
#ifndef PURSUIT_SETTING_CHECK_H
#define PURSUIT_SETTING_CHECK_H

#include "daemon/error.h"
#include "daemon/options.h"

/* This one, as it stands in the settings. 0 or -EINVAL with a sentence. A configuration_check. */
int setting_check(const struct option_row *row, const struct settings *settings, struct error *error);

/* All of them. */
int setting_check_all(const struct settings *settings, struct error *error);

#endif
