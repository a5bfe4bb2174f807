/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The public header compiles alone, as C++, and its functions link. */
#include "pursuit.h"

int main()
{
	pursuit_stream_params params = {};
	params.color_format = PURSUIT_COLOR_RGBA8;
	return pursuit_open(&params) != nullptr || pursuit_version()[0] != '0';
}
