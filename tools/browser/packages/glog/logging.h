// SPDX-License-Identifier: BSD-3-Clause
// What the program asks of glog: silence.  Ceres has its own small copy here, whose words go nowhere.
#pragma once
namespace google {
constexpr int GLOG_FATAL = 3;
}
inline int FLAGS_minloglevel = 0;
