#pragma once
// The little of HDF5 that results need, with owners instead of bare identifiers and exceptions instead of
// return codes. Not for other folders.

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gabion::coupler::hdf5 {

/// Owns one HDF5 identifier; close is the matching H5?close.
class Handle {
 public:
  Handle() = default;
  /// Throws ResultsError with what was tried and HDF5's own reason when id is negative.
  Handle(hid_t id, herr_t (*close)(hid_t), const std::string& tried);
  Handle(Handle&& other) noexcept { swap(other); }
  Handle& operator=(Handle&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }

  operator hid_t() const { return id_; }
  bool open() const { return id_ >= 0; }
  void reset() { Handle().swap(*this); }

 private:
  void swap(Handle& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
  }
  hid_t id_ = H5I_INVALID_HID;
  herr_t (*close_)(hid_t) = nullptr;
};

/// Throws ResultsError with what was tried and HDF5's own reason.
void check(herr_t status, const std::string& tried);

/// A new file; an old one of that name is replaced. Readable by every HDF5 since 1.8, and at any time by others
/// while it is being written (no file lock, metadata on disk only at flush).
Handle create_file(const std::filesystem::path& path);
/// With its parents, kept if it is there.
Handle group(hid_t parent, const std::string& path);

/// An existing file, for reading.
Handle open_file(const std::filesystem::path& path);
/// A whole dataset as doubles, whatever its number type, and its extent. Throws ResultsError when it is not there.
struct Values {
  std::vector<double> data;
  std::vector<hsize_t> extent;
};
Values read(hid_t parent, const std::string& path);
/// Whether the path, all of its groups included, exists.
bool exists(hid_t parent, const std::string& path);

using Extent = std::vector<hsize_t>;

void write(hid_t parent, const std::string& name, std::span<const double> values, const Extent& extent);
void write(hid_t parent, const std::string& name, std::span<const std::int32_t> values, const Extent& extent);
void write(hid_t parent, const std::string& name, std::span<const std::int64_t> values, const Extent& extent);
void write(hid_t parent, const std::string& name, std::span<const std::uint8_t> values, const Extent& extent);

/// Attribute of the group or dataset `name` under parent; "." is parent itself.
void attribute(hid_t parent, const std::string& name, const std::string& key, const std::string& text);
void attribute(hid_t parent, const std::string& name, const std::string& key, double value);
void attribute(hid_t parent, const std::string& name, const std::string& key, std::span<const std::int64_t> values);

/// A dataset of doubles or 64-bit integers along one axis that grows by one value at a time.
class Column {
 public:
  Column() = default;
  Column(hid_t parent, const std::string& name, hid_t type);
  void append(double value) { append(&value, H5T_NATIVE_DOUBLE); }
  void append(std::uint64_t value) { append(&value, H5T_NATIVE_UINT64); }

 private:
  void append(const void* value, hid_t memory_type);
  std::string name_;
  Handle dataset_;
  hsize_t size_ = 0;
};

/// A dataset without data of its own: the listed datasets of another file, one after the other along the first
/// axis, each of the given extent. The other file is looked for beside this one.
void write_virtual(hid_t parent, const std::string& name, const std::string& other_file,
                   const std::vector<std::string>& datasets, const Extent& extent, hid_t type);

}  // namespace gabion::coupler::hdf5
