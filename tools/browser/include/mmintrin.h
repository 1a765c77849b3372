// SPDX-License-Identifier: BSD-3-Clause
// Eigen includes it beside the headers of SSE2, which emscripten has; nothing of it is used.
#pragma once
