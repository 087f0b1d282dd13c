// SPDX-License-Identifier: GPL-3.0-or-later
//
// What every test of a reader of models begins with.
#pragma once

#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "base/error.h"
#include "tests/io/models/model_checks.h"
#include "tests/io/models/model_samples.h"

using namespace voxtone;
using namespace voxtone::io;
using namespace voxtone::test;
using Catch::Contains;
using Eigen::Vector2f;
using Eigen::Vector3d;
using Eigen::Vector3f;
