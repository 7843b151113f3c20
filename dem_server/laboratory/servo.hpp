#pragma once
// Keeps stresses of a periodic sample where they are wanted, by straining its cell.
//
//   e    = (p - p_wanted)/M                              what is missing, as a strain
//   rate = (e + integral of e dt/t_i)/t_p                along each axis under control, extension positive
//
//   p        mean normal stress along the axis, compression positive [Pa]
//   M        stiffness that the contacts give if every grain follows the cell [Pa]
//   t_p, t_i times of the proportional and the integral part [s]
//
// The integral part carries the lateral rate of a sample that dilates or flows: with a proportional part
// alone the stress is off by M t_p rate, more than the stress itself.

#include <array>

#include "dem_server/neighbours.hpp"

namespace gabion::dem {

class Servo {
 public:
  /// largest_rate: bound on |rate|, 1/s.
  Servo(Vec stiffness, double step, double largest_rate);

  /// Rates for the next step, 1/s, from the present stresses (compression positive), Pa.
  Vec rate(Vec pressure, double wanted, double step);

  /// Stiffness changes as contacts come and go.
  void set_stiffness(Vec stiffness);
  void set_largest_rate(double largest_rate) { largest_rate_ = largest_rate; }

 private:
  Vec stiffness_;
  double proportional_, integral_;  ///< s
  double largest_rate_;
  Vec sum_{};
};

}  // namespace gabion::dem
