// SPDX-License-Identifier: GPL-3.0-or-later
//
// Setup, profiles and the wavelet: what they say, and what they refuse.
#include <cmath>
#include <string>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "calibration/edge/edge_profiles.h"
#include "calibration/edge/edge_setup.h"
#include "calibration/edge/profile_table.h"
#include "calibration/edge/wavelet_gradient.h"
#include "tests/io/files/schema.h"

using namespace voxtone;
using namespace voxtone::calibration;
using Catch::Matchers::Contains;

namespace {

const std::string setup_head = R"({"format": "voxtone-edge-setup", "version": 1)";

// A profile of a step, with what a lab may do to it.
std::string csv(double left, double right, const std::string& head = "resin,thickness_mm,x_mm,R,G,B\n",
                const std::string& more = "") {
    std::string text = "# a comment\n" + head;
    for (int k = -60; k < 60; ++k) {
        const double v = k < 0 ? left : right;
        const std::string s = std::to_string(v);
        text += "W,0.5," + std::to_string((k + 0.5) * 0.05) + "," + s + "," + s + "," + s + more + "\n";
    }
    return text;
}

void refuse(const std::string& text, const std::string& why) {
    INFO(why);
    CHECK_THROWS_WITH(check_edge_profiles(parse_edge_profiles(text, "p.csv"), "p.csv"), Contains(why));
}

}  // namespace

TEST_CASE("a setup says every figure, and reads back as it was", "[edge]") {
    EdgeSetup setup;
    setup.white = {0.9, 0.91, 0.92};
    setup.assembly.gel = false;
    setup.assembly.glass_mm = 0.5;
    setup.blur_mm = 0.03;
    setup.gel_error_mm = 0.02;
    const EdgeSetup back = parse_edge_setup(edge_setup_text(setup), "setup.json");
    CHECK(back.assembly == setup.assembly);
    CHECK(edge_setup_text(back) == edge_setup_text(setup));
    CHECK(edge_setup_text(parse_edge_setup(setup_head + "}", "s")) == edge_setup_text(EdgeSetup()));
    const auto x = setup.positions();
    CHECK(x.size() == 362);
    CHECK(x.front() == Approx(-x.back()));
    // What changes light paths changes the digest; sheet and camera do not.
    EdgeSetup other = setup;
    other.black = {0.1, 0.1, 0.1};
    other.pitch_mm = 0.05;
    CHECK(other.scene_digest() == setup.scene_digest());
    other.assembly.gel_index = 1.4;
    CHECK(other.scene_digest() != setup.scene_digest());
}

TEST_CASE("a setup is what its schema says", "[edge]") {
    CHECK(io::schema_faults("edge-setup", edge_setup_text(EdgeSetup())).empty());
    CHECK(io::schema_faults("edge-setup", setup_head + "}").empty());
    CHECK_FALSE(io::schema_faults("edge-setup", setup_head + R"(, "gel": {"thickness": 1}})").empty());
}

TEST_CASE("a setup that cannot be is refused by key", "[edge]") {
    const auto refused = [](const std::string& text, const char* why) {
        INFO(text);
        CHECK_THROWS_WITH(parse_edge_setup(setup_head + text, "s.json"), Contains(why));
    };
    refused(R"(, "sheet": {"white": [0.5, 0.5, 0.5], "black": [0.6, 0.1, 0.1]}})", "white");
    refused(R"(, "sheet": {"white": [1, 1, 1]}})", "at most 0.999");
    refused(R"(, "light": {"angle_deg": 85}})", "half_width_deg");
    refused(R"(, "gel": {"thickness": 1}})", "gel");
    refused(R"(, "camera": {"pitch_mm": 0.5, "width_mm": 2}})", "20 samples");
    refused(R"(, "glas": {}})", "glass");
    CHECK_THROWS_AS(parse_edge_setup("{}", "s"), InputError);
}

TEST_CASE("profiles are read as spreadsheets of any country write them", "[edge]") {
    std::string text = csv(0.1, 0.5);
    std::string other;
    for (const char c : text) other += c == ',' ? ";" : c == '.' ? "," : c == '\n' ? "\r\n" : std::string(1, c);
    const auto expected = parse_edge_profiles(text, "p.csv"), found = parse_edge_profiles(other, "p.csv");
    REQUIRE(found.size() == 1);
    CHECK(found[0].x_mm == expected[0].x_mm);
    CHECK(found[0].value == expected[0].value);
}

TEST_CASE("profiles are read, and written as they were read", "[edge]") {
    const auto profiles = parse_edge_profiles(
        csv(0.1, 0.5, "resin,thickness_mm,x_mm,R,G,B,error_R,error_G,error_B\n", ",0.001,0.002,0.003"), "p.csv");
    REQUIRE(profiles.size() == 1);
    CHECK(profiles[0].resin == "W");
    CHECK(profiles[0].x_mm.size() == 120);
    CHECK(profiles[0].error[2][5] == 0.003);
    check_edge_profiles(profiles, "p.csv");
    const auto again = parse_edge_profiles(edge_profiles_text(profiles, "a\nb"), "q.csv");
    CHECK(again[0].value == profiles[0].value);
    CHECK(again[0].error == profiles[0].error);
    CHECK(parse_edge_profiles(csv(0.1, 0.5) + "W,1,0,0.1,nan,\n", "p.csv").size() == 2);
}

TEST_CASE("profiles that no bench gives are refused with the line and what to do", "[edge]") {
    refuse("", "no header line");
    refuse("resin;thickness_mm\n", "2 columns");
    refuse("resin,thickness,x_mm,R,G,B\n", "line 1: column 2 is \"thickness\"");
    refuse("resin,thickness_mm,x_mm,R,G,B,error_R\n", "7 columns");
    refuse("resin,thickness_mm,x_mm,R,G,B\n", "no samples");
    refuse("resin,thickness_mm,x_mm,R,G,B\nW,0.5,0,1,2\n", "line 2: has 5 cells");
    refuse("resin,thickness_mm,x_mm,R,G,B\nW,0.5,a,1,1,1\n", "line 2, column 3 (\"x_mm\"): \"a\" is no number");
    refuse("resin,thickness_mm,x_mm,R,G,B\nW,500,0,1,1,1\n", "thickness_mm is 500");
    refuse("resin,thickness_mm,x_mm,R,G,B\nW,0.5,0,1,1,1\nW,0.5,0,1,1,1\n", "must grow");
    refuse(csv(0.5, 0.1), "wrong way round");
    refuse(csv(5, 50), "percent");
    refuse("resin,thickness_mm,x_mm,R,G,B\nW,0.5,0,1,1,1\n", "1 samples");
    std::string narrow = "resin,thickness_mm,x_mm,R,G,B\n";
    for (int k = 0; k < 40; ++k) narrow += "W,0.5," + std::to_string(0.1 * k) + ",0.1,0.1,0.1\n";
    refuse(narrow, "both sides of the edge");
    std::string clipped = "resin,thickness_mm,x_mm,R,G,B\n";
    for (int k = -40; k < 40; ++k)
        clipped += "W,0.5," + std::to_string(0.1 * k) + ",0.1,0.1," + (k < 0 ? "0.1" : "nan") + "\n";
    refuse(clipped, "B is not known on one side");
}

TEST_CASE("the wavelet takes gradients", "[edge]") {
    for (int level = 1; level <= 5; ++level) {
        const Eigen::VectorXd taps = wavelet_derivative_taps(level);
        const Eigen::Index n = taps.size();
        CHECK(n == 1 + 3 * ((1 << (level - 1)) - 1) + (1 << (level - 1)));
        CHECK(std::abs(taps.sum()) < 1e-12);
        for (Eigen::Index k = 0; k < n; ++k) CHECK(taps[k] == Approx(-taps[n - 1 - k]));
        // A ramp of slope 1 has the gradient 1, a parabola's is the ramp.
        const Eigen::MatrixXd map = wavelet_gradient_map(200, level);
        const Eigen::VectorXd ramp = Eigen::VectorXd::LinSpaced(200, 0, 199);
        const Eigen::VectorXd slope = map * ramp, curved = map * ramp.cwiseAbs2();
        CHECK((slope.segment(60, 80).array() - 1).abs().maxCoeff() < 1e-12);
        CHECK((curved.segment(60, 80) - (2 * ramp.segment(60, 80).array() + 1).matrix()).cwiseAbs().maxCoeff() < 1e-9);
    }
}

TEST_CASE("a noisy step: the wavelet keeps its place and its height, and takes noise away", "[edge]") {
    // A step of width 6 samples (standard deviation), noise of 2 % of it.
    const Eigen::Index n = 362;
    RandomStream random(3, 1);
    Eigen::VectorXd clean(n), noise(n), truth(n - 1);
    for (Eigen::Index k = 0; k < n; ++k) {
        clean[k] = 0.5 * std::erfc(-(static_cast<double>(k) - 180.5) / (6 * std::sqrt(2.0)));
        noise[k] =
            0.02 * (random.uniform() + random.uniform() + random.uniform() + random.uniform() - 2) * std::sqrt(3.0);
    }
    for (Eigen::Index k = 0; k + 1 < n; ++k) truth[k] = clean[k + 1] - clean[k];
    const Eigen::MatrixXd fine = wavelet_gradient_map(n, 1), wavelet = wavelet_gradient_map(n, 3);
    const Eigen::VectorXd seen = wavelet * (clean + noise);
    Eigen::Index place = 0;
    const double height = seen.maxCoeff(&place);
    CHECK(std::abs(static_cast<double>(place) - 180) <= 3);
    CHECK(height == Approx(truth.maxCoeff()).epsilon(0.15));
    CHECK((wavelet * noise).norm() < 0.1 * (fine * noise).norm());
    CHECK((seen - truth).norm() < 0.25 * (fine * (clean + noise) - truth).norm());
    // Far from the step a plain difference would see nothing but noise.
    CHECK(seen.head(100).cwiseAbs().maxCoeff() < 0.1 * height);
}

TEST_CASE("weights between the records of a dictionary", "[edge]") {
    std::vector<double> nodes;
    for (const double s : paper_extinctions()) nodes.push_back(std::log(s));
    double last = 0;
    for (double x = nodes.front(); x <= nodes.back(); x += 0.01) {
        const NodeWeights w = smooth_weights(nodes, x);
        double one = 0, line = 0, cubic = 0;
        for (std::size_t k = 0; k < w.weights.size(); ++k) {
            const double node = nodes[w.first + k];
            one += w.weights[k], line += w.weights[k] * node, cubic += w.weights[k] * node * node * node;
        }
        CHECK(one == Approx(1));
        CHECK(line == Approx(x).margin(1e-9));
        CHECK(cubic == Approx(x * x * x).margin(1e-8));
        // No jump where the window moves on.
        double ripple = 0;
        for (std::size_t k = 0; k < w.weights.size(); ++k) ripple += w.weights[k] * ((w.first + k) % 2 ? 1 : -1);
        if (x > nodes.front()) CHECK(std::abs(ripple - last) < 0.35);
        last = ripple;
    }
    // exp(-3 u), u = sqrt(1 - albedo), falls like what comes back from deep.
    for (const double albedo : {0.05, 0.31, 0.777, 0.95, 0.9985, 0.99999}) {
        const Eigen::VectorXd w = albedo_weights(albedo);
        double sum = 0;
        for (std::size_t k = 0; k < albedo_nodes; ++k)
            sum += w[static_cast<Eigen::Index>(k)] * std::exp(-3 * std::sqrt(1 - albedo_node(k)));
        CHECK(sum == Approx(std::exp(-3 * std::sqrt(1 - albedo))).epsilon(1e-9));
    }
    const NodeWeights g = polynomial_weights(paper_anisotropies(), 0.43);
    double cube = 0;
    for (std::size_t k = 0; k < g.weights.size(); ++k)
        cube += g.weights[k] * std::pow(paper_anisotropies()[g.first + k], 3);
    CHECK(cube == Approx(0.43 * 0.43 * 0.43));
    CHECK(polynomial_weights(paper_anisotropies(), 0.4).weights.size() == 1);
}
