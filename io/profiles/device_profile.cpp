// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/profiles/device_profile.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "io/files/file_reader.h"
#include "io/files/packed_values.h"

namespace voxtone::io {

namespace {

constexpr double most_profile_seconds = 60;
constexpr std::uint64_t most_profile_memory = std::uint64_t{1} << 30;

bool all_finite(std::span<const double> values) {
    return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

}  // namespace

template <class Stream, class Text>
requires std::is_same_v<std::remove_const_t<Text>, MeasurementText>
void describe(Stream& stream, Text& t) { stream(t.tag, t.text); }

template <class Stream, class Profile>
requires std::is_same_v<std::remove_const_t<Profile>, DeviceProfile>
void describe(Stream& stream, Profile& p) {
    stream(p.name, p.device_class, p.colour_space, p.connection_space, p.description, p.channels, p.table,
           p.media_white, p.measurements, p.samples, p.lab_relative, p.lab_absolute);
}

std::vector<std::byte> pack(const DeviceProfile& profile) { return packed(profile); }

DeviceProfile unpack_device_profile(std::span<const std::byte> bytes) {
    auto profile = unpacked<DeviceProfile>(bytes);
    const std::size_t colours = profile.channels == 0 ? 0 : profile.samples.size() / profile.channels;
    if (profile.table > DeviceTable::colorimetric || profile.samples.size() != colours * profile.channels ||
        profile.lab_relative.size() != 3 * colours || profile.lab_absolute.size() != 3 * colours)
        throw InputError("what the reader left is no device profile: it has other colours than were asked for");
    if (!all_finite(profile.media_white) || !all_finite(profile.samples) || !all_finite(profile.lab_relative) ||
        !all_finite(profile.lab_absolute))
        throw InputError(fmt::format("{}: its table gives colours that are no numbers; it is damaged", profile.name));
    return profile;
}

DeviceProfile read_device_profile(const std::filesystem::path& file, const ChooseSamples& choose,
                                  const Progress* progress) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error))
        throw FileError(fmt::format("the profile {} is not there or is no file", file.string()));
    ReadRequest request{
        .kind = ReadKind::device_profile, .path = file.string(), .max_file_bytes = most_device_profile_bytes};
    const auto reader =
        start_reader(file.string(), request, {.memory_bytes = most_profile_memory, .timeout_s = most_profile_seconds});
    const DeviceProfile profile = unpack_device_profile(reader->result(progress));
    request.samples = choose(profile);
    reader->post_request(pack(request));
    DeviceProfile answer = unpack_device_profile(reader->result(progress));
    if (answer.samples != request.samples)
        throw InputError("what the reader left is no device profile: it has other colours than were asked for");
    return answer;
}

}  // namespace voxtone::io
