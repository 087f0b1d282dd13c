// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/skin_file.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <span>
#include <system_error>
#include <type_traits>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/deflate.h"
#include "io/files/packed_values.h"
#include "io/files/whole_file.h"
#include "io/files/xxh64.h"
#include "io/programs/build_identity.h"

namespace voxtone::slicer {

namespace {

constexpr std::string_view skin_magic = "voxtone-skin 1\n", any_skin_magic = "voxtone-skin ";  // of any version
/// Two digests of the job and the size of what was deflated come after the magic.
constexpr std::size_t number_size = sizeof(std::uint64_t), skin_head_size = skin_magic.size() + 3 * number_size;

/// All parts, for writing and reading alike.
template <class Stream, class Skin>
void skin_in(Stream& stream, Skin& skin) {
    static_assert(std::is_trivially_copyable_v<halftone::LoopStep> &&
                  std::is_trivially_copyable_v<optics::SurfaceCell>);
    auto& result = skin.result;
    auto& state = result.state;
    stream(skin.left_out, skin.model, skin.seconds, skin.surface.cell_voxels, skin.surface.cells, skin.target,
           skin.cell_um, skin.mixtures);
    auto best = std::uint64_t(state.best);
    stream(best);
    if constexpr (!std::is_const_v<Skin>) state.best = std::size_t(best);
    stream(state.steps, state.open, state.shown, result.in_gamut, result.why_stopped, result.remarks);
}

/// A loop without a limit ends where it gains no more: `auto` and `long` differ from where the first ends all the same.
constexpr std::string_view settled = "settled";

std::string length_of(const JobLoopOptions& loop) {
    return loop.iterations ? std::to_string(*loop.iterations) : loop.patient ? "long" : "auto";
}

std::string settled_length_of(const JobLoopOptions& loop) {
    return loop.iterations ? length_of(loop) : std::string(settled);
}

bool has_settled(const SavedSkin& skin) {
    return skin.result.state.steps.size() <= std::size_t(halftone::most_iterations);  // the first is the open loop
}

std::uint64_t digest_of_job(std::string_view identity, std::string_view length) {
    const std::string text = fmt::format("{}\niterations={}\nvoxtone {}\n", identity, length, io::build_identity());
    return io::xxh64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::uint64_t number_in(std::span<const std::uint8_t> bytes, std::size_t index) {
    std::uint64_t number = 0;
    std::memcpy(&number, bytes.data() + skin_magic.size() + index * number_size, number_size);
    return number;
}

[[noreturn]] void fail_broken(const std::filesystem::path& file) {
    throw FileError(fmt::format(
        "{}: is broken and holds no result of an appearance loop; make it again: slice --until loop --overwrite",
        file.string()));
}

[[noreturn]] void fail_foreign(const std::filesystem::path& file) {
    throw InputError(fmt::format(
        "{}: is what the appearance loop of another job came to (another model, other options that decide its colours, "
        "or another version of this program); take another folder, or make it anew: slice --until loop --overwrite",
        file.string()));
}

bool starts(std::span<const std::uint8_t> bytes, std::string_view text) {
    return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

void check_skin_head(const std::filesystem::path& file, std::span<const std::uint8_t> begin) {
    if (starts(begin, any_skin_magic) && !starts(begin, skin_magic)) fail_foreign(file);
    if (!starts(begin, skin_magic) || begin.size() < skin_head_size) fail_broken(file);
}

std::vector<std::uint8_t> head_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::vector<std::uint8_t> head(skin_head_size);
    in.read(reinterpret_cast<char*>(head.data()), std::streamsize(head.size()));
    head.resize(std::size_t(in.gcount()));
    check_skin_head(file, head);
    return head;
}

/// What is read goes into lists that are looked up without asking.
bool fits_together(const SavedSkin& skin, std::size_t layers) {
    const std::size_t cells = skin.surface.cells.size();
    const halftone::LoopState& state = skin.result.state;
    if (!skin.left_out.empty()) return cells == 0 && skin.mixtures.empty();
    const auto& edges = skin.surface.cell_voxels;
    const auto of_all = [&](const auto& list) { return list.size() == cells; };
    constexpr std::int32_t most_cells = 1 << 24;
    return cells > 0 && *std::min_element(edges.begin(), edges.end()) > 0 && of_all(skin.target) &&
           of_all(state.open) && of_all(state.shown) && of_all(skin.result.in_gamut) && !state.steps.empty() &&
           state.best < state.steps.size() && (skin.mixtures.empty() || skin.mixtures.size() == cells * layers) &&
           std::all_of(skin.surface.cells.begin(), skin.surface.cells.end(), [](const optics::SurfaceCell& cell) {
               return std::all_of(cell.cell.begin(), cell.cell.end(),
                                  [](std::int32_t at) { return at >= 0 && at < most_cells; });
           });
}

}  // namespace

SkinFile::SkinFile(std::filesystem::path file, std::string_view opened_identity, std::string_view loop_identity,
                   const JobLoopOptions& loop)
    : file_(std::move(file)),
      asked_{digest_of_job(opened_identity, length_of(loop)), digest_of_job(loop_identity, length_of(loop))},
      settled_{digest_of_job(opened_identity, settled_length_of(loop)),
               digest_of_job(loop_identity, settled_length_of(loop))} {}

bool SkinFile::exists() const {
    std::error_code none;
    return std::filesystem::exists(file_, none);
}

bool SkinFile::is_of_this_job() const {
    try {
        const std::vector<std::uint8_t> head = head_of(file_);
        return is_ours({number_in(head, 0), number_in(head, 1)});
    } catch (const InputError&) {
        return false;
    }
}

void SkinFile::write(const SavedSkin& skin) const {
    constexpr int quick_and_small = 3;
    io::PackedWriter values;
    skin_in(values, skin);
    std::vector<std::uint8_t> file(skin_magic.begin(), skin_magic.end());
    const auto put = [&](const void* data, std::size_t size) {
        const auto* const bytes = static_cast<const std::uint8_t*>(data);
        file.insert(file.end(), bytes, bytes + size);
    };
    const Owner& owner = has_settled(skin) ? settled_ : asked_;
    for (const std::uint64_t number : {owner.opened, owner.job, std::uint64_t{values.bytes.size()}})
        put(&number, number_size);
    const std::vector<std::byte> small = io::deflated(values.bytes, quick_and_small);
    put(small.data(), small.size());
    const std::uint64_t sum = io::xxh64(file);
    put(&sum, number_size);
    io::write_whole_file(file_, file);
}

SavedSkin SkinFile::read(std::size_t layers) const {
    constexpr std::uint64_t most = std::uint64_t{1} << 34;
    const std::vector<std::uint8_t> bytes = io::read_whole_file(file_, most);
    check_skin_head(file_, bytes);
    if (bytes.size() < skin_head_size + number_size) fail_broken(file_);
    const auto body = std::span(bytes).first(bytes.size() - number_size);
    std::uint64_t sum = 0;
    std::memcpy(&sum, bytes.data() + body.size(), number_size);
    if (io::xxh64(body) != sum) fail_broken(file_);
    if (!is_ours({number_in(bytes, 0), number_in(bytes, 1)})) fail_foreign(file_);
    SavedSkin skin;
    try {
        const std::vector<std::byte> values =
            io::inflated(std::as_bytes(body.subspan(skin_head_size)), number_in(bytes, 2));
        io::PackedReader reader(values);
        skin_in(reader, skin);
        reader.expect_end();
    } catch (const InputError&) {
        fail_broken(file_);
    }
    if (!fits_together(skin, layers)) fail_broken(file_);
    return skin;
}

void SkinFile::expect_same_job(const std::filesystem::path& file, std::string_view opened_identity,
                               const JobLoopOptions& loop) {
    if (std::error_code none; !std::filesystem::exists(file, none)) return;
    const SkinFile own(file, opened_identity, {}, loop);
    const std::uint64_t owner = number_in(head_of(file), 0);
    if (owner != own.asked_.opened && owner != own.settled_.opened) fail_foreign(file);
}

}  // namespace voxtone::slicer
