/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/*
 * The table of GL functions: one a context, filled by that context's own
 * lookup. No GL library is linked; every call of the engine goes through it.
 */
#ifndef PURSUIT_ENGINE_GL_GL_H
#define PURSUIT_ENGINE_GL_GL_H

#include <stdbool.h>

#include <GL/glcorearb.h>

#include "daemon/error.h"

/* Fewer tiles (contents.h) between others of a row go along with these though nobody needs them: a call costs more. */
#define GL_TILES_OF_CALL 3u

/* Every one of these must exist. */
#define GL_FUNCTIONS(X)                                 \
	X(ActiveTexture, ACTIVETEXTURE)                     \
	X(AttachShader, ATTACHSHADER)                       \
	X(BindAttribLocation, BINDATTRIBLOCATION)           \
	X(BindBuffer, BINDBUFFER)                           \
	X(BindBufferBase, BINDBUFFERBASE)                   \
	X(BindFramebuffer, BINDFRAMEBUFFER)                 \
	X(BindRenderbuffer, BINDRENDERBUFFER)               \
	X(BindTexture, BINDTEXTURE)                         \
	X(BindVertexArray, BINDVERTEXARRAY)                 \
	X(BlendFunc, BLENDFUNC)                             \
	X(BlitFramebuffer, BLITFRAMEBUFFER)                 \
	X(BufferData, BUFFERDATA)                           \
	X(BufferSubData, BUFFERSUBDATA)                     \
	X(CheckFramebufferStatus, CHECKFRAMEBUFFERSTATUS)   \
	X(ClearBufferfv, CLEARBUFFERFV)                     \
	X(ClientWaitSync, CLIENTWAITSYNC)                   \
	X(CompileShader, COMPILESHADER)                     \
	X(CreateProgram, CREATEPROGRAM)                     \
	X(CreateShader, CREATESHADER)                       \
	X(CullFace, CULLFACE)                               \
	X(DeleteBuffers, DELETEBUFFERS)                     \
	X(DeleteFramebuffers, DELETEFRAMEBUFFERS)           \
	X(DeleteProgram, DELETEPROGRAM)                     \
	X(DeleteRenderbuffers, DELETERENDERBUFFERS)         \
	X(DeleteShader, DELETESHADER)                       \
	X(DeleteSync, DELETESYNC)                           \
	X(DeleteTextures, DELETETEXTURES)                   \
	X(DeleteVertexArrays, DELETEVERTEXARRAYS)           \
	X(DepthFunc, DEPTHFUNC)                             \
	X(DepthMask, DEPTHMASK)                             \
	X(Disable, DISABLE)                                 \
	X(DrawArrays, DRAWARRAYS)                           \
	X(DrawBuffers, DRAWBUFFERS)                         \
	X(DrawElements, DRAWELEMENTS)                       \
	X(Enable, ENABLE)                                   \
	X(EnableVertexAttribArray, ENABLEVERTEXATTRIBARRAY) \
	X(FenceSync, FENCESYNC)                             \
	X(Finish, FINISH)                                   \
	X(Flush, FLUSH)                                     \
	X(FramebufferRenderbuffer, FRAMEBUFFERRENDERBUFFER) \
	X(FramebufferTexture2D, FRAMEBUFFERTEXTURE2D)       \
	X(FrontFace, FRONTFACE)                             \
	X(GenBuffers, GENBUFFERS)                           \
	X(GenFramebuffers, GENFRAMEBUFFERS)                 \
	X(GenRenderbuffers, GENRENDERBUFFERS)               \
	X(GenTextures, GENTEXTURES)                         \
	X(GenVertexArrays, GENVERTEXARRAYS)                 \
	X(GetError, GETERROR)                               \
	X(GetIntegerv, GETINTEGERV)                         \
	X(GetProgramInfoLog, GETPROGRAMINFOLOG)             \
	X(GetProgramiv, GETPROGRAMIV)                       \
	X(GetShaderInfoLog, GETSHADERINFOLOG)               \
	X(GetShaderiv, GETSHADERIV)                         \
	X(GetString, GETSTRING)                             \
	X(GetStringi, GETSTRINGI)                           \
	X(GetUniformLocation, GETUNIFORMLOCATION)           \
	X(LinkProgram, LINKPROGRAM)                         \
	X(MapBufferRange, MAPBUFFERRANGE)                   \
	X(PixelStorei, PIXELSTOREI)                         \
	X(ReadBuffer, READBUFFER)                           \
	X(ReadPixels, READPIXELS)                           \
	X(RenderbufferStorage, RENDERBUFFERSTORAGE)         \
	X(Scissor, SCISSOR)                                 \
	X(ShaderSource, SHADERSOURCE)                       \
	X(TexImage2D, TEXIMAGE2D)                           \
	X(TexParameteri, TEXPARAMETERI)                     \
	X(TexSubImage2D, TEXSUBIMAGE2D)                     \
	X(Uniform1f, UNIFORM1F)                             \
	X(Uniform1i, UNIFORM1I)                             \
	X(Uniform2f, UNIFORM2F)                             \
	X(UnmapBuffer, UNMAPBUFFER)                         \
	X(UseProgram, USEPROGRAM)                           \
	X(VertexAttribPointer, VERTEXATTRIBPOINTER)         \
	X(Viewport, VIEWPORT)

/* These may be missing (NULL). GLES has them under the names of its extensions. */
#define GL_OPTIONAL_FUNCTIONS(X)                      \
	X(GetGraphicsResetStatus, GETGRAPHICSRESETSTATUS) \
	X(GenQueries, GENQUERIES)                         \
	X(DeleteQueries, DELETEQUERIES)                   \
	X(BeginQuery, BEGINQUERY)                         \
	X(EndQuery, ENDQUERY)                             \
	X(GetQueryObjectui64v, GETQUERYOBJECTUI64V)       \
	X(DispatchCompute, DISPATCHCOMPUTE)               \
	X(MemoryBarrier, MEMORYBARRIER)

struct gl {
#define X(name, type) PFNGL##type##PROC name;
	GL_FUNCTIONS(X)
	GL_OPTIONAL_FUNCTIONS(X)
#undef X
	bool gles;
	int version;  /* 10 x major + minor */
	int max_size; /* of textures and viewports, pixels */
	bool timer_queries;
	bool compute;    /* shaders of 4.3 core or ES 3.1 that write to buffers */
	int max_storage; /* bytes of such a buffer */
	/*
	 * How 4 bytes a pixel go in and out: taken for RGBA though they are BGRA, which no pass minds; in a context that
	 * was brought as what they are, since others see the pictures there.
	 */
	GLenum pixel_format, pixel_type;
};

typedef void (*gl_function)(void);
typedef gl_function (*gl_lookup)(const char *name);

/* Fills the table; the context is current. 0 or -ENOTSUP with the name of what is missing. */
int gl_load(struct gl *gl, gl_lookup lookup, struct error *error);

bool gl_has_extension(const struct gl *gl, const char *name);

/*
 * Waits until that fence has come, five seconds at most: a GPU that needs longer is not coming back. 0, or -EIO with a
 * sentence: the context is lost. So it is where it gave NULL for a fence.
 */
int gl_wait(const struct gl *gl, GLsync fence, struct error *error);

#endif
