#include "drivers/files/settings/bench_edit.hpp"

#include <map>
#include <sstream>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  return first == std::string::npos
             ? std::string()
             : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// "bars.input" of "[bars.input]" or "[[gauges]]  # four of them"; empty for other lines.
std::string header_of(const std::string& line) {
  const std::string text = trimmed(line);
  if (text.empty() || text.front() != '[') {
    return {};
  }
  const auto first = text.find_first_not_of("[ \t");
  const auto last = text.find_first_of("] \t", first);
  return text.substr(first, last - first);
}

std::string key_of(const std::string& line) {
  const auto equals = line.find('=');
  return equals == std::string::npos ? std::string() : trimmed(line.substr(0, equals));
}

/// The comment of a line whose value holds no '#'.
std::string comment_of(const std::string& line) {
  const auto hash = line.find('#');
  return hash == std::string::npos || line.find('"') < hash ? "" : "  " + line.substr(hash);
}

struct Table {
  std::size_t begin = 0;  ///< its first line after the header
  std::size_t end = 0;    ///< past its last line that is not empty
};

Table find_table(const std::vector<std::string>& lines, const BenchEdit& edit) {
  std::map<std::string, std::size_t> seen;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string header = header_of(lines[i]);
    if (header != edit.table || seen[header]++ != edit.index) {
      continue;
    }
    Table table{i + 1, i + 1};
    for (std::size_t n = i + 1; n < lines.size() && header_of(lines[n]).empty(); ++n) {
      if (!trimmed(lines[n]).empty()) {
        table.end = n + 1;
      }
    }
    return table;
  }
  throw InputError("bench file: " + edit.table, "is not under a header of its own",
                   "write it as [" + edit.table + "] or [[" + edit.table + "]], a key a line");
}

void apply(const BenchEdit& edit, std::vector<std::string>& lines) {
  const Table table = find_table(lines, edit);
  std::size_t after = table.end;
  for (std::size_t n = table.begin; n < table.end; ++n) {
    const std::string key = key_of(lines[n]);
    if (key == edit.key) {
      if (edit.text) {
        lines[n] = edit.key + " = " + *edit.text + comment_of(lines[n]);
      } else {
        lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(n));
      }
      return;
    }
    if (key + "_sd" == edit.key) {
      after = n + 1;
    }
  }
  if (edit.text) {
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(after), edit.key + " = " + *edit.text);
  }
}

}  // namespace

std::string edit_bench(const std::string& text, const std::vector<BenchEdit>& edits) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    lines.push_back(line);
  }
  for (const BenchEdit& edit : edits) {
    apply(edit, lines);
  }
  std::string out;
  for (const std::string& line : lines) {
    out += line + "\n";
  }
  return out;
}

}  // namespace kolsky
