/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include <errno.h>

#include "daemon/frame.h"
#include "tests/record/sample.h"
#include "tests/test.h"

static struct pursuit_frame_header good;
static uint64_t good_bytes;

/* One way to spoil a header, and the field that the refusal must name. */
struct spoiled {
	const char *field;
	uint64_t value;
	void (*spoil)(struct pursuit_frame_header *header);
};

#define SPOIL(name, statement)                       \
	static void name(struct pursuit_frame_header *h) \
	{                                                \
		statement;                                   \
	}

#define HUGE_ALIGNED (UINT64_MAX / 64 * 64)

SPOIL(id_zero, h->frame_id = 0)
SPOIL(flags_unknown, h->flags |= 1u << 31)
SPOIL(no_planes, h->plane_count = 0)
SPOIL(nine_planes, h->plane_count = 9)
SPOIL(all_planes, h->plane_count = UINT32_MAX)
SPOIL(role_zero, h->planes[1].role = 0)
SPOIL(role_twice, h->planes[2] = h->planes[1])
SPOIL(no_color, h->planes[0].role = 99)
SPOIL(color_format_zero, h->planes[0].format = 0)
SPOIL(color_format_depth, h->planes[0].format = PURSUIT_FORMAT_DEPTH32F)
SPOIL(color_format_5, h->planes[0].format = 5)
SPOIL(depth_format, h->planes[1].format = PURSUIT_FORMAT_RG16F)
SPOIL(depth_format_19, h->planes[1].format = 19)
SPOIL(motion_format, h->planes[2].format = PURSUIT_FORMAT_BGRA8)
SPOIL(ui_format, h->planes[3].format = PURSUIT_FORMAT_RGBA16F)
SPOIL(id_format, h->planes[4].format = PURSUIT_FORMAT_RG32F)
SPOIL(storage_zero, h->planes[0].storage = 0)
SPOIL(storage_two, h->planes[4].storage = 2)
SPOIL(width_zero, h->planes[1].width = 0)
SPOIL(width_large, h->planes[1].width = PURSUIT_MAX_SIZE + 1)
SPOIL(height_zero, h->planes[2].height = 0)
SPOIL(height_all, h->planes[2].height = UINT32_MAX)
SPOIL(plane_reserved0, h->planes[0].reserved0 = 1)
SPOIL(plane_reserved1, h->planes[3].reserved1 = (uint64_t)1 << 40)
SPOIL(offset_odd, h->planes[1].offset += 4)
SPOIL(offset_beyond, h->planes[1].offset = (good_bytes / 64 + 1) * 64)
SPOIL(offset_huge, h->planes[1].offset = HUGE_ALIGNED)
SPOIL(stride_small, h->planes[0].stride = 4 * h->planes[0].width - 4)
SPOIL(stride_odd, h->planes[0].stride += 1)
SPOIL(stride_zero, h->planes[1].stride = 0)
SPOIL(stride_overflow, h->planes[0].stride = UINT64_MAX / 4 * 4)
SPOIL(stride_overflow_sum, h->planes[0].stride = UINT64_MAX / 5 / 4 * 4)
SPOIL(size_small, h->planes[0].size -= 1)
SPOIL(size_zero, h->planes[4].size = 0)
SPOIL(size_past_end, h->planes[4].size = good_bytes - h->planes[4].offset + 1)
SPOIL(size_huge, h->planes[4].size = UINT64_MAX - h->planes[4].offset + 1)
SPOIL(curve_zero, h->planes[0].transfer.curve = 0)
SPOIL(curve_four, h->planes[0].transfer.curve = 4)
SPOIL(curve_on_depth, h->planes[1].transfer.curve = PURSUIT_CURVE_SRGB)
SPOIL(gamma_on_srgb, h->planes[0].transfer.gamma = 2.0f)
SPOIL(gamma_nan, (h->planes[0].transfer.curve = PURSUIT_CURVE_GAMMA, h->planes[0].transfer.gamma = NAN))
SPOIL(gamma_small, (h->planes[0].transfer.curve = PURSUIT_CURVE_GAMMA, h->planes[0].transfer.gamma = 0.5f))
SPOIL(gamma_large, (h->planes[3].transfer.curve = PURSUIT_CURVE_GAMMA, h->planes[3].transfer.gamma = 5.5f))
SPOIL(black_infinite, h->planes[0].transfer.black = -INFINITY)
SPOIL(peak_nan, h->planes[0].transfer.peak = NAN)
SPOIL(peak_below_black, (h->planes[0].transfer.black = 0.5f, h->planes[0].transfer.peak = 0.25f))
SPOIL(ui_width, h->planes[3].width -= 1)
SPOIL(ui_height, h->planes[3].height -= 1)
SPOIL(motion_kind_three, h->motion_kind = 3)
SPOIL(motion_kind_none, h->motion_kind = PURSUIT_MOTION_NONE)
SPOIL(depth_kind_four, h->depth_kind = 4)
SPOIL(depth_kind_none, h->depth_kind = PURSUIT_DEPTH_NONE)
SPOIL(near_negative, h->near_distance = -1.0f)
SPOIL(near_nan, h->near_distance = NAN)
SPOIL(near_infinite, (h->near_distance = INFINITY, h->far_distance = INFINITY))
SPOIL(far_below_near, h->far_distance = 0.05f)
SPOIL(far_negative, (h->near_distance = 0.0f, h->far_distance = -1.0f))
SPOIL(far_nan, h->far_distance = NAN)
SPOIL(damage_without_flag, h->damage_since = 1)
SPOIL(damage_count_without_flag, h->damage_count = 2)
SPOIL(damage_rest, h->damage[7].x = 1)
SPOIL(damage_since_itself, h->flags |= PURSUIT_FRAME_DAMAGE; h->damage_since = h->frame_id)
SPOIL(damage_since_none, h->flags |= PURSUIT_FRAME_DAMAGE)
SPOIL(reserved0, h->reserved0 = 7)
SPOIL(reserved_first, h->reserved[0] = 3)
SPOIL(reserved_last, h->reserved[sizeof(h->reserved) - 1] = 4)

#define ANY UINT64_C(0xabcdef)

static const struct spoiled spoiled[] = {
	{"frame_id", 0, id_zero},
	{"flags", ANY, flags_unknown},
	{"plane_count", 0, no_planes},
	{"plane_count", 9, nine_planes},
	{"plane_count", UINT32_MAX, all_planes},
	{"planes[1].role", 0, role_zero},
	{"planes[2].role", 2, role_twice},
	{"planes[0].role", 99, no_color},
	{"planes[0].format", 0, color_format_zero},
	{"planes[0].format", 18, color_format_depth},
	{"planes[0].format", 5, color_format_5},
	{"planes[1].format", 32, depth_format},
	{"planes[1].format", 19, depth_format_19},
	{"planes[2].format", 1, motion_format},
	{"planes[3].format", 4, ui_format},
	{"planes[4].format", 33, id_format},
	{"planes[0].storage", 0, storage_zero},
	{"planes[4].storage", 2, storage_two},
	{"planes[1].width", 0, width_zero},
	{"planes[1].width", 16385, width_large},
	{"planes[2].height", 0, height_zero},
	{"planes[2].height", UINT32_MAX, height_all},
	{"planes[0].reserved0", 1, plane_reserved0},
	{"planes[3].reserved1", (uint64_t)1 << 40, plane_reserved1},
	{"planes[1].offset", ANY, offset_odd},
	{"planes[1].offset", ANY, offset_beyond},
	{"planes[1].offset", HUGE_ALIGNED, offset_huge},
	{"planes[0].stride", 24, stride_small},
	{"planes[0].stride", 41, stride_odd},
	{"planes[1].stride", 0, stride_zero},
	{"planes[0].stride", ANY, stride_overflow},
	{"planes[0].size", ANY, stride_overflow_sum},
	{"planes[0].size", ANY, size_small},
	{"planes[4].size", 0, size_zero},
	{"planes[4].size", ANY, size_past_end},
	{"planes[4].size", ANY, size_huge},
	{"planes[0].transfer.curve", 0, curve_zero},
	{"planes[0].transfer.curve", 4, curve_four},
	{"planes[1].transfer.curve", 1, curve_on_depth},
	{"planes[0].transfer.gamma", 0x40000000, gamma_on_srgb},
	{"planes[0].transfer.gamma", ANY, gamma_nan},
	{"planes[0].transfer.gamma", ANY, gamma_small},
	{"planes[3].transfer.gamma", ANY, gamma_large},
	{"planes[0].transfer.black", ANY, black_infinite},
	{"planes[0].transfer.peak", ANY, peak_nan},
	{"planes[0].transfer.peak", ANY, peak_below_black},
	{"planes[3].width", 6, ui_width},
	{"planes[3].height", 4, ui_height},
	{"motion_kind", 3, motion_kind_three},
	{"motion_kind", 0, motion_kind_none},
	{"depth_kind", 4, depth_kind_four},
	{"depth_kind", 0, depth_kind_none},
	{"near_distance", ANY, near_negative},
	{"near_distance", ANY, near_nan},
	{"near_distance", ANY, near_infinite},
	{"far_distance", ANY, far_below_near},
	{"far_distance", ANY, far_negative},
	{"far_distance", ANY, far_nan},
	{"damage_since", 1, damage_without_flag},
	{"damage_count", 2, damage_count_without_flag},
	{"damage", 0, damage_rest},
	{"damage_since", ANY, damage_since_itself},
	{"damage_since", 0, damage_since_none},
	{"reserved0", 7, reserved0},
	{"reserved", 3, reserved_first},
	{"reserved", 4, reserved_last},
};

static int validate(struct pursuit_frame_header *header, struct error *error)
{
	return frame_validate(header, good_bytes, NULL, NULL, error);
}

static void test_good_header(void)
{
	struct pursuit_frame_header header = good;
	struct error error = {""};
	CHECK_INT(validate(&header, &error), 0);
	CHECK(memcmp(&header, &good, sizeof(good)) == 0);
	CHECK_INT(frame_validate(&header, 0, NULL, NULL, &error), -EINVAL);
}

static void test_each_refusal(void)
{
	for (size_t i = 0; i < sizeof(spoiled) / sizeof(spoiled[0]); i++) {
		struct pursuit_frame_header header = good;
		struct error error = {""};
		const char *field = NULL;
		uint64_t value = 0;
		spoiled[i].spoil(&header);
		CHECK_INT(frame_validate(&header, good_bytes, &field, &value, &error), -EINVAL);
		CHECK_STRING(field, spoiled[i].field);
		if (spoiled[i].value != ANY)
			CHECK(value == spoiled[i].value);
		CHECK(strstr(error.text, spoiled[i].field) && strstr(error.text, " must be "));
		CHECK(strncmp(error.text, "frame ", 6) == 0);
		CHECK_INT(validate(&header, &error), -EINVAL);
	}
}

static void test_good_variants(void)
{
	struct pursuit_frame_header header = good;
	struct error error = {""};
	header.far_distance = INFINITY;
	CHECK_INT(validate(&header, &error), 0);
	header.near_distance = header.far_distance = 0.0f;
	CHECK_INT(validate(&header, &error), 0);
	header.planes[0].transfer = (struct pursuit_transfer){PURSUIT_CURVE_GAMMA, 5.0f, 0.01f, 2.0f};
	header.planes[3].transfer = (struct pursuit_transfer){PURSUIT_CURVE_LINEAR, 0.0f, 0.0f, 0.0f};
	CHECK_INT(validate(&header, &error), 0);
	header.planes[0].width = header.planes[0].height = header.planes[3].width = header.planes[3].height = 1;
	CHECK_INT(validate(&header, &error), 0);
	header.flags |= PURSUIT_FRAME_CUT | PURSUIT_FRAME_MOTION_INVALID | PURSUIT_FRAME_TRUTH_ONLY;
	CHECK_INT(validate(&header, &error), 0);
}

/* A later role, in a format of its own, is carried as bytes; it must still lie within the planes. */
static void test_unknown_role(void)
{
	struct pursuit_frame_header header = good;
	struct error error = {""};
	header.planes[5] = (struct pursuit_plane){
		.role = 1000, .format = 1000, .storage = 1, .width = 9, .height = 9, .offset = 64, .stride = 3, .size = 24};
	header.plane_count = 6;
	CHECK_INT(validate(&header, &error), 0);
	header.planes[6] = header.planes[5];
	header.plane_count = 7;
	CHECK_INT(validate(&header, &error), 0);
	header.planes[6].size = 23;
	CHECK_INT(validate(&header, &error), -EINVAL);
	header.planes[6].size = good_bytes - 63;
	CHECK_INT(validate(&header, &error), -EINVAL);
	header.planes[6].size = 24;
	header.planes[6].stride = UINT64_MAX;
	CHECK_INT(validate(&header, &error), -EINVAL);
}

/* Planes on top of each other would make a small slot into a large copy. */
static void test_sum_of_planes(void)
{
	struct pursuit_frame_header header = good;
	struct error error = {""};
	const char *field;
	uint64_t value;
	header.planes[0].size = header.planes[1].size = PURSUIT_MAX_FRAME_BYTES / 2 + 64;
	header.planes[0].offset = header.planes[1].offset = 0;
	CHECK_INT(frame_validate(&header, UINT64_MAX, &field, &value, &error), -EINVAL);
	CHECK_STRING(field, "planes[1].size");
}

static void test_mended(void)
{
	struct pursuit_frame_header header = good;
	struct error error = {""};
	const float zeros[16] = {0};
	header.view_projection[7] = NAN;
	header.jitter_y = -1e9f;
	header.time_ns = UINT64_MAX;
	header.real_interval_ns = (uint64_t)-33333333;
	header.motion_interval_ns = (uint64_t)-1;
	header.planes[5].role = 12345;
	CHECK_INT(validate(&header, &error), 0);
	CHECK(memcmp(header.view_projection, zeros, sizeof(zeros)) == 0);
	CHECK_INT(header.flags & (PURSUIT_FRAME_JITTER | PURSUIT_FRAME_MATRICES), 0);
	CHECK(header.jitter_x == 0.0f && header.jitter_y == 0.0f);
	CHECK_INT(header.time_ns, 0);
	CHECK_INT(header.submit_ns, good.submit_ns);
	CHECK_INT(header.real_interval_ns, 0);
	CHECK_INT(header.motion_interval_ns, 0);
	CHECK_INT(header.planes[5].role, 0);

	header = good;
	header.jitter_x = NAN;
	header.previous_view_projection[0] = INFINITY;
	CHECK_INT(validate(&header, &error), 0);
	CHECK(header.jitter_x == 0.0f && header.previous_view_projection[0] == 0.0f);

	/* Kinds of planes that are not there. */
	header = good;
	header.plane_count = 1;
	CHECK_INT(validate(&header, &error), 0);
	CHECK_INT(header.motion_kind, PURSUIT_MOTION_NONE);
	CHECK_INT(header.depth_kind, PURSUIT_DEPTH_NONE);
}

static void test_find_plane(void)
{
	struct pursuit_frame_header header = good;
	CHECK_INT(frame_find_plane(&header, PURSUIT_ROLE_MOTION), 2);
	CHECK_INT(frame_find_plane(&header, 99), -1);
	header.plane_count = 2;
	CHECK_INT(frame_find_plane(&header, PURSUIT_ROLE_MOTION), -1);
	header.plane_count = UINT32_MAX;
	CHECK_INT(frame_find_plane(&header, 99), -1);
}

static void test_layout(void)
{
	struct pursuit_frame_header header = good;
	struct error error = {""};
	const uint64_t bytes = frame_layout(&header);
	CHECK_INT(bytes, 5 * 64 * 5);
	CHECK_INT(header.planes[0].stride, 64);
	CHECK_INT(header.planes[1].offset, 5 * 64);
	CHECK_INT(header.planes[4].offset, 20 * 64);
	CHECK_INT(frame_validate(&header, bytes, NULL, NULL, &error), 0);
	CHECK_INT(frame_validate(&header, bytes - 1, NULL, NULL, &error), -EINVAL);
	header.planes[0].width = PURSUIT_MAX_SIZE + 1;
	CHECK_INT(frame_layout(&header), 0);
	header = good;
	header.plane_count = 9;
	CHECK_INT(frame_layout(&header), 0);
	header = good;
	header.planes[0].size = UINT64_MAX; /* not yet set by anyone */
	CHECK_INT(frame_layout(&header), bytes);
}

/* Random bytes over a good header: refused or in bounds, never anything else. */
static void test_random_headers(void)
{
	uint32_t state = 12345;
	unsigned accepted = 0;
	for (int round = 0; round < 200000; round++) {
		struct pursuit_frame_header header = good;
		struct error error;
		for (int i = 0; i < 2; i++) {
			state = state * 1664525u + 1013904223u;
			uint8_t *bytes = (uint8_t *)&header;
			bytes[(state >> 8) % 600] ^= (uint8_t)(1u << (state >> 29));
		}
		if (validate(&header, &error) < 0)
			continue;
		accepted++;
		for (uint32_t p = 0; p < header.plane_count; p++) {
			const struct pursuit_plane *plane = &header.planes[p];
			const __uint128_t end = (__uint128_t)plane->offset + (__uint128_t)plane->stride * (plane->height - 1) +
									(__uint128_t)plane->width * pursuit_format_bytes(plane->format);
			CHECK(end <= good_bytes);
		}
	}
	CHECK(accepted > 1000);
}

int main(void)
{
	struct sample sample;
	sample_init(&sample, 12, 7, 5);
	good = sample.frame.header;
	good_bytes = sample.bytes;
	sample_finish(&sample);
	RUN(test_good_header);
	RUN(test_each_refusal);
	RUN(test_good_variants);
	RUN(test_unknown_role);
	RUN(test_sum_of_planes);
	RUN(test_mended);
	RUN(test_find_plane);
	RUN(test_layout);
	RUN(test_random_headers);
	return test_result();
}
