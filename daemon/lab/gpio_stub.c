/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* A build without libgpiod: no chip can be opened, and the message says so. */

#include "daemon/lab/chip.h"

#include <errno.h>
#include <stddef.h>

const char *chip_library(void)
{
	return "none";
}

struct chip *chip_open(const struct chip_params *params, struct error *error)
{
	error_set(error, -ENOTSUP, "%s: this pursuitd was built without libgpiod (-Dgpio=enabled)", params->option);
	return NULL;
}

void chip_close(struct chip **chip)
{
	*chip = NULL;
}

uint32_t chip_line_count(const struct chip *chip)
{
	(void)chip;
	return 0;
}

const char *chip_text(const struct chip *chip)
{
	(void)chip;
	return "";
}

int chip_set(struct chip *chip, uint32_t levels)
{
	(void)chip;
	(void)levels;
	return -ENOTSUP;
}

int chip_get(struct chip *chip, uint32_t *levels)
{
	(void)chip;
	*levels = 0;
	return -ENOTSUP;
}

int chip_fd(const struct chip *chip)
{
	(void)chip;
	return -1;
}

int chip_read(struct chip *chip, struct chip_edge *edges, uint32_t most)
{
	(void)chip;
	(void)edges;
	(void)most;
	return -ENOTSUP;
}
