// SPDX-License-Identifier: GPL-3.0-or-later
//
// By what a part is told from the others once support is washed off: whose it is, by the plan's own columns, and what
// is written on it.
#pragma once

#include <string>

#include "slicer/plans/tray_part.h"

namespace voxtone::slicer {

/// "customer Klein; serial 007; label \"No. 7\""; empty: there is nothing to say.
[[nodiscard]] std::string about_part(const TrayPart& part);

/// Of its texts the one called customer; the others may be the shop's own. Empty: there is none.
[[nodiscard]] std::string customer_of(const TrayPart& part);
/// "cow (for Klein)"; without a customer the name.
[[nodiscard]] std::string name_for(const std::string& name, const std::string& customer);

/// What is wrong with a part, behind its place in the plan and its file, where the sentence names neither.
[[nodiscard]] std::string fault_at_place(const TrayPart& part, const std::string& fault);

}  // namespace voxtone::slicer
