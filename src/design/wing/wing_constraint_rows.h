#pragma once
/// Order and scale of the wing problem's constraints, shared by its rungs.

namespace snapwing::design {

enum WingConstraintRow { ROW_SEPARATION, ROW_JOINT2_X, ROW_JOINT1_Y, ROW_CRANK, ROW_ROCKER, ROW_TRANSMISSION };
constexpr double CONSTRAINT_LENGTH = 0.01;  ///< [m] scale of the length constraints

}  // namespace snapwing::design
