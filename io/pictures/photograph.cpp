// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/photograph.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "io/files/file_reader.h"
#include "io/files/packed_values.h"
#include "io/pictures/srgb_code.h"

namespace voxtone::io {

namespace {

constexpr double most_seconds = 300;
constexpr std::uint64_t most_bytes = std::uint64_t{12} << 30;

}  // namespace

template <class Stream, class Photo>
requires std::is_same_v<std::remove_const_t<Photo>, Photograph>
void describe(Stream& stream, Photo& p) {
    stream(p.name, p.width_px, p.height_px, p.coding, p.bits, p.pixels, p.exposure_s, p.orientation);
}

std::vector<std::byte> pack(const Photograph& photograph) { return packed(photograph); }

Packing packing_of(Photograph photograph) { return packing(std::move(photograph)); }

Photograph unpack_photograph(std::span<const std::byte> bytes) {
    auto photograph = unpacked<Photograph>(bytes);
    const std::uint64_t pixels = std::uint64_t{photograph.width_px} * photograph.height_px;
    if (pixels == 0 || photograph.pixels.size() != pixels || photograph.coding > SampleCoding::unknown)
        throw InputError("what the reader left is no photograph: its size is not that of its pixels");
    if (!(photograph.exposure_s > 0 && std::isfinite(photograph.exposure_s))) photograph.exposure_s = 0;
    if (photograph.orientation < 1 || photograph.orientation > 8) photograph.orientation = 1;
    for (Eigen::Vector3f& pixel : photograph.pixels)
        for (float& value : pixel)
            if (!std::isfinite(value)) value = 0;
    return photograph;
}

Photograph read_photograph(const std::filesystem::path& file, const Progress* progress) {
    return PhotographReader(std::span<const std::filesystem::path>{}).read(file, progress);
}

PhotographReader::PhotographReader(std::span<const std::filesystem::path> files, bool by_profile)
    : by_profile_(by_profile) {
    for (const std::filesystem::path& file : files) files_.push_back(file.string());
}
PhotographReader::~PhotographReader() = default;

Photograph PhotographReader::read(const std::filesystem::path& file, const Progress* progress) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error))
        throw FileError(fmt::format("the photograph {} is not there or is no file", file.string()));
    const ReadRequest request{.kind = ReadKind::photograph, .path = file.string(), .use_profile = by_profile_};
    std::unique_ptr<IsolatedProgram> program = std::move(program_);  // of no use after most errors
    if (program) {
        program->post_request(pack(request), file.string());
    } else {
        IsolationLimits limits{.memory_bytes = most_bytes, .timeout_s = most_seconds};
        std::ranges::copy_if(files_, std::back_inserter(limits.readable),
                             [](const std::string& name) { return std::filesystem::exists(name); });
        program = start_reader(file.string(), request, std::move(limits));
    }
    Photograph photograph = unpack_photograph(program->result(progress));
    program_ = std::move(program);
    return photograph;
}

void turn_upright(Photograph& photograph) {
    const int orientation = std::exchange(photograph.orientation, 1);
    if (orientation == 1) return;
    const std::uint32_t w = photograph.width_px, h = photograph.height_px;
    const bool lies = orientation >= 5;
    Photograph stored = photograph;
    if (lies) std::swap(photograph.width_px, photograph.height_px);
    const bool from_right = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8,
               from_below = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
    for (std::uint32_t y = 0; y < photograph.height_px; ++y)
        for (std::uint32_t x = 0; x < photograph.width_px; ++x) {
            const std::uint32_t column = lies ? y : x, row = lies ? x : y;
            photograph.pixels[photograph.index(x, y)] =
                stored.pixels[stored.index(from_right ? w - 1 - column : column, from_below ? h - 1 - row : row)];
        }
}

void make_linear(Photograph& photograph) {
    if (photograph.coding == SampleCoding::linear) return;
    for (Eigen::Vector3f& pixel : photograph.pixels)
        for (float& value : pixel) value = srgb_to_linear(value);
    photograph.coding = SampleCoding::linear;
}

}  // namespace voxtone::io
