// SPDX-License-Identifier: GPL-3.0-or-later
//
// Functions in modules: shared libraries of voxtone that carry what most runs do without (OpenVDB alone costs 20 ms and
// 25 MB at every start) and are loaded when they are first called. They lie where the helper programs lie.
#pragma once

#include <string>

namespace voxtone::io {

/// The function `name` (extern "C") of a module; loaded once, kept until the program ends. From any thread. Throws
/// FileError where the module is missing or cannot be loaded.
[[nodiscard]] void* module_function(const std::string& module, const char* name);

}  // namespace voxtone::io
