// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/photo/checker_chart.h"

#include <filesystem>
#include <span>

#include <fmt/format.h>

#include "base/embedded_file.h"
#include "base/error.h"
#include "io/files/json_object.h"
#include "optics/colour/colour.h"

namespace voxtone {

namespace embedded {
std::span<const EmbeddedFile> checkers();
}

namespace calibration {

namespace {

CheckerChart from_json(const io::JsonObject& object) {
    object.allow_only({"format", "version", "name", "source", "licence", "columns", "rows", "patches"});
    if (object.text("format") != "voxtone-checker") object.fail("format", "must be \"voxtone-checker\"");
    if (object.integer("version", 1, 1000000) != 1) object.fail("version", "only version 1 is known");
    CheckerChart chart;
    chart.name = object.text("name");
    chart.columns = static_cast<int>(object.integer("columns", 1, 100));
    chart.rows = static_cast<int>(object.integer("rows", 1, 100));
    for (const io::JsonObject& patch : object.objects("patches")) {
        patch.allow_only({"name", "lab_d50"});
        const std::vector<double> lab = patch.numbers("lab_d50", 3, -200, 200);
        const Eigen::Vector3d xyz = optics::xyz_from_lab({lab[0], lab[1], lab[2]}, optics::d50_white());
        chart.names.push_back(patch.text("name"));
        chart.linear_srgb.push_back(
            optics::linear_srgb_from_xyz(optics::adapt_white(xyz, optics::d50_white(), optics::d65_white())));
    }
    if (chart.names.size() != std::size_t(chart.columns * chart.rows))
        object.fail("patches", "must be as many as columns x rows");
    if (chart.names.size() < 8) object.fail("patches", "must be eight or more, for a colour correction to be found");
    return chart;
}

}  // namespace

CheckerChart find_checker(const std::string& name_or_file) {
    std::string names;
    for (const EmbeddedFile& file : embedded::checkers()) {
        if (file.name == name_or_file)
            return from_json(io::JsonObject::parse(file.text, fmt::format("checker {}", file.name)));
        names += (names.empty() ? "" : ", ") + std::string(file.name);
    }
    if (std::filesystem::exists(name_or_file)) return from_json(io::JsonObject::read(name_or_file));
    throw InputError(fmt::format(
        "there is no colour checker \"{}\" and no file of that name; checkers that come with the program: {}",
        name_or_file, names));
}

}  // namespace calibration
}  // namespace voxtone
