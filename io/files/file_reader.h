// SPDX-License-Identifier: GPL-3.0-or-later
//
// The program `voxtone-read`, in which every model, picture, photograph and ICC profile is parsed (io/codecs): how it
// is asked. Libraries of formats (OpenImageIO and what it loads, Little CMS) are linked into it alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "voxtone/io/files/isolate.h"
#include "voxtone/io/files/read_options.h"

namespace voxtone::io {

enum class ReadKind : std::uint8_t {
    model,           ///< answered by packed ModelParts (io/models/model_parts.h)
    picture,         ///< by a packed DecodedImage
    photograph,      ///< by a packed Photograph
    device_profile,  ///< by a packed DeviceProfile (io/profiles/device_profile.h)
};

struct ReadRequest {
    ReadKind kind = ReadKind::model;
    std::string path;
    std::uint64_t max_file_bytes = 0, max_pixels = 0, max_unpacked_bytes = 0;  ///< as ReadOptions has them
    std::string texture{};                                                     ///< given to a model; empty: none
    std::vector<double> samples{};                                             ///< asked of a device profile
};

[[nodiscard]] std::vector<std::byte> pack(const ReadRequest& request);
/// Throws ResourceError when another version of voxtone asks: the two would not understand each other.
[[nodiscard]] ReadRequest unpack_request(std::span<const std::byte> bytes);

/// Starts the program for a model or picture.
[[nodiscard]] std::unique_ptr<IsolatedProgram> start_reader(ReadKind kind, const std::filesystem::path& path,
                                                            const ReadOptions& options);
/// Starts the program, which may read the file and, of a model, what lies in its folder. `what` names the file in
/// messages. Throws FileError (the program is missing), TryAgain.
[[nodiscard]] std::unique_ptr<IsolatedProgram> start_reader(const std::string& what, const ReadRequest& request,
                                                            IsolationLimits limits);

/// What it answers; where the system lacks a wall around it, a warning says so.
[[nodiscard]] std::vector<std::byte> read_guarded(IsolatedProgram& reader, const Progress* progress,
                                                  std::vector<std::string>& warnings);

}  // namespace voxtone::io
