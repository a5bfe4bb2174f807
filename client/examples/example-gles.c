/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * A renderer with OpenGL ES 3 and EGL, without a window: its textures are read
 * back by the shim. GLES reads no depth textures, so depth is a third target.
 *
 * usage: example-gles [--seconds S]
 */

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GLES3/gl3.h>
#include <math.h>
#include <pursuit.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define WIDTH 640
#define HEIGHT 360
#define FRAME_NS UINT64_C(25000000)
#define VERSION "#version 300 es\nprecision highp float;\n"

static const char vertex_source[] =
	VERSION "void main() {\n"
			"	vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);\n"
			"	gl_Position = vec4(corner, 0.0, 1.0);\n"
			"}\n";

/* A disc that circles over stripes, and how far each pixel has come since the frame before. */
static const char fragment_source[] = VERSION "uniform vec2 center, before;\n"
											  "layout(location = 0) out vec4 color;\n"
											  "layout(location = 1) out vec4 motion;\n"
											  "layout(location = 2) out vec4 depth;\n"
											  "void main() {\n"
											  "	vec2 at = gl_FragCoord.xy - center;\n"
											  "	bool disc = length(at) < 80.0;\n"
											  "	vec2 wave = disc ? sin(at * 0.3) : sin(gl_FragCoord.yy * 0.1);\n"
											  "	color = vec4(0.5 + 0.4 * wave, disc ? 0.8 : 0.2, 1.0);\n"
											  "	motion = vec4(disc ? center - before : vec2(0.0), 0.0, 0.0);\n"
											  "	depth = vec4(disc ? 0.3 : 0.9);\n"
											  "}\n";

static GLuint compile(GLenum type, const char *source)
{
	GLuint shader = glCreateShader(type);
	GLint good = 0;
	char log[512];

	glShaderSource(shader, 1, &source, NULL);
	glCompileShader(shader);
	glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
	if (!good) {
		glGetShaderInfoLog(shader, sizeof(log), NULL, log);
		fprintf(stderr, "%s\n", log);
		exit(1);
	}
	return shader;
}

static GLuint make_program(void)
{
	GLuint program = glCreateProgram();

	glAttachShader(program, compile(GL_VERTEX_SHADER, vertex_source));
	glAttachShader(program, compile(GL_FRAGMENT_SHADER, fragment_source));
	glLinkProgram(program);
	glUseProgram(program);
	return program;
}

static GLuint make_texture(GLenum internal, GLenum format, GLenum type, GLenum attachment)
{
	GLuint texture = 0;

	glGenTextures(1, &texture);
	glBindTexture(GL_TEXTURE_2D, texture);
	glTexImage2D(GL_TEXTURE_2D, 0, (GLint)internal, WIDTH, HEIGHT, 0, format, type, NULL);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, texture, 0);
	return texture;
}

static void *lookup(const char *name)
{
	return (void *)eglGetProcAddress(name);
}

static bool make_context(void)
{
	const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_NONE};
	EGLDisplay display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);

	if (!display || !eglInitialize(display, NULL, NULL) || !eglBindAPI(EGL_OPENGL_ES_API)) {
		return false;
	}
	EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, version);
	return context && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

/* Three textures in one framebuffer. In GL the first row is the lowest, and y points up. */
static struct pursuit_gl_textures make_targets(void)
{
	const GLenum targets[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
	GLuint framebuffer = 0;

	glGenFramebuffers(1, &framebuffer);
	glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
	struct pursuit_gl_textures textures = {
		.color = make_texture(GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, targets[0]),
		.motion = make_texture(GL_RG16F, GL_RG, GL_HALF_FLOAT, targets[1]),
		.depth = make_texture(GL_R32F, GL_RED, GL_FLOAT, targets[2]),
		.bottom_up = 1,
		.motion_y_up = 1,
	};
	glDrawBuffers(3, targets);
	glViewport(0, 0, WIDTH, HEIGHT);
	return textures;
}

/* Draws the scene of second `at`, as it was one frame earlier for the motion. */
static void draw(GLuint program, double at)
{
	double past = at - (double)FRAME_NS * 1e-9;

	glUniform2f(glGetUniformLocation(program, "center"), (float)(320 + 150 * cos(at * 2)),
				(float)(180 + 80 * sin(at * 2)));
	glUniform2f(glGetUniformLocation(program, "before"), (float)(320 + 150 * cos(past * 2)),
				(float)(180 + 80 * sin(past * 2)));
	glDrawArrays(GL_TRIANGLES, 0, 3);
}

static uint64_t now_ns(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static void sleep_until(uint64_t ns)
{
	struct timespec until = {.tv_sec = (time_t)(ns / 1000000000u), .tv_nsec = (long)(ns % 1000000000u)};
	clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
}

int main(int count, char **arguments)
{
	double seconds = count == 3 && strcmp(arguments[1], "--seconds") == 0 ? atof(arguments[2]) : 5.0;

	if (!make_context()) {
		fprintf(stderr, "no OpenGL ES 3 context without a surface\n");
		return 77;
	}
	GLuint program = make_program();
	struct pursuit_gl_textures textures = make_targets();
	struct pursuit_stream_params params = {
		.width = WIDTH,
		.height = HEIGHT,
		.color_format = PURSUIT_COLOR_RGBA8,
		.depth_format = PURSUIT_DEPTH_FLOAT32,
		.motion_format = PURSUIT_MOTION_FLOAT16,
		.name = "example-gles",
	};
	struct pursuit_stream *stream = pursuit_open(&params);
	struct pursuit_gl *gl = pursuit_gl_create(stream, lookup);

	if (!gl) {
		perror("pursuit");
		return 1;
	}
	uint64_t begin = now_ns();
	for (uint32_t number = 0; (double)number * (double)FRAME_NS < seconds * 1e9; number++) {
		struct pursuit_frame frame = {.time_ns = begin + number * FRAME_NS};
		draw(program, (double)number * (double)FRAME_NS * 1e-9);
		pursuit_gl_submit(gl, &textures, &frame);
		/* Half a frame later the read-back is done, and the frame leaves half a frame earlier. */
		sleep_until(frame.time_ns + FRAME_NS / 2);
		pursuit_gl_update(gl);
		sleep_until(frame.time_ns + FRAME_NS);
	}
	pursuit_gl_flush(gl);

	struct pursuit_status status;
	pursuit_get_status(stream, &status);
	printf("%llu frames submitted, %llu published; %s\n", (unsigned long long)status.submitted,
		   (unsigned long long)status.published, status.message);
	pursuit_gl_destroy(&gl);
	pursuit_close(&stream);
	return 0;
}
