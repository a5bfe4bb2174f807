/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The page of a report takes pictures up to a limit, and says what it left out beyond that. */

#include <string.h>

#include "daemon/cli/report_viewer.h"
#include "tests/test.h"

/* What is written of both works into a page that has `before` bytes already. */
static void write_after(long before, char *text, size_t size)
{
	struct report_work works[2] = {{.name = "first", .n = 2}, {.name = "second", .n = 2}};
	struct report_gallery galleries[2] = {{.work = &works[0], .shown_count = 1}, {.work = &works[1], .shown_count = 1}};
	const struct report report = {
		.options = {.out = "/nonexistent"}, .works = works, .work_count = 2, .galleries = galleries};
	FILE *page = tmpfile();
	memset(text, 0, size);
	CHECK(page != NULL);
	if (!page)
		return;
	fseek(page, before, SEEK_SET);
	viewer_write_data(&report, page);
	fseek(page, before, SEEK_SET);
	CHECK(fread(text, 1, size - 1, page) > 0);
	fclose(page);
}

static void test_below_the_limit(void)
{
	char text[32768];
	write_after(0, text, sizeof(text));
	CHECK(strstr(text, "\"first, N = 2") && strstr(text, "\"second, N = 2"));
	CHECK(!strstr(text, "left-out"));
}

static void test_beyond_the_limit(void)
{
	char text[32768];
	write_after(VIEWER_MOST_BYTES + 1, text, sizeof(text));
	CHECK(!strstr(text, "\"first, N = 2") && !strstr(text, "\"second, N = 2"));
	CHECK(strstr(text, "[]</script>"));
	CHECK(strstr(text, "<p id=\"left-out\">2 scenes or recordings are not in the viewer"));
}

int main(void)
{
	RUN(test_below_the_limit);
	RUN(test_beyond_the_limit);
	return test_result();
}
