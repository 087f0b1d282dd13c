// SPDX-License-Identifier: GPL-3.0-or-later
#include <vector>

#include "voxtone/base/contracts.h"
#include "voxtone/base/parallel.h"
#include "voxtone/optics/viewing_transport.h"

namespace voxtone::optics {

void ViewingTransport::derivatives(const ViewingField& forward, std::span<float> by_sigma_t, std::span<float> by_sigma_s) const {
    VOXTONE_EXPECT(scale_ > 0 && forward.scale == 0 && forward.cells.size() == source_.size());
    const auto linear = static_cast<float>(grid_.directions.linear);
    const float V = volume_ * scale_;
    parallel_ranges(0, source_.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t cell = begin; cell < end; ++cell) {
            by_sigma_t[cell] = by_sigma_s[cell] = 0;
            if (grid_.medium[cell] == 0) continue;
            const Moments a = moments_of(forward.cells[cell]);
            const Moments& b = source_[cell];
            const float share = 1 / media_->cells[grid_.medium[cell]].sigma_s;
            const float phi2 = a.phi * b.phi * share, J2 = linear != 0 ? (a.x * b.x + a.y * b.y + a.z * b.z) * share / (3 * linear) : 0;
            by_sigma_t[cell] = -V * (phi2 - 3 * J2);
            by_sigma_s[cell] = V * (phi2 - 3 * linear * J2);
        }
    });
}

void ViewingTransport::exact_derivatives(const ViewingField& forward, std::span<float> by_sigma_t, std::span<float> by_sigma_s) {
    const std::size_t n = source_.size();
    const auto theta = static_cast<float>(viewing_theta);
    reflect();
    std::vector<Moments> source = source_;
    std::vector<Octet> in = in_;
    auto core_in = core_in_;
    const float scale = scale_;
    take_light({});
    load(forward);
    std::vector<Octet> record(2 * n), out(out_.size());
    std::vector<float> product(2 * n, 0.0f);
    for (int octant = 0; octant < 8; ++octant) {
        const SweepJob job{&grid_, {media_->cells, media_->cells}, source_, {}, in_, out, record, {}, viewing_.place_of_face, core_in_, theta, core_out_};
        record_octant(job, octant);
        const SweepJob against{&grid_, {media_->cells, media_->cells}, source, {}, in, out, record, product, viewing_.place_of_face, core_in, theta, core_out_};
        multiply_octant(against, 7 - octant);
    }
    const auto linear = static_cast<float>(grid_.directions.linear);
    const float V = volume_ * scale;
    for (std::size_t cell = 0; cell < n; ++cell) {
        by_sigma_t[cell] = by_sigma_s[cell] = 0;
        if (grid_.medium[cell] == 0) continue;
        const float sigma_s = media_->cells[grid_.medium[cell]].sigma_s;
        const Moments &a = source_[cell], &b = source[cell];
        by_sigma_t[cell] = -V * (product[2 * cell] + product[2 * cell + 1]);
        by_sigma_s[cell] = V * product[2 * cell + 1] +
                           V / (sigma_s * sigma_s) * (a.phi * b.phi - (linear != 0 ? (a.x * b.x + a.y * b.y + a.z * b.z) / (3 * linear) : 0.0f));
    }
}

}  // namespace voxtone::optics
