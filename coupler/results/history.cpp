#include "coupler/results/history.hpp"

#include <charconv>
#include <cmath>
#include <set>

#include "coupler/results/errors.hpp"

namespace gabion::coupler {

namespace {

constexpr std::size_t longest_double = 32;  // characters; the shortest form of any double has at most 24

void append_number(std::string& line, double value) {
  if (std::isnan(value)) {  // to_chars would also write -nan
    line += "nan";
    return;
  }
  char text[longest_double];
  const auto end = std::to_chars(text, text + longest_double, value).ptr;
  line.append(text, end);
}

}  // namespace

std::string shortest(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

History::History(std::filesystem::path path, std::vector<std::string> columns, std::uint32_t flush_rows)
    : path_(std::move(path)), columns_(std::move(columns)), flush_rows_(flush_rows) {
  if (columns_.empty()) throw ResultsError(path_.string() + ": a history needs at least one column");
  std::set<std::string> seen;
  for (const std::string& column : columns_) {
    if (column.empty() || column.find_first_of(",\n\r\"") != std::string::npos)
      throw ResultsError(path_.string() + ": column name '" + column + "' is empty or has a comma, quote or line break");
    if (!seen.insert(column).second)
      throw ResultsError(path_.string() + ": column '" + column + "' stands twice");
  }
  out_.open(path_, std::ios::binary | std::ios::trunc);
  for (std::size_t k = 0; k < columns_.size(); ++k) out_ << (k ? "," : "") << columns_[k];
  out_ << '\n';
  flush();
}

void History::append(std::span<const double> row) {
  if (row.size() != columns_.size())
    throw ResultsError(path_.string() + ": a row of " + std::to_string(row.size()) + " numbers for " +
                       std::to_string(columns_.size()) + " columns");
  line_.clear();
  for (std::size_t k = 0; k < row.size(); ++k) {
    if (k) line_ += ',';
    append_number(line_, row[k]);
  }
  line_ += '\n';
  out_.write(line_.data(), static_cast<std::streamsize>(line_.size()));
  if (++rows_ % flush_rows_ == 0) flush();
}

void History::flush() {
  out_.flush();
  if (!out_) throw ResultsError(path_.string() + ": cannot write (disk full, or no permission)");
}

}  // namespace gabion::coupler
