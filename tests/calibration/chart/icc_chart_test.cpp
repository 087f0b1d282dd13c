// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/chart/icc_chart.h"

#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <set>

#include <lcms2.h>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "calibration/chart/mixture_samples.h"
#include "calibration/patches/patch_mixture.h"
#include "optics/colour/colour.h"
#include "tests/calibration/chart/icc_samples.h"
#include "tests/io/files/temporary_folder.h"

namespace voxtone::calibration {
namespace {

using Catch::Contains;
using namespace testing;

class Profiles {
public:
    [[nodiscard]] std::filesystem::path write(const std::string& bytes) const {
        std::ofstream(file(), std::ios::binary) << bytes;
        return file();
    }
    [[nodiscard]] IccChart chart(const std::string& bytes, const IccChartOptions& options = {}) const {
        return read_icc_chart(write(bytes), options);
    }
    [[nodiscard]] std::string refused(const std::string& bytes, const IccChartOptions& options = {}) const {
        try {
            (void)chart(bytes, options);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    }

private:
    [[nodiscard]] std::filesystem::path file() const { return folder_.path() / "printer.icc"; }
    io::TemporaryFolder folder_;
};

double share_of(const Patch& patch, const std::string& role) {
    for (const ResinShare& share : patch.top)
        if (share.role == role) return share.fraction;
    return 0;
}

std::string built_in(cmsHPROFILE profile) {
    cmsUInt32Number bytes = 0;
    cmsSaveProfileToMem(profile, nullptr, &bytes);
    std::string out(bytes, '\0');
    cmsSaveProfileToMem(profile, out.data(), &bytes);
    cmsCloseProfile(profile);
    return out;
}

}  // namespace

TEST_CASE("Mixtures of a profile have the colours of its table, and fill the volume") {
    const Profiles profiles;
    const IccChart chart = profiles.chart(profile_of({}, straight));
    CHECK(chart.colour_space == "CMYK");
    CHECK(chart.measured.empty());
    CHECK(chart.white.x() == Approx(90).margin(0.01));
    CHECK(chart.table.is_chart);
    CHECK(chart.table.patches.size() >= 390);
    std::set<std::string> solids;
    for (const Patch& patch : chart.table.patches) {
        double sum = 0;
        for (const ResinShare& share : patch.top) sum += share.fraction;
        CHECK(sum == Approx(1).margin(1e-6));
        if (patch.top.size() == 1) solids.insert(patch.top.front().role);
        const cmsCIELab wanted =
            straight({share_of(patch, "C"), share_of(patch, "M"), share_of(patch, "Y"), share_of(patch, "K")});
        const Eigen::Vector3d white = optics::d50_white();
        const Eigen::Vector3d lab =
            optics::lab_from_xyz(Eigen::Vector3d(patch.rho[0], patch.rho[1], patch.rho[2]).cwiseProduct(white), white);
        CAPTURE(mixture_text(patch.top));
        CHECK((lab - Eigen::Vector3d(wanted.L, wanted.a, wanted.b)).norm() < 0.05);
    }
    CHECK(solids == std::set<std::string>{"C", "K", "M", "W", "Y"});
}

TEST_CASE("Channels of a profile are named by who knows them") {
    const Profiles profiles;
    const std::string three = profile_of({cmsSigCmyData, 3}, straight),
                      numbered = profile_of({cmsSig4colorData, 4}, straight);
    CHECK(profiles.chart(three).table.patches.size() >= 390);
    CHECK_THAT(profiles.refused(numbered), Contains("4 channels have no names"));
    IccChartOptions named;
    named.channels_are = {"O", "G", "V", "K"};
    named.rest = "T";
    named.patches = 30;
    std::set<std::string> roles;
    for (const Patch& patch : profiles.chart(numbered, named).table.patches)
        for (const ResinShare& share : patch.top) roles.insert(share.role);
    CHECK(roles == std::set<std::string>{"G", "K", "O", "T", "V"});
    CHECK_THAT(profiles.refused(three, named), Contains("names 4 resins") && Contains("3 channels"));
    named.channels_are = {"C", "C", "M", "Y"};
    CHECK_THAT(profiles.refused(numbered, named), Contains("C is there twice"));
}

TEST_CASE("A profile that carries its measurements gives these") {
    const Profiles profiles;
    std::string cgats =
        "CGATS.17\nBEGIN_DATA_FORMAT\nSAMPLE_ID CMYK_C CMYK_M CMYK_Y CMYK_K LAB_L LAB_A LAB_B\n"
        "END_DATA_FORMAT\nNUMBER_OF_SETS 12\nBEGIN_DATA\n";
    for (int i = 0; i < 12; ++i)
        cgats += std::to_string(i + 1) + " " + std::to_string(5 * i) + " 0 " + std::to_string(2 * i) + " 0 " +
                 std::to_string(88 - 3 * i) + " " + std::to_string(-2 * i) + " 1\n";
    cgats += "END_DATA\n";
    const IccChart chart = profiles.chart(profile_of({.measurements = cgats}, straight));
    CHECK(chart.measured == "targ");
    CHECK(chart.table.patches.size() == 12);
    CHECK(chart.table.patches[3].rho[1] ==
          Approx(optics::xyz_from_lab({79, -6, 1}, optics::d50_white()).y()).epsilon(1e-6));
}

TEST_CASE("Profiles of other devices are refused in a sentence") {
    const Profiles profiles;
    CHECK_THAT(profiles.refused("not a profile at all"), Contains("is no ICC profile"));
    CHECK_THAT(profiles.refused(built_in(cmsCreate_sRGBProfile())), Contains("a display"));
    CHECK_THAT(profiles.refused(built_in(cmsCreateLab4Profile(nullptr))), Contains("says nothing of resins"));
    CHECK_THAT(profiles.refused(profile_of({cmsSigRgbData, 3}, straight)), Contains("channels are RGB"));
    CHECK_THAT(profiles.refused(profile_of({cmsSigCmykData, 4, cmsSigNamedColorClass}, straight)),
               Contains("says nothing of resins"));
    CHECK_THAT(profiles.refused(profile_of({}, nullptr)), Contains("no table from device to colour"));
    CHECK_THAT(profiles.refused(profile_of({},
                                           [](const Inks& ink) {
                                               return cmsCIELab{20 + 60 * ink[3], 0, 0};
                                           })),
               Contains("no printer's white"));
}

TEST_CASE("A profile that is cut anywhere is refused, or read as the whole one", "[slow]") {
    const Profiles profiles;
    const std::string whole = profile_of({.measurements = "CGATS.17"}, straight);
    IccChartOptions few;
    few.patches = 10;
    for (std::size_t bytes = 0; bytes < whole.size(); bytes += 1 + whole.size() / 10) {
        CAPTURE(bytes);
        CHECK_FALSE(profiles.refused(whole.substr(0, bytes), few).empty());
    }
    for (std::size_t at = 0; at < 400; at += 37) {
        std::string damaged = whole;
        damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
        CAPTURE(at);
        CHECK_NOTHROW(profiles.refused(damaged, few));
    }
}

TEST_CASE("Samples of mixtures are solids, ramps and what fills the volume between, none twice") {
    const std::vector<std::vector<double>> samples = mixture_samples(4, 200);
    CHECK(samples.size() >= 190);
    std::set<std::vector<double>> different(samples.begin(), samples.end());
    CHECK(different.size() == samples.size());
    for (const auto& sample : samples) {
        double sum = 0;
        for (const double share : sample) {
            CHECK(share >= 0);
            sum += share;
        }
        CHECK(sum <= 1 + 1e-9);
    }
    CHECK(mixture_samples(4, 200) == samples);
}

}  // namespace voxtone::calibration
