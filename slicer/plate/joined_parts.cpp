// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/plate/joined_parts.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "base/warning.h"
#include "io/files/sha256.h"
#include "io/layers/stack_folder.h"
#include "slicer/mesh/disjoint_sets.h"
#include "slicer/mesh/mesh_gap.h"
#include "slicer/options/option_table.h"
#include "slicer/part/joined_body.h"
#include "slicer/plans/job_names.h"
#include "slicer/plate/part_outline.h"
#include "slicer/solid/solid.h"

namespace voxtone::slicer {

namespace {

using Place = std::array<int, 3>;

struct Copy {
    std::size_t part;
    Place at;
    int tray = 0;
    friend auto operator<=>(const Copy&, const Copy&) = default;
};

Place operator-(const Place& a, const Place& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

std::vector<Copy> copies_of(const std::vector<ReadyPart>& parts) {
    std::vector<Copy> copies;
    for (std::size_t p = 0; p < parts.size(); ++p)
        for (const PlacedCopy& copy : parts[p].copies) copies.push_back({p, copy.at, copy.tray});
    return copies;
}

/// Whether copies of two parts, the second so many voxels from the first, are near each other.
class Nearness {
public:
    explicit Nearness(const std::vector<ReadyPart>& parts) : parts_(parts) {}

    bool operator()(const Copy& a, const Copy& b) {
        if (a.tray != b.tray) return false;
        const auto [entry, is_new] = known_.try_emplace({a.part, b.part, b.at - a.at});
        if (is_new) entry->second = measure(a, b);
        return entry->second;
    }

private:
    [[nodiscard]] bool measure(const Copy& a, const Copy& b) const {
        const VoxelGrid &first_grid = parts_[a.part].grid(), &second_grid = parts_[b.part].grid();
        const Eigen::Vector3d& pitch = first_grid.pitch_mm;
        // Places are whole voxels: what was asked to lie this far apart may lie a voxel nearer.
        const double mm = near_mm - pitch.maxCoeff();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const int apart = std::max(b.at[axis] - a.at[axis] - first_grid.size[axis],
                                       a.at[axis] - b.at[axis] - second_grid.size[axis]);
            if (apart * pitch[static_cast<Eigen::Index>(axis)] >= mm) return false;
        }
        // What has no mesh is as near as its box.
        if (!parts_[a.part].ready || !parts_[b.part].ready) return true;
        const JobBody &first = parts_[a.part].ready->body, &second = parts_[b.part].ready->body;
        const Place between = b.at - a.at;
        const Eigen::Vector3d shift = Eigen::Vector3d(between[0], between[1], between[2]).cwiseProduct(pitch) +
                                      first.grid.origin_mm - second.grid.origin_mm;
        return nearer_than(first.solid.tree(), second.solid.tree(), shift, mm);
    }

    const std::vector<ReadyPart>& parts_;
    std::map<std::tuple<std::size_t, std::size_t, Place>, bool> known_;
};

/// A part's options without what places its model, which a body that is there has behind it.
SliceOptions without_placement(const ReadyPart& part) {
    SliceOptions options = part.ready->job.options.raw;
    const SliceOptions usual;
    options.unit = usual.unit, options.scale = usual.scale, options.size_mm = usual.size_mm;
    options.rotate = usual.rotate;
    options.flip_x = options.flip_y = options.swap_xy = false;
    return options;
}

/// What decides the look of a part beside its model and how that stands.
std::string look_of(const ReadyPart& part) {
    if (part.component) return {};
    SliceOptions options = without_placement(part);
    options.repair = SliceOptions{}.repair;
    return deciding_lines(options, Decides::looks);
}

/// Nobody asked how it will look.
bool is_plain(const ReadyPart& part) {
    return part.component && (part.part.component->is_shape() || part.part.component->kind == ComponentKind::body);
}

/// Why a copy of this part is not joined with others; empty: it may be.
std::string why_alone(const ReadyPart& part) {
    if (part.component) return "is a component";
    if (part.part.cuts) return "cuts";
    if (part.ready->body.is_picture) return "is a picture";
    // Texture coordinates of others are others'.
    if (std::ranges::any_of(part.ready->body.model.mesh.decals, &io::Decal::by_uv)) return "has marks on its texture";
    return {};
}

std::string names_of(const std::vector<ReadyPart>& parts, const std::vector<Copy>& copies) {
    std::map<std::size_t, int> times;
    for (const Copy& copy : copies) ++times[copy.part];
    std::vector<std::string> names;
    for (const auto& [part, count] : times)
        names.push_back(count == 1 ? parts[part].part.name : fmt::format("{} of {}", count, parts[part].part.name));
    return fmt::format("{}", fmt::join(names, " and "));
}

std::string identity_of(const std::vector<ReadyPart>& parts, const std::vector<Copy>& kind) {
    std::string text = "voxtone joined parts 1\n";
    for (const Copy& copy : kind)
        text += fmt::format("{} {} {} {}\n", parts[copy.part].ready->identity.job, copy.at[0], copy.at[1], copy.at[2]);
    return io::sha256({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

/// Of the folder: the names of what is in it, and which arrangement of it that is, so that a loop which was interrupted
/// goes on in the arrangement in which it began and in no other.
std::string folder_name(const std::vector<ReadyPart>& parts, const std::vector<Copy>& kind, std::string_view identity) {
    std::set<std::size_t> members;
    for (const Copy& copy : kind) members.insert(copy.part);
    std::vector<std::string> names;
    for (const std::size_t member : members) names.push_back(parts[member].part.name);
    return fmt::format("{}-{:.6}", name_after(fmt::format("{}", fmt::join(names, "+"))), identity);
}

SliceOptions options_of(const ReadyPart& first, const std::filesystem::path& folder) {
    SliceOptions options = without_placement(first);
    options.out = folder.string();
    options.mixtures.clear();
    options.resume = false;
    return options;
}

/// What more than one of the bodies fills. The joined part has core resin there; told, as it may not be meant.
double shared_mm3(const std::vector<ReadyPart>& parts, const std::vector<Copy>& kind, const JobBody& whole,
                  Progress& progress) {
    std::map<std::size_t, std::uint64_t> known;
    std::uint64_t sum = 0;
    for (const Copy& copy : kind) {
        const auto [entry, is_new] = known.try_emplace(copy.part);
        if (is_new) entry->second = voxels_of(parts[copy.part].ready->body);
        sum += entry->second;
    }
    const std::uint64_t together = voxels_of(whole);
    const double mm3 = sum > together ? double(sum - together) * whole.grid.voxel_volume_mm3() : 0;
    // A voxel here and there is how a common wall falls on the grid.
    if (mm3 > 0.01) progress.note(fmt::format("{} overlap: {:.1f} mm3 are in more than one of them", whole.name, mm3));
    return mm3;
}

/// `kind`: copies from the corner of their box.
ReadyPart join(const std::vector<ReadyPart>& parts, const std::vector<Copy>& kind, const std::filesystem::path& out,
               Progress& progress) {
    std::vector<BodyAt> bodies;
    for (const Copy& copy : kind) bodies.push_back({&parts[copy.part].ready->body, copy.at});
    ReadyPart joined;
    const std::string identity = identity_of(parts, kind);
    joined.part.name = folder_name(parts, kind, identity);
    joined.part.priority = parts[kind[0].part].part.priority;
    for (const Copy& copy : kind) joined.part.priority = std::max(joined.part.priority, parts[copy.part].part.priority);
    JobBody body = join_bodies(bodies, progress);
    body.name = names_of(parts, kind);
    body.side_files.push_back({"parts", identity});
    joined.shared_mm3 = shared_mm3(parts, kind, body, progress);
    joined.ready = make_ready(open_job(options_of(parts[kind[0].part], out / io::parts_name / joined.part.name)),
                              std::move(body), progress);
    joined.is_joined = true;
    return joined;
}

/// Warns of neighbours that are not joined, once for each two parts.
void warn_of(const ReadyPart& a, const ReadyPart& b, std::set<std::string>& said, Progress& progress) {
    const std::string &first = a.part.name, &second = b.part.name;
    std::string why = why_alone(a).empty() ? why_alone(b) : why_alone(a);
    const std::string who = why_alone(a).empty() ? second : first;
    why = why.empty() ? "their options differ" : fmt::format("{} {}", who, why);
    const std::string sentence = fmt::format(
        "{} and {} lie within {:g} mm of each other, and light that passes between them is not predicted "
        "({}): their edges there may look otherwise than asked",
        first, second, near_mm, why);
    if (said.insert(sentence).second) progress.warn(named_warning("neighbours", sentence));
}

}  // namespace

void join_near_parts(std::vector<ReadyPart>& parts, const std::filesystem::path& out, Progress& progress) {
    const std::vector<Copy> copies = copies_of(parts);
    DisjointSets sets(copies.size());
    Nearness near(parts);
    std::vector<std::string> look;
    for (const ReadyPart& part : parts) look.push_back(look_of(part));
    std::set<std::string> said;
    for (std::size_t a = 0; a < copies.size(); ++a)
        for (std::size_t b = a + 1; b < copies.size(); ++b) {
            const ReadyPart &first = parts[copies[a].part], &second = parts[copies[b].part];
            if (is_plain(first) && is_plain(second)) continue;
            if (!near(copies[a], copies[b])) continue;
            if (why_alone(first).empty() && why_alone(second).empty() && look[copies[a].part] == look[copies[b].part])
                sets.unite(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
            else
                warn_of(first, second, said, progress);
        }
    std::map<std::uint32_t, std::vector<Copy>> groups;
    for (std::size_t c = 0; c < copies.size(); ++c)
        groups[sets.root(static_cast<std::uint32_t>(c))].push_back(copies[c]);

    for (ReadyPart& part : parts) part.alone.clear();
    std::map<std::vector<Copy>, std::size_t> kinds;  // the part that each has become
    for (auto& [root, group] : groups) {
        if (group.size() == 1) {
            parts[group[0].part].alone.push_back({group[0].at, group[0].tray});
            continue;
        }
        Place low = group[0].at;
        for (const Copy& copy : group)
            for (std::size_t axis = 0; axis < 3; ++axis) low[axis] = std::min(low[axis], copy.at[axis]);
        const PlacedCopy place{low, group[0].tray};
        for (Copy& copy : group) copy = {copy.part, copy.at - low};
        std::ranges::sort(group);
        const auto [kind, is_new] = kinds.try_emplace(group, parts.size());
        if (is_new) {
            progress.note(fmt::format("{} lie within {:g} mm of each other: they are looped and predicted as one body",
                                      names_of(parts, group), near_mm));
            parts.push_back(join(parts, group, out, progress));
        }
        parts[kind->second].copies.push_back(place);
        parts[kind->second].alone.push_back(place);
    }
}

}  // namespace voxtone::slicer
