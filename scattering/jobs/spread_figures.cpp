// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/spread_figures.h"

#include <fmt/format.h>

#include "optics/profiles/resin_laminate.h"

namespace voxtone::scattering {

SpreadFigures spread_figures(const optics::HankelGrid& grid, const std::vector<double>& coefficients) {
    return {coefficients[0], optics::radius_of_share(grid, coefficients, 0.5),
            optics::radius_of_share(grid, coefficients, 0.8)};
}

std::string spread_text(char letter, const SpreadFigures& figures, double error) {
    return fmt::format("{} {:.4f}{}, half of it within {:.2f} mm, 80 % within {:.2f} mm", letter, figures.total,
                       error > 0 ? fmt::format(" +- {:.4f}", error) : std::string(), figures.half_mm, figures.most_mm);
}

}  // namespace voxtone::scattering
