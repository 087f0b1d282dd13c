// SPDX-License-Identifier: GPL-3.0-or-later
#include "slicer/part/other_print.h"

#include <algorithm>
#include <fstream>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/file_digest.h"
#include "slicer/part/job_identity.h"
#include "slicer/part/opened_job.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/slicer/options/declared_show.h"

using namespace voxtone;
using namespace voxtone::slicer;

namespace {

/// Shows what lies in one file, by black and white.
class Relic final : public OtherPrint {
public:
    explicit Relic(std::string file) : file_(std::move(file)) {}
    std::string usual_resins(const PrinterProfile&) const override { return "vero-opaque"; }
    void check(const LoadedResins& resins) const override {
        if (resins.entries.size() > 2) throw InputError("two resins make it");
    }
    std::vector<JobInput> inputs() const override { return {{"relic", file_, {}}}; }
    std::vector<Work> work(const LoadedResins&) const override { return {{Phase::search, 3}}; }
    std::string what() const override { return "a relic"; }
    std::string why_no_resins() const override { return "Nobody knows."; }
    std::string why_whole() const override { return "it is one"; }
    std::unique_ptr<Print> make(const OpenedJob&, const JobBody&, Progress&) const override { return nullptr; }

private:
    std::string file_;
};

std::unique_ptr<const OtherPrint> open_relic(ResolvedJob& job) {
    job.threads = 7;
    return std::make_unique<const Relic>(dynamic_cast<const RelicOptions&>(*job.other).relic);
}

}  // namespace

TEST_CASE("A print that shows no colours is opened by who registered it, and by nobody else") {
    const io::TemporaryFolder folder;
    declare_relics();
    SliceOptions options;
    options.model = (folder.path() / "a.obj").string();
    const std::string bone = (folder.path() / "relic.json").string();
    options.out = (folder.path() / "out").string();
    options = with_relic(options, bone);
    options.load = {"W", "K"};
    std::ofstream(options.model) << "v 0 0 0\n";
    std::ofstream(bone) << "bone";
    register_other_print(open_relic);
    const OpenedJob job = open_job(options);
    REQUIRE(job.other);
    CHECK(job.options.threads == 7);
    CHECK(job.options.loop.iterations == 0);
    CHECK(job.resins.set.resins[std::size_t(job.resins.core)].role == "K");
    // What it is made of makes it another job.
    const JobIdentity identity = identify(job, {});
    const auto relic = std::ranges::find(identity.inputs, std::string("relic"), &JobInput::key);
    REQUIRE(relic != identity.inputs.end());
    CHECK(relic->sha256 == io::file_sha256(bone));
    std::ofstream(bone) << "tooth";
    CHECK(identify(job, {}).job != identity.job);

    options.load = {"W", "K", "C"};
    CHECK_THROWS_WITH(open_job(options), "two resins make it");
    // A job of colours never comes here.
    options.show = "colour";
    options.other.clear();
    CHECK_FALSE(open_job(options).other);
    register_other_print(nullptr);
}
