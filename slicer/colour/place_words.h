// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where something lies on a print, as a person says it: "upper left, front", before any coordinates. Thirds of the box:
// what lies in the middle third of an axis has no word for it; nor has an axis along which the body is thin.
#pragma once

#include <array>
#include <set>
#include <string>

#include "slicer/part/job_body.h"

namespace voxtone::slicer {

class PlaceWords {
public:
    /// Keeps a reference.
    explicit PlaceWords(const JobBody& body);
    /// "upper left front"; with the name of the material there, unless half of the model or more is of it. `at_mm`:
    /// from the corner of the print.
    [[nodiscard]] std::string at(const std::array<double, 3>& at_mm) const;

private:
    const JobBody& body_;
    std::set<std::string> names_;  ///< of materials that say where something is
};

/// "upper left front", "middle": of a box. A picture has its height along y.
[[nodiscard]] std::string place_in_box(const std::array<double, 3>& at_mm, const std::array<double, 3>& size_mm,
                                       bool is_picture);

}  // namespace voxtone::slicer
