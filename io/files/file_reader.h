// SPDX-License-Identifier: GPL-3.0-or-later
//
// The programs in which other people's files are parsed, and how they are asked. `voxtone-read` (io/codecs) parses
// models, ICC profiles, PNG, JPEG and WebP; `voxtone-read-pictures` (io/openimageio) pictures of all other kinds, and
// photographs: OpenImageIO and the hundred libraries that it loads are linked into it alone. It starts when such a
// picture comes: voxtone-read, behind its walls, asks for it, and it is given the picture's bytes and sees no file.
// `voxtone-read-drawings` (io/drawings) is asked in the same way for SVG; it sees this machine's fonts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "io/files/isolate.h"
#include "io/files/read_options.h"

namespace voxtone::io {

enum class ReadKind : std::uint8_t {
    model,           ///< answered by packed ModelParts (io/models/model_parts.h)
    picture,         ///< by a packed DecodedImage
    photograph,      ///< by a packed Photograph; voxtone-read-pictures
    other_picture,   ///< by a packed DecodedImage; voxtone-read-pictures, voxtone-read-drawings
    folder,          ///< asked by voxtone-read: the model names files beside it, which it was not given
    device_profile,  ///< by a packed DeviceProfile (io/profiles/device_profile.h)
    side_files,      ///< of a model: by packed ModelParts that hold these alone
    codes,           ///< of a picture's bytes: by packed CodeInPicture (io/pictures/codes_in_picture.h)
};

struct ReadRequest {
    ReadKind kind = ReadKind::model;
    std::string path;
    std::uint64_t max_file_bytes = 0, max_pixels = 0, max_unpacked_bytes = 0;  ///< as ReadOptions has them
    std::string texture{};                                                     ///< given to a model; empty: none
    std::vector<double> samples{};  ///< asked of a device profile; of codes: columns, rows, most_times
    bool sees_folder = true;        ///< of a model: what lies beside it may be read
    bool keep_alpha = false;        ///< of a model, as ReadOptions has it
    // of other_picture; its name for messages is `path`
    std::string format{};  ///< as OpenImageIO names it, or "svg"
    bool use_profile = true, turn_upright = false;
    DrawingRaster drawing{};  ///< of picture, too
    std::vector<std::byte> bytes{};
};

/// ReadRequest::format of an SVG drawing.
inline constexpr const char* drawing_format = "svg";

/// Of a reader that was not given the folder of its model, and asks for it.
struct NeedsFolder {};

[[nodiscard]] std::vector<std::byte> pack(const ReadRequest& request);
/// Throws ResourceError when another version of voxtone asks: the two would not understand each other.
[[nodiscard]] ReadRequest unpack_request(std::span<const std::byte> bytes);

/// Starts the program for a model or picture. Without `sees_folder` its result may be NeedsFolder, thrown.
[[nodiscard]] std::unique_ptr<IsolatedProgram> start_reader(ReadKind kind, const std::filesystem::path& path,
                                                            const ReadOptions& options, bool sees_folder = true);
/// Starts the program, which may read the file, what `limits` names and, of a model, what lies in its folder and does
/// not begin with a dot. `what` names the file in messages. Throws FileError (the program is missing), TryAgain.
[[nodiscard]] std::unique_ptr<IsolatedProgram> start_reader(const std::string& what, const ReadRequest& request,
                                                            IsolationLimits limits);

class PackedReader;

/// What it answers, unpacked piece by piece as it is read; where the system lacks a wall around it, a warning says so.
void read_guarded(IsolatedProgram& reader, const Progress* progress, std::vector<std::string>& warnings,
                  const std::function<void(PackedReader& answer)>& unpack);
/// What it answers; where the system lacks a wall around it, a warning says so.
[[nodiscard]] std::vector<std::byte> read_guarded(IsolatedProgram& reader, const Progress* progress,
                                                  std::vector<std::string>& warnings);

}  // namespace voxtone::io
