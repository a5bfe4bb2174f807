/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The settings: the table itself, text in and out, files, command lines. */

#include <errno.h>
#include <unistd.h>

#include "daemon/configuration.h"
#include "daemon/present/presenter.h"
#include "tests/test.h"

static void test_table(void)
{
	struct settings settings;
	settings_defaults(&settings);
	for (const struct option_row *row = option_table(); row->name; row++) {
		char value[1024];
		struct error error = {""};
		CHECK(row->help && *row->help);
		CHECK(strspn(row->name, "abcdefghijklmnopqrstuvwxyz-") == strlen(row->name));
		CHECK_INT(settings_get(&settings, row->name, value, sizeof(value)), 0);
		CHECK_STRING(value, row->default_value);
		CHECK_INT(settings_set(&settings, row->name, row->default_value, &error), 0);
		for (const struct option_row *other = row + 1; other->name; other++)
			CHECK(strcmp(row->name, other->name) != 0);
		if (row->type != OPTION_NUMBER && row->type != OPTION_REAL && row->type != OPTION_RATE)
			continue;
		char text[32];
		snprintf(text, sizeof(text), "%g", row->min - 1);
		CHECK_INT(settings_set(&settings, row->name, text, &error), -EINVAL);
		CHECK(strstr(error.text, row->name) == error.text);
		snprintf(text, sizeof(text), "%g", row->max + 1);
		CHECK_INT(settings_set(&settings, row->name, text, &error), -EINVAL);
		CHECK(strstr(error.text, row->name) == error.text);
		CHECK(strstr(error.text, text) || row->type == OPTION_RATE);
	}
}

/* As long as may be; never cut, and refused if it is longer, with file, line and name. */
static void test_long_texts(void)
{
	for (const struct option_row *row = option_table(); row->name; row++) {
		char text[OPTION_VALUE_BYTES + 1] = "", value[OPTION_VALUE_BYTES];
		struct settings settings, other;
		struct error error = {""};
		CHECK(row->size <= OPTION_VALUE_BYTES);
		if (row->type != OPTION_TEXT)
			continue;
		settings_defaults(&settings);
		memset(text, 'x', row->size - 1);
		CHECK_INT(settings_set(&settings, row->name, text, &error), 0);
		CHECK_INT(settings_get(&settings, row->name, value, sizeof(value)), 0);
		CHECK_STRING(value, text);
		settings_defaults(&other);
		CHECK(!settings_agree(&settings, &other, row));
		settings_copy(&other, &settings, row);
		CHECK(memcmp(&settings, &other, sizeof(settings)) == 0);
		text[row->size - 2] = 'y';
		CHECK_INT(settings_set(&other, row->name, text, &error), 0);
		CHECK(!settings_agree(&settings, &other, row));
		text[row->size - 1] = 'x';
		CHECK_INT(settings_set(&settings, row->name, text, &error), -EINVAL);
		CHECK(strstr(error.text, row->name) == error.text && strstr(error.text, "is longer than"));
	}
}

/* To the last bit: what is compared and copied is not what is printed. */
static void test_reals(void)
{
	static const char *const texts[] = {"600.00000000001", "0x1.2c00000000001p9", "555.5", "1e3"};
	struct settings settings, again;
	for (size_t i = 0; i < sizeof(texts) / sizeof(texts[0]); i++) {
		char value[OPTION_VALUE_BYTES];
		struct error error = {""};
		settings_defaults(&settings);
		settings_defaults(&again);
		CHECK_INT(settings_set(&settings, "viewing-distance-mm", texts[i], &error), 0);
		CHECK(!settings_agree(&settings, &again, option_find("viewing-distance-mm")));
		settings_get(&settings, "viewing-distance-mm", value, sizeof(value));
		CHECK(i < 2 || strlen(value) <= 5);
		CHECK_INT(settings_set(&again, "viewing-distance-mm", value, &error), 0);
		CHECK(memcmp(&settings, &again, sizeof(settings)) == 0);
	}
	settings_defaults(&again);
	settings = again;
	CHECK_INT(settings_set(&settings, "gamma", "-0", &(struct error){""}), 0);
	CHECK(settings_agree(&settings, &again, option_find("gamma")));
}

static void expect(const char *name, const char *value, int result, const char *sentence)
{
	struct settings settings;
	struct error error = {""};
	settings_defaults(&settings);
	CHECK_INT(settings_set(&settings, name, value, &error), result);
	CHECK_STRING(error.text, sentence);
}

#define METHODS "hold, black, blur-hold, mcif, interpolate, scatter, grid, adaptive-grid, pursuit"

static void test_refusals(void)
{
	expect("cell", "3", -EINVAL, "cell: 3 is below 4 px");
	expect("threads", "9", -EINVAL, "threads: 9 is above 8");
	expect("cell", "8.5", -EINVAL, "cell: \"8.5\" is not a whole number");
	expect("cell", "", -EINVAL, "cell: \"\" is not a whole number");
	expect("cell", "99999999999999999999", -EINVAL, "cell: 99999999999999999999 is above 64 px");
	expect("cel", "8", -EINVAL, "cel: there is no such setting; did you mean cell?");
	expect("zzzzzzzz", "8", -EINVAL, "zzzzzzzz: there is no such setting");
	expect("gamma", "nan", -EINVAL, "gamma: \"nan\" is not a number");
	expect("gamma", "0.5", -EINVAL, "gamma: 0.5 is neither 0 (sRGB) nor 1 to 5");
	expect("snap-threshold", "0.3", -EINVAL, "snap-threshold: 0.3 is not a multiple of 0.25");
	expect("stats", "/a\x1b[2J", -EINVAL, "stats: holds a control character (27)");
	expect("stats", "/a\x7f", -EINVAL, "stats: holds a control character (127)");
	expect("stats", "/a\xc2\x9b", -EINVAL, "stats: holds a control character (155)");
	expect("stats", "/a\xff", -EINVAL, "stats: is no UTF-8 text (byte 0xff)");
	expect("stats", "/a\xc3", -EINVAL, "stats: is no UTF-8 text (byte 0xc3)");
	expect("stats", "/a\xe2\x82(", -EINVAL, "stats: is no UTF-8 text (byte 0xe2)");
	expect("stats", "/a\xed\xa0\x80", -EINVAL, "stats: is no UTF-8 text (byte 0xed)");
	expect("stats", "/a\xc0\xaf", -EINVAL, "stats: is no UTF-8 text (byte 0xc0)");
	expect("stats", "/a\xf4\x90\x80\x80", -EINVAL, "stats: is no UTF-8 text (byte 0xf4)");
	expect("stats", "/gr\u00f6\u00dfe \u20ac \U0001f600 \u00a0", 0, "");
	expect("blur", "some", -EINVAL, "blur: \"some\" is none of doubtful, everywhere, off");
	expect("gles", "maybe", -EINVAL, "gles: \"maybe\" is neither yes nor no");
	expect("refresh", "0", -EINVAL, "refresh: 0 is below 1 Hz");
	expect("refresh", "120/0", -EINVAL, "refresh: \"120/0\" is not a rate like 120, 119.88 or 120000/1001");
	expect("refresh", "12a", -EINVAL, "refresh: \"12a\" is not a rate like 120, 119.88 or 120000/1001");
	expect("context", "glx", -EINVAL, "context: \"glx\" is none of auto, egl, egl-device:INDEX, osmesa, cpu");
	expect("context", "egl-device:x", -EINVAL, "context: \"egl-device:x\": the index of the device must be 0 to 255");
	expect("context", "egl-device:INDEX", -EINVAL,
		   "context: \"egl-device:INDEX\" is none of auto, egl, egl-device:INDEX, osmesa, cpu");
	expect("method", "", -EINVAL, "method: \"\" is none of " METHODS);
	expect("method", "grid,hold", -EINVAL, "method: \"grid,hold\" is none of " METHODS);
	expect("present", "kms, headless", 0, "");
	expect("present", "", -EINVAL, "present: \"\" is none of headless, glfw, kms");
	expect("present", "kms,hologram", -EINVAL, "present: \"hologram\" is none of headless, glfw, kms");
	expect("window-size", "auto", 0, "");
	expect("window-size", "16x16384", 0, "");
	expect("window-size", "15x100", -EINVAL, "window-size: 15x100 is not within 16 to 16384 px");
	expect("window-size", "100x99999", -EINVAL, "window-size: 100x99999 is not within 16 to 16384 px");
	expect("window-size", "100", -EINVAL, "window-size: \"100\" is neither auto nor a size like 1280x720");
	expect("window-size", "100x100000", -EINVAL,
		   "window-size: \"100x100000\" is neither auto nor a size like 1280x720");
	expect("window-size", "-1x99", -EINVAL, "window-size: \"-1x99\" is neither auto nor a size like 1280x720");
	expect("context", "egl-device:2", 0, "");
}

static void test_rates(void)
{
	static const struct {
		const char *text;
		unsigned long long numerator, denominator;
		const char *printed;
	} rates[] = {
		{"120", 120, 1, "120"},
		{"119.88", 2997, 25, "119.880000"},
		{"120000/1001", 120000, 1001, "120000/1001"},
		{"143.9", 1439, 10, "143.900000"},
		{"60.000", 60, 1, "60"},
		{"240/2", 120, 1, "120"},
	};
	for (size_t i = 0; i < sizeof(rates) / sizeof(rates[0]); i++) {
		struct settings settings, again;
		struct error error = {""};
		char value[64];
		settings_defaults(&settings);
		again = settings;
		CHECK_INT(settings_set(&settings, "refresh", rates[i].text, &error), 0);
		CHECK_INT(settings.refresh_numerator, rates[i].numerator);
		CHECK_INT(settings.refresh_denominator, rates[i].denominator);
		settings_get(&settings, "refresh", value, sizeof(value));
		CHECK_STRING(value, rates[i].printed);
		CHECK_INT(settings_set(&again, "refresh", value, &error), 0);
		CHECK(memcmp(&settings, &again, sizeof(settings)) == 0);
	}
}

/* Writes a temporary file; its name lives until the next call. */
static const char *file_with(const char *text)
{
	static char path[64];
	snprintf(path, sizeof(path), "/tmp/pursuit-options-XXXXXX");
	const int fd = mkstemp(path);
	CHECK(fd >= 0 && write(fd, text, strlen(text)) == (ssize_t)strlen(text));
	close(fd);
	return path;
}

static int load(struct settings *settings, const char *path, struct error *error)
{
	struct profiles profiles = {NULL, 0};
	const int result = configuration_load(settings, &profiles, path, NULL, error);
	profiles_finish(&profiles);
	return result;
}

static void test_config_round_trip(void)
{
	struct settings defaults, loaded;
	struct error error = {""};
	char *text = NULL;
	size_t size = 0, rows = 0;
	FILE *out = open_memstream(&text, &size);
	configuration_print(out);
	fclose(out);
	settings_defaults(&defaults);
	memset(&loaded, 0, sizeof(loaded));
	char *rest = text;
	for (char *line = strsep(&rest, "\n"); line; line = strsep(&rest, "\n")) {
		if (line[0] != '#' || line[1] == ' ')
			continue;
		const char *path = file_with(line + 1); /* a commented default, uncommented */
		CHECK_INT(load(&loaded, path, &error), 0);
		unlink(path);
		rows++;
	}
	free(text);
	CHECK(rows > 15);
	CHECK(memcmp(&defaults, &loaded, sizeof(defaults)) == 0);
}

/* The page as it is printed, and with every setting's comment sign taken away: both are the defaults. */
static void test_whole_config(void)
{
	struct settings defaults, loaded;
	struct error error = {""};
	char *text = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	configuration_print(out);
	fclose(out);
	settings_defaults(&defaults);
	const char *path = file_with(text);
	settings_defaults(&loaded);
	CHECK_INT(load(&loaded, path, &error), 0);
	CHECK(memcmp(&defaults, &loaded, sizeof(defaults)) == 0);
	unlink(path);
	for (char *c = text; *c; c++)
		if ((c == text || c[-1] == '\n') && c[0] == '#' && c[1] != ' ' && c[1] != '\n')
			*c = ' ';
	path = file_with(text);
	memset(&loaded, 0, sizeof(loaded));
	CHECK_INT(load(&loaded, path, &error), 0);
	CHECK_STRING(error.text, "");
	CHECK(memcmp(&defaults, &loaded, sizeof(defaults)) == 0);
	unlink(path);
	free(text);
}

static void test_config_errors(void)
{
	struct settings settings;
	struct error error = {""};
	char want[600];
	settings_defaults(&settings);
	const char *path = file_with("# a comment\n\n  cell = 16  \n\tgles=yes\nmethod = hold\nblur-level = 9\n");
	CHECK_INT(load(&settings, path, &error), -EINVAL);
	snprintf(want, sizeof(want), "%s:6: blur-level: 9 is above 6", path);
	CHECK_STRING(error.text, want);
	CHECK_INT(settings.cell, 16);
	CHECK(settings.gles);
	CHECK_STRING(settings.method, "hold");
	unlink(path);
	path = file_with("cell 16\n");
	CHECK_INT(load(&settings, path, &error), -EINVAL);
	snprintf(want, sizeof(want), "%s:1: \"cell 16\" is not of the form name = value", path);
	CHECK_STRING(error.text, want);
	unlink(path);
	char text[OPTION_VALUE_BYTES + 16];
	snprintf(text, sizeof(text), "\ntee = %0*d\n", (int)OPTION_VALUE_BYTES, 0);
	path = file_with(text);
	CHECK_INT(load(&settings, path, &error), -EINVAL);
	snprintf(want, sizeof(want), "%s:2: tee: \"%032d...\" is longer than 511 bytes", path, 0);
	CHECK_STRING(error.text, want);
	unlink(path);
	CHECK_INT(load(&settings, "/nonexistent/pursuit.conf", &error), -ENOENT);
	CHECK_STRING(error.text, "/nonexistent/pursuit.conf: No such file or directory");
	CHECK(load(&settings, "/tmp", &error) < 0);
}

static int take(struct settings *settings, unsigned mask, char *a, char *b, int *used, struct error *error)
{
	char *argv[] = {(char[]){"x"}, a, b, NULL};
	int index = 1;
	const int result = settings_argument(settings, mask, b ? 3 : 2, argv, &index, error);
	*used = index;
	return result;
}

/* Sections that cannot be, each with the line in its sentence. */
static void test_sections_refused(void)
{
	static const struct {
		const char *text, *sentence;
	} wrong[] = {
		{"[application]\n", ":1: "},
		{"cell = 8\n[application a/b]\n",
		 ":2: application: \"a/b\" must be the name of an executable, without folders"},
		{"[application x\ty]\n", ":1: application: the name holds a control character"},
		{"[application "
		 "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx"
		 "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx"
		 "xxxxxx"
		 "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx]\n",
		 "is longer than"},
		{"[application x]\n[application x]\n", ":2: application x has a section already, at line 1"},
	};
	struct settings settings;
	struct error error = {""};
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		settings_defaults(&settings);
		const char *path = file_with(wrong[i].text);
		CHECK(load(&settings, path, &error) < 0);
		CHECK(strstr(error.text, wrong[i].sentence) != NULL);
		unlink(path);
	}
	CHECK(profile_check_name(" x", &error) < 0 && strstr(error.text, "begins or ends with a space"));
}

/* One more than there may be; and a file that is read again on top of itself. */
static void test_many_sections(void)
{
	char text[PROFILES_MOST * 32 + 64] = "";
	struct profiles profiles = {NULL, 0};
	struct settings settings;
	struct error error = {""};
	settings_defaults(&settings);
	size_t used = 0;
	for (unsigned i = 0; i < PROFILES_MOST; i++)
		used += (size_t)snprintf(text + used, sizeof(text) - used, "[application a%u]\ncell = 9\n", i);
	const char *path = file_with(text);
	CHECK_INT(configuration_load(&settings, &profiles, path, NULL, &error), 0);
	CHECK_INT(configuration_load(&settings, &profiles, path, NULL, &error), 0);
	CHECK_INT(profiles.count, PROFILES_MOST);
	unlink(path);
	path = file_with("[application one-more]\n");
	CHECK(configuration_load(&settings, &profiles, path, NULL, &error) < 0);
	CHECK(strstr(error.text, "is one more than the 256") != NULL);
	unlink(path);
	profiles_finish(&profiles);
}

/* For the programs that make man page and completions. */
static void test_print_options(void)
{
	char *text = NULL, value[8];
	size_t size = 0;
	struct settings settings;
	FILE *out = open_memstream(&text, &size);
	settings_print_options(1u << OPTION_OUTPUT, out);
	fclose(out);
	CHECK(strstr(text, "option\ton-client-exit\tNAME\tkeep,black\t") != NULL);
	CHECK(strstr(text, "option\t[no-]fullscreen\t\t\t") != NULL);
	CHECK(!strstr(text, "option\tcell"));
	free(text);
	settings_defaults(&settings);
	CHECK_INT(settings_get(&settings, "nothing", value, sizeof(value)), -ENOENT);
}

static void test_arguments(void)
{
	struct settings settings;
	struct error error = {""};
	int used;
	const unsigned engine = 1u << OPTION_ENGINE;
	settings_defaults(&settings);
	CHECK_INT(take(&settings, engine, (char[]){"--cell"}, (char[]){"12"}, &used, &error), 1);
	CHECK_INT(used, 2);
	CHECK_INT(settings.cell, 12);
	CHECK_INT(take(&settings, engine, (char[]){"--cell=20"}, NULL, &used, &error), 1);
	CHECK_INT(used, 1);
	CHECK_INT(settings.cell, 20);
	CHECK_INT(take(&settings, engine, (char[]){"--no-compensation"}, NULL, &used, &error), 1);
	CHECK(!settings.compensation);
	CHECK_INT(take(&settings, engine, (char[]){"--compensation=yes"}, NULL, &used, &error), 1);
	CHECK(settings.compensation);
	CHECK_INT(take(&settings, engine, (char[]){"--gles"}, (char[]){"no"}, &used, &error), 1);
	CHECK(settings.gles);
	CHECK_INT(used, 1);
	CHECK_INT(take(&settings, engine, (char[]){"--refresh"}, (char[]){"60"}, &used, &error), 0);
	CHECK_INT(take(&settings, engine, (char[]){"--no-cell"}, NULL, &used, &error), 0);
	CHECK_INT(take(&settings, engine, (char[]){"scene"}, NULL, &used, &error), 0);
	CHECK_INT(take(&settings, engine, (char[]){"--cell"}, NULL, &used, &error), -EINVAL);
	CHECK_STRING(error.text, "--cell needs a value");
	CHECK_INT(take(&settings, engine, (char[]){"--no-gles=yes"}, NULL, &used, &error), -EINVAL);
}

static void test_engine_params(void)
{
	struct settings settings;
	struct engine_params params;
	struct error error = {""};
	settings_defaults(&settings);
	CHECK_INT(settings_engine_params(&settings, &params, &error), 0);
	CHECK_STRING(params.method, "pursuit");
	CHECK_INT(params.context, ENGINE_CONTEXT_AUTO);
	CHECK_INT(params.threshold_quarter, 2);
	CHECK_INT(params.cell, 8);
	CHECK_INT(params.threads, 0);
	CHECK_INT(settings_set(&settings, "threads", "3", &error), 0);
	CHECK_INT(settings_engine_params(&settings, &params, &error), 0);
	CHECK_INT(params.threads, 3);
	CHECK_INT(params.curve, ENGINE_CURVE_SRGB);
	CHECK(!params.no_compensation);
	CHECK_INT(settings_set(&settings, "context", "egl-device:3", &error), 0);
	CHECK_INT(settings_set(&settings, "gamma", "2.2", &error), 0);
	CHECK_INT(settings_engine_params(&settings, &params, &error), 0);
	CHECK_INT(params.context, ENGINE_CONTEXT_EGL_DEVICE);
	CHECK_INT(params.device, 3);
	CHECK_INT(params.curve, ENGINE_CURVE_GAMMA);
}

/* What the table offers is what there is. */
static void test_choices(void)
{
	const char *const *names = option_find("method")->choices;
	size_t count = 0;
	for (const struct engine_method_info *info = engine_methods(); info->name; info++, count++)
		CHECK_STRING(names[count], info->name);
	CHECK(!names[count]);
	names = option_find("present")->choices;
	count = 0;
	for (const struct presenter_impl *const *impl = presenter_impls(); *impl; impl++, count++)
		CHECK(option_choices_have(names, (*impl)->name, NULL));
	CHECK(names[count - 1] && !names[count]);
	CHECK_STRING(option_find("context")->choices[ENGINE_CONTEXT_CPU], "cpu");
}

static void test_help(void)
{
	char *text = NULL;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	settings_print_help(1u << OPTION_ENGINE, out);
	fclose(out);
	CHECK(strstr(text, "--cell NUMBER") && strstr(text, "--[no-]gles") && strstr(text, "4 to 64 px"));
	CHECK(!strstr(text, "--refresh"));
	free(text);
}

int main(void)
{
	RUN(test_table);
	RUN(test_long_texts);
	RUN(test_reals);
	RUN(test_refusals);
	RUN(test_rates);
	RUN(test_config_round_trip);
	RUN(test_whole_config);
	RUN(test_config_errors);
	RUN(test_sections_refused);
	RUN(test_many_sections);
	RUN(test_print_options);
	RUN(test_arguments);
	RUN(test_engine_params);
	RUN(test_choices);
	RUN(test_help);
	return test_result();
}
