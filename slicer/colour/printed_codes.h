// SPDX-License-Identifier: GPL-3.0-or-later
//
// Codes of a printed picture that a scanner reads: in what was asked for, and whether in the print, too.
//
// The picture is read as it was given, too (slab_picture.h). Target and print are read as they lie, cell by cell and
// enlarged (io/pictures/codes_in_picture.h), each code of the print within its own frame and a sixth of its size around
// it. It is what a patient reader makes of even light and no blur of its own: a code that cannot be read so is read by
// no scanner, one that can may still take a steady hand. A business card's QR code of 9 mm, modules of 0.31 mm, is read
// in one print and not in the next (default set). Codes of a body's texture and those laid on it (slicer/surface) are
// not looked for.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/models/mesh.h"
#include "slicer/colour/job_prediction.h"

namespace voxtone::slicer {

struct PrintedCode {
    std::string kind;  ///< "QR code"
    std::vector<std::uint32_t> cells;
    double width_mm = 0, height_mm = 0;
    double module_mm =
        0;  ///< of EAN, UPC; of QR codes and Data Matrices, if their text was given no more room than it needs; else 0
    bool is_read = false;  ///< in the print
};

/// Of a picture's slab. Empty where nothing reads codes (voxtone-read is missing or ended).
/// `picture`: the slab's mesh with its picture, upright on it or it is left aside; nullptr: the target alone.
[[nodiscard]] std::vector<PrintedCode> printed_codes(const JobPrediction& prediction,
                                                     const io::TexturedMesh* picture = nullptr);

}  // namespace voxtone::slicer
