// SPDX-License-Identifier: GPL-3.0-or-later
#include "farm/cluster/held_jobs.h"

#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "farm/batch/batch_folder.h"

namespace voxtone::farm {

std::string hold_text(const Submission& submission, const SlurmQueue& queue) {
    for (const std::string& number : submission.numbers()) {
        const auto held = queue.held.find(number);
        if (held == queue.held.end()) continue;
        const bool by_admin = held->second.find("Admin") != std::string::npos;
        return fmt::format("job {} is held in Slurm{}{}, and does not begin before `scontrol release {}`{}", number,
                           held->second.empty() ? "" : ": ", held->second, number,
                           by_admin ? ", which an administrator has to say" : "");
    }
    return {};
}

std::map<std::string, std::string> held_jobs(const std::filesystem::path& out) {
    const BatchFolder batch = BatchFolder::open(out);
    std::vector<Submission> waiting;
    for (Submission& submission : SubmissionFolder(batch).all()) {
        const auto state = batch.state_of(submission.job);
        if (!state || state->phase == JobPhase::done || state->phase == JobPhase::failed) continue;
        if (!submission.numbers().empty()) waiting.push_back(std::move(submission));
    }
    std::map<std::string, std::string> texts;
    if (waiting.empty()) return texts;
    try {
        const SlurmQueue queue = slurm_queue();
        for (const Submission& submission : waiting)
            if (std::string text = hold_text(submission, queue); !text.empty()) texts[submission.job] = std::move(text);
    } catch (const Error&) {
        // What the states say is said without it.
    }
    return texts;
}

}  // namespace voxtone::farm
