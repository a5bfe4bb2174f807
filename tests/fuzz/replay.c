/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Runs a fuzz target over files, and over inputs made from them by chance: so
 * a build of any compiler looks for findings, if without being led by coverage.
 *
 *   replay [--mutants N] [--seed S] FILE|FOLDER...
 */
#include <dirent.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/fuzz/fuzz.h"

#define MOST_BYTES ((size_t)64 << 10)
#define MOST_INPUTS 4096

struct input {
	uint8_t *data;
	size_t size;
};

struct corpus {
	struct input inputs[MOST_INPUTS];
	size_t count;
};

/* ---- files ---- */

static int add_file(struct corpus *corpus, const char *path)
{
	FILE *file = fopen(path, "rbe");
	struct input input = {malloc(MOST_BYTES), 0};
	if (!file || !input.data || corpus->count == MOST_INPUTS) {
		fprintf(stderr, "%s: %s\n", path, strerror(errno));
		free(input.data);
		if (file)
			fclose(file);
		return 1;
	}
	input.size = fread(input.data, 1, MOST_BYTES, file);
	fclose(file);
	corpus->inputs[corpus->count++] = input;
	return 0;
}

static int not_hidden(const struct dirent *entry)
{
	return entry->d_name[0] != '.';
}

/* In the order of their names, so that two runs are the same. */
static int add_folder(struct corpus *corpus, const char *path)
{
	struct dirent **entries;
	const int count = scandir(path, &entries, not_hidden, alphasort);
	int failed = count < 0;
	for (int i = 0; i < count; i++) {
		char name[4096];
		snprintf(name, sizeof(name), "%s/%s", path, entries[i]->d_name);
		failed |= add_file(corpus, name);
		free(entries[i]);
	}
	if (count >= 0)
		free(entries);
	else
		perror(path);
	return failed;
}

static int add_path(struct corpus *corpus, const char *path)
{
	struct stat status;
	if (stat(path, &status) == 0 && S_ISDIR(status.st_mode))
		return add_folder(corpus, path);
	return add_file(corpus, path);
}

/* ---- mutants ---- */

static uint64_t draw(uint64_t *state)
{
	*state ^= *state << 13;
	*state ^= *state >> 7;
	*state ^= *state << 17;
	return *state;
}

static size_t below(uint64_t *state, size_t limit)
{
	return limit ? (size_t)(draw(state) % limit) : 0;
}

static void change_bytes(struct input *input, uint64_t *state)
{
	static const uint8_t hard[] = {0, 1, 0x7f, 0x80, 0xff, 0x40, '\n', ' ', '='};
	if (input->size == 0)
		return;
	uint8_t *at = input->data + below(state, input->size);
	switch (below(state, 3)) {
	case 0:
		*at ^= (uint8_t)(1u << below(state, 8));
		return;
	case 1:
		*at = (uint8_t)draw(state);
		return;
	default:
		*at = hard[below(state, sizeof(hard))];
	}
}

static void insert_bytes(struct input *input, uint64_t *state, const struct input *from)
{
	const size_t start = below(state, from->size), room = MOST_BYTES - input->size;
	size_t count = 1 + below(state, from->size - start < 64 ? from->size - start + 1 : 64);
	const size_t at = below(state, input->size + 1);
	if (count > from->size - start)
		count = from->size - start;
	if (count > room)
		count = room;
	memmove(input->data + at + count, input->data + at, input->size - at);
	memcpy(input->data + at, from->data + start, count);
	input->size += count;
}

static void remove_bytes(struct input *input, uint64_t *state)
{
	const size_t at = below(state, input->size);
	size_t count = 1 + below(state, 32);
	if (count > input->size - at)
		count = input->size - at;
	memmove(input->data + at, input->data + at + count, input->size - at - count);
	input->size -= count;
}

static void mutate(struct input *input, uint64_t *state, const struct corpus *corpus)
{
	const size_t changes = 1 + below(state, 5);
	for (size_t i = 0; i < changes; i++) {
		const size_t kind = below(state, 8);
		if (kind == 0)
			insert_bytes(input, state, &corpus->inputs[below(state, corpus->count)]);
		else if (kind == 1)
			remove_bytes(input, state);
		else
			change_bytes(input, state);
	}
}

/* The input at work, for the one who looks into a finding; written by a signal handler. */
static struct input current;

static void save_finding(int number)
{
	FILE *file = fopen("finding.bin", "wbe");
	if (file) {
		fwrite(current.data, 1, current.size, file);
		fclose(file);
	}
	signal(number, SIG_DFL);
	raise(number);
}

static void run_mutants(const struct corpus *corpus, unsigned long count, uint64_t state)
{
	struct input mutant = {malloc(MOST_BYTES), 0};
	for (unsigned long i = 0; mutant.data && i < count; i++) {
		const struct input *parent = &corpus->inputs[below(&state, corpus->count)];
		memcpy(mutant.data, parent->data, parent->size);
		mutant.size = parent->size;
		mutate(&mutant, &state, corpus);
		current = mutant;
		fuzz_one(mutant.data, mutant.size);
	}
	free(mutant.data);
}

int main(int argc, char **argv)
{
	static struct corpus corpus;
	unsigned long mutants = 0;
	uint64_t seed = 1;
	int failed = 0;

	signal(SIGABRT, save_finding);
	for (int i = 1; i < argc; i++) {
		if (strcmp(argv[i], "--mutants") == 0 && i + 1 < argc)
			mutants = strtoul(argv[++i], NULL, 10);
		else if (strcmp(argv[i], "--seed") == 0 && i + 1 < argc)
			seed = strtoull(argv[++i], NULL, 10) * 2 + 1;
		else
			failed |= add_path(&corpus, argv[i]);
	}
	if (failed || corpus.count == 0) {
		fprintf(stderr, "usage: %s [--mutants N] [--seed S] FILE|FOLDER...\n", argv[0]);
		return 1;
	}
	for (size_t i = 0; i < corpus.count; i++) {
		current = corpus.inputs[i];
		fuzz_one(current.data, current.size);
	}
	run_mutants(&corpus, mutants, seed);
	printf("%zu inputs of the corpus, %lu made from them\n", corpus.count, mutants);
	for (size_t i = 0; i < corpus.count; i++)
		free(corpus.inputs[i].data);
	return 0;
}
