// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/spot/response_sweep_job.h"

#include <array>
#include <numeric>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "io/disk/output_files.h"
#include "io/files/json_writer.h"
#include "io/profiles/bssrdf_file.h"

namespace voxtone::calibration {

JobResult run_response_sweep(const ResponseSweepJob& job, Progress& progress) {
    job.geometry.validate();
    if (!job.out.ends_with(".bssrdf")) throw UsageError(fmt::format("{}: a data set's name ends in .bssrdf", job.out));
    if (job.card.lit.size() != job.card.dark.size() || job.card.lit.empty())
        throw UsageError(
            fmt::format("--card has {} photographs and --card-dark {}; each needs a dark frame of its time",
                        job.card.lit.size(), job.card.dark.size()));
    io::expect_outputs({job.out}, job.overwrite);
    const std::vector<SweepExposures> frames = read_sweep(job.frames, job.geometry);
    SweptResponses swept = measure_sweep(frames, job.card, job.card_albedo, job.geometry, job.noise, progress);
    std::array<double, 3> albedo{}, beyond{};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto& total = swept.responses.channels[c].total;
        albedo[c] = std::accumulate(total.begin(), total.end(), 0.0) / double(total.size());
        beyond[c] = optics::share_beyond_window(swept.responses, c);
    }
    const auto [width, height] = job.geometry.points;
    io::write_bssrdf(
        {fmt::format("voxtone calibrate responses {}", job.frames), optics::Channels(), std::move(swept.responses)},
        job.out);
    io::JsonWriter json;
    json.begin_object().add("format", "voxtone-calibrate-responses").add("version", 1).add("dataset", job.out);
    json.add("points", job.geometry.points).add("mean_albedo", albedo).add("beyond_window", beyond);
    json.add("asymmetry", swept.asymmetry).end_object();
    return {json.text(),
            fmt::format("{}: {} x {} points at {} mm; mean albedo {:.3f}; share of light beyond {:.3g} mm {:.4f}; both "
                        "ways between cells differ by {:.1f} %\nNext: voxtone laminate factor {} -o map.json\n",
                        job.out, width, height, job.geometry.pitch_mm, fmt::join(albedo, ", "),
                        job.geometry.radius * job.geometry.pitch_mm, fmt::join(beyond, ", "), 100 * swept.asymmetry,
                        job.out)};
}

}  // namespace voxtone::calibration
