#pragma once

#include <vector>

#include "processing/identification/bar_records.hpp"
#include "processing/waves/compliance.hpp"

namespace kolsky {

/// What the first pass leaves under the second is known by.
struct FirstPass {
  const Compliance* solid = nullptr;  ///< null: it is left there
  bool judged = false;                ///< refuse what the bar's creep does not explain
};

/// Makes two gauges of one that sees the pulse go out and come back from a free end: what it reads
/// of the return, inverted, is what a second one would read at 2 L - x on a bar without an end. The
/// noise of the two stretches of the record is independent, and of the gauge's gain nothing is
/// left. The way between them is known as well as L and x are filed.
///
/// What the first pass leaves under the return is taken off: the record up to the first pulse's
/// end, carried back to the struck end, where nobody pushes any more, and forward again (see
/// `incident_tail`). Whether that is so shows between the pulse's end and the return.
///
/// @param bench    of the shots; becomes that of the two gauges
/// @param records  of all shots, one gauge each
/// @throws InputError where no inverted return stands out of the noise, the pulse is not over
/// before
///   it, or the struck end's answer to the return overtakes it
void split_passes(Bench& bench, std::vector<BarRecords>& records, const FirstPass& first);

}  // namespace kolsky
