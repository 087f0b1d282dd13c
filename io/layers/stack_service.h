// SPDX-License-Identifier: GPL-3.0-or-later
//
// What crosses the wall between the program that reads a layer stack (voxtone-read) and the one that asks it
// (io/layers/stack_reader.h): first a listing, then layer after layer. Nothing that comes back is believed: unpacking
// throws InputError where its parts do not fit together.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/layers/layer_scan.h"
#include "io/layers/stack_files.h"

namespace voxtone::io {

/// A layer looked at, as far as it can be read.
struct LayerInspection {
    std::optional<PngHeader> header;
    std::string fault;  ///< why it cannot be read whole; empty: it can, and `scan` is there
    LayerScan scan;
};

/// A container's Zbuffer.png looked at.
struct ZbufferInspection {
    std::string fault;  ///< why it cannot be read whole; empty: it can, and the rest is there
    PngHeader header;
    std::uint64_t digest = 0;  ///< topmost_digest of its numbers
};

struct LayerRequest {
    std::uint32_t index = 0;
    std::vector<Rgb> palette;
    OtherPixels others{};
};

[[nodiscard]] std::vector<std::byte> pack_stack_request(const std::filesystem::path& path);
[[nodiscard]] std::vector<std::byte> pack(const LayerRequest& request);
[[nodiscard]] std::vector<std::byte> pack_zbuffer_request();
[[nodiscard]] StackListing unpack_listing(std::span<const std::byte> bytes);
/// Of a request with so many materials.
[[nodiscard]] LayerInspection unpack_inspection(std::span<const std::byte> bytes, std::size_t materials);
[[nodiscard]] ZbufferInspection unpack_zbuffer(std::span<const std::byte> bytes);

/// The answers: the first request names the stack, each other one a layer or the Zbuffer. Throws FileError, InputError;
/// what is wrong with one layer's file is in its inspection.
class StackService {
public:
    /// Whether the request is one of these: voxtone-read has requests of other kinds (io/files/file_reader.h).
    [[nodiscard]] bool serves(std::span<const std::byte> request) const;
    [[nodiscard]] std::vector<std::byte> answer(std::span<const std::byte> request);

private:
    std::unique_ptr<const StackFiles> stack_;
};

}  // namespace voxtone::io
