// SPDX-License-Identifier: GPL-3.0-or-later
//
// ICC profiles of devices (ICC.1:2022): what a printer's profile says of itself, and the colours that it has for chosen
// amounts of the device's channels. Read by another program (io/files/file_reader.h), with Little CMS.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/progress.h"

namespace voxtone::io {

/// Which table from device to colour the profile's colours come from.
enum class DeviceTable : std::uint8_t {
    none,          ///< there is no such table: colours cannot be asked for
    perceptual,    ///< A2B0 alone, which may be bent to please
    colorimetric,  ///< A2B1 or D2B1: as measured
};

/// A tag that carries a text of measurements: `targ` (CGATS, or the mere name of a known data set), `CxF ` (XML).
struct MeasurementText {
    std::string tag;
    std::string text;  ///< unpacked where the tag is
};

struct DeviceProfile {
    std::string name;              ///< of the file, for messages
    std::string device_class;      ///< signature: "prtr" of a printer
    std::string colour_space;      ///< signature: "CMYK", "6CLR"
    std::string connection_space;  ///< signature: "Lab " or "XYZ "
    std::string description;       ///< printable
    std::uint32_t channels = 0;    ///< of the colour space; 0: not known
    DeviceTable table = DeviceTable::none;
    std::array<double, 3> media_white{};  ///< XYZ, a perfect diffuser under D50 has Y = 1
    std::vector<MeasurementText> measurements;

    std::vector<double> samples;       ///< `channels` values each, from 0 to 1 (all of a channel)
    std::vector<double> lab_relative;  ///< CIELAB (D50) of each sample, relative to the white of the medium
    std::vector<double> lab_absolute;  ///< relative to a perfect diffuser (ICC-absolute)
};

/// Says for which samples colours are wanted, once all that is above them is known; what it throws ends the reading.
using ChooseSamples = std::function<std::vector<double>(const DeviceProfile& profile)>;

/// At most 64 MB. Throws FileError, ResourceError, Cancelled, InputError: no ICC profile, cut short, damaged, a table
/// that cannot be used.
[[nodiscard]] DeviceProfile read_device_profile(const std::filesystem::path& file, const ChooseSamples& choose,
                                                const Progress* progress = nullptr);

inline constexpr std::uint64_t most_device_profile_bytes = std::uint64_t{64} << 20;

/// To bytes and back, on one machine. Unpacking throws InputError where sizes do not agree or numbers are not finite.
[[nodiscard]] std::vector<std::byte> pack(const DeviceProfile& profile);
[[nodiscard]] DeviceProfile unpack_device_profile(std::span<const std::byte> bytes);

}  // namespace voxtone::io
