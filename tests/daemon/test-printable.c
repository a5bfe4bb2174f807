/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* Names of others, as text: nothing in them controls a terminal, and none is cut within a character. */
#include "daemon/printable.h"
#include "tests/test.h"

static void check_clean(const char *name, const char *want)
{
	char text[64];
	snprintf(text, sizeof(text), "%s", name);
	printable_clean(text);
	CHECK_STRING(text, want);
}

static void test_clean(void)
{
	check_clean("", "");
	check_clean("Super \xc3\x84 \xe2\x82\xac", "Super \xc3\x84 \xe2\x82\xac");
	check_clean("a\x1b[31m\n\x7f", "a?[31m??");
	check_clean("a\xff\xc3\x84", "a???");
	check_clean("a\xc2\x9b"
				"31m\xc2\x80\xc2\x9f",
				"a??31m????");
	check_clean("\xc2\xa0\xc3\x9b", "\xc2\xa0\xc3\x9b");
	check_clean("a\xc2", "a?");
}

static void test_copy(void)
{
	char text[5];
	printable_copy(text, sizeof(text), "abcd");
	CHECK_STRING(text, "abcd");
	printable_copy(text, sizeof(text), "abcde");
	CHECK_STRING(text, "abcd");
	printable_copy(text, sizeof(text), "abc\xc3\x84");
	CHECK_STRING(text, "abc");
	printable_copy(text, sizeof(text), "\xe2\x82\xac\xe2\x82\xac");
	CHECK_STRING(text, "\xe2\x82\xac");
	printable_copy(text, 1, "abc");
	CHECK_STRING(text, "");
}

int main(void)
{
	RUN(test_clean);
	RUN(test_copy);
	return test_result();
}
