/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "hud_layout.h"

#include <stdio.h>

#include "maths.h"

static void panel(struct overlay *ui, double x, double y, double width, double height, uint32_t edge)
{
	overlay_rectangle(ui, x, y, width, height, 0x0c1420, 0.58);
	overlay_frame(ui, x, y, width, height, ui->unit, edge, 0.85);
}

static void bar(struct overlay *ui, double x, double y, double width, const char *name, double part, uint32_t color)
{
	double u = ui->unit;
	overlay_text(ui, x, y, 1.0, 0xe0e8f0, name);
	overlay_rectangle(ui, x + 20 * u, y, width, 7 * u, 0x000000, 0.6);
	overlay_rectangle(ui, x + 21 * u, y + u, (width - 2 * u) * part, 5 * u, color, 0.95);
	overlay_rectangle(ui, x + 21 * u, y + u, (width - 2 * u) * part, 2 * u, 0xffffff, 0.35);
}

static void status(struct overlay *ui, double time)
{
	double u = ui->unit, x = 4 * u, y = 4 * u;
	panel(ui, x, y, 112 * u, 42 * u, 0x50c8f0);
	bar(ui, x + 5 * u, y + 6 * u, 82 * u, "HP", 0.68 + 0.22 * scene_wave(time, 7.0, 0.0), 0xe84840);
	bar(ui, x + 5 * u, y + 17 * u, 82 * u, "EN", 0.55 + 0.35 * scene_wave(time, 4.0, 0.3), 0x40a0f0);
	bar(ui, x + 5 * u, y + 28 * u, 82 * u, "XP", scene_phase(time, 60.0), 0xf0c040);
}

static void radar(struct overlay *ui, double time)
{
	double u = ui->unit, size = 62 * u, x = ui->width - size - 4 * u, y = 4 * u, cx = x + size / 2, cy = y + size / 2;
	panel(ui, x, y, size, size, 0x50f0a0);
	for (int i = 1; i < 4; i++) {
		overlay_rectangle(ui, x + size * i / 4, y + u, u, size - 2 * u, 0x50f0a0, 0.3);
		overlay_rectangle(ui, x + u, y + size * i / 4, size - 2 * u, u, 0x50f0a0, 0.3);
	}
	double sweep = 2.0 * SCENE_PI * scene_phase(time, 2.0), reach = size * 0.46;
	overlay_line(ui, cx, cy, cx + reach * cos(sweep), cy + reach * sin(sweep), 2 * u, 0x80ffc0, 0.9);
	for (uint32_t i = 0; i < 9; i++) {
		double a = 6.283 * (scene_random(i, 1) + scene_phase(time, 20.0 + i)),
			   r = reach * (0.2 + 0.75 * scene_random(i, 2));
		overlay_rectangle(ui, cx + r * cos(a) - u, cy + r * sin(a) - u, 3 * u, 3 * u, i % 3 ? 0xf0e060 : 0xf05848,
						  0.95);
	}
}

static void compass(struct overlay *ui, double time)
{
	static const char *const names[8] = {"N", "NE", "E", "SE", "S", "SW", "W", "NW"};
	double u = ui->unit, width = fmin(130 * u, ui->width * 0.36), x = floor((ui->width - width) / 2), y = 4 * u;
	double heading = 20.0 * scene_wave(time, 9.0, 0.22) + 40.0;
	overlay_rectangle(ui, x, y, width, 16 * u, 0x0c1420, 0.5);
	for (int mark = -18; mark <= 36; mark++) {
		double at = x + width / 2 + (mark * 15.0 - heading) * width / 180.0;
		if (at < x + 2 * u || at > x + width - 8 * u)
			continue;
		overlay_rectangle(ui, at, y + (mark % 3 ? 12 : 10) * u, u, (mark % 3 ? 3 : 5) * u, 0xffffff, 0.9);
		if (mark % 3 == 0)
			overlay_text(ui, at - 2 * u, y + 2 * u, 1.0, 0xffffff, names[((mark / 3) % 8 + 8) % 8]);
	}
	overlay_rectangle(ui, x + width / 2 - u, y + 14 * u, 3 * u, 4 * u, 0xf0c040, 1.0);
}

static void chat(struct overlay *ui, double time)
{
	static const char *const lines[10] = {
		"KESTREL: TWO BEHIND YOU",    "TOWER: LANE 4 IS CLEAR",  "MARLA: THANKS FOR THE RIDE", "NEWS: RAIN AFTER NINE",
		"OTIS: RACE YOU TO THE PIER", "TOWER: KEEP BELOW 60",    "KESTREL: NICE TURN!",        "SYSTEM: FUEL AT 55%",
		"MARLA: SEE THE SUNSET?",     "OTIS: LEFT AT THE BRICKS"};
	double u = ui->unit, width = 172 * u, height = 66 * u, x = 4 * u, y = ui->height - height - 4 * u;
	uint32_t first = (uint32_t)fmod(floor(fabs(time) / 1.6), 1e6);
	panel(ui, x, y, width, height, 0x8090c0);
	for (uint32_t i = 0; i < 6; i++) {
		uint32_t line = (first + i) % 10;
		overlay_text(ui, x + 5 * u, y + (5 + 10 * i) * u, 1.0,
					 i == 5     ? 0xffffff
					 : line % 3 ? 0xb8c8e0
								: 0xf0d890,
					 lines[line]);
	}
}

static void hotbar(struct overlay *ui, double time)
{
	static const uint32_t colors[6] = {0xe05848, 0x48a0e0, 0x60c860, 0xe0b040, 0xb070e0, 0x50c8c8};
	double u = ui->unit, size = 19 * u, x = ui->width - 6 * (size + 2 * u) - 4 * u, y = ui->height - size - 4 * u;
	char text[8];
	for (int i = 0; i < 6; i++, x += size + 2 * u) {
		double wait = scene_phase(time + 1.3 * i, 3.0 + i);
		panel(ui, x, y, size, size, i == 1 ? 0xffffff : 0x8898b0);
		overlay_rectangle(ui, x + 4 * u, y + 4 * u, size - 8 * u, size - 8 * u, colors[i], 0.9);
		overlay_rectangle(ui, x + 7 * u, y + 7 * u, size - 14 * u, size - 14 * u, 0xffffff, 0.5);
		overlay_rectangle(ui, x + u, y + u, size - 2 * u, (size - 2 * u) * (1.0 - wait), 0x000000, 0.45);
		snprintf(text, sizeof(text), "%d", i + 1);
		overlay_text(ui, x + 2 * u, y + 2 * u, 1.0, 0xffffff, text);
	}
}

static void figures(struct overlay *ui, double time)
{
	double u = ui->unit, width = 84 * u, height = 64 * u, x = ui->width - width - 4 * u,
		   y = ui->height - height - 28 * u;
	char text[32];
	panel(ui, x, y, width, height, 0xf0a050);
	const struct {
		const char *name;
		double value;
	} rows[3] = {{"SPEED", 140.0 + 9.0 * scene_wave(time, 3.0, 0.0)},
				 {"ALT", 65.0 + 16.0 * scene_wave(time, 7.0, 0.1)},
				 {"DIST", fmod(fabs(time) * 14.0, 100000.0)}};
	for (int i = 0; i < 3; i++) {
		snprintf(text, sizeof(text), "%-6s%6.1f", rows[i].name, rows[i].value);
		overlay_text(ui, x + 5 * u, y + (5 + 10 * i) * u, 1.0, 0xf8e8d0, text);
	}
	for (int i = 0; i < 24; i++) {
		double h =
			(8.0 + 6.0 * scene_wave(time + i * 0.13, 1.7, 0.0) + 4.0 * scene_wave(time + i * 0.13, 0.73, 0.2)) * u;
		overlay_rectangle(ui, x + (5 + 3 * i) * u, y + 59 * u - fmax(h, u), 2 * u, fmax(h, u),
						  h > 13 * u ? 0xf06050 : 0x70d0a0, 0.9);
	}
}

static void reticle(struct overlay *ui, double time)
{
	double u = ui->unit, cx = floor(ui->width / 2), cy = floor(ui->height / 2),
		   gap = (7 + 2 * scene_wave(time, 1.5, 0)) * u;
	for (int s = -1; s <= 1; s += 2) {
		overlay_rectangle(ui, s < 0 ? cx - gap - 9 * u : cx + gap, cy, 10 * u, u, 0x80ffd0, 0.9);
		overlay_rectangle(ui, cx, s < 0 ? cy - gap - 9 * u : cy + gap, u, 10 * u, 0x80ffd0, 0.9);
	}
	overlay_rectangle(ui, cx, cy, u, u, 0xff5040, 1.0);
}

void hud_layout(struct overlay *ui, double time)
{
	double stepped = floor(time * 15.0) / 15.0;
	status(ui, stepped);
	radar(ui, stepped);
	compass(ui, stepped);
	chat(ui, stepped);
	hotbar(ui, stepped);
	figures(ui, stepped);
	reticle(ui, stepped);
}
