// SPDX-License-Identifier: GPL-3.0-or-later
//
// What entries of the option table are made of (option_table.h).
#pragma once

#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "slicer/options/option_spec.h"
#include "slicer/options/option_values.h"
#include "slicer/options/resolved_job.h"

namespace voxtone::slicer {

/// Where a value lies in a ResolvedJob: pointers to members, from outside inwards.
template <class... Members>
[[nodiscard]] auto at(Members... members) {
    return [members...](ResolvedJob& job) -> decltype(auto) { return (job.*....*members); };
}

/// A value that the resolved job has as it is. `place`: of a ResolvedJob, the value's.
template <class Type, class Place>
[[nodiscard]] OptionSpec plain(Type SliceOptions::*member, Place place, OptionSpec spec) {
    spec.member = member;
    spec.resolve = [member, place](const SliceOptions& o, ResolvedJob& job) { place(job) = o.*member; };
    return spec;
}
template <class Place>
[[nodiscard]] OptionSpec plain(OptionSpec::Length member, Place place, OptionSpec spec) {
    spec.member = member;
    spec.metavar = "LENGTH";
    spec.resolve = [member, place](const SliceOptions& o, ResolvedJob& job) { place(job) = o.*member.mm; };
    return spec;
}

/// One of the names of an enum.
template <class Place>
[[nodiscard]] OptionSpec choice(std::string SliceOptions::*member, Place place, OptionSpec spec) {
    using Enum = std::remove_reference_t<decltype(place(std::declval<ResolvedJob&>()))>;
    spec.member = member;
    spec.choices = names_of<Enum>();
    spec.resolve = [member, place, option = spec.key](const SliceOptions& o, ResolvedJob& job) {
        place(job) = parse_choice<Enum>(option, o.*member);
    };
    return spec;
}

/// What the surface shows unless another kind of print is asked for.
inline constexpr const char* colour_show = "colour";
[[nodiscard]] inline bool shows_colours(const SliceOptions& o) { return o.show == colour_show; }
/// Whether an appearance loop runs, or what one has found is printed.
[[nodiscard]] inline bool has_loop(const SliceOptions& o) { return parse_iterations(o.iterations) != 0 || o.resume; }

/// Reasons for which a job would do nothing with an option.
namespace idle {

[[nodiscard]] inline std::string_view without_loop(const SliceOptions& o, bool) {
    return unless(has_loop(o),
                  "there is no appearance loop (--iterations 0, which --quality draft means too): leave one of the two "
                  "out");
}
[[nodiscard]] inline std::string_view of_a_mesh(const SliceOptions&, bool is_picture) {
    return unless(is_picture, "it is for pictures; --size scales a model");
}

}  // namespace idle

}  // namespace voxtone::slicer
