/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * Pictures that engine_render() does not wait for: to the bit what it gives when it waits, whatever comes before they
 * are taken; nothing waits that need not; nothing is written once nobody wants them; and what a lost context means. The
 * argument is the context: cpu, surfaceless, gles, osmesa; GL on the CPU reads back by way of buffers here.
 */
#include "tests/test.h"

#include <errno.h>
#include <pthread.h>
#include <unistd.h>

#include "daemon/engine/gl/executor_gl.h"
#include "tests/engine/picture.h"

#define PATTERN 0x5a

static struct engine_params params;

static bool in_gl(void)
{
	return params.context != ENGINE_CONTEXT_CPU;
}

static struct engine *make_with(bool buffered)
{
	struct engine_params own = params;
	struct error error;
	own.buffer_software = buffered;
	struct engine *engine = engine_create(&own, &error);
	if (!engine)
		SKIP(error.text);
	return engine;
}

static struct engine *make(void)
{
	return make_with(true);
}

static void begin(struct engine *engine, const struct picture *picture)
{
	struct error error = {""};
	const struct engine_begin_params how = {.n = 3, .last_phase = -1.0};
	CHECK_INT(engine_begin(engine, &picture->frame, &how, &error), 0);
	CHECK_STRING(error.text, "");
}

static void draw(struct picture *picture, uint32_t width, uint32_t height, double t)
{
	picture_init(picture, width, height, PURSUIT_FORMAT_BGRA8, PICTURE_MOTION | PICTURE_DEPTH | PICTURE_UI);
	picture_draw_layers(picture, t);
	for (uint32_t y = 10; y < 30 && y < height; y++)
		memset(picture_row(picture, PURSUIT_ROLE_UI, y), 0x40 + (int)y, 4 * (size_t)width / 2);
}

/* ---- any order ---- */

#define MEMORIES 5u
#define MOST_BYTES ((size_t)4 * 760 * 420)

struct memory {
	struct engine_image image;
	uint8_t *expected;
	uint32_t height;
	bool lent; /* to the engine */
};

struct sequence {
	uint32_t random, seed;
	struct engine *engine, *plain; /* the second waits for each picture, and has no buffers */
	struct picture picture;
	struct memory memories[MEMORIES];
	uint32_t lent[ENGINE_MAX_UNFINISHED], lent_count; /* memories, the oldest first */
	uint32_t taken, begun_between;
	uint64_t frame_id, kept;
};

static uint32_t pick(struct sequence *sequence, uint32_t count)
{
	return picture_random(&sequence->random) % count;
}

static bool is_same(const struct memory *memory)
{
	return memcmp(memory->image.data, memory->expected, memory->image.stride * memory->height) == 0;
}

static void check(const struct sequence *sequence, const struct memory *memory)
{
	const bool same = is_same(memory);
	CHECK(same);
	if (!same)
		fprintf(stderr, "seed %u: picture %u is another\n", sequence->seed, sequence->taken);
}

static void change_frame(struct sequence *sequence)
{
	static const uint32_t sizes[][2] = {{64, 48}, {131, 170}, {1, 1}, {700, 400}, {300, 200}};
	const uint32_t *size = sizes[pick(sequence, 5)];
	struct error error;
	if (pick(sequence, 4) == 0 || !sequence->picture.width) {
		picture_finish(&sequence->picture);
		draw(&sequence->picture, size[0], size[1], 0.3 * pick(sequence, 5));
	} else if (pick(sequence, 4)) {
		picture_draw_discs(&sequence->picture, 0.3 * pick(sequence, 5));
	}
	if (pick(sequence, 4) == 0) {
		static const char *const methods[] = {"pursuit", "grid", "hold", "blur-hold"};
		struct engine_params other = params;
		other.method = methods[pick(sequence, 4)];
		CHECK_INT(engine_set_params(sequence->engine, &other, &error), 0);
		CHECK_INT(engine_set_params(sequence->plain, &other, &error), 0);
	}
	/* The second has never seen the stream: it keeps nothing. */
	sequence->kept += engine_get_report(sequence->engine)->bytes_kept;
	sequence->picture.frame.stream = 7;
	sequence->picture.frame.header.frame_id = ++sequence->frame_id;
	begin(sequence->engine, &sequence->picture);
	sequence->picture.frame.stream = 0;
	begin(sequence->plain, &sequence->picture);
	sequence->begun_between += sequence->lent_count > 0;
}

/* A memory that the engine does not have, made ready for another picture; its padding tells who writes there. */
static struct memory *prepare(struct sequence *sequence)
{
	struct memory *memory = &sequence->memories[pick(sequence, MEMORIES)];
	while (memory->lent)
		memory = &sequence->memories[pick(sequence, MEMORIES)];
	const size_t stride = 4 * (size_t)sequence->picture.width + 4 * pick(sequence, 4);
	if (memory->image.stride != stride || memory->height != sequence->picture.height || pick(sequence, 3) == 0) {
		memory->image.stride = stride;
		memory->image.holds = 0;
		memory->height = sequence->picture.height;
		memset(memory->image.data, PATTERN, MOST_BYTES);
		memset(memory->expected, PATTERN, MOST_BYTES);
	}
	return memory;
}

static void render(struct sequence *sequence, bool ahead)
{
	struct error error = {""};
	struct memory *memory = prepare(sequence);
	const struct engine_request request = {(enum engine_show)pick(sequence, 3), 0.25 * pick(sequence, 5)};
	struct engine_image expected = {.data = memory->expected, .stride = memory->image.stride};
	memory->image.unfinished = ahead;
	CHECK_INT(engine_render(sequence->plain, &request, &expected, &error), 0);
	CHECK_INT(engine_render(sequence->engine, &request, &memory->image, &error), 0);
	CHECK_STRING(error.text, "");
	memory->lent = ahead;
	if (ahead)
		sequence->lent[sequence->lent_count++] = (uint32_t)(memory - sequence->memories);
	else
		check(sequence, memory);
	CHECK(!ahead || memory->image.holds == 0);
}

static void take(struct sequence *sequence)
{
	struct engine_image image;
	struct error error = {""};
	struct memory *memory = &sequence->memories[sequence->lent[0]];
	CHECK_INT(engine_take(sequence->engine, &image, &error), 0);
	CHECK(image.data == memory->image.data && image.stride == memory->image.stride && image.unfinished);
	memory->image.holds = image.holds;
	memory->lent = false;
	sequence->lent[0] = sequence->lent[1];
	sequence->lent_count--;
	sequence->taken++;
	check(sequence, memory);
}

static void drop(struct sequence *sequence)
{
	engine_drop(sequence->engine);
	for (uint32_t i = 0; i < MEMORIES; i++) {
		sequence->memories[i].image.holds = sequence->memories[i].lent ? 0 : sequence->memories[i].image.holds;
		sequence->memories[i].height = sequence->memories[i].lent ? 0 : sequence->memories[i].height;
		sequence->memories[i].lent = false;
	}
	sequence->lent_count = 0;
}

static void finish(struct sequence *sequence)
{
	struct error error;
	CHECK_INT(engine_finish(sequence->engine, &error), 0);
	for (uint32_t i = 0; i < sequence->lent_count; i++)
		check(sequence, &sequence->memories[sequence->lent[i]]);
}

static void step(struct sequence *sequence)
{
	const uint32_t what = pick(sequence, 40);
	if (what < 8)
		change_frame(sequence);
	else if (what < 22 && sequence->lent_count < ENGINE_MAX_UNFINISHED)
		render(sequence, true);
	else if (what < 27)
		render(sequence, false);
	else if (what < 37 && sequence->lent_count > 0)
		take(sequence);
	else if (what == 37)
		drop(sequence);
	else if (what == 38)
		finish(sequence);
	else
		engine_leave(sequence->engine);
}

static uint64_t run_seed(uint32_t seed)
{
	struct sequence sequence = {.random = seed, .seed = seed, .engine = make(), .plain = make_with(false)};
	for (uint32_t i = 0; i < MEMORIES; i++) {
		sequence.memories[i].image.data = malloc(MOST_BYTES);
		sequence.memories[i].expected = malloc(MOST_BYTES);
	}
	change_frame(&sequence);
	for (uint32_t i = 0; i < 80; i++)
		step(&sequence);
	CHECK(sequence.taken > 5 && sequence.begun_between > 2);
	engine_destroy(&sequence.engine);
	engine_destroy(&sequence.plain);
	picture_finish(&sequence.picture);
	for (uint32_t i = 0; i < MEMORIES; i++) {
		free(sequence.memories[i].image.data);
		free(sequence.memories[i].expected);
	}
	return sequence.kept;
}

static void test_any_order(void)
{
	uint64_t kept = 0;
	for (uint32_t seed = 1; seed <= (in_gl() ? 4u : 8u); seed++)
		kept += run_seed(seed);
	CHECK(kept > 0);
}

/* ---- two pictures under way ---- */

#define WIDTH 1000u
#define HEIGHT 700u
#define BYTES ((size_t)4 * WIDTH * HEIGHT)

struct pair {
	struct engine *engine;
	struct picture picture, next;
	uint8_t *out[3];
};

static void pair_begin(struct pair *pair)
{
	*pair = (struct pair){.engine = make()};
	draw(&pair->picture, WIDTH, HEIGHT, 0.0);
	draw(&pair->next, WIDTH, HEIGHT, 0.5);
	picture_fill_random(&pair->next, PURSUIT_ROLE_UI, 1);
	begin(pair->engine, &pair->picture);
	for (int i = 0; i < 3; i++)
		pair->out[i] = memset(malloc(BYTES), PATTERN, BYTES);
}

static void pair_end(struct pair *pair)
{
	engine_destroy(&pair->engine);
	picture_finish(&pair->picture);
	picture_finish(&pair->next);
	for (int i = 0; i < 3; i++)
		free(pair->out[i]);
}

static int show(struct pair *pair, int out, bool ahead, struct error *error)
{
	const struct engine_request request = {ENGINE_SHOW_IN_BETWEEN, 0.2 + 0.3 * out};
	struct engine_image image = {.data = pair->out[out], .stride = 4 * (size_t)WIDTH, .unfinished = ahead};
	error->text[0] = '\0';
	return engine_render(pair->engine, &request, &image, error);
}

static void show_both(struct pair *pair)
{
	struct error error;
	CHECK_INT(show(pair, 0, true, &error), 0);
	CHECK_INT(show(pair, 1, true, &error), 0);
}

static bool is_untouched(const uint8_t *out)
{
	for (size_t i = 0; i < BYTES; i++)
		if (out[i] != PATTERN)
			return false;
	return true;
}

static void test_limits(void)
{
	struct pair pair;
	struct error error;
	struct engine_image image = {.stride = 1};
	pair_begin(&pair);
	CHECK_INT(engine_take(pair.engine, &image, &error), -ENOENT);
	CHECK(!image.data && !image.stride && strstr(error.text, "no unfinished picture"));
	CHECK_INT(show(&pair, 0, true, &error), 0);
	CHECK_INT(show(&pair, 0, true, &error), -EBUSY);
	CHECK_INT(show(&pair, 0, false, &error), -EBUSY);
	CHECK(strstr(error.text, "memory") != NULL);
	CHECK_INT(show(&pair, 1, true, &error), 0);
	CHECK_INT(show(&pair, 1, false, &error), -EBUSY);
	CHECK_INT(show(&pair, 2, true, &error), -EBUSY);
	CHECK(strstr(error.text, "2 pictures") != NULL);
	CHECK_INT(show(&pair, 2, false, &error), 0);
	CHECK_INT(engine_take(pair.engine, &image, &error), 0);
	CHECK(image.data == pair.out[0]);
	CHECK_INT(show(&pair, 0, true, &error), 0);
	CHECK_INT(engine_take(pair.engine, &image, &error), 0);
	CHECK(image.data == pair.out[1]);
	CHECK_INT(engine_take(pair.engine, &image, &error), 0);
	CHECK(image.data == pair.out[0]);
	CHECK_INT(engine_take(pair.engine, &image, &error), -ENOENT);
	pair_end(&pair);
}

/* Dropped: whatever the engine does next, the memory is the caller's. */
static void test_dropped(void)
{
	struct pair pair;
	struct engine_image image;
	struct error error;
	pair_begin(&pair);
	show_both(&pair);
	CHECK(!in_gl() || (is_untouched(pair.out[0]) && is_untouched(pair.out[1])));
	engine_drop(pair.engine);
	memset(pair.out[0], PATTERN, BYTES);
	memset(pair.out[1], PATTERN, BYTES);
	CHECK_INT(show(&pair, 2, true, &error), 0);
	CHECK_INT(engine_finish(pair.engine, &error), 0);
	CHECK_INT(engine_take(pair.engine, &image, &error), 0);
	CHECK(image.data == pair.out[2] && !is_untouched(pair.out[2]));
	CHECK_INT(engine_take(pair.engine, &image, &error), -ENOENT);
	engine_drop(pair.engine);
	CHECK(is_untouched(pair.out[0]) && is_untouched(pair.out[1]));
	pair_end(&pair);
}

static void test_destroyed(void)
{
	struct pair pair;
	pair_begin(&pair);
	show_both(&pair);
	free(pair.out[0]);
	memset(pair.out[1], PATTERN, BYTES);
	engine_destroy(&pair.engine);
	CHECK(is_untouched(pair.out[1]));
	pair.out[0] = NULL;
	pair_end(&pair);
}

static void *take_both(void *data)
{
	const struct pair *pair = data;
	struct engine_image image;
	struct error error;
	for (int i = 0; i < 2; i++)
		CHECK_INT(engine_take(pair->engine, &image, &error), 0);
	CHECK_INT(engine_take(pair->engine, &image, &error), -ENOENT);
	engine_leave(pair->engine);
	return NULL;
}

static void test_another_thread(void)
{
	struct pair pair;
	struct error error;
	pthread_t thread;
	pair_begin(&pair);
	show_both(&pair);
	engine_leave(pair.engine);
	CHECK_INT(pthread_create(&thread, NULL, take_both, &pair), 0);
	pthread_join(thread, NULL);
	for (int i = 0; i < 2; i++) {
		const struct engine_request request = {ENGINE_SHOW_IN_BETWEEN, 0.2 + 0.3 * i};
		struct engine_image image = {.data = pair.out[2], .stride = 4 * (size_t)WIDTH};
		CHECK_INT(engine_render(pair.engine, &request, &image, &error), 0);
		CHECK(memcmp(pair.out[i], pair.out[2], BYTES) == 0);
	}
	pair_end(&pair);
}

/* ---- waiting ---- */

static struct gl real;
static uint32_t waits;

/* A renderer that is never done when it is asked, and always when somebody waits for it. */
static GLenum wait_slowly(GLsync sync, GLbitfield flags, GLuint64 timeout)
{
	if (timeout == 0)
		return GL_TIMEOUT_EXPIRED;
	waits++;
	return real.ClientWaitSync(sync, flags, timeout);
}

/* Neither the picture nor the next real frame waits; what does wait without `unfinished` shows that this can be seen.
 */
static void test_who_waits(void)
{
	struct pair pair;
	struct engine_image image;
	struct error error;
	pair_begin(&pair);
	real = *table_of(pair.engine);
	gl_of(pair.engine)->context->gl.ClientWaitSync = wait_slowly;
	waits = 0;
	begin(pair.engine, &pair.next);
	CHECK(waits > 0);
	waits = 0;
	CHECK_INT(show(&pair, 0, false, &error), 0);
	CHECK(waits > 0);
	waits = 0;
	show_both(&pair);
	begin(pair.engine, &pair.picture);
	CHECK_INT(waits, 0);
	CHECK_INT(engine_take(pair.engine, &image, &error), 0);
	CHECK(waits > 0);
	CHECK_INT(show(&pair, 0, false, &error), 0);
	waits = 0;
	CHECK_INT(engine_take(pair.engine, &image, &error), 0);
	CHECK_INT(waits, 0);
	pair_end(&pair);
}

/* ---- losses ---- */

static enum { MAP, WAIT, FENCE, RESET } broken;
static bool breaks;

static void *break_map(GLenum target, GLintptr offset, GLsizeiptr length, GLbitfield access)
{
	return breaks && broken == MAP && target == GL_PIXEL_PACK_BUFFER
			   ? NULL
			   : real.MapBufferRange(target, offset, length, access);
}

static GLenum break_wait(GLsync sync, GLbitfield flags, GLuint64 timeout)
{
	waits++;
	return breaks && broken == WAIT ? GL_WAIT_FAILED : real.ClientWaitSync(sync, flags, timeout);
}

static GLsync break_fence(GLenum condition, GLbitfield flags)
{
	return breaks && broken == FENCE ? NULL : real.FenceSync(condition, flags);
}

static GLenum break_status(void)
{
	return breaks && broken == RESET ? GL_UNKNOWN_CONTEXT_RESET : GL_NO_ERROR;
}

static void break_gl(struct engine *engine)
{
	struct gl *gl = &gl_of(engine)->context->gl;
	real = *gl;
	gl->MapBufferRange = break_map;
	gl->ClientWaitSync = break_wait;
	gl->FenceSync = break_fence;
	gl->GetGraphicsResetStatus = break_status;
}

static void check_loss(int how)
{
	struct pair pair;
	struct engine_image image;
	struct error error;
	pair_begin(&pair);
	break_gl(pair.engine);
	broken = how;
	breaks = how == FENCE;
	show_both(&pair);
	breaks = true;
	waits = 0;
	for (int i = 0; i < 2; i++) {
		error.text[0] = '\0';
		CHECK_INT(engine_take(pair.engine, &image, &error), -EIO);
		CHECK(image.data == pair.out[i] && image.holds == 0);
		CHECK(error.text[0] != '\0');
	}
	CHECK(waits <= 1);
	CHECK_INT(engine_take(pair.engine, &image, &error), -ENOENT);
	CHECK(is_untouched(pair.out[0]) && is_untouched(pair.out[1]));
	/* One that waits loses those under way with its own. */
	breaks = how == FENCE;
	CHECK_INT(show(&pair, 0, true, &error), 0);
	breaks = true;
	CHECK_INT(show(&pair, 1, false, &error), -EIO);
	breaks = false;
	CHECK_INT(engine_take(pair.engine, &image, &error), how == RESET ? 0 : -EIO);
	CHECK(image.data == pair.out[0] && is_untouched(pair.out[0]) == (how != RESET));
	/* As if nothing had been. */
	CHECK_INT(show(&pair, 0, true, &error), 0);
	CHECK_INT(engine_take(pair.engine, &image, &error), 0);
	CHECK(!is_untouched(pair.out[0]) && is_untouched(pair.out[1]));
	breaks = true;
	pair_end(&pair);
	breaks = false;
}

static void test_losses(void)
{
	for (int how = MAP; how <= RESET; how++)
		check_loss(how);
}

/* ---- memory ---- */

static uint64_t memory_of(struct engine *engine, const struct picture *pictures, uint8_t *const *out, bool ahead)
{
	struct engine_image image;
	struct error error;
	for (uint32_t i = 0; i < 6; i++) {
		const struct engine_request request = {i % 2 ? ENGINE_SHOW_IN_BETWEEN : ENGINE_SHOW_REAL, i % 2 ? 0.5 : 0.0};
		image = (struct engine_image){.data = out[i % 3], .stride = 4 * (size_t)pictures->width, .unfinished = ahead};
		if (i % 2 == 0)
			begin(engine, &pictures[i / 2 % 2]);
		if (ahead && i >= 2)
			CHECK_INT(engine_take(engine, &(struct engine_image){.data = NULL}, &error), 0);
		CHECK_INT(engine_render(engine, &request, &image, &error), 0);
	}
	CHECK_INT(engine_finish(engine, &error), 0);
	engine_drop(engine);
	return engine_get_report(engine)->memory_bytes;
}

/*
 * Only who asks for them pays for them: buffers of a picture on its way back and some of the next, and, of a renderer
 * that is far behind, of colour and UI on their way up.
 */
static void test_memory(void)
{
	struct engine *engine = make();
	struct picture pictures[2];
	uint8_t *out[3];
	for (int i = 0; i < 2; i++)
		draw(&pictures[i], 1920, 1080, i);
	for (int i = 0; i < 3; i++)
		out[i] = malloc((size_t)4 * 1920 * 1080);
	const uint64_t block = READBACK_BLOCK, blocks = 16 + READBACK_SPARE,
				   bytes = memory_of(engine, pictures, out, false);
	CHECK_INT(readback_bytes(&gl_of(engine)->readback), READBACK_BLOCKS * block);
	CHECK_INT(stream_bytes(&gl_of(engine)->stream), STREAM_BLOCKS * block);
	CHECK(bytes <= UINT64_C(60000000));
	real = *table_of(engine);
	gl_of(engine)->context->gl.ClientWaitSync = wait_slowly;
	const uint64_t ahead = memory_of(engine, pictures, out, true);
	printf("%.1f MB at 1920x1080, %.1f with unfinished pictures\n", (double)bytes * 1e-6, (double)ahead * 1e-6);
	CHECK_INT(readback_bytes(&gl_of(engine)->readback), blocks * block);
	CHECK(bytes + (blocks - READBACK_BLOCKS) * block <= UINT64_C(60000000));
	CHECK(stream_bytes(&gl_of(engine)->stream) <= STREAM_BLOCKS * block + 2 * 34 * block / 2);
	memory_of(engine, pictures, out, false);
	memory_of(engine, pictures, out, true);
	CHECK_INT(readback_bytes(&gl_of(engine)->readback), blocks * block);
	for (int i = 0; i < 3; i++)
		free(out[i]);
	for (int i = 0; i < 2; i++)
		picture_finish(&pictures[i]);
	engine_destroy(&engine);
}

int main(int argc, char **argv)
{
	const char *kind = argc > 1 ? argv[1] : "surfaceless";
	params.context = strcmp(kind, "osmesa") == 0 ? ENGINE_CONTEXT_OSMESA
					 : strcmp(kind, "cpu") == 0  ? ENGINE_CONTEXT_CPU
												 : ENGINE_CONTEXT_EGL_SURFACELESS;
	params.gles = strcmp(kind, "gles") == 0;
	struct engine *engine = make();
	engine_destroy(&engine);
	RUN(test_any_order);
	RUN(test_limits);
	RUN(test_dropped);
	RUN(test_destroyed);
	RUN(test_another_thread);
	if (in_gl()) {
		RUN(test_who_waits);
		RUN(test_losses);
	}
	if (strcmp(kind, "surfaceless") == 0)
		RUN(test_memory);
	return test_result();
}
