#include "coupler/results/hdf5.hpp"

#include "coupler/results/errors.hpp"

namespace gabion::coupler::hdf5 {

namespace {

/// The innermost entry of HDF5's error stack: the one with the reason.
std::string reason() {
  std::string text;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned depth, const H5E_error2_t* entry, void* into) -> herr_t {
        if (depth == 0 && entry->desc) *static_cast<std::string*>(into) = entry->desc;
        return 0;
      },
      &text);
  H5Eclear2(H5E_DEFAULT);
  return text.empty() ? "" : ": " + text;
}

/// HDF5 prints its error stack on standard error by itself; here it becomes an exception instead.
void silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

Handle space(const Extent& extent) {
  return {H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr), H5Sclose, "create a dataspace"};
}

void write_raw(hid_t parent, const std::string& name, const void* values, std::size_t count, const Extent& extent,
               hid_t memory_type, hid_t file_type) {
  hsize_t expected = 1;
  for (const hsize_t n : extent) expected *= n;
  if (expected != count)
    throw ResultsError("dataset " + name + ": " + std::to_string(count) + " values where its extent needs " +
                       std::to_string(expected));
  const Handle shape = space(extent);
  const Handle dataset(H5Dcreate2(parent, name.c_str(), file_type, shape, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                       H5Dclose, "create dataset " + name);
  if (count > 0)
    check(H5Dwrite(dataset, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "write dataset " + name);
}

void attribute_raw(hid_t parent, const std::string& name, const std::string& key, hid_t type, const Handle& shape,
                   const void* value) {
  const Handle object(H5Oopen(parent, name.c_str(), H5P_DEFAULT), H5Oclose, "open " + name);
  const Handle attribute(H5Acreate2(object, key.c_str(), type, shape, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                         "create attribute " + key + " of " + name);
  check(H5Awrite(attribute, type, value), "write attribute " + key + " of " + name);
}

Handle scalar() { return {H5Screate(H5S_SCALAR), H5Sclose, "create a dataspace"}; }

}  // namespace

Handle::Handle(hid_t id, herr_t (*close)(hid_t), const std::string& tried) : id_(id), close_(close) {
  if (id < 0) throw ResultsError("results: cannot " + tried + reason());
}

void check(herr_t status, const std::string& tried) {
  if (status < 0) throw ResultsError("results: cannot " + tried + reason());
}

Handle create_file(const std::filesystem::path& path) {
  silence();
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "create file access properties");
  check(H5Pset_file_locking(access, 0, 1), "switch off file locks");
  // Metadata must not reach the disk in the middle of a state: a killed run would leave a tree that points nowhere.
  H5AC_cache_config_t cache;
  cache.version = H5AC__CURR_CACHE_CONFIG_VERSION;
  check(H5Pget_mdc_config(access, &cache), "read the metadata cache settings");
  cache.evictions_enabled = 0;
  cache.incr_mode = H5C_incr__off;
  cache.flash_incr_mode = H5C_flash_incr__off;
  cache.decr_mode = H5C_decr__off;
  check(H5Pset_mdc_config(access, &cache), "set the metadata cache");
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose, "create " + path.string()};
}

Handle group(hid_t parent, const std::string& path) {
  if (H5Lexists(parent, path.c_str(), H5P_DEFAULT) > 0)
    return {H5Gopen2(parent, path.c_str(), H5P_DEFAULT), H5Gclose, "open group " + path};
  return {H5Gcreate2(parent, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose, "create group " + path};
}

Handle open_file(const std::filesystem::path& path) {
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, "open " + path.string()};
}

bool exists(hid_t parent, const std::string& path) {
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    if (H5Lexists(parent, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
    if (end == std::string::npos) return true;
  }
}

Values read(hid_t parent, const std::string& path) {
  if (!exists(parent, path)) throw ResultsError("there is no " + path);
  const Handle dataset(H5Dopen2(parent, path.c_str(), H5P_DEFAULT), H5Dclose, "open " + path);
  const Handle space(H5Dget_space(dataset), H5Sclose, "extent of " + path);
  Values values;
  values.extent.resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, values.extent.data(), nullptr);
  std::size_t count = 1;
  for (const hsize_t n : values.extent) count *= static_cast<std::size_t>(n);
  values.data.resize(count);
  check(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data.data()), "read " + path);
  return values;
}

void write(hid_t parent, const std::string& name, std::span<const double> values, const Extent& extent) {
  write_raw(parent, name, values.data(), values.size(), extent, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE);
}
void write(hid_t parent, const std::string& name, std::span<const std::int32_t> values, const Extent& extent) {
  write_raw(parent, name, values.data(), values.size(), extent, H5T_NATIVE_INT32, H5T_STD_I32LE);
}
void write(hid_t parent, const std::string& name, std::span<const std::int64_t> values, const Extent& extent) {
  write_raw(parent, name, values.data(), values.size(), extent, H5T_NATIVE_INT64, H5T_STD_I64LE);
}
void write(hid_t parent, const std::string& name, std::span<const std::uint8_t> values, const Extent& extent) {
  write_raw(parent, name, values.data(), values.size(), extent, H5T_NATIVE_UINT8, H5T_STD_U8LE);
}

void attribute(hid_t parent, const std::string& name, const std::string& key, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "create a string type");
  const std::string stored = text.empty() ? " " : text;  // HDF5 has no strings of length 0
  check(H5Tset_size(type, stored.size()), "size a string type");
  check(H5Tset_strpad(type, H5T_STR_NULLPAD), "pad a string type");
  for (const char c : stored)
    if (static_cast<unsigned char>(c) > 127) H5Tset_cset(type, H5T_CSET_UTF8);
  attribute_raw(parent, name, key, type, scalar(), stored.data());
}

void attribute(hid_t parent, const std::string& name, const std::string& key, double value) {
  attribute_raw(parent, name, key, H5T_NATIVE_DOUBLE, scalar(), &value);
}

void attribute(hid_t parent, const std::string& name, const std::string& key, std::span<const std::int64_t> values) {
  const Handle shape = values.size() == 1 ? scalar() : space({values.size()});
  attribute_raw(parent, name, key, H5T_NATIVE_INT64, shape, values.data());
}

Column::Column(hid_t parent, const std::string& name, hid_t type) : name_(name) {
  constexpr hsize_t none = 0, unlimited = H5S_UNLIMITED, chunk = 256;
  const Handle shape(H5Screate_simple(1, &none, &unlimited), H5Sclose, "create a dataspace");
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "create dataset properties");
  check(H5Pset_chunk(creation, 1, &chunk), "set the chunk of " + name);
  dataset_ = Handle(H5Dcreate2(parent, name.c_str(), type, shape, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
                    "create dataset " + name);
}

void Column::append(const void* value, hid_t memory_type) {
  const hsize_t start = size_++, one = 1;
  check(H5Dset_extent(dataset_, &size_), "grow dataset " + name_);
  const Handle target(H5Dget_space(dataset_), H5Sclose, "get a dataspace");
  check(H5Sselect_hyperslab(target, H5S_SELECT_SET, &start, nullptr, &one, nullptr), "select in " + name_);
  check(H5Dwrite(dataset_, memory_type, scalar(), target, H5P_DEFAULT, value), "write dataset " + name_);
}

void write_virtual(hid_t parent, const std::string& name, const std::string& other_file,
                   const std::vector<std::string>& datasets, const Extent& extent, hid_t type) {
  Extent whole = extent;
  whole[0] *= datasets.size();
  const Handle shape = space(whole), part = space(extent);
  const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "create dataset properties");
  Extent start(extent.size(), 0);
  for (const std::string& dataset : datasets) {
    check(H5Sselect_hyperslab(shape, H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr),
          "select in " + name);
    check(H5Pset_virtual(creation, shape, other_file.c_str(), dataset.c_str(), part), "map " + dataset);
    start[0] += extent[0];
  }
  const Handle dataset(H5Dcreate2(parent, name.c_str(), type, shape, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
                       "create virtual dataset " + name);
}

}  // namespace gabion::coupler::hdf5
