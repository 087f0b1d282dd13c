// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/print/run_whole.h"

#include <utility>

#include "base/parallel.h"

namespace voxtone::slicer {

JobResult run_whole(Plate& plate, Progress& progress) {
    const Stopwatch watch;
    // All that can refuse the job, from what costs nothing to what costs most ...
    io::StackFolder folder = plate.take_folder(progress);
    if (auto done = plate.done_before(folder, progress)) return *std::move(done);
    plate.expect_replaceable(folder, progress);
    const ThreadLimit threads(static_cast<std::size_t>(plate.job().options.threads));
    plate.prepare(progress);

    // ... and from here on hours may be spent.
    if (auto kept = plate.rearrange(progress)) return *std::move(kept);
    return plate.print(std::move(folder), watch, progress);
}

}  // namespace voxtone::slicer
