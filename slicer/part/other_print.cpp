// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/other_print.h"

#include "base/contracts.h"

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
    VOXTONE_EXPECT(registered());  // by who declared it (options/table_of_shows.h)
    return registered()(job);
}

}  // namespace voxtone::slicer
