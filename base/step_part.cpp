// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/step_part.h"

#include <algorithm>

namespace voxtone {

void ShowsParts::tell(double share) const {
    const double part = low_ + (high_ - low_) * std::clamp(share, 0.0, 1.0);
    const std::scoped_lock lock(telling_);  // threads tell one after the other, so that it never goes back
    if (part <= part_) return;
    part_ = part;
    on_part(part);
}

void tell_part(const Progress* progress, double share) {
    if (const auto* const shows = dynamic_cast<const ShowsParts*>(progress)) shows->tell(share);
}

PartRange::PartRange(const Progress* progress, double low, double high)
    : shows_(dynamic_cast<const ShowsParts*>(progress)) {
    if (!shows_) return;
    before_ = shows_->range();
    const double width = before_.high - before_.low;
    shows_->set_range({before_.low + low * width, before_.low + high * width});
}

PartRange::~PartRange() {
    if (!shows_) return;
    shows_->tell(1);
    shows_->set_range(before_);
}

}  // namespace voxtone
