// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxtone/calibration/patch_file.h"
