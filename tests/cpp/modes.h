// SPDX-License-Identifier: Apache-2.0
// The modes that a test goes through.
#pragma once

#include <iota/reports.h>
#include <iota/system.h>

namespace iota {

inline constexpr IntegrationMode all_modes[] = {IntegrationMode::plausible, IntegrationMode::robust,
                                                IntegrationMode::energy_keeping, IntegrationMode::accurate};
/// Those of the end-point rule.
inline constexpr IntegrationMode end_point_modes[] = {IntegrationMode::plausible, IntegrationMode::robust};

}  // namespace iota
