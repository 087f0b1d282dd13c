// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/layers/stack_reader.h"

#include <algorithm>
#include <mutex>

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "io/files/isolate.h"
#include "io/files/sandbox.h"
#include "io/layers/stack_folder.h"
#include "io/programs/helper_program.h"

namespace voxtone::io {

namespace {

namespace fs = std::filesystem;

/// What the stack's programs may read: the folder or the container.
std::string place_of(const fs::path& path) {
    if (path.filename() != fs::path(manifest_name)) return path.string();
    return path.has_parent_path() ? path.parent_path().string() : ".";
}

LayerScan whole(LayerInspection found) {
    if (!found.fault.empty()) throw InputError(found.fault);
    return std::move(found.scan);
}

}  // namespace

struct StackReader::State {
    explicit State(const fs::path& stack) : path(stack) {
        auto program = start();
        listing = unpack_listing(program->result());
        missing_walls = program->missing_walls();
        idle.push_back(std::move(program));
    }

    [[nodiscard]] std::unique_ptr<IsolatedProgram> start() const {
        IsolationLimits limits{.readable = {place_of(path)}};
        if (built_with_address_sanitizer()) limits.memory_bytes = 0;
        return std::make_unique<IsolatedProgram>(path.string(), find_helper("voxtone-read"), pack_stack_request(path),
                                                 limits);
    }
    /// A program that has the stack open and nothing to do.
    std::unique_ptr<IsolatedProgram> borrow() {
        {
            const std::scoped_lock lock(mutex);
            if (!idle.empty()) {
                auto program = std::move(idle.back());
                idle.pop_back();
                return program;
            }
        }
        auto program = start();
        (void)program->result();  // the listing once more
        return program;
    }
    void give_back(std::unique_ptr<IsolatedProgram> program) {
        const std::scoped_lock lock(mutex);
        idle.push_back(std::move(program));
    }

    fs::path path;
    StackListing listing;
    std::uint8_t missing_walls = 0;
    std::mutex mutex;
    std::vector<std::unique_ptr<IsolatedProgram>> idle;
};

StackReader::StackReader(const fs::path& path) : state_(std::make_unique<State>(path)) {}
StackReader::~StackReader() = default;
StackReader::StackReader(StackReader&&) noexcept = default;
StackReader& StackReader::operator=(StackReader&&) noexcept = default;

StackReader::Kind StackReader::kind() const { return state_->listing.kind; }
const std::optional<StackDescription>& StackReader::description() const { return state_->listing.description; }
ManifestSeal StackReader::seal() const { return state_->listing.seal; }
const StackOrigin& StackReader::origin() const { return state_->listing.origin; }
const std::optional<std::string>& StackReader::sheet() const { return state_->listing.sheet; }
const std::optional<GcvfConfig>& StackReader::gcvf() const { return state_->listing.gcvf; }
const std::optional<Orientation>& StackReader::orientation() const { return state_->listing.orientation; }
std::uint32_t StackReader::layers() const { return static_cast<std::uint32_t>(state_->listing.names.size()); }
const std::string& StackReader::layer_name(std::uint32_t index) const { return state_->listing.names.at(index); }
const std::vector<std::string>& StackReader::strangers() const { return state_->listing.strangers; }
const std::vector<std::string>& StackReader::missing() const { return state_->listing.missing; }
std::uint64_t StackReader::missing_count() const { return state_->listing.missing_count; }
std::string StackReader::untold_note() const { return told_walls().note(state_->missing_walls); }

LayerInspection StackReader::inspect(std::uint32_t index, std::span<const Rgb> palette,
                                     const OtherPixels& others) const {
    auto program = state_->borrow();
    program->post_request(pack(LayerRequest{index, {palette.begin(), palette.end()}, others}));
    LayerInspection found =
        unpack_inspection(program->result(), palette.size() + (others.transparent == palette.size()));
    state_->give_back(std::move(program));  // one that failed is not used again
    return found;
}

bool StackReader::has_zbuffer() const { return state_->listing.has_zbuffer; }
std::array<std::uint64_t, 2> StackReader::preview_bytes() const { return state_->listing.preview_bytes; }

std::optional<ZbufferInspection> StackReader::zbuffer() const {
    if (!has_zbuffer()) return std::nullopt;
    auto program = state_->borrow();
    program->post_request(pack_zbuffer_request());
    ZbufferInspection found = unpack_zbuffer(program->result());
    state_->give_back(std::move(program));
    return found;
}

LayerRuns StackReader::read(std::uint32_t index, std::span<const Rgb> palette, const OtherPixels& others) const {
    const std::string& name = layer_name(index);
    LayerScan scan = whole(inspect(index, palette, others));
    if (scan.runs) return std::move(*scan.runs);
    for (const auto& colour : scan.colours) {
        const bool known = std::any_of(palette.begin(), palette.end(), [&](const Rgb& c) {
            return Rgba{c[0], c[1], c[2], 255} == colour.rgba;
        });
        if (!known)
            throw InputError(fmt::format(
                "{}: pixel ({}, {}) has the colour {} {} {} with alpha {}, which stands for no resin", name,
                colour.first_x, colour.first_y, colour.rgba[0], colour.rgba[1], colour.rgba[2], colour.rgba[3]));
    }
    throw InputError(
        fmt::format("{}: has more than {} colours; a layer has one per resin", name, LayerScan::most_colours));
}

std::vector<Rgb> StackReader::palette() const {
    if (description()) return description()->palette();
    std::vector<Rgb> result;
    if (gcvf()) {
        const auto& b = gcvf()->background;
        result.push_back({b[0], b[1], b[2]});
        for (const auto& m : gcvf()->materials) result.push_back({m.rgba[0], m.rgba[1], m.rgba[2]});
    } else {
        std::vector<std::vector<Rgb>> found(layers());
        parallel_for(0, layers(), 1, [&](std::size_t k) {
            const auto index = static_cast<std::uint32_t>(k);
            for (const auto& colour : whole(inspect(index, {})).colours)
                if (colour.rgba[3] > 0) found[k].push_back({colour.rgba[0], colour.rgba[1], colour.rgba[2]});
        });
        result.push_back({0, 0, 0});
        for (const auto& colours : found)
            for (const auto& colour : colours)
                if (std::find(result.begin(), result.end(), colour) == result.end()) {
                    if (result.size() >= max_materials)
                        throw InputError(
                            fmt::format("{}: its layers have more than {} colours; a stack has one per resin",
                                        state_->path.string(), max_materials));
                    result.push_back(colour);
                }
    }
    if (result.size() > max_materials)
        throw InputError(fmt::format("{}: names {} materials, more than the {} that a stack can have",
                                     state_->path.string(), result.size() - 1, max_materials - 1));
    return result;
}

}  // namespace voxtone::io
