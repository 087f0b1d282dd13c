// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/monte_carlo/monte_carlo_options.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"

namespace voxtone::optics {

void MonteCarloOptions::validate() const {
    if (paths < 2)
        throw InputError(
            fmt::format("{} paths per cell cannot tell how uncertain their mean is; use at least 2.", paths));
    if (!(error >= 0 && std::isfinite(error)))
        throw InputError(
            fmt::format("A standard error of {} cannot be reached; use a small positive number, 0.005 for "
                        "half a percent of white, or 0 for a fixed number of paths.",
                        error));
    const std::uint32_t most = error > 0 ? std::max(paths, max_paths) : paths;
    if (most > ~std::uint32_t{0} - first_path)
        throw InputError(
            fmt::format("Paths {} to {} + {} are asked for, but a cell has only 2^32; lower the first or "
                        "the number of paths.",
                        first_path, first_path, most));
}

}  // namespace voxtone::optics
