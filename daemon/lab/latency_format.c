/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "daemon/lab/latency_format.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const struct {
	const char *name, *meaning;
} columns[] = {
	{"vblank", "number of the refresh on the daemon's grid"},
	{"frame_id", "the client's number of the real frame on display, 0 none"},
	{"show", "real, in-between, repeat (intended), standby (plain picture for a late in-between), kept (nothing came)"},
	{"phase", "of the picture between its real frame and the next"},
	{"method", "that made the picture"},
	{"code", "number of the picture's bit in the sequence of the photodiode patch (its target vblank modulo 2^32)"},
	{"level", "of the photodiode patch on display, 0 black, 1 white"},
	{"submit_ns", "the client published the real frame (the client's clock reading; not checked)"},
	{"intake_ns", "the daemon saw it"},
	{"target_ns", "the vblank aimed at, on the daemon's grid"},
	{"ready_ns", "the picture was done"},
	{"flip_ns", "shown, as flip_source knows it: start of scan-out, not light"},
	{"event_ns", "the presenter's event reached the lab"},
	{"edge_ns", "the call that set the line for this flip came back: the edge is at most set_ns before"},
	{"photon_ns", "the photodiode's edge, stamped by the kernel in the interrupt"},
	{"trigger_ns", "the newest edge of the trigger input since the flip before, stamped by the kernel"},
	{"set_ns", "how long the call that set the line took"},
	{"flip_source",
	 "how flip_ns is known: kernel, display server, external vsync (the fitted vblank), timer (no display), estimated"},
	{"late", "1: the flip was handled only after the next vblank's time"},
	{"skipped", "refreshes just before this one that nobody handled"},
	{"edge_lost", "1: an edge was wanted and no line was there, or it was up still from the pulse before"},
	{"photon_lost", "1: the patch changed and no edge of the photodiode came in its window"},
};

#define COLUMNS (sizeof(columns) / sizeof(columns[0]))
static const enum point order[] = {POINT_SUBMIT, POINT_INTAKE, POINT_TARGET, POINT_READY,  POINT_FLIP,
								   POINT_EVENT,  POINT_EDGE,   POINT_PHOTON, POINT_TRIGGER};
_Static_assert(sizeof(order) / sizeof(order[0]) == POINT_COUNT, "every time point has its column");

void latency_print_explanation(FILE *out)
{
	fprintf(out,
			"# Pursuit latency log, version 1: one row for each displayed refresh.\n"
			"# Columns that end in _ns: nanoseconds; times are CLOCK_MONOTONIC of this machine (since boot), empty "
			"where unknown, - where not yet known.\n");
	for (size_t i = 0; i < COLUMNS; i++)
		fprintf(out, "# %s: %s\n", columns[i].name, columns[i].meaning);
}

const char *latency_column_line(void)
{
	return "vblank,frame_id,show,phase,method,code,level,submit_ns,intake_ns,target_ns,ready_ns,flip_ns,event_ns,"
		   "edge_ns,photon_ns,trigger_ns,set_ns,flip_source,late,skipped,edge_lost,photon_lost\n";
}

/* ---- CSV ---- */

static void print_time(FILE *out, uint64_t time_ns)
{
	if (time_ns == POINT_NOT_YET)
		fputs("-,", out);
	else if (time_ns == POINT_UNKNOWN)
		fputs(",", out);
	else
		fprintf(out, "%" PRIu64 ",", time_ns);
}

size_t latency_print_row(const struct points *points, char line[LATENCY_LINE])
{
	FILE *out = fmemopen(line, LATENCY_LINE, "w");
	if (!out)
		return 0;
	fprintf(out, "%" PRIu64 ",%" PRIu64 ",%s,%.4f,%.15s,%" PRIu32 ",%d,", points->vblank, points->frame_id,
			points_show_name(points->show), (double)points->phase, points->method, points->code, points->level);
	for (size_t i = 0; i < POINT_COUNT; i++)
		print_time(out, points->time[order[i]]);
	fprintf(out, "%" PRIu32 ",%s,%d,%" PRIu32 ",%d,%d\n", points->set_ns,
			presenter_time_source_name((enum presenter_time_source)points->source), points->late, points->skipped,
			points->edge_lost, points->photon_lost);
	const long length = ftell(out);
	fclose(out);
	return length > 0 ? (size_t)length : 0;
}

/* Splits a line at its commas; false unless it has exactly COLUMNS fields. */
static bool split(char *line, char *fields[COLUMNS])
{
	line[strcspn(line, "\r\n")] = '\0';
	for (size_t i = 0; i < COLUMNS; i++) {
		fields[i] = line;
		char *comma = strchr(line, ',');
		if (!comma != (i + 1 == COLUMNS))
			return false;
		if (comma) {
			*comma = '\0';
			line = comma + 1;
		}
	}
	return true;
}

static bool parse_number(const char *text, uint64_t most, uint64_t *value)
{
	char *end;
	if (*text < '0' || *text > '9')
		return false;
	*value = strtoull(text, &end, 10);
	return *end == '\0' && *value <= most;
}

static bool parse_time(const char *text, uint64_t *time_ns)
{
	*time_ns = POINT_UNKNOWN;
	if (*text == '\0')
		return true;
	*time_ns = POINT_NOT_YET;
	return strcmp(text, "-") == 0 || parse_number(text, INT64_MAX, time_ns);
}

static bool parse_show(const char *text, uint8_t *show)
{
	for (*show = 0; *show < POINTS_SHOWS; ++*show)
		if (strcmp(text, points_show_name(*show)) == 0)
			return true;
	return false;
}

static bool parse_source(const char *text, uint8_t *source)
{
	for (*source = 0; *source < PRESENTER_TIME_SOURCES; ++*source)
		if (strcmp(text, presenter_time_source_name((enum presenter_time_source) * source)) == 0)
			return true;
	return false;
}

bool latency_parse_row(const char *line, struct points *points)
{
	char copy[LATENCY_LINE], *fields[COLUMNS], *end;
	uint64_t code, level, set, late, skipped, edge_lost, photon_lost;
	if (strlen(line) >= sizeof(copy))
		return false;
	memset(points, 0, sizeof(*points));
	snprintf(copy, sizeof(copy), "%s", line);
	if (!split(copy, fields) || !parse_number(fields[0], UINT64_MAX, &points->vblank) ||
		!parse_number(fields[1], UINT64_MAX, &points->frame_id) || !parse_show(fields[2], &points->show))
		return false;
	points->phase = strtof(fields[3], &end);
	snprintf(points->method, sizeof(points->method), "%.15s", fields[4]);
	for (size_t i = 0; i < POINT_COUNT; i++)
		if (!parse_time(fields[7 + i], &points->time[order[i]]))
			return false;
	const size_t rest = 7 + POINT_COUNT;
	if (*end || !parse_number(fields[5], UINT32_MAX, &code) || !parse_number(fields[6], 1, &level) ||
		!parse_number(fields[rest], UINT32_MAX, &set) || !parse_source(fields[rest + 1], &points->source) ||
		!parse_number(fields[rest + 2], 1, &late) || !parse_number(fields[rest + 3], UINT32_MAX, &skipped) ||
		!parse_number(fields[rest + 4], 1, &edge_lost) || !parse_number(fields[rest + 5], 1, &photon_lost))
		return false;
	points->code = (uint32_t)code;
	points->level = level != 0;
	points->set_ns = (uint32_t)set;
	points->late = late != 0;
	points->skipped = (uint32_t)skipped;
	points->edge_lost = edge_lost != 0;
	points->photon_lost = photon_lost != 0;
	return true;
}

/* ---- binary ---- */

void latency_put_u32(uint8_t *bytes, uint32_t value)
{
	for (unsigned i = 0; i < 4; i++)
		bytes[i] = (uint8_t)(value >> 8 * i);
}

void latency_put_u64(uint8_t *bytes, uint64_t value)
{
	for (unsigned i = 0; i < 8; i++)
		bytes[i] = (uint8_t)(value >> 8 * i);
}

uint32_t latency_get_u32(const uint8_t *bytes)
{
	return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

uint64_t latency_get_u64(const uint8_t *bytes)
{
	return latency_get_u32(bytes) | (uint64_t)latency_get_u32(bytes + 4) << 32;
}

/*
 * u64 vblank, frame_id, nine times; u32 code, set_ns, skipped, phase (float);
 * u8 show, source, flags (1 late, 2 level, 4 edge_lost, 8 photon_lost), 0;
 * char method[16]; 4 bytes of 0.
 */
void latency_pack_row(const struct points *points, uint8_t bytes[LATENCY_ROW_BYTES])
{
	uint32_t phase;
	memset(bytes, 0, LATENCY_ROW_BYTES);
	memcpy(&phase, &points->phase, sizeof(phase));
	latency_put_u64(bytes, points->vblank);
	latency_put_u64(bytes + 8, points->frame_id);
	for (size_t i = 0; i < POINT_COUNT; i++)
		latency_put_u64(bytes + 16 + 8 * i, points->time[order[i]]);
	latency_put_u32(bytes + 88, points->code);
	latency_put_u32(bytes + 92, points->set_ns);
	latency_put_u32(bytes + 96, points->skipped);
	latency_put_u32(bytes + 100, phase);
	bytes[104] = points->show;
	bytes[105] = points->source;
	bytes[106] = (uint8_t)(points->late | points->level << 1 | points->edge_lost << 2 | points->photon_lost << 3);
	memcpy(bytes + 108, points->method, sizeof(points->method));
}

void latency_unpack_row(const uint8_t bytes[LATENCY_ROW_BYTES], struct points *points)
{
	memset(points, 0, sizeof(*points));
	const uint32_t phase = latency_get_u32(bytes + 100);
	memcpy(&points->phase, &phase, sizeof(phase));
	points->vblank = latency_get_u64(bytes);
	points->frame_id = latency_get_u64(bytes + 8);
	for (size_t i = 0; i < POINT_COUNT; i++)
		points->time[order[i]] = latency_get_u64(bytes + 16 + 8 * i);
	points->code = latency_get_u32(bytes + 88);
	points->set_ns = latency_get_u32(bytes + 92);
	points->skipped = latency_get_u32(bytes + 96);
	points->show = bytes[104];
	points->source = bytes[105];
	points->late = bytes[106] & 1;
	points->level = bytes[106] >> 1 & 1;
	points->edge_lost = bytes[106] >> 2 & 1;
	points->photon_lost = bytes[106] >> 3 & 1;
	memcpy(points->method, bytes + 108, sizeof(points->method) - 1);
}

uint64_t latency_checksum(const uint8_t *bytes, size_t size)
{
	uint64_t sum = UINT64_C(14695981039346656037);
	for (size_t i = 0; i < size; i++)
		sum = (sum ^ bytes[i]) * UINT64_C(1099511628211);
	return sum;
}
