// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/layers/part_rows.h"

#include <algorithm>

namespace voxtone::slicer {

PartRows::PartRows(std::span<const PartInLayer> parts, int width) : width_(width) {
    for (const PartInLayer& part : parts)
        parts_.push_back({&part, io::LayerRuns(static_cast<std::uint32_t>(part.width), 1)});
    std::ranges::stable_sort(parts_, {}, [](const Part& part) { return part.standing->left(); });
}

bool PartRows::are_apart(int j) {
    here_.clear();
    for (Part& part : parts_)
        if (part.standing->reaches(j)) here_.push_back(&part);
    boxes_are_apart_ = true;
    for (std::size_t p = 1; p < here_.size(); ++p)
        boxes_are_apart_ = boxes_are_apart_ && here_[p]->standing->left() >= here_[p - 1]->standing->right();
    if (boxes_are_apart_) return true;
    find_stretches(j);
    for (std::size_t s = 1; s < stretches_.size(); ++s)
        if (stretches_[s].begin < stretches_[s - 1].end) return false;
    return true;
}

void PartRows::find_stretches(int j) {
    stretches_.clear();
    for (Part* part : here_) {
        part->row.clear();
        part->standing->push_row(j, part->row);
        part->row.end_row();
        const std::span<const io::Run> runs = part->row.row(0);
        int i = part->standing->left();
        for (std::size_t r = 0; r < runs.size();) {
            const std::size_t first = r;
            const int begin = i;
            for (; r < runs.size() && runs[r].material != io::background; ++r) i += runs[r].length;
            if (r > first) stretches_.push_back({begin, i, runs.subspan(first, r - first), part->standing->cuts});
            if (r < runs.size()) i += runs[r++].length;
        }
    }
    std::ranges::sort(stretches_, {}, &Stretch::begin);
}

void PartRows::push_boxes(int j, io::LayerRuns& out) const {
    int i = 0;
    for (const Part* part : here_) {
        const PartInLayer& standing = *part->standing;
        out.push(static_cast<std::uint32_t>(standing.left() - i), io::background);
        if (standing.cuts)
            out.push(static_cast<std::uint32_t>(standing.width), io::background);
        else
            standing.push_row(j, out);
        i = standing.right();
    }
    out.push(static_cast<std::uint32_t>(width_ - i), io::background);
    out.end_row();
}

void PartRows::push(int j, io::LayerRuns& out) const {
    if (boxes_are_apart_) return push_boxes(j, out);
    int i = 0;
    for (const Stretch& stretch : stretches_) {
        out.push(static_cast<std::uint32_t>(stretch.begin - i), io::background);
        i = stretch.end;
        if (stretch.cuts)
            out.push(static_cast<std::uint32_t>(stretch.end - stretch.begin), io::background);
        else
            for (const io::Run& run : stretch.runs) out.push(run.length, static_cast<io::Material>(run.material));
    }
    out.push(static_cast<std::uint32_t>(width_ - i), io::background);
    out.end_row();
}

void OverlaidRow::lay(std::span<const PartInLayer> parts, int j, std::vector<Overlap>& lost) {
    std::fill(material_.begin(), material_.end(), io::background);
    std::fill(owner_.begin(), owner_.end(), nullptr);
    for (const PartInLayer& part : parts) {
        if (!part.reaches(j)) continue;
        io::LayerRuns row(static_cast<std::uint32_t>(part.width), 1);
        part.push_row(j, row);
        row.end_row();
        auto i = static_cast<std::size_t>(part.left());
        for (const io::Run& run : row.row(0)) {
            if (run.material != io::background) take(part, i, i + run.length, run.material, lost);
            i += run.length;
        }
    }
}

void OverlaidRow::push(io::LayerRuns& out) const {
    for (const io::Material material : material_) out.push(1, material);
    out.end_row();
}

void OverlaidRow::take(const PartInLayer& part, std::size_t begin, std::size_t end, std::uint16_t material,
                       std::vector<Overlap>& lost) {
    for (std::size_t i = begin; i < end; ++i) {
        if (const PartInLayer* const owner = owner_[i]) {
            Overlap& overlap = lost[owner->part];
            ++overlap.voxels;
            if (owner->priority == part.priority && !part.cuts) ++overlap.to_equals;
        }
        owner_[i] = &part;
        material_[i] = part.cuts ? io::background : static_cast<io::Material>(material);
    }
}

}  // namespace voxtone::slicer
