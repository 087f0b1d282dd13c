// SPDX-License-Identifier: GPL-3.0-or-later
//
// io/pictures/photograph_writer.h by OpenImageIO: the source of the module voxtone-photographs.so.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/pictures/photograph.h"

/// The module's door: a file of the kind .png, .tif or .exr. Samples of 8 bits are codes already.
extern "C" void voxtone_encode_photograph(const voxtone::io::Photograph& photograph, const std::string& extension,
                                          std::vector<std::uint8_t>& bytes);
