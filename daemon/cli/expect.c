/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "expect.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "daemon/record/image.h"
#include "daemon/record/pattern.h"

#define NAMED_DIFFERENCES 10u

/* ---- writing ---- */

int expect_writer_open(struct expect_writer *writer, const char *path, const struct engine_info *info,
					   const char *method, struct error *error)
{
	*writer = (struct expect_writer){.path = path, .info = info, .method = method};
	writer->file = fopen(path, "w");
	if (!writer->file)
		return error_set(error, -errno, "%s: %s", path, strerror(errno));
	return 0;
}

int expect_writer_add(struct expect_writer *writer, uint64_t number, const struct picture *picture, uint64_t hash,
					  struct error *error)
{
	if (!writer->started)
		fprintf(writer->file,
				"# pursuit expect 1\n# renderer %s\n# version %s\n# context %s\n# method %s\n# size %ux%u\n",
				writer->info->renderer, writer->info->version, writer->info->context, writer->method, picture->width,
				picture->height);
	writer->started = true;
	if (fprintf(writer->file, "%" PRIu64 " %016" PRIx64 "\n", number, hash) < 0)
		return error_set(error, -EIO, "%s: %s", writer->path, strerror(errno));
	return 0;
}

int expect_writer_close(struct expect_writer *writer, struct error *error)
{
	FILE *file = writer->file;
	writer->file = NULL;
	if (!file)
		return 0;
	bool wrong = ferror(file) != 0;
	if (fclose(file) != 0 || wrong)
		return error_set(error, -EIO, "%s: not written whole: %s", writer->path, strerror(errno));
	return 0;
}

/* ---- loading ---- */

bool expect_read_tolerance(const char *text, struct expect *expect)
{
	char *end;
	expect->limit = strtod(text, &end);
	if (end == text || !(expect->limit >= 0) || !isfinite(expect->limit))
		return false;
	expect->tolerance = EXPECT_CODES;
	if (strcmp(end, "dB") == 0 || strcmp(end, "db") == 0)
		expect->tolerance = EXPECT_PSNR;
	else if (*end)
		return false;
	return true;
}

static int add_hash(struct expect *expect, uint32_t *capacity, uint64_t number, uint64_t hash)
{
	if (expect->count == *capacity) {
		*capacity = *capacity ? 2 * *capacity : 256;
		uint64_t *numbers = realloc(expect->numbers, *capacity * sizeof(*numbers));
		if (numbers)
			expect->numbers = numbers;
		uint64_t *hashes = realloc(expect->hashes, *capacity * sizeof(*hashes));
		if (hashes)
			expect->hashes = hashes;
		if (!numbers || !hashes)
			return -ENOMEM;
	}
	expect->numbers[expect->count] = number;
	expect->hashes[expect->count++] = hash;
	return 0;
}

static void note_maker(struct expect *expect, const char *line)
{
	size_t used = strlen(expect->made_by);
	if (strncmp(line, "# renderer ", 11) != 0 && strncmp(line, "# version ", 10) != 0)
		return;
	const char *value = strchr(line + 2, ' ') + 1;
	snprintf(expect->made_by + used, sizeof(expect->made_by) - used, "%s%.*s", used ? ", " : "",
			 (int)strcspn(value, "\n"), value);
}

static int load_hashes(struct expect *expect, const char *path, FILE *file, struct error *error)
{
	char line[600];
	uint32_t capacity = 0;
	for (unsigned row = 1; fgets(line, sizeof(line), file); row++) {
		uint64_t number, hash;
		char rest;
		if (row == 1 && strcmp(line, "# pursuit expect 1\n") != 0)
			return error_set(error, -EINVAL,
							 "%s: no file of --write-expect: its first line is not `# pursuit expect 1`", path);
		note_maker(expect, line);
		if (line[0] == '#')
			continue;
		if (sscanf(line, "%" SCNu64 " %" SCNx64 "%c", &number, &hash, &rest) < 2)
			return error_set(error, -EINVAL, "%s:%u: not a line of `number hash`", path, row);
		if (expect->count && number <= expect->numbers[expect->count - 1])
			return error_set(error, -EINVAL, "%s:%u: number %" PRIu64 " does not rise", path, row, number);
		if (add_hash(expect, &capacity, number, hash) < 0)
			return error_set(error, -ENOMEM, "out of memory");
	}
	expect->seen = calloc(expect->count + 1u, sizeof(*expect->seen));
	if (!expect->seen)
		return error_set(error, -ENOMEM, "out of memory");
	if (expect->count == 0)
		return error_set(error, -EINVAL, "%s: no hash in it", path);
	return 0;
}

/* "f_00012.png" to "f_%05d.png": the last digits before .png are the number. */
static bool pattern_of_name(const char *folder, const char *file, char *pattern, size_t size)
{
	size_t length = strlen(file);
	if (length < 5 || strcmp(file + length - 4, ".png") != 0)
		return false;
	size_t end = length - 4, start = end;
	while (start > 0 && isdigit((unsigned char)file[start - 1]))
		start--;
	if (start == end || strchr(file, '%') || strchr(folder, '%'))
		return false;
	char number[16] = "%d";
	if (file[start] == '0' && end - start > 1)
		snprintf(number, sizeof(number), "%%0%ud", (unsigned)(end - start));
	struct error ignored;
	int wrote = snprintf(pattern, size, "%s/%.*s%s.png", folder, (int)start, file, number);
	return wrote > 0 && (size_t)wrote < size && pattern_check("--expect", pattern, &ignored) == 0;
}

/* The pattern of the numbered PNG files in a folder, taken from the first of them found. */
static bool pattern_of_folder(const char *folder, char *pattern, size_t size)
{
	DIR *open_folder = opendir(folder);
	bool found = false;
	for (struct dirent *entry; open_folder && !found && (entry = readdir(open_folder));)
		found = pattern_of_name(folder, entry->d_name, pattern, size);
	if (open_folder)
		closedir(open_folder);
	return found;
}

/* Which images there are: each is to be displayed. */
static int list_images(struct expect *expect, struct error *error)
{
	size_t count;
	const int result = pattern_list(expect->pattern, &expect->numbers, &count, error);
	if (result == -ENOMEM)
		return result;
	expect->count = (uint32_t)count;
	expect->seen = calloc(count + 1, sizeof(*expect->seen));
	return expect->seen ? 0 : error_set(error, -ENOMEM, "out of memory");
}

int expect_load(struct expect *expect, const char *path, struct error *error)
{
	struct stat status;
	if (strchr(path, '%')) {
		snprintf(expect->pattern, sizeof(expect->pattern), "%s", path);
		const int result = pattern_check("--expect", path, error);
		return result < 0 ? result : list_images(expect, error);
	}
	if (stat(path, &status) == 0 && S_ISDIR(status.st_mode)) {
		if (!pattern_of_folder(path, expect->pattern, sizeof(expect->pattern)))
			return error_set(error, -ENOENT, "%s: no numbered PNG file in it", path);
		return list_images(expect, error);
	}
	if (expect->tolerance != EXPECT_IDENTICAL)
		return error_set(error, -EINVAL, "--expect-tolerance needs images to compare with; %s holds hashes", path);
	FILE *file = fopen(path, "r");
	if (!file)
		return error_set(error, -errno, "%s: %s", path, strerror(errno));
	int result = load_hashes(expect, path, file, error);
	fclose(file);
	return result;
}

void expect_finish(struct expect *expect)
{
	free(expect->numbers);
	free(expect->hashes);
	free(expect->seen);
	*expect = (struct expect){{0}};
}

/* ---- comparing ---- */

__attribute__((format(printf, 3, 4))) static void differs(struct expect *expect, uint64_t number, const char *format,
														  ...)
{
	if (++expect->different > NAMED_DIFFERENCES)
		return;
	va_list arguments;
	va_start(arguments, format);
	fprintf(stderr, "pursuit replay: displayed frame %" PRIu64 " ", number);
	vfprintf(stderr, format, arguments);
	fputc('\n', stderr);
	va_end(arguments);
}

/* Where the number is among the expected ones, which is seen then; the count of them: nowhere. */
static uint32_t see(struct expect *expect, uint64_t number)
{
	uint32_t low = 0, high = expect->count;
	while (low < high) {
		uint32_t middle = low + (high - low) / 2;
		if (expect->numbers[middle] < number)
			low = middle + 1;
		else
			high = middle;
	}
	if (low == expect->count || expect->numbers[low] != number)
		return expect->count;
	expect->seen[low] = true;
	return low;
}

static void compare_hash(struct expect *expect, uint64_t number, uint64_t hash)
{
	const uint32_t at = see(expect, number);
	if (at == expect->count) {
		expect->unexpected++;
		differs(expect, number, "is not expected");
	} else if (expect->hashes[at] != hash) {
		differs(expect, number, "differs: hash %016" PRIx64 ", expected %016" PRIx64, hash, expect->hashes[at]);
	}
}

static unsigned largest_difference(const struct picture *a, const struct picture *b)
{
	unsigned largest = 0;
	for (uint32_t y = 0; y < a->height; y++) {
		const uint8_t *left = a->data + y * a->stride, *right = b->data + y * b->stride;
		for (uint32_t x = 0; x < 4 * a->width; x++) {
			unsigned off = (unsigned)abs(left[x] - right[x]);
			if (off > largest && x % 4 != 3)
				largest = off;
		}
	}
	return largest;
}

static void compare_image(struct expect *expect, uint64_t number, const struct picture *picture)
{
	char name[PATTERN_MAX_PATH];
	struct image image;
	struct error error = {"its name is too long"};
	see(expect, number);
	if (!pattern_name(expect->pattern, number, name) || image_read(name, IMAGE_BGRA, 0, &image, &error) < 0) {
		differs(expect, number, "has no image to compare with: %s", error.text);
		return;
	}
	const struct picture wanted = {image.bgra, 4 * (size_t)image.width, image.width, image.height};
	if (image.width != picture->width || image.height != picture->height) {
		differs(expect, number, "is %ux%u, %s is %ux%u", picture->width, picture->height, name, image.width,
				image.height);
	} else if (expect->tolerance == EXPECT_PSNR) {
		double psnr = measure_psnr(picture, &wanted);
		if (psnr < expect->limit)
			differs(expect, number, "differs: PSNR %.2f dB, at least %.2f expected", psnr, expect->limit);
	} else {
		unsigned off = largest_difference(picture, &wanted);
		if (off > expect->limit)
			differs(expect, number, "differs by up to %u code values, at most %.0f expected", off, expect->limit);
	}
	image_finish(&image);
}

void expect_compare(struct expect *expect, uint64_t number, const struct picture *picture, uint64_t hash)
{
	expect->compared++;
	if (expect->pattern[0])
		compare_image(expect, number, picture);
	else
		compare_hash(expect, number, hash);
}

bool expect_conclude(struct expect *expect, const struct engine_info *info)
{
	uint32_t missing = 0;
	for (uint32_t i = 0; i < expect->count; i++)
		missing += !expect->seen[i];
	if (missing)
		fprintf(stderr, "pursuit replay: %u expected frames were not displayed\n", missing);
	if (expect->different > NAMED_DIFFERENCES)
		fprintf(stderr, "pursuit replay: and %u more\n", expect->different - NAMED_DIFFERENCES);
	if (expect->different == 0 && missing == 0 && expect->compared > 0)
		return true;
	char maker[512];
	snprintf(maker, sizeof(maker), "%s, %s", info->renderer, info->version);
	if (!expect->pattern[0] && expect->count && strcmp(maker, expect->made_by) != 0)
		fprintf(stderr,
				"pursuit replay: the expectation was made by another renderer (%s; this is %s): only pictures of the "
				"same one are promised to be equal\n",
				expect->made_by, maker);
	fprintf(stderr, "pursuit replay: %u of %u displayed frames differ from what is expected\n", expect->different,
			expect->compared);
	return false;
}
