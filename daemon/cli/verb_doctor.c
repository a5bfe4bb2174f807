/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* pursuit doctor: what works on this machine, what does not, and what mends it. */

#include <assert.h>
#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>

#include "args.h"
#include "color.h"
#include "doctor.h"
#include "json_out.h"
#include "verbs.h"

#define VERB "doctor"

static const char *const words[] = {"works", "note", "limit", "fails"};

void doctor_add(struct doctor *doctor, enum doctor_state state, const char *area, const char *mend, const char *format,
				...)
{
	va_list arguments;
	assert(state < DOCTOR_LIMIT || (mend && *mend));
	if (doctor->count == DOCTOR_FINDINGS)
		return;
	struct doctor_finding *finding = &doctor->findings[doctor->count++];
	finding->state = state;
	finding->area = area;
	snprintf(finding->mend, sizeof(finding->mend), "%s", mend ? mend : "");
	va_start(arguments, format);
	vsnprintf(finding->text, sizeof(finding->text), format, arguments);
	va_end(arguments);
}

static void print_text(const struct doctor *doctor)
{
	static const char *const colors[] = {"\033[32m", "\033[36m", "\033[33m", "\033[31m"};
	const bool color = color_is_wanted();
	for (uint32_t i = 0; i < doctor->count; i++) {
		const struct doctor_finding *finding = &doctor->findings[i];
		printf("%s%-5s%s  %-10s  %s\n", color ? colors[finding->state] : "", words[finding->state],
			   color ? "\033[0m" : "", finding->area, finding->text);
		if (finding->mend[0])
			printf("%20s-> %s\n", "", finding->mend);
	}
}

static int print_json(const struct doctor *doctor)
{
	json_t *list = json_array();
	for (uint32_t i = 0; i < doctor->count; i++) {
		const struct doctor_finding *finding = &doctor->findings[i];
		json_array_append_new(list, json_pack("{s:s, s:s, s:s, s:s}", "state", words[finding->state], "area",
											  finding->area, "text", finding->text, "mend", finding->mend));
	}
	return json_out(VERB, json_pack("{s:o}", "findings", list));
}

int verb_doctor(int argc, char **argv)
{
	bool json = false;
	const char *socket = NULL;
	const struct arg_row rows[] = {
		{"json", ARG_FLAG, &json, 0, 0, NULL, NULL, "what was found as one JSON object"},
		{"socket", ARG_TEXT, &socket, 0, 0, NULL, "PATH", "of the daemon, where it is not the usual one"},
		{NULL},
	};
	const struct args args = {
		.verb = VERB,
		.usage = "[--json]",
		.summary = "Looks at this machine: renderers, displays and their rates, GPIO chips, priorities, units of "
				   "systemd, the socket, the daemon.\n"
				   "Says in plain words what works and what mends the rest.",
		.status = "something that every use needs does not work",
		.examples = "  pursuit doctor\n",
		.rows = rows,
	};
	struct doctor doctor = {.system = ""};
	int status = STATUS_DONE;
	if (!args_parse(&args, argc, argv, &status))
		return status;
	doctor_look_at_renderers(&doctor);
	doctor_look_at_displays(&doctor);
	doctor_look_at_gpio(&doctor);
	doctor_look_at_scheduling(&doctor);
	doctor_look_at_service(&doctor);
	doctor_look_at_daemon(&doctor, socket);
	if (json)
		status = print_json(&doctor);
	else
		print_text(&doctor);
	for (uint32_t i = 0; i < doctor.count; i++)
		if (doctor.findings[i].state == DOCTOR_FAILS)
			status = STATUS_FAILED;
	return status;
}
