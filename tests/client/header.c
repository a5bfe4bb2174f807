/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

/* The public header compiles alone, as C11. */
#include "pursuit.h"

int main(void)
{
	struct pursuit_stream_params params = {0};
	return pursuit_open(&params) != NULL || pursuit_version()[0] != '0';
}
