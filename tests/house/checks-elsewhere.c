/* SPDX-License-Identifier: MIT */
/* SPDX-FileCopyrightText: 2026 The Pursuit authors */

#include "tests/house/checks-elsewhere.h"
#include "tests/test.h"

void check_elsewhere(bool holds)
{
	CHECK(holds);
}
