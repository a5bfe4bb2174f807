/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "cases.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

void cases_of_sizes(cases_check *check)
{
	static const uint32_t sizes[][2] = {{1, 1},  {1, 7},   {7, 1},    {2, 2},     {7, 5},  {8, 8},   {9, 9},
										{16, 8}, {17, 25}, {333, 77}, {16384, 2}, {2, 99}, {64, 64}, {129, 65}};
	static const uint32_t formats[] = {PURSUIT_FORMAT_RG32F, PURSUIT_FORMAT_RG16F};
	const struct plan_params params = {.last_phase = 0.5f};
	for (uint32_t i = 0; i < COUNT(sizes); i++)
		for (int field = 0; field < FIELD_COUNT; field++)
			for (uint32_t f = 0; f < COUNT(formats); f++) {
				const struct fixture_spec spec = {sizes[i][0], sizes[i][1], .motion_format = formats[f],
												  .depth_format = PURSUIT_FORMAT_DEPTH32F};
				check(&spec, &params, (enum fixture_field)field, 1 + i + f);
			}
}

void cases_of_cells(cases_check *check)
{
	static const uint32_t cells[] = {4, 5, 8, 13, 16, 31, 32, 63, 64};
	const struct fixture_spec spec = {203, 131, .motion_format = PURSUIT_FORMAT_RG16F,
									  .depth_format = PURSUIT_FORMAT_DEPTH24};
	for (size_t i = 0; i < COUNT(cells); i++)
		for (uint32_t threshold = 0; threshold <= 63; threshold += 21)
			for (int field = FIELD_SMOOTH; field <= FIELD_SPARSE; field++) {
				const struct plan_params params = {
					.cell = cells[i], .threshold_quarter = threshold, .last_phase = 2.0f / 3};
				check(&spec, &params, (enum fixture_field)field, 50 + threshold);
			}
}

void cases_of_depths(cases_check *check)
{
	static const uint32_t formats[] = {0, PURSUIT_FORMAT_DEPTH16, PURSUIT_FORMAT_DEPTH24, PURSUIT_FORMAT_DEPTH32F};
	static const struct {
		uint32_t kind;
		float near_distance, far_distance;
	} kinds[] = {{PURSUIT_DEPTH_DEVICE, 0, 0},           {PURSUIT_DEPTH_DEVICE_REVERSED, 0, 0},
				 {PURSUIT_DEPTH_LINEAR, 0.125f, 0.875f}, {PURSUIT_DEPTH_LINEAR, 0.125f, INFINITY},
				 {PURSUIT_DEPTH_LINEAR, 0, 0},           {PURSUIT_DEPTH_LINEAR, 0.5f, 0}};
	const struct plan_params params = {.last_phase = 0.5f};
	for (size_t f = 0; f < COUNT(formats); f++)
		for (size_t k = 0; k < COUNT(kinds); k++)
			for (int field = FIELD_LAYERS; field <= FIELD_BITS; field++) {
				const struct fixture_spec spec = {93,
												  61,
												  .motion_format = PURSUIT_FORMAT_RG32F,
												  .depth_format = formats[f],
												  .depth_kind = kinds[k].kind,
												  .near_distance = kinds[k].near_distance,
												  .far_distance = kinds[k].far_distance};
				check(&spec, &params, (enum fixture_field)field, 9);
			}
}

void cases_of_planes(cases_check *check)
{
	static const uint32_t others[][4] = {{160, 90, 80, 45},  {161, 91, 80, 45}, {80, 45, 160, 90},
										 {100, 60, 100, 30}, {100, 60, 50, 60}, {97, 61, 1, 1},
										 {97, 61, 31, 97},   {1, 1, 64, 64},    {640, 8, 639, 9}};
	const struct plan_params params = {.last_phase = 0.5f};
	for (size_t i = 0; i < COUNT(others); i++)
		for (int field = FIELD_CONSTANT; field <= FIELD_BITS; field++)
			for (int apart = 0; apart < 2; apart++) {
				const uint32_t *o = others[i];
				const struct fixture_spec spec = {
					o[0], o[1], PURSUIT_FORMAT_RG16F, o[2], o[3], PURSUIT_FORMAT_DEPTH16, apart ? o[0] : o[2], o[3]};
				check(&spec, &params, (enum fixture_field)field, 77);
			}
}
