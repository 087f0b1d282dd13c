// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixels of CIELAB under some white, as TIFF stores them, to sRGB codes; the white is adapted (Bradford).
// Source: TIFF 6.0, section 23 (CIELAB); TIFF Photoshop notes (ICCLAB); ICC.1:2022, 10.20 (encodings).
#pragma once

#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "optics/colour/colour.h"

namespace voxtone::io {

struct LabCoding {
    bool offset = false;  ///< a and b lie around the middle of their range (ICCLAB); else they are signed (CIELAB)
    int bits = 8;         ///< 8 or 16, as in the file
    Eigen::Vector3d white = optics::d50_white();  ///< XYZ, Y = 1
};

/// In place: L*, a*, b* in the file's bits spread over 16, and a value that is not touched; then RGB codes of 65535.
void lab_to_srgb(std::span<std::uint16_t> pixels, const LabCoding& coding);

}  // namespace voxtone::io
