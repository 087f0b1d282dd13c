// SPDX-License-Identifier: GPL-3.0-or-later
//
// A case of the suite together with its Monte Carlo reference, in one small file that needs nothing else.
//
// Format: the line "voxtone appearance reference 1"; one line of JSON (the case, its resins, provenance, lengths of
// what follows); zlib streams of the voxels (one byte each, x fastest, then y, z) and of the values. Values are 16-bit
// codes, little-endian: v = 2 (code / 65535)^2, so that dark ones are kept as well as bright ones (within 4.4e-5 at
// 0.5): two independent halves one after the other, per group of cells and channel; for bodies without mirrored sides
// another two of the same body all of white resin.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "suite_case.h"

namespace voxtone::accuracy {

struct Reference {
    SuiteCase of;
    std::array<std::vector<float>, 2> half;   ///< [group * channels + channel]
    std::array<std::vector<float>, 2> white;  ///< the same of white resin; empty where it is known exactly
    double core_seconds = 0;                  ///< that both halves took, without the white
    std::uint64_t all_paths = 0;              ///< of both halves
    std::uint64_t seed = 0;                   ///< of the first half; the second's is one more
    std::string made;                         ///< command and date, in words
};

void write_reference(const std::filesystem::path& file, const Reference& reference);
/// Throws FileError.
[[nodiscard]] Reference read_reference(const std::filesystem::path& file);

}  // namespace voxtone::accuracy
