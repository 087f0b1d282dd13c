// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattering/jobs/profile_map_job.h"

#include <numeric>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/pictures/picture.h"
#include "io/pictures/picture_writer.h"
#include "optics/colour/channels.h"
#include "optics/numerics/hankel.h"
#include "scattering/jobs/laminate_factor_job.h"
#include "scattering/jobs/profile_map_picture.h"
#include "scattering/local_profiles/luminance_channel.h"
#include "scattering/local_profiles/tinted_responses.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/scattering/local_profiles/response_samples.h"

using namespace voxtone;
using namespace voxtone::scattering;
using Catch::Matchers::Contains;

namespace {

io::BssrdfFile sample(double counts, std::uint64_t seed) {
    return {"a test",
            {},
            scattering::testing::separable_responses(scattering::testing::wandering_profiles({26, 22}, 5, 3), counts,
                                                     seed)};
}

}  // namespace

TEST_CASE("A profile map has the profiles of the clusters, scaled to an albedo") {
    const io::BssrdfFile data = sample(200, 1), check = sample(200, 2);
    ProfileMapOptions options;
    options.clusters.clusters = 9;
    options.max_albedo = 0.6;
    Progress quiet;
    const ProfileMapResult result = make_profile_map(data, options, quiet, &check);
    const io::ProfileMap& map = result.map;
    CHECK((map.width_px == 26 && map.height_px == 22));
    CHECK(map.width_mm == Approx(13));
    CHECK(map.height_mm == Approx(11));
    CHECK(map.source == "a test");
    CHECK(map.cluster == result.clusters.cluster);
    REQUIRE(map.target.size() == 9);
    const optics::HankelGrid grid(3, 8);
    double brightest = 0;
    for (const auto& target : map.target) {
        REQUIRE(target.size() == 3);
        for (const auto& samples : target) {
            CHECK(samples.light.size() == 6);
            brightest = std::max(brightest, grid.from_even(samples.light, samples.spacing_mm)[0]);
        }
    }
    CHECK(brightest == Approx(0.6));
    CHECK(result.scale * result.brightest == Approx(0.6));
    for (const ChannelOutcome& channel : result.channels) {
        CHECK(channel.factor.converged);
        CHECK(channel.factored.light_error < channel.clustered.light_error);
        CHECK(channel.factored_checked.light_error > channel.factored.light_error);
    }
}

TEST_CASE("A comparison shows data, factored and clustered surface side by side") {
    const io::BssrdfFile data = sample(2000, 1);
    ProfileMapOptions options;
    options.clusters.clusters = 60;
    Progress quiet;
    const ProfileMapResult result = make_profile_map(data, options, quiet);
    const ComparisonPicture drawn = draw_comparison(data, result, 5 * 26 + 7);
    CHECK(drawn.point == 137);
    CHECK(drawn.channel == 1);
    CHECK((0 < drawn.least_mm && drawn.least_mm < drawn.most_mm));
    CHECK(drawn.most_per_mm2 == Approx(1e5 * drawn.least_per_mm2));
    const io::Picture8& picture = drawn.picture;
    // 16 x 12 points remain, 15 px each; gaps of 10 px.
    CHECK(picture.width_px == 3 * 240 + 40);
    const auto code = [&](std::uint32_t x, std::uint32_t y) {
        return static_cast<int>(picture.codes[3 * (std::size_t{y} * picture.width_px + x)]);
    };
    CHECK(code(2, 2) == 255);
    // The albedo of three points, each in three panels.
    for (const std::uint32_t x : {20u, 120u, 230u})
        for (const std::uint32_t panel : {1u, 2u}) CHECK(std::abs(code(x, 90) - code(x + panel * 250, 90)) < 25);
    CHECK(std::abs(code(20, 90) - code(200, 90)) + std::abs(code(20, 90) - code(120, 90)) > 25);
}

TEST_CASE("A factorisation that is given too few steps says so, and one that has enough does not") {
    class Warnings final : public Progress {
    public:
        std::string all;

    private:
        void on_warning(const std::string& message) override { all += message + '\n'; }
    };
    const io::TemporaryFolder folder;
    LaminateFactorJob job;
    job.dataset = folder.path() / "data";
    job.out = folder.path() / "map.json";
    job.map.clusters.clusters = 3;
    io::write_bssrdf(sample(200, 1), job.dataset);
    Warnings enough, few;
    (void)run_laminate_factor(job, enough);
    CHECK_THAT(enough.all, !Contains("factorisation"));
    job.map.factor.max_steps = 1;
    job.overwrite = true;
    (void)run_laminate_factor(job, few);
    CHECK_THAT(few.all,
               Contains("red: the factorisation stopped") && Contains("after 1 steps") && Contains("[not-converged]"));
}

TEST_CASE("Of luminance is asked what Y of the channels says, of each channel of the resins") {
    const io::BssrdfFile data = sample(200, 1), grey = luminance_of(data);
    CHECK(is_luminance(grey.channels));
    CHECK_FALSE(is_luminance(data.channels));
    CHECK_FALSE(optics::fault_of(grey.channels));
    REQUIRE(grey.responses.channels.size() == 1);
    // IEC 61966-2-1, Y of linear sRGB.
    const auto& of = data.responses.channels;
    for (const std::size_t i : {std::size_t{0}, std::size_t{777}, of[0].pairs.size() - 1})
        CHECK(grey.responses.channels[0].pairs[i] ==
              Approx(0.2126 * of[0].pairs[i] + 0.7152 * of[1].pairs[i] + 0.0722 * of[2].pairs[i]).epsilon(1e-3));
    CHECK(grey.responses.channels[0].total[5] ==
          Approx(0.2126 * of[0].total[5] + 0.7152 * of[1].total[5] + 0.0722 * of[2].total[5]).epsilon(1e-3));
    // Independent counts: weights squared.
    CHECK(grey.responses.channels[0].noise == Approx(of[0].noise * 0.5619).epsilon(1e-3));

    ProfileMapOptions options;
    options.clusters.clusters = 3;
    Progress quiet;
    const io::ProfileMap map = make_profile_map(grey, options, quiet).map;
    REQUIRE(map.target[0].size() == 1);
    const optics::Channels wavelengths{{450, 550, 600, 650}};
    const io::ProfileMap asked = asked_of(wavelengths, map);
    CHECK(asked.channels == wavelengths);
    for (std::size_t k = 0; k < 3; ++k) {
        REQUIRE(asked.target[k].size() == 4);
        for (const auto& samples : asked.target[k]) CHECK(samples.light == map.target[k][0].light);
    }
    const io::BssrdfFile many = asked_of(wavelengths, grey);
    REQUIRE(many.responses.channels.size() == 4);
    CHECK(many.responses.channels[3].pairs == grey.responses.channels[0].pairs);
    CHECK(asked_of(wavelengths, data).channels == data.channels);  // of colours nothing else is asked
}

TEST_CASE("Profile maps that cannot be made are refused with the reason") {
    const io::BssrdfFile data = sample(0, 1);
    Progress quiet;
    ProfileMapOptions options;
    options.max_albedo = 1.5;
    CHECK_THROWS_WITH((void)make_profile_map(data, options, quiet), Contains("largest albedo"));
    options.max_albedo.reset();
    io::BssrdfFile other = data;
    other.responses.pitch_mm = 0.4;
    CHECK_THROWS_WITH((void)make_profile_map(data, options, quiet, &other), Contains("one surface"));
}

TEST_CASE("Under a coloured skin local profiles are those of the data times its colour, and spread as far") {
    // Two colours, the upper half of the picture and the lower one; data of one channel.
    io::BssrdfFile data = sample(200, 1);
    data.channels = luminance_channel();
    data.responses.channels.resize(1);
    const std::uint32_t width = data.responses.width, height = data.responses.height;
    io::LinearPicture halves{2, 2, {{1, 1, 0, 1}, {1, 1, 0, 1}, {0.5F, 0.5F, 0.5F, 1}, {0.5F, 0.5F, 0.5F, 1}}};
    const io::TemporaryFolder folder;
    const auto file = folder.path() / "two.png";
    io::write_whole_file(file, io::png_bytes(io::encode_over(halves, Eigen::Vector3f::Zero())));
    const auto texture = io::read_picture(file).texture;
    const io::BssrdfFile dyed = tinted(data, *texture);
    REQUIRE(dyed.channels.is_rgb());
    REQUIRE(dyed.responses.channels.size() == 3);
    const std::size_t top = 0, bottom = std::size_t{height - 1} * width;
    const auto total = [](const io::BssrdfFile& of, std::size_t c, std::size_t point) {
        return static_cast<double>(of.responses.channels[c].pairs[point]);  // of a point with itself
    };
    for (std::size_t c = 0; c < 3; ++c) {
        CHECK(total(dyed, c, top) == Approx((c < 2 ? 1 : 0) * total(data, 0, top)).margin(1e-6));
        CHECK(total(dyed, c, bottom) == Approx(0.503 * total(data, 0, bottom)).epsilon(0.005));
    }
    io::BssrdfFile other = data;
    other.channels = {};
    other.channels.wavelengths_nm = {500};
    CHECK_THROWS_WITH(tinted(other, *texture), Catch::Matchers::Contains("--tint"));
}
