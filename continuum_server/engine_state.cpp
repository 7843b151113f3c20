// ContinuumEngine's state as fields, hash and checkpoint.

#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <string>

#include "continuum_server/continuum_engine.hpp"
#include "protocol/engine/hash.hpp"

namespace gabion::continuum {

using engine::RequestError;

namespace {

std::vector<double> components(const VecField& field) {
  std::vector<double> values;
  values.reserve(3 * field.size());
  for (const Vec v : field) values.insert(values.end(), {v[0], v[1], v[2]});
  return values;
}

constexpr std::uint64_t blob_kind = 0x33304d554e49544eull;  // "NTINUM03"

/// Appends to, or reads from, a blob; one list of members serves both.
class Writer {
 public:
  template <class T>
  void operator()(const T& value) {
    append(&value, sizeof value);
  }
  void operator()(const VecField& field) { append(field.data(), field.size() * sizeof(Vec)); }
  std::vector<std::uint8_t> blob;

 private:
  void append(const void* data, std::size_t size) {
    if (size == 0) return;
    const std::size_t at = blob.size();
    blob.resize(at + size);
    std::memcpy(blob.data() + at, data, size);
  }
};

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> blob) : blob_(blob) {}
  template <class T>
  void operator()(T& value) {
    take(&value, sizeof value);
  }
  void operator()(VecField& field) { take(field.data(), field.size() * sizeof(Vec)); }
  bool at_end() const { return blob_.empty(); }

 private:
  void take(void* data, std::size_t size) {
    if (size > blob_.size())
      throw RequestError("RESTORE.blob", "the state ends too early", "take it from an engine set up the same way");
    if (size == 0) return;
    std::memcpy(data, blob_.data(), size);
    blob_ = blob_.subspan(size);
  }
  std::span<const std::uint8_t> blob_;
};

}  // namespace

std::vector<std::string> ContinuumEngine::field_names() {
  return {"displacement", "velocity",   "force",  "tie_force", "position",
          "mass",         "plain_mass", "stress", "strain",    "element_weight"};
}

std::vector<double> ContinuumEngine::centre_strains() const {
  std::vector<double> strains;
  strains.reserve(6 * mesh_.elements.size());
  for (std::size_t e = 0; e < mesh_.elements.size(); ++e) {
    std::array<Vec, 8> u;
    for (int corner = 0; corner < 8; ++corner) u[corner] = motion.displacement[mesh_.elements[e][corner]];
    const auto strain = centre_strain(corners_of(mesh_, e, edges()), u);
    strains.insert(strains.end(), strain.begin(), strain.end());
  }
  return strains;
}

std::optional<std::vector<double>> ContinuumEngine::field(const std::string& name,
                                                          std::vector<std::uint64_t>& shape) const {
  using Getter = std::function<std::vector<double>()>;
  const auto stress = [&] {
    const std::vector<double> strain = centre_strains();
    std::vector<double> stress(strain.size(), 0.0);
    for (std::size_t e = 0; e < mesh_.elements.size(); ++e)
      for (int r = 0; r < 6; ++r)
        for (int s = 0; s < 6; ++s)
          stress[6 * e + r] += materials_[mesh_.material[e]].stiffness[6 * r + s] * strain[6 * e + s];
    return stress;
  };
  const std::map<std::string, Getter> getters{{"displacement", [&] { return components(motion.displacement); }},
                                              {"velocity", [&] { return components(motion.velocity); }},
                                              {"force", [&] { return components(rates_.several() ? present_forces() : motion.force); }},
                                              {"tie_force", [&] { return components(motion.tie_force); }},
                                              {"position", [&] { return components(motion.position); }},
                                              {"mass", [&] { return motion.mass; }},
                                              {"plain_mass", [&] { return motion.plain_mass; }},
                                              {"stress", stress},
                                              {"strain", [&] { return centre_strains(); }},
                                              {"element_weight", [&] { return share_; }}};
  const auto found = getters.find(name);
  if (found == getters.end()) return std::nullopt;
  std::vector<double> values = found->second();
  const std::uint64_t rows =
      name == "stress" || name == "strain" || name == "element_weight" ? mesh_.elements.size() : motion.size();
  shape = {rows};
  if (values.size() > rows) shape.push_back(values.size() / rows);
  return values;
}

void ContinuumEngine::set_field(const std::string& name, std::span<const double> values) {
  const std::map<std::string, VecField*> fields{{"displacement", &motion.displacement}, {"velocity", &motion.velocity}};
  const auto found = fields.find(name);
  if (found == fields.end())
    throw RequestError("SET_FIELD.field", "'" + name + "' cannot be set", "displacement or velocity");
  if (values.size() != 3 * motion.size())
    throw RequestError("SET_FIELD.values",
                       std::to_string(values.size()) + " numbers for " + std::to_string(motion.size()) + " nodes",
                       "three a node");
  for (std::size_t k = 0; k < values.size(); ++k)
    if (!std::isfinite(values[k]))
      throw RequestError("SET_FIELD.values", "value of node " + std::to_string(k / 3) + " is not finite", "send finite numbers");
  past_step_ = 0.0;
  for (std::size_t n = 0; n < motion.size(); ++n)
    (*found->second)[n] = engine::vec(values[3 * n], values[3 * n + 1], values[3 * n + 2]);
}

std::uint64_t ContinuumEngine::state_hash() const {
  engine::Hash hash;
  hash.add(std::span<const Vec>(motion.displacement));
  hash.add(std::span<const Vec>(motion.velocity));
  return hash.value();
}

namespace {

/// Everything that a step reads and changes, in the order of the blob.
template <class Visitor, class Motion, class Boundary, class Tie>
void visit_state(Visitor& visit, Motion& motion, Boundary& boundary, Tie& tie) {
  visit(motion.displacement);
  visit(motion.velocity);
  visit(motion.force);
  visit(motion.tie_force);
  visit(motion.damping_work);
  visit(motion.dashpot_work);
  visit(boundary.load_work);
  visit(boundary.constraint_work);
  visit(tie.work);
  visit(tie.origin());
}

}  // namespace

std::vector<std::uint8_t> ContinuumEngine::checkpoint() const {
  Writer write;
  write(blob_kind);
  write(static_cast<std::uint64_t>(motion.size()));
  write(static_cast<std::uint64_t>(tie.reach()));
  visit_state(write, motion, boundary, tie);
  write(kinetic_);
  write(elastic_);
  write(gravity_);
  write(rate_swing_);
  write(past_step_);
  write(step_change_);
  write(time_);
  return std::move(write.blob);
}

void ContinuumEngine::restore(std::span<const std::uint8_t> blob) {
  Reader read(blob);
  std::uint64_t kind = 0, nodes = 0, reach = 0;
  read(kind);
  read(nodes);
  read(reach);
  if (kind != blob_kind || nodes != motion.size())
    throw RequestError("RESTORE.blob",
                       kind != blob_kind ? std::string("this is not a state of this engine")
                                         : "the state has " + std::to_string(nodes) + " nodes, the mesh has " +
                                               std::to_string(motion.size()),
                       "take it from an engine set up the same way");
  if (reach != tie.reach())
    throw RequestError("RESTORE.blob",
                       "the state was taken with " + std::to_string(reach) + " interface nodes, there are " +
                           std::to_string(tie.reach()),
                       "send the same TIE before RESTORE");
  visit_state(read, motion, boundary, tie);
  read(kinetic_);
  read(elastic_);
  read(gravity_);
  read(rate_swing_);
  read(past_step_);
  read(step_change_);
  read(time_);
  if (!read.at_end())
    throw RequestError("RESTORE.blob", "the state is too long", "take it from an engine set up the same way");
}

}  // namespace gabion::continuum
