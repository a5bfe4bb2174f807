/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "contact.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "daemon/letters.h"
#include "daemon/record/image.h"

#define COLUMNS 4u
#define MAX_ROWS 12u
#define MAX_CELL_WIDTH 640u
#define MIN_CELL_WIDTH 320u
#define GAP 10u
#define LETTER_SCALE 2u
#define INK 0xffebebebu
#define LINE (LETTER_SCALE * (LETTER_HEIGHT + 4u))
/* So much of the error may be beyond white. */
#define CLIPPED_SHARE 0.002

struct contact {
	uint32_t width, height;   /* of the pictures */
	uint32_t shrink, enlarge; /* one of them is 1 */
	uint32_t cell_width, cell_height;
	uint32_t rows;
	char labels[MAX_ROWS][160];
	uint8_t *cells[MAX_ROWS][COLUMNS]; /* cell_width x cell_height BGRA; the last column is the error itself */
	uint64_t errors[256];              /* how often each error is in a channel of a pixel */
};

struct sheet {
	uint8_t *data;
	uint32_t width, height;
};

struct contact *contact_create(uint32_t width, uint32_t height)
{
	struct contact *contact = calloc(1, sizeof(*contact));
	if (!contact)
		return NULL;
	contact->width = width;
	contact->height = height;
	contact->shrink = (width + MAX_CELL_WIDTH - 1) / MAX_CELL_WIDTH;
	contact->enlarge = contact->shrink > 1 ? 1 : (MIN_CELL_WIDTH + width - 1) / width;
	contact->cell_width = width * contact->enlarge / contact->shrink;
	contact->cell_height = height * contact->enlarge / contact->shrink;
	if (contact->cell_height == 0)
		contact->cell_height = 1;
	return contact;
}

void contact_destroy(struct contact **contact)
{
	if (!contact || !*contact)
		return;
	for (uint32_t row = 0; row < (*contact)->rows; row++)
		for (uint32_t column = 0; column < COLUMNS; column++)
			free((*contact)->cells[row][column]);
	free(*contact);
	*contact = NULL;
}

/* The mean over the pixels of one cell pixel; of the difference if there is another picture. */
static uint8_t mean_at(const struct contact *contact, const struct picture *a, const struct picture *b, uint32_t x,
					   uint32_t y, uint32_t channel)
{
	uint32_t sum = 0, step = contact->shrink, left = x * step / contact->enlarge, top = y * step / contact->enlarge;
	uint32_t bottom = top + step < a->height ? top + step : a->height;
	for (uint32_t j = top; j < bottom; j++) {
		for (uint32_t i = left; i < left + step; i++) {
			int value = a->data[j * a->stride + 4 * i + channel];
			sum += (uint32_t)(b ? abs(value - b->data[j * b->stride + 4 * i + channel]) : value);
		}
	}
	uint32_t count = step * (bottom - top);
	return (uint8_t)(count ? (sum + count / 2) / count : 0);
}

static uint8_t *make_cell(const struct contact *contact, const struct picture *a, const struct picture *b)
{
	uint8_t *cell = malloc(4 * (size_t)contact->cell_width * contact->cell_height), *pixel = cell;
	for (uint32_t y = 0; cell && y < contact->cell_height; y++) {
		for (uint32_t x = 0; x < contact->cell_width; x++, pixel += 4) {
			for (uint32_t channel = 0; channel < 3; channel++)
				pixel[channel] = mean_at(contact, a, b, x, y, channel);
			pixel[3] = 255;
		}
	}
	return cell;
}

static void count_errors(struct contact *contact, const uint8_t *cell)
{
	size_t bytes = 4 * (size_t)contact->cell_width * contact->cell_height;
	for (size_t i = 0; i < bytes; i++) {
		if (i % 4 != 3)
			contact->errors[cell[i]]++;
	}
}

int contact_add(struct contact *contact, const char *label, const struct picture *real,
				const struct picture *in_between, const struct picture *truth, struct error *error)
{
	const struct picture *const pictures[COLUMNS] = {real, in_between, truth, in_between};
	if (contact->rows == MAX_ROWS)
		return 0;
	uint32_t row = contact->rows;
	bool whole = true;
	for (uint32_t column = 0; column < COLUMNS; column++) {
		contact->cells[row][column] = make_cell(contact, pictures[column], column == 3 ? truth : NULL);
		whole &= contact->cells[row][column] != NULL;
	}
	contact->rows++;
	snprintf(contact->labels[row], sizeof(contact->labels[row]), "%s", label);
	if (!whole)
		return error_set(error, -ENOMEM, "out of memory for the contact sheet");
	count_errors(contact, contact->cells[row][3]);
	return 0;
}

/* The largest power of two that leaves nearly all errors below white. */
static uint32_t error_factor(const struct contact *contact)
{
	uint64_t all = 0, above = 0;
	for (uint32_t i = 0; i < 256; i++)
		all += contact->errors[i];
	int limit = 255;
	while (limit > 0 && (double)(above + contact->errors[limit]) <= CLIPPED_SHARE * (double)all)
		above += contact->errors[limit--];
	uint32_t factor = 1;
	while (factor < 16 && 2 * factor * (uint32_t)limit <= 255)
		factor *= 2;
	return factor;
}

static void put_text(const struct sheet *sheet, uint32_t x, uint32_t y, const char *text)
{
	const struct letters_picture picture = {sheet->data, (size_t)sheet->width * 4, sheet->width, sheet->height};
	letters_line(&picture, x, y, LETTER_SCALE, INK, text);
}

static void put_cell(const struct sheet *sheet, const struct contact *contact, uint32_t row, uint32_t column,
					 uint32_t x, uint32_t y, uint32_t factor)
{
	const uint8_t *cell = contact->cells[row][column];
	for (uint32_t j = 0; j < contact->cell_height; j++) {
		uint8_t *line = sheet->data + 4 * ((size_t)(y + j) * sheet->width + x);
		for (uint32_t i = 0; i < 4 * contact->cell_width; i++) {
			uint32_t value = cell[4 * (size_t)j * contact->cell_width + i] * (i % 4 == 3 ? 1 : factor);
			line[i] = (uint8_t)(value > 255 ? 255 : value);
		}
	}
}

static void draw(const struct sheet *sheet, const struct contact *contact, const char *title)
{
	char headings[COLUMNS][48] = {"real frame", "in-between", "truth", ""};
	uint32_t factor = error_factor(contact);
	snprintf(headings[3], sizeof(headings[3]), "error x %u", factor);
	put_text(sheet, GAP, GAP, title);
	for (uint32_t column = 0; column < COLUMNS; column++)
		put_text(sheet, GAP + column * (contact->cell_width + GAP), GAP + 2 * LINE, headings[column]);
	for (uint32_t row = 0; row < contact->rows; row++) {
		uint32_t y = GAP + 3 * LINE + row * (contact->cell_height + LINE + GAP);
		for (uint32_t column = 0; column < COLUMNS; column++)
			put_cell(sheet, contact, row, column, GAP + column * (contact->cell_width + GAP), y,
					 column == 3 ? factor : 1);
		put_text(sheet, GAP, y + contact->cell_height + LETTER_SCALE * 2, contact->labels[row]);
	}
}

int contact_write(const struct contact *contact, const char *title, const char *path, struct error *error)
{
	struct sheet sheet = {
		.width = GAP + COLUMNS * (contact->cell_width + GAP),
		.height = GAP + 3 * LINE + contact->rows * (contact->cell_height + LINE + GAP),
	};
	size_t bytes = 4 * (size_t)sheet.width * sheet.height;
	sheet.data = malloc(bytes);
	if (!sheet.data)
		return error_set(error, -ENOMEM, "out of memory for the contact sheet");
	for (size_t i = 0; i < bytes; i++)
		sheet.data[i] = i % 4 == 3 ? 255 : 32;
	draw(&sheet, contact, title);
	int result = image_write_png_small(path, sheet.data, sheet.width, sheet.height, false, error);
	free(sheet.data);
	return result;
}
