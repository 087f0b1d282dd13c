// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference_file.h"

#include <cmath>
#include <cstring>
#include <fstream>

#include <fmt/format.h>
#include <zlib.h>
#include <nlohmann/json.hpp>

#include "base/error.h"

namespace voxtone::accuracy {
namespace {

using nlohmann::json;
using Bytes = std::vector<unsigned char>;

constexpr const char* first_line = "voxtone appearance reference 1";
constexpr double largest = 2;

Bytes deflated(const Bytes& plain) {
    uLongf length = compressBound(plain.size());
    Bytes out(length);
    if (compress2(out.data(), &length, plain.data(), plain.size(), 9) != Z_OK) throw std::bad_alloc();
    out.resize(length);
    return out;
}

Bytes inflated(const Bytes& packed, std::size_t length, const std::filesystem::path& file) {
    Bytes out(length);
    uLongf got = length;
    if (uncompress(out.data(), &got, packed.data(), packed.size()) != Z_OK || got != length)
        throw FileError(file.string() + ": the reference is damaged; make it again with `predictor_accuracy make`");
    return out;
}

void append_codes(const std::vector<float>& values, Bytes& out) {
    for (const float v : values) {
        const auto code = static_cast<unsigned>(
            std::lround(65535 * std::sqrt(std::clamp(static_cast<double>(v), 0.0, largest) / largest)));
        out.push_back(static_cast<unsigned char>(code & 255));
        out.push_back(static_cast<unsigned char>(code >> 8));
    }
}

json resins_json(const optics::ResinSet& set) {
    json j{{"name", set.name}, {"g", set.g}, {"eta", set.eta}, {"resins", json::array()}};
    for (const optics::Resin& r : set.resins)
        j["resins"].push_back({{"role", r.role}, {"sigma_t", r.sigma_t_per_mm}, {"albedo", r.albedo}});
    return j;
}

optics::ResinSet resins_of(const json& j) {
    optics::ResinSet set;
    set.name = j.at("name");
    set.g = j.at("g");
    set.eta = j.at("eta");
    const json& resins = j.at("resins");
    for (const json& r : resins) {
        optics::Resin resin;
        resin.name = resin.role = r.at("role").get<std::string>();
        resin.sigma_t_per_mm = r.at("sigma_t").get<std::vector<double>>();
        resin.albedo = r.at("albedo").get<std::vector<double>>();
        set.resins.push_back(std::move(resin));
    }
    return set;
}

}  // namespace

void write_reference(const std::filesystem::path& file, const Reference& reference) {
    const SuiteCase& c = reference.of;
    const auto& size = c.volume.size();
    Bytes voxels(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                 static_cast<std::size_t>(size[2]));
    c.volume.copy_box({0, 0, 0}, size, voxels);
    Bytes values;
    for (const auto& half : reference.half) append_codes(half, values);
    for (const auto& half : reference.white) append_codes(half, values);
    const Bytes packed_voxels = deflated(voxels), packed_values = deflated(values);
    const json head{{"name", c.name},
                    {"shown", c.shown},
                    {"tuning", c.tuning},
                    {"size", size},
                    {"pitch_mm", c.volume.pitch_mm()},
                    {"backing", static_cast<int>(c.backing)},
                    {"sides", static_cast<int>(c.sides)},
                    {"part", static_cast<int>(c.part)},
                    {"symmetry", static_cast<int>(c.symmetry)},
                    {"boundary", c.boundary},
                    {"wanted_noise", c.noise},
                    {"resin_set", resins_json(c.resins)},
                    {"values_per_half", reference.half[0].size()},
                    {"white_values", reference.white[0].size()},
                    {"core_seconds", reference.core_seconds},
                    {"all_paths", reference.all_paths},
                    {"seed", reference.seed},
                    {"made", reference.made},
                    {"bytes_of_voxels", packed_voxels.size()},
                    {"bytes_of_values", packed_values.size()}};
    const std::filesystem::path part = file.string() + ".part";
    {
        std::ofstream out(part, std::ios::binary);
        out << first_line << '\n' << head.dump() << '\n';
        for (const Bytes* bytes : {&packed_voxels, &packed_values})
            out.write(reinterpret_cast<const char*>(bytes->data()), static_cast<std::streamsize>(bytes->size()));
        if (!out.flush()) throw FileError(file.string() + ": cannot be written");
    }
    std::filesystem::rename(part, file);
}

Reference read_reference(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string line, head_line;
    if (!std::getline(in, line) || line != first_line || !std::getline(in, head_line))
        throw FileError(file.string() +
                        ": not a reference of the accuracy suite; make it with `predictor_accuracy make`");
    const json head = json::parse(head_line);
    const auto packed = [&](const char* key) {
        Bytes bytes(head.at(key).get<std::size_t>());
        in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        return bytes;
    };
    const Bytes packed_voxels = packed("bytes_of_voxels"), packed_values = packed("bytes_of_values");
    Reference r;
    SuiteCase& c = r.of;
    c.name = head.at("name");
    c.shown = head.at("shown");
    c.tuning = head.at("tuning");
    c.backing = static_cast<optics::Backing>(head.at("backing").get<int>());
    c.sides = static_cast<optics::Sides>(head.at("sides").get<int>());
    c.part = static_cast<optics::SurfacePart>(head.at("part").get<int>());
    c.symmetry = static_cast<Symmetry>(head.at("symmetry").get<int>());
    c.boundary = head.at("boundary");
    c.noise = head.at("wanted_noise");
    c.resins = resins_of(head.at("resin_set"));
    r.core_seconds = head.at("core_seconds");
    r.all_paths = head.at("all_paths");
    r.seed = head.at("seed");
    r.made = head.at("made");
    const auto size = head.at("size").get<std::array<int, 3>>();
    const auto layer = static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]);
    const Bytes voxels = inflated(packed_voxels, layer * static_cast<std::size_t>(size[2]), file);
    optics::ResinVolumeBuilder builder(size, head.at("pitch_mm").get<std::array<double, 3>>());
    for (std::size_t z = 0; z < static_cast<std::size_t>(size[2]); ++z)
        builder.add_layer(std::span(voxels).subspan(z * layer, layer));
    c.volume = builder.finish();
    const std::size_t n = head.at("values_per_half"), white = head.at("white_values");
    const Bytes codes = inflated(packed_values, 4 * (n + white), file);
    std::size_t at = 0;
    const auto take = [&](std::size_t count) {
        std::vector<float> values(count);
        for (float& v : values) {
            const double code = codes[at] + 256.0 * codes[at + 1];
            v = static_cast<float>(largest * (code / 65535) * (code / 65535));
            at += 2;
        }
        return values;
    };
    for (auto& half : r.half) half = take(n);
    for (auto& half : r.white) half = take(white);
    return r;
}

}  // namespace voxtone::accuracy
