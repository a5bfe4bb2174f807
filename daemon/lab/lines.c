/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/lines.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#define MS UINT64_C(1000000)
#define FIRST_DELAY (100 * MS)
#define LAST_DELAY (5000 * MS)
#define CHECK_DELAY (1000 * MS)

static void wait_longer(struct lines *lines, uint64_t now_ns)
{
	lines->delay_ns = lines->delay_ns ? lines->delay_ns * 2 : FIRST_DELAY;
	if (lines->delay_ns > LAST_DELAY)
		lines->delay_ns = LAST_DELAY;
	lines->retry_ns = now_ns + lines->delay_ns;
	lines->failures++;
}

/* They are there. */
static void tell(struct lines *lines, uint64_t now_ns)
{
	snprintf(lines->text, sizeof(lines->text), "%s %.128s", chip_text(lines->chip), lines->params.lines);
	log_info(lines->log, "%s: %s", lines->params.option, lines->text);
	lines->delay_ns = 0;
	lines->check_ns = now_ns + CHECK_DELAY;
}

/* What is wrong with the chip is said for each list of lines. */
static void name_lines(const struct lines *lines, struct error *error)
{
	const struct error why = *error;
	if (strncmp(why.text, lines->params.option, strlen(lines->params.option)) != 0)
		error_set(error, 0, "%s %.64s: %.400s", lines->params.option, lines->params.lines, why.text);
}

bool lines_revive(struct lines *lines, uint64_t now_ns)
{
	struct error error = {""};
	if (!lines->wanted || lines->chip || now_ns < lines->retry_ns)
		return false;
	lines->chip = chip_open(&lines->params, &error);
	if (!lines->chip) {
		wait_longer(lines, now_ns);
		name_lines(lines, &error);
		if (strncmp(error.text, lines->text, sizeof(lines->text) - 1) != 0)
			log_warning(lines->log, "%s; trying again until it works", error.text);
		snprintf(lines->text, sizeof(lines->text), "%.*s", (int)sizeof(lines->text) - 1, error.text);
		return false;
	}
	tell(lines, now_ns);
	return true;
}

void lines_adopt(struct lines *lines, struct chip *chip, uint64_t now_ns)
{
	lines->chip = chip;
	if (chip)
		tell(lines, now_ns);
}

void lines_lose(struct lines *lines, int code, uint64_t now_ns)
{
	chip_close(&lines->chip);
	lines->delay_ns = 0;
	wait_longer(lines, now_ns);
	snprintf(lines->text, sizeof(lines->text), "%s: %.128s is lost: %s", lines->params.option, lines->params.lines,
			 strerror(code < 0 ? -code : code));
	log_warning(lines->log, "%s; trying again until it works", lines->text);
}

uint64_t lines_next(const struct lines *lines)
{
	if (!lines->wanted)
		return UINT64_MAX;
	if (!lines->chip)
		return lines->retry_ns;
	return lines->params.input ? lines->check_ns : UINT64_MAX;
}

void lines_check(struct lines *lines, uint64_t now_ns)
{
	uint32_t levels;
	if (!lines->chip || !lines->params.input || now_ns < lines->check_ns)
		return;
	lines->check_ns = now_ns + CHECK_DELAY;
	const int result = chip_get(lines->chip, &levels);
	if (result < 0)
		lines_lose(lines, result, now_ns);
}

void lines_finish(struct lines *lines)
{
	chip_close(&lines->chip);
	lines->wanted = false;
}
