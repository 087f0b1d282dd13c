// SPDX-License-Identifier: GPL-3.0-or-later
//
// The parts of a tray, ready to be printed.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "slicer/plans/tray_plan.h"
#include "slicer/plate/placed_copy.h"
#include "slicer/plate/prepared_job.h"
#include "slicer/plate/ready_component.h"

namespace voxtone::slicer {

/// In OUT/parts: what parts came to that left. One that comes back finds its own there.
inline constexpr std::string_view earlier_parts_name = "earlier";

struct ReadyPart {
    TrayPart part;
    std::unique_ptr<PreparedJob> ready;  ///< null: a component
    std::string report;                  ///< report.json of the part; empty: none
    std::string page{};                  ///< of its report, as OUT names it
    std::vector<PlacedCopy> copies{};    ///< once they have places
    std::vector<PlacedCopy> alone{};     ///< those of them that no joined part holds (joined_parts.h)
    bool is_joined = false;
    double shared_mm3 = 0;  ///< of a joined part: that more than one of its bodies fills
    std::optional<ReadyComponent> component{};

    [[nodiscard]] const VoxelGrid& grid() const { return ready ? ready->body.grid : component->layers->grid(); }
    /// Most that layers of all copies that stand alone take, and its report; `common`: what all parts have.
    [[nodiscard]] std::uint64_t disk_bytes(const OpenedJob& common) const;
    /// As it is to be printed.
    [[nodiscard]] std::shared_ptr<const LayerSource> layers() const {
        return ready ? std::shared_ptr<const LayerSource>(ready->print->layers()) : component->layers;
    }
};

/// A part without which the tray is made.
struct FailedPart {
    std::string name, message;
    ExitCode exit_code = ExitCode::done;
    std::string customer = {};  ///< who waits for it; empty: the plan does not say

    /// "cow (for Klein)".
    [[nodiscard]] std::string who() const;
};

struct TrayParts {
    std::vector<ReadyPart> ready;               ///< at least one
    std::vector<FailedPart> failed;             ///< of them none is among the others
    std::shared_ptr<const OpenedJob> common{};  ///< what all have, of no part; null: there are no components

    /// For what all have: printer, resins, formats.
    [[nodiscard]] const OpenedJob& any_job() const;
};

/// Keeps what `work` throws for the part's own fault; with `fail_fast`, and what is not the part's fault (the disk, a
/// request to stop), it is thrown on. Whether all went well.
[[nodiscard]] bool goes_well(const TrayPart& part, bool fail_fast, std::vector<FailedPart>& failed, Progress& progress,
                             const std::function<void()>& work);

/// That the tray is made without it.
[[nodiscard]] std::string failed_warning(const FailedPart& part);
/// Throws what the first threw where no part is left.
void expect_some(const std::vector<FailedPart>& failed, std::size_t ready);

/// What all parts have in common, as a job of none of them; nothing where there are no components. `roles`: of the
/// resins that the parts load which are models; empty: the printer's.
[[nodiscard]] std::optional<OpenedJob> common_job(const TrayPlan& plan, const std::vector<std::string>& roles = {});

/// A part's job, whose options say where it keeps what it comes to. `kept`: its body, where that is known. It goes on
/// from where an interrupted loop of the same job was. Throws what the job throws, ResourceError where its loop takes
/// more memory than is allowed.
[[nodiscard]] std::unique_ptr<PreparedJob> make_ready(OpenedJob opened, std::optional<JobBody> kept, Progress& progress,
                                                      bool loop_elsewhere = false);

/// Reads and prepares each part; all get the resins that the first one loads. Those that may be are turned where they
/// come to lie closer so, before they are voxelised. Parts keep what they come to in OUT/parts/NAME. Throws what the
/// jobs throw, beginning with the part's place; where every part fails, what the first threw.
[[nodiscard]] TrayParts prepare_parts(const TrayPlan& plan, Progress& progress);

}  // namespace voxtone::slicer
