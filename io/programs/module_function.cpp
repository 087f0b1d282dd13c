// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/programs/module_function.h"

#include <dlfcn.h>

#include <fmt/core.h>

#include "base/error.h"
#include "io/programs/helper_program.h"

namespace voxtone::io {

void* module_function(const std::string& module, const char* name) {
    // A library that is open already is found again, and counted: none is ever closed.
    void* const library = dlopen(find_helper(module).c_str(), RTLD_NOW | RTLD_LOCAL);
    void* const function = library ? dlsym(library, name) : nullptr;
    if (!function)
        throw FileError(
            fmt::format("{}, a part of voxtone, cannot be loaded ({}); install voxtone again", module, dlerror()));
    return function;
}

}  // namespace voxtone::io
