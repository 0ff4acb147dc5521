#include "clients/cli/reports/budget.hpp"

#include <fmt/format.h>

namespace kolsky::cli {

JsonList budget_json(const std::vector<BudgetLine>& budget,
                     const std::vector<std::string>& numbers) {
  JsonList list;
  for (const BudgetLine& line : budget) {
    JsonObject entry = {{"source", line.source}};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      entry.push_back({numbers[i], JsonObject{{"sd", line.sd[i]}, {"share", line.share[i]}}});
    }
    list.push_back(std::move(entry));
  }
  return list;
}

std::string budget_table(const std::vector<BudgetLine>& budget,
                         const std::vector<std::string>& heads) {
  std::string text = fmt::format("  {:<22}", "share of variance");
  for (const std::string& head : heads) {
    text += fmt::format("{:>16}", head);
  }
  text += "\n";
  for (const BudgetLine& line : budget) {
    text += fmt::format("    {:<20}", line.source);
    for (const double share : line.share) {
      text += fmt::format("{:>14.1f} %", 100.0 * share);
    }
    text += "\n";
  }
  return text;
}

}  // namespace kolsky::cli
