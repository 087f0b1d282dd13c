// SPDX-License-Identifier: GPL-3.0-or-later
#include "traced.h"

#include <cstring>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/files/sha256.h"
#include "io/files/whole_file.h"
#include "io/files/xxh64.h"
#include "optics/monte_carlo/monte_carlo.h"

namespace voxtone::loop_benchmark {
namespace {

std::span<const std::uint8_t> bytes_of(const std::string& text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string describe(const optics::ResinSet& set) {
    std::string text = fmt::format("g {} eta {}\n", set.g, set.eta);
    if (set.dot_spread > 0) text += fmt::format("dot spread {}\n", set.dot_spread);
    for (const optics::Resin& r : set.resins)
        text += fmt::format("{} {} {}\n", r.role, fmt::join(r.sigma_t_per_mm, " "), fmt::join(r.albedo, " "));
    return text;
}

/// Cells and faces, in their order.
void digest_surface(const optics::Surface& surface, io::Sha256& sha) {
    for (const optics::SurfaceFace& f : surface.faces) {
        std::array<std::int32_t, 4> numbers{f.voxel[0], f.voxel[1], f.voxel[2], static_cast<std::int32_t>(f.facing)};
        sha.update({reinterpret_cast<const std::uint8_t*>(numbers.data()), sizeof numbers});
    }
    for (const optics::SurfaceCell& c : surface.cells) {
        const std::array<std::uint32_t, 2> numbers{c.first_face, c.faces};
        sha.update({reinterpret_cast<const std::uint8_t*>(numbers.data()), sizeof numbers});
    }
}

}  // namespace

std::string volume_digest(const optics::ResinVolume& volume) {
    io::Sha256 sha;
    const auto& size = volume.size();
    const auto& pitch = volume.pitch_mm();
    sha.update(bytes_of(fmt::format("{} pitch {}\n", fmt::join(size, " "), fmt::join(pitch, " "))));
    std::vector<optics::Material> layer(static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]));
    for (int z = 0; z < size[2]; ++z) {
        volume.copy_box({0, 0, z}, {size[0], size[1], 1}, layer);
        const std::uint64_t digest = io::xxh64(layer);  // SHA-256 of a billion voxels takes longer than some traces
        sha.update({reinterpret_cast<const std::uint8_t*>(&digest), sizeof digest});
    }
    return sha.finish();
}

std::vector<float> traced(const optics::Scene& scene, const std::string& digest, const optics::Surface& surface,
                          const Tracing& how, const std::filesystem::path& cache) {
    io::Sha256 sha;
    sha.update(bytes_of(fmt::format("traced 1 {} backing {} sides {} boundary {} paths {} seed {}\n{}", digest,
                                    static_cast<int>(scene.backing), static_cast<int>(scene.sides), how.boundary_name,
                                    how.paths, how.seed, describe(*scene.resins))));
    digest_surface(surface, sha);
    const std::filesystem::path file = cache / (sha.finish().substr(0, 32) + ".f32");
    const std::size_t count = surface.cells.size() * scene.resins->channels.size();
    std::vector<float> value(count);
    if (std::filesystem::exists(file) && std::filesystem::file_size(file) == count * sizeof(float)) {
        const auto bytes = io::read_whole_file(file, count * sizeof(float));
        std::memcpy(value.data(), bytes.data(), bytes.size());
        return value;
    }
    optics::MonteCarloOptions options;
    options.paths = how.paths;
    options.seed = how.seed;
    options.boundary = how.boundary;
    value = optics::MonteCarlo(options).predict(scene, surface).value;
    std::filesystem::create_directories(cache);
    io::write_whole_file(file, std::span(reinterpret_cast<const std::uint8_t*>(value.data()), count * sizeof(float)));
    return value;
}

}  // namespace voxtone::loop_benchmark
