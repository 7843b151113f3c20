#pragma once
// An engine's side of the interface: projects its trial motion onto the rows, and applies what the
// coupler answers. See docs/theory.md, "Rows", and PROTOCOL.md, TIE.
//
//   gap    send  g_k = sum_e G_ke (v*_e + u_e/dt),            then  v_e = v*_e - m_e^-1 sum_k G_ke mu_k
//   slave  send  b_s = sum_i N_is (m_i + c dt/2) v*_i,        then  v_i = sum_s N_is V_s
//
//   u counts from the moment the rows were set (or from where a checkpoint left it). Slave rows work on velocities
//   alone: displacements there would bring their own round-off, which grows with the distance travelled.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "protocol/engine/motion.hpp"

namespace gabion::engine {

/// How a step meets the coupler. Implemented by the session over TCP, and by tests.
class Exchange {
 public:
  virtual ~Exchange() = default;
  /// rows: [slots][3]
  virtual void send_gap(std::span<const double> rows) = 0;
  /// Fills rows [slots][3]; false when this is to be the last step.
  virtual bool receive_multipliers(std::span<double> rows) = 0;
};

class Tie {
 public:
  enum class Mode { none, gap, slave };

  void clear() { *this = Tie{}; }

  /// rows, columns, values as CSR; columns are points (gap) or slots (slave); tied only for slave.
  /// Throws std::invalid_argument or std::out_of_range with what is wrong.
  void set(Mode mode, std::size_t slots, std::vector<std::int32_t> tied, std::vector<std::int32_t> row_ptr,
           std::vector<std::int32_t> columns, std::vector<double> values, const Motion& motion);

  Mode mode() const { return mode_; }
  std::size_t slots() const { return slots_; }
  /// Every tied point has an index below this.
  std::size_t reach() const { return reach_; }

  /// From trial velocities to the rows; the buffer is valid until the next call.
  std::span<const double> project(const Motion& motion, const StepContext& context);
  std::span<double> answer_buffer() { return answer_; }
  /// Applies answer_buffer(); writes motion.tie_force; books the work of the multipliers.
  void correct(Motion& motion, const StepContext& context);

  double largest_displacement(const Motion& motion) const;
  /// Displacements of points [0, reach) when the rows were set: part of an engine's state, for checkpoints.
  const VecField& origin() const { return origin_; }
  VecField& origin() { return origin_; }
  Work work;  ///< of the multipliers on this engine, J (ledger on)

 private:
  void project_gap(const Motion& motion, double dt);
  void project_slave(const Motion& motion, double dt);

  Mode mode_ = Mode::none;
  std::size_t slots_ = 0, reach_ = 0;
  // row by row, for project; and its transpose, for correct: each result is one ordered sum
  std::vector<std::int32_t> row_ptr_, columns_;
  std::vector<double> values_;
  std::vector<std::int32_t> turned_ptr_, turned_rows_;
  std::vector<double> turned_values_;
  std::vector<std::int32_t> tied_;
  VecField origin_;  ///< displacement of points [0, reach) when the rows were set
  std::vector<double> projected_, answer_;
};

}  // namespace gabion::engine
