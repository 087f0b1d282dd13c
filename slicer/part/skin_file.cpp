// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/skin_file.h"

#include <algorithm>
#include <array>
#include <span>
#include <type_traits>
#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/deflate.h"
#include "io/programs/build_identity.h"

namespace voxtone::slicer {

namespace {

constexpr std::string_view of_another_job =
    "is what the appearance loop of another job came to (another model, other options that decide its colours, or "
    "another version of this program); take another folder, or make it anew: slice --until loop --overwrite";
constexpr ArtefactKind skin_kind{
    "voxtone-skin", 3,
    "is broken and holds no result of an appearance loop; make it again: slice --until loop --overwrite",
    of_another_job, of_another_job};

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
    stream(state.steps, state.open, state.shown, state.white, result.last_look, result.in_gamut, result.why_stopped,
           result.remarks);
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
    return digest_of_text(fmt::format("{}\niterations={}\nvoxtone {}\n", identity, length, io::build_identity()));
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
           of_all(state.open) && of_all(state.shown) && state.white.size() % cells == 0 &&
           (skin.result.last_look.empty() || of_all(skin.result.last_look)) && of_all(skin.result.in_gamut) &&
           !state.steps.empty() && state.best < state.steps.size() &&
           (skin.mixtures.empty() || skin.mixtures.size() == cells * layers) &&
           std::all_of(skin.surface.cells.begin(), skin.surface.cells.end(), [](const optics::SurfaceCell& cell) {
               return std::all_of(cell.cell.begin(), cell.cell.end(),
                                  [](std::int32_t at) { return at >= 0 && at < most_cells; });
           });
}

}  // namespace

SkinFile::SkinFile(std::filesystem::path file, std::string_view opened_identity, std::string_view loop_identity,
                   const JobLoopOptions& loop)
    : file_(std::move(file), skin_kind),
      asked_{digest_of_job(opened_identity, length_of(loop)), digest_of_job(loop_identity, length_of(loop))},
      settled_{digest_of_job(opened_identity, settled_length_of(loop)),
               digest_of_job(loop_identity, settled_length_of(loop))} {}

bool SkinFile::is_of_this_job() const {
    try {
        const std::optional<ArtefactKey> key = file_.key();
        return key == asked_ || key == settled_;
    } catch (const InputError&) {
        return false;
    }
}

void SkinFile::write(const SavedSkin& skin) const {
    constexpr int quick_and_small = 3;
    io::PackedWriter values;
    skin_in(values, skin);
    file_.write(has_settled(skin) ? settled_ : asked_, [&](io::PackedWriter& to) {
        to(std::uint64_t{values.bytes.size()});
        to.add(io::deflated(values.bytes, quick_and_small));
    });
}

SavedSkin SkinFile::read(std::size_t layers) const {
    const Artefact::Content content = file_.read(std::array{asked_, settled_});
    SavedSkin skin;
    try {
        std::uint64_t size = 0;
        io::PackedReader(content.values)(size);
        const std::vector<std::byte> values = io::inflated(content.values.subspan(sizeof size), size);
        io::PackedReader reader(values);
        skin_in(reader, skin);
        reader.expect_end();
    } catch (const InputError&) {
        file_.fail_broken();
    }
    if (!fits_together(skin, layers)) file_.fail_broken();
    return skin;
}

void SkinFile::expect_same_job(const std::filesystem::path& file, std::string_view opened_identity,
                               const JobLoopOptions& loop) {
    const SkinFile own(file, opened_identity, {}, loop);
    const std::optional<ArtefactKey> key = own.file_.key();
    if (key && key->opened != own.asked_.opened && key->opened != own.settled_.opened) own.file_.fail_foreign();
}

}  // namespace voxtone::slicer
