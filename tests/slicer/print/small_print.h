// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whole jobs in this process, of a body that takes a few tenths of a second.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "io/files/whole_file.h"
#include "slicer/print/run_print.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/said_progress.h"

namespace voxtone::test {

/// A box of 2 x 3 x 1.5 mm with colours that the usual resins reach, another at each corner.
class PrintDesk {
public:
    PrintDesk() { write_box("box.obj", {2, 3, 1.5}); }

    void write_box(const std::string& name, const std::array<double, 3>& mm) const {
        std::ofstream out(path(name));
        for (int c = 0; c < 8; ++c)
            out << fmt::format("v {} {} {} {} {} {}\n", c & 1 ? mm[0] : 0, c & 2 ? mm[1] : 0, c & 4 ? mm[2] : 0,
                               c & 1 ? 0.5 : 0.35, c & 2 ? 0.5 : 0.4, c & 4 ? 0.45 : 0.35);
        out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    }
    [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_.path() / name; }
    [[nodiscard]] slicer::SliceOptions options(const std::string& out) const {
        slicer::SliceOptions options;
        options.model = path("box.obj").string();
        options.unit.assign("mm");
        options.out = path(out).string();
        options.iterations.assign(1, '0');
        options.predict.assign("none");
        return options;
    }
    JobResult print(const slicer::SliceOptions& options) { return slicer::run_print({options}, said); }
    /// Of some models, and copies of each.
    JobResult tray(const slicer::SliceOptions& options, std::vector<std::string> models, int copies = 1) {
        for (std::string& model : models) model = path(model).string();
        return slicer::run_print({options, {std::move(models), copies}, true}, said);
    }
    [[nodiscard]] nlohmann::json json(const std::string& name) const {
        std::ifstream in(path(name));
        return nlohmann::json::parse(in);
    }
    /// What the layers of a stack are, whatever they were written by.
    [[nodiscard]] std::string content(const std::string& out) const {
        return json(out + "/manifest.json").at("content_sha256");
    }

    SaidProgress said;

private:
    io::TemporaryFolder folder_;
};

/// The box, printed as "out" once for all that look at a stack.
inline PrintDesk& printed_desk() {
    static PrintDesk one;
    static const bool made = [] {
        slicer::SliceOptions options = one.options("out");
        options.report = false;
        (void)one.print(options);
        return true;
    }();
    static_cast<void>(made);
    return one;
}

}  // namespace voxtone::test
