// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reading in this process: what voxtone-read does when it is asked, and what tests do where the wall around the parsers
// (io/files/isolate.h) is not what is tested. A hostile file can end the program.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "io/decoders/decode_options.h"
#include "io/files/packed_values.h"
#include "io/models/model_reader.h"
#include "io/pictures/picture.h"

namespace voxtone::io {

/// As read_model and read_picture; limits of memory and time have no effect. `others` decodes what is not PNG,
/// JPEG or WebP; without it such pictures are refused. Throws FileError, InputError.
[[nodiscard]] ModelFile read_model_here(const std::filesystem::path& path, const ReadOptions& options = {},
                                        const OtherDecoder& others = {});
[[nodiscard]] Picture read_picture_here(const std::filesystem::path& path, const ReadOptions& options = {},
                                        const OtherDecoder& others = {});

/// Answers a packed ReadRequest (io/files/file_reader.h).
[[nodiscard]] Packing answer(std::span<const std::byte> request);

}  // namespace voxtone::io
