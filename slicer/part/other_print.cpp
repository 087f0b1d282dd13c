// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/other_print.h"

#include <fmt/core.h>

#include "base/error.h"

namespace voxtone::slicer {

namespace {

OpenOtherPrint& registered() {
    static OpenOtherPrint open = nullptr;
    return open;
}

}  // namespace

void register_other_print(OpenOtherPrint open) { registered() = open; }

std::unique_ptr<const OtherPrint> open_other_print(ResolvedJob& job) {
    if (job.shows_colours()) return nullptr;
    if (!registered())
        throw InputError(
            fmt::format("--show {}: this program was built without such prints; use `voxtone slice`", job.raw.show));
    return registered()(job);
}

}  // namespace voxtone::slicer
