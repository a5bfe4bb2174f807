/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The GL functions that the scenes use, looked up in the caller's context; nothing is linked. */
#ifndef PURSUIT_SCENES_GL_H
#define PURSUIT_SCENES_GL_H

#include <GL/glcorearb.h>

#include "client/scenes/scene.h"

#define SCENE_GL_FUNCTIONS(X)                                    \
	X(PFNGLACTIVETEXTUREPROC, ActiveTexture)                     \
	X(PFNGLATTACHSHADERPROC, AttachShader)                       \
	X(PFNGLBINDBUFFERPROC, BindBuffer)                           \
	X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                 \
	X(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer)               \
	X(PFNGLBINDSAMPLERPROC, BindSampler)                         \
	X(PFNGLBINDTEXTUREPROC, BindTexture)                         \
	X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                 \
	X(PFNGLBLENDFUNCPROC, BlendFunc)                             \
	X(PFNGLBUFFERDATAPROC, BufferData)                           \
	X(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus)   \
	X(PFNGLCLEARBUFFERFVPROC, ClearBufferfv)                     \
	X(PFNGLCLEARBUFFERUIVPROC, ClearBufferuiv)                   \
	X(PFNGLCOLORMASKPROC, ColorMask)                             \
	X(PFNGLCOMPILESHADERPROC, CompileShader)                     \
	X(PFNGLCREATEPROGRAMPROC, CreateProgram)                     \
	X(PFNGLCREATESHADERPROC, CreateShader)                       \
	X(PFNGLCULLFACEPROC, CullFace)                               \
	X(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                     \
	X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)           \
	X(PFNGLDELETEPROGRAMPROC, DeleteProgram)                     \
	X(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers)         \
	X(PFNGLDELETESHADERPROC, DeleteShader)                       \
	X(PFNGLDELETETEXTURESPROC, DeleteTextures)                   \
	X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)           \
	X(PFNGLDEPTHFUNCPROC, DepthFunc)                             \
	X(PFNGLDEPTHMASKPROC, DepthMask)                             \
	X(PFNGLDISABLEPROC, Disable)                                 \
	X(PFNGLDRAWARRAYSPROC, DrawArrays)                           \
	X(PFNGLDRAWBUFFERSPROC, DrawBuffers)                         \
	X(PFNGLDRAWELEMENTSPROC, DrawElements)                       \
	X(PFNGLENABLEPROC, Enable)                                   \
	X(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray) \
	X(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer) \
	X(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D)       \
	X(PFNGLFRONTFACEPROC, FrontFace)                             \
	X(PFNGLGENBUFFERSPROC, GenBuffers)                           \
	X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)                 \
	X(PFNGLGENRENDERBUFFERSPROC, GenRenderbuffers)               \
	X(PFNGLGENTEXTURESPROC, GenTextures)                         \
	X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)                 \
	X(PFNGLGETERRORPROC, GetError)                               \
	X(PFNGLGETINTEGERVPROC, GetIntegerv)                         \
	X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)             \
	X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                       \
	X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)               \
	X(PFNGLGETSHADERIVPROC, GetShaderiv)                         \
	X(PFNGLGETSTRINGPROC, GetString)                             \
	X(PFNGLGETSTRINGIPROC, GetStringi)                           \
	X(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)           \
	X(PFNGLLINKPROGRAMPROC, LinkProgram)                         \
	X(PFNGLPIXELSTOREIPROC, PixelStorei)                         \
	X(PFNGLREADBUFFERPROC, ReadBuffer)                           \
	X(PFNGLREADPIXELSPROC, ReadPixels)                           \
	X(PFNGLRENDERBUFFERSTORAGEPROC, RenderbufferStorage)         \
	X(PFNGLSHADERSOURCEPROC, ShaderSource)                       \
	X(PFNGLTEXIMAGE2DPROC, TexImage2D)                           \
	X(PFNGLTEXIMAGE3DPROC, TexImage3D)                           \
	X(PFNGLTEXPARAMETERIPROC, TexParameteri)                     \
	X(PFNGLTEXSUBIMAGE3DPROC, TexSubImage3D)                     \
	X(PFNGLUNIFORM1IPROC, Uniform1i)                             \
	X(PFNGLUNIFORM1UIPROC, Uniform1ui)                           \
	X(PFNGLUNIFORM2FPROC, Uniform2f)                             \
	X(PFNGLUNIFORM3FPROC, Uniform3f)                             \
	X(PFNGLUNIFORM4FPROC, Uniform4f)                             \
	X(PFNGLUNIFORMMATRIX3FVPROC, UniformMatrix3fv)               \
	X(PFNGLUNIFORMMATRIX4FVPROC, UniformMatrix4fv)               \
	X(PFNGLUSEPROGRAMPROC, UseProgram)                           \
	X(PFNGLVERTEXATTRIBIPOINTERPROC, VertexAttribIPointer)       \
	X(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)         \
	X(PFNGLVIEWPORTPROC, Viewport)

struct scene_gl {
#define SCENE_GL_MEMBER(type, name) type name;
	SCENE_GL_FUNCTIONS(SCENE_GL_MEMBER)
#undef SCENE_GL_MEMBER
	bool es; /* the context is OpenGL ES */
};

/* Fills the table and checks that the context can do what the scenes need; a sentence in error if not. */
bool scene_gl_init(struct scene_gl *gl, scene_gl_lookup lookup, char *error, size_t error_size);

/* Compiles and links; the sources lack their version line. 0 with a sentence in error on failure. */
GLuint scene_gl_program(const struct scene_gl *gl, const char *vertex, const char *fragment, char *error,
						size_t error_size);

#endif
