// SPDX-License-Identifier: GPL-3.0-or-later
//
// CxF3 (ISO 17972-1), the XML in which measuring programs keep charts. Read of it:
//
//   Resources / ObjectCollection / Object [ObjectType, Name]
//     DeviceColorValues / ColorCMYK or ColorCMYKPlusN       Cyan, Magenta, Yellow, Black in percent -> C, M, Y, K;
//                                                           SpotColor: Name and Percentage -> the role of that name
//     ColorValues / ReflectanceSpectrum [StartWL], ColorCIELab (L, A, B), ColorCIEXYZ (X, Y, Z)
//     TagCollection [Name = Location] / Tag [Name, Value]
//   Resources / ColorSpecificationCollection / ColorSpecification [Id]
//     TristimulusSpec / Illuminant, Observer
//     MeasurementSpec / WavelengthRange [StartWL, Increment]
//
// A spot colour White is W and Clear is T; without white, W is the rest. Mixture and measurement stand in one object or
// in two, which share their Location or else their Name. Of several measurements of a patch (M0, M1, M2) the first kind
// is taken. Spectra go before L, a, b, and these before X, Y, Z. Prefixes of namespaces do not matter.
#pragma once

#include <string>
#include <string_view>

#include "calibration/patches/chart_reading.h"

namespace voxtone::calibration {

/// Whether a text is XML, by its first mark.
[[nodiscard]] bool is_xml(std::string_view text);

/// Throws InputError that names file, line or object: XML that is damaged or no CxF3, objects without mixture,
/// wavelengths that are not told or differ.
[[nodiscard]] ChartReading read_cxf(std::string_view text, const std::string& source);

}  // namespace voxtone::calibration
