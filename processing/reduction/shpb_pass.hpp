#pragma once

#include "processing/reduction/reducer.hpp"
#include "processing/reduction/shpb_tables.hpp"

namespace kolsky {

/// One reduction, from the records of a split Hopkinson bar to the histories and their quality.
/// @pre the plans and tables are this shot's
[[nodiscard]] Reduction shpb_pass(const Shot& shot, const BarStation& in, const BarStation& out,
                                  const ReductionOptions& options, ShpbPlans& plans,
                                  ShpbTables& tables);

}  // namespace kolsky
