// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

namespace CLI {
class FormatterBase;
}

namespace fracfit {

/// Help text whose descriptions break at the width of a terminal page.
[[nodiscard]] std::shared_ptr<CLI::FormatterBase> wrapped_help();

}  // namespace fracfit
