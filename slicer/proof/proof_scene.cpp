// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/proof/proof_scene.h"

#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "slicer/proof/proof_light.h"

namespace voxtone::slicer {

namespace {

using Eigen::Vector3d;

/// Bodies stand side by side in the room, on one level.
class Row {
public:
    explicit Row(const Eigen::Matrix3d& axes) : axes_(axes) {}

    /// How far the next body is moved, in the model's frame: to the `right` of those before, in the room's.
    Vector3d place(const Box& box, const Vector3d& right) {
        const Box here = turned(axes_, box);
        Vector3d moved = Vector3d::Zero();
        if (begun_) {
            const double gap = 0.12 * (here.high - here.low).maxCoeff();
            moved = middle_ - 0.5 * (here.low + here.high);
            moved.z() = all_.low.z() - here.low.z();
            for (const Eigen::Index a : {0, 1}) {
                if (right[a] > 0) moved[a] = all_.high[a] + gap - here.low[a];
                if (right[a] < 0) moved[a] = all_.low[a] - gap - here.high[a];
            }
        } else {
            all_ = here;
            middle_ = 0.5 * (here.low + here.high);
        }
        begun_ = true;
        all_ = {all_.low.cwiseMin(here.low + moved), all_.high.cwiseMax(here.high + moved)};
        return axes_.transpose() * moved;
    }
    [[nodiscard]] const Box& all() const { return all_; }

private:
    Eigen::Matrix3d axes_;
    Box all_{Vector3d::Zero(), Vector3d::Zero()};
    Vector3d middle_ = Vector3d::Zero();  ///< of the first
    bool begun_ = false;
};

}  // namespace

std::unique_ptr<const ProofScene> make_proof_scene(const ResolvedProof& job, Progress& progress) {
    auto made = std::make_unique<ProofScene>();
    ProofScene& s = *made;
    for (const ProofLamp& lamp : job.lamps) s.skies.push_back(light_of(lamp, job.requested.turn_light_deg, progress));
    const Eigen::Matrix3d axes = room_axes(job.up, job.requested.turn_deg);
    Row row(axes);
    const auto right_of = [&](const ProofPrint& first) {
        return rightward(job, first.box, axes, first.stack.of_picture);
    };
    for (const std::string& stack : job.requested.stacks) {
        auto print = make_print(job, stack, progress);
        print->moved_mm = row.place(print->box, right_of(s.prints.empty() ? *print : *s.prints.front()));
        s.prints.push_back(std::move(print));
        if (s.prints.back()->stack.resins.channels != s.channels())
            throw InputError(fmt::format("{}: its resins have other channels than those of {}; proof them apart", stack,
                                         job.requested.stacks.front()));
    }
    const ProofPrint& first = *s.prints.front();
    if (job.requested.with_target) s.target = make_target(first, row.place(first.box, right_of(first)), progress);

    s.camera.sky = &s.skies.front();
    for (std::size_t k = 0; k < 3; ++k) s.camera.sky_axes[k] = point_of(axes.row(static_cast<Eigen::Index>(k)));
    for (const auto& print : s.prints)
        s.camera.prints.push_back({&print->scene, &*print->boundary, print->finish.get(),
                                   point_of(vector_of(print->stack.corner_mm) + print->moved_mm)});
    if (job.backing.kind != optics::Backing::none)
        for (const auto& print : s.prints)
            s.sheets.push_back(std::make_unique<const SheetBehind>(
                job.backing, Box{print->box.low + print->moved_mm, print->box.high + print->moved_mm}));
    for (const auto& sheet : s.sheets) s.camera.diffusers.push_back(sheet.get());
    for (const auto& body : s.target) s.camera.diffusers.push_back(body.get());
    // What lies on the ground touches it here and there only.
    constexpr double gap_mm = 0.01;
    if (job.ground && job.view != ProofView::bottom)
        s.camera.ground =
            optics::Ground{s.camera.sky_axes[2], row.all().low.z() - gap_mm, {*job.ground, *job.ground, *job.ground}};
    s.camera.view = place_camera(job, row.all(), axes, first.stack.of_picture);
    return made;
}

}  // namespace voxtone::slicer
