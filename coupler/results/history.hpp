#pragma once
// A table that grows by rows: one CSV file, numbers written in the shortest form that reads back exactly.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace gabion::coupler {

/// Columns carry their unit, as in "time [s]". Rows reach the disk at the latest every flush_rows rows.
class History {
 public:
  /// Creates the file and writes the header. Throws ResultsError: cannot write, no columns, a comma or a line
  /// break in a column's name, the same name twice.
  History(std::filesystem::path path, std::vector<std::string> columns, std::uint32_t flush_rows = 64);

  /// One number a column, in order. Throws ResultsError: wrong count, or the disk is full.
  void append(std::span<const double> row);
  void append(std::initializer_list<double> row) { append(std::span<const double>(row.begin(), row.size())); }

  /// Everything appended so far is handed to the system: survives the end of this process, however it ends.
  void flush();

  const std::vector<std::string>& columns() const { return columns_; }
  std::uint64_t rows() const { return rows_; }

 private:
  std::filesystem::path path_;
  std::vector<std::string> columns_;
  std::uint32_t flush_rows_;
  std::uint64_t rows_ = 0;
  std::string line_;
  std::ofstream out_;
};

/// Shortest decimal form that reads back to the same bits, whatever the locale; nan, inf, -inf.
std::string shortest(double value);

}  // namespace gabion::coupler
