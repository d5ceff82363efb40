#pragma once
/// What arms and folding wings do to the motion along the thrust axis: they move with the travel u. With the ring at z
/// and their masses counted in the ring's,
///   T = m_r z'^2 / 2 + m_c (z' - u')^2 / 2 + S(u) z' u' + K(u) u'^2 / 2
/// K and S interpolate the tables of arms and wings monotonically [Fritsch and Carlson 1980]: C1, and nowhere beyond
/// the tables' own values; constant outside a table. H is the exact integral of S.

#include <memory>
#include <vector>

#include "snapwing/common/loan.h"
#include "snapwing/vehicle/force_table.h"
#include "snapwing/vehicle/wing_table.h"

namespace snapwing::rom {

struct InertiaSample {
  double kinetic_mass = 0;   ///< K [kg]
  double kinetic_slope = 0;  ///< dK/du [kg/m]
  double coupled_mass = 0;   ///< S [kg]
  double coupled_slope = 0;  ///< dS/du [kg/m]
  double mass_moment = 0;    ///< H = integral of S from the tables' first travels [kg m]
  double friction = 0;       ///< of all pins against u' [N], >= 0
};

/// Inertia of the relative motion, with what couples it to the common one.
struct RelativeInertia {
  double mass = 0;        ///< m(u) = m_c + K - (m_c - S)^2 / (m_r + m_c) [kg]
  double mass_slope = 0;  ///< dm/du [kg/m]
  double lag = 0;         ///< m_c - S [kg]
  double share = 0;       ///< lag / (m_r + m_c)
};

/// @param moved   at the travel; all 0 = weightless arms and no wings
/// @param centre  m_c [kg]; @param all  m_r + m_c [kg], infinite = the ring is held
RelativeInertia relativeInertia(const InertiaSample& moved, double centre, double all);

/// Sum of what the tables say of arms and wings. Immutable, cheap to copy: copies share the coefficients.
class TravelInertia : public common::Lender {
 public:
  /// All arms of the vehicle. @param table  of one; @throws common::Error for a bad table
  explicit TravelInertia(const vehicle::ForceTable& table);
  /// Both wings.
  /// @param table  with the blade's columns, at least two rows
  /// @param inertia_scale   real masses / the table's, > 0; @param friction_scale  likewise, >= 0
  /// @throws common::Error if the columns are missing, not finite or negative (K, friction), or a scale is out of range
  explicit TravelInertia(const vehicle::WingTable& table, double inertia_scale = 1, double friction_scale = 1);

  /// The same with other scales, at no cost. @throws common::Error
  TravelInertia scaled(double inertia_scale, double friction_scale) const;
  /// Both together.
  TravelInertia operator+(const TravelInertia& other) const;

  /// @param u  travel [m], finite
  InertiaSample at(double u) const;
  double lowest() const;   ///< [m] of all tables
  double highest() const;  ///< [m]

 private:
  struct Curve;
  struct Part {
    std::shared_ptr<const Curve> curve;
    double inertia_scale = 1, friction_scale = 1;
  };
  std::vector<Part> parts_;
};

}  // namespace snapwing::rom
