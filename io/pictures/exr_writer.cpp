// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/pictures/exr_writer.h"

#include <algorithm>
#include <cstring>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>

#include "base/contracts.h"
#include "base/units.h"

namespace voxtone::io {

namespace {

class MemoryStream : public Imf::OStream {
public:
    MemoryStream() : OStream("picture.exr") {}
    void write(const char* data, int size) override {
        const std::size_t end = at_ + static_cast<std::size_t>(size);
        if (end > bytes_.size()) bytes_.resize(end);
        if (size > 0) std::memcpy(bytes_.data() + at_, data, static_cast<std::size_t>(size));
        at_ = end;
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t at) override { at_ = static_cast<std::size_t>(at); }
    [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }

private:
    std::vector<std::uint8_t> bytes_;
    std::size_t at_ = 0;
};

/// Without its channels.
Imf::Header header_of(const NumberPicture& picture, std::array<double, 2> px_per_mm) {
    Imf::Header header(static_cast<int>(picture.width_px), static_cast<int>(picture.height_px));
    header.compression() = Imf::ZIP_COMPRESSION;
    // No date, for the same picture would have other bytes each time; but some readers look for one.
    Imf::addCapDate(header, "0000:00:00 00:00:00");
    Imf::addChromaticities(header, {{0.64f, 0.33f}, {0.30f, 0.60f}, {0.15f, 0.06f}, {0.3127f, 0.3290f}});  // sRGB, D65
    if (px_per_mm[0] > 0 && px_per_mm[1] > 0) {
        Imf::addXDensity(header, static_cast<float>(px_per_mm[0] * mm_per_inch));
        header.insert("ResolutionUnit", Imf::StringAttribute("in"));
        header.pixelAspectRatio() = static_cast<float>(px_per_mm[1] / px_per_mm[0]);
    }
    return header;
}

}  // namespace

std::vector<std::uint8_t> exr_bytes(const LinearPicture& picture, std::array<double, 2> px_per_mm) {
    NumberPicture numbers{picture.width_px, picture.height_px, {"R", "G", "B", "A"}, {}};
    numbers.values.reserve(4 * picture.pixels.size());
    for (const Eigen::Vector4f& pixel : picture.pixels)
        for (const float value : {pixel[3] * pixel[0], pixel[3] * pixel[1], pixel[3] * pixel[2], pixel[3]})
            numbers.values.push_back(value);
    return exr_bytes(numbers, px_per_mm);
}

std::vector<std::uint8_t> exr_bytes(const NumberPicture& picture, std::array<double, 2> px_per_mm,
                                    const std::string& comment) {
    VOXTONE_EXPECT(picture.width_px >= 1 && picture.height_px >= 1 && !picture.names.empty());
    VOXTONE_EXPECT(picture.values.size() == std::size_t{picture.width_px} * picture.height_px * picture.names.size());

    Imf::Header header = header_of(picture, px_per_mm);
    if (!comment.empty()) Imf::addComments(header, comment);
    Imf::FrameBuffer frame;
    const std::size_t pixel_bytes = picture.names.size() * sizeof(float);
    for (std::size_t c = 0; c < picture.names.size(); ++c) {
        header.channels().insert(picture.names[c], Imf::Channel(Imf::FLOAT));
        // OpenEXR reads through a pointer that it calls writable.
        char* const first = reinterpret_cast<char*>(const_cast<float*>(picture.values.data() + c));
        frame.insert(picture.names[c], Imf::Slice(Imf::FLOAT, first, pixel_bytes, pixel_bytes * picture.width_px));
    }
    MemoryStream memory;
    {
        constexpr int in_this_thread = 0;
        Imf::OutputFile file(memory, header, in_this_thread);
        file.setFrameBuffer(frame);
        file.writePixels(static_cast<int>(picture.height_px));
    }  // which writes the table of lines
    return memory.take();
}

}  // namespace voxtone::io
