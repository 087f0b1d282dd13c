// SPDX-License-Identifier: GPL-3.0-or-later
#include "optics/numerics/bicubic_table.h"

#include <cmath>

#include <catch2/catch.hpp>

using namespace voxtone::optics;

namespace {

template <class Function>
BicubicTable table_of(int rows, int cols, double x_max, double y_max, const Function& f) {
    Eigen::MatrixXd samples(rows, cols);
    for (int i = 0; i < rows; ++i)
        for (int j = 0; j < cols; ++j) samples(i, j) = f(i * x_max / (rows - 1), j * y_max / (cols - 1));
    return {samples, x_max, y_max};
}

}  // namespace

TEST_CASE("A bicubic table is exact of cubics, with their derivatives, up to its ends", "[numerics]") {
    const auto f = [](double x, double y) { return 2 + x - 3 * y + x * x * y - 0.5 * y * y * y + x * x * x * y * y; };
    const auto fx = [](double x, double y) { return 1 + 2 * x * y + 3 * x * x * y * y; };
    const auto fy = [](double x, double y) { return -3 + x * x - 1.5 * y * y + 2 * x * x * x * y; };
    const double x_max = 2, y_max = 3;
    const BicubicTable table = table_of(6, 9, x_max, y_max, f);
    for (const double x : {0.0, 0.01, 0.4, 0.7, 1.3, 1.99, 2.0})
        for (const double y : {0.0, 0.1, 0.375, 1.6, 2.9, 3.0}) {
            CAPTURE(x, y);
            CHECK(table(x, y) == Approx(f(x, y)).margin(1e-10));
            const auto value = table.with_gradient(x, y);
            CHECK(value.f == table(x, y));
            CHECK(value.df_dx == Approx(fx(x, y)).margin(1e-9));
            CHECK(value.df_dy == Approx(fy(x, y)).margin(1e-9));
        }
}

TEST_CASE("Beyond its ends a bicubic table stays as it is there, with no slope across", "[numerics]") {
    const auto f = [](double x, double y) { return x + 10 * y; };
    const BicubicTable table = table_of(5, 5, 1, 1, f);
    for (const double out : {-1e9, -0.01, 1.01, 1e9}) {
        const double edge = out < 0 ? 0 : 1;
        const auto across_x = table.with_gradient(out, 0.4), across_y = table.with_gradient(0.4, out);
        CHECK(across_x.f == Approx(f(edge, 0.4)));
        CHECK(across_x.df_dx == 0);
        CHECK(across_x.df_dy == Approx(10));
        CHECK(across_y.f == Approx(f(0.4, edge)));
        CHECK(across_y.df_dx == Approx(1));
        CHECK(across_y.df_dy == 0);
    }
    CHECK(table.with_gradient(0, 0).df_dx == Approx(1));
    CHECK(table.with_gradient(1, 1).df_dy == Approx(10));
}

TEST_CASE("A bicubic table's error falls with the fourth power of its step", "[numerics]") {
    const auto f = [](double x, double y) { return std::sin(3 * x) * std::exp(y); };
    const auto error = [&](int n) {
        const BicubicTable table = table_of(n, n, 1, 1, f);
        double most = 0;
        for (int i = 0; i <= 50; ++i)
            for (int j = 0; j <= 50; ++j)
                most = std::max(most, std::abs(table(i / 50.0, j / 50.0) - f(i / 50.0, j / 50.0)));
        return most;
    };
    const double coarse = error(17), fine = error(33);
    CHECK(coarse < 1e-4);
    CHECK(coarse / fine > 11.3);  // 16 of the fourth power, 8 of the third
}
