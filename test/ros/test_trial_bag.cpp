// A bag of a trial, read back: times, travel and wing angles are those of the series.
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/JointState.h>
#include <snapwing/ModeState.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include <cmath>
#include <fstream>
#include <map>

#include "snapwing/common/error.h"
#include "snapwing/vehicle/vehicle.h"
#include "snapwing/vehicle/wing_table.h"
#include "support/own_folder.h"
#include "support/paths.h"
#include "trial_bag.h"
#include "wing_picture.h"

namespace snapwing::nodes {
namespace {

constexpr int ROWS = 101;
double timeOf(int k) { return 0.002 * k + 1e-4 * (k % 3); }
double travelOf(int k) { return 0.06 * k / (ROWS - 1); }
double leftOf(int k) { return 2.4 * k / (ROWS - 1); }
double rightOf(int k) { return 0.5 * leftOf(k) - 0.1; }

class TrialBag : public testing::Test {
 protected:
  void SetUp() override {
    std::remove(file("run.bag").c_str());
    summary(R"({"file": "yes"})");
    std::ofstream csv(file("series.csv"));
    csv << "time_s,travel_m,travel_rate_m_per_s,arm_rotation_rad,wing_left_rad,wing_right_rad,ring_position_m,"
           "ring_speed_m_per_s,thrust_N,more\n";
    csv.precision(12);
    for (int k = 0; k < ROWS; ++k) {
      csv << timeOf(k) << ',' << travelOf(k) << ",0.3," << 0.01 * k << ',' << leftOf(k) << ',' << rightOf(k) << ','
          << 0.1 * k << ",2," << 0.2 * k << ",0\n";
    }
  }
  void summary(const std::string& linkage) {
    std::ofstream(file("summary.json")) << R"({"trial": "made", "inputs": {"vehicle_file": ")" << test::sourceDir()
                                        << R"(/config/vehicles/arris_x220.yaml"}, "surroundings": {"wings": "auto"},
        "model": {"linkage": )" << linkage
                                        << R"(, "static_barrier": 0.0301}})";
  }
  std::string file(const std::string& name) const { return folder_ + name; }
  std::string refused() const {
    try {
      writeTrialBag(folder_);
    } catch (const common::FileError& e) {
      return e.what();
    }
    return "";
  }
  std::string folder_ = test::ownFolder();
};

TEST_F(TrialBag, HoldsWhatTheSeriesHolds) {
  rosbag::Bag bag(writeTrialBag(folder_));
  std::map<std::string, int> count;
  ros::Time last;
  double drawn = 0;
  for (const rosbag::MessageInstance& m : rosbag::View(bag)) {
    const int k = count[m.getTopic()]++;
    EXPECT_GE(m.getTime(), last);
    last = m.getTime();
    if (m.getTopic() != "/markers") {
      EXPECT_NEAR(m.getTime().toSec(), BAG_BEGIN + timeOf(k), 1e-8) << m.getTopic();
    }
    if (const auto joints = m.instantiate<sensor_msgs::JointState>()) {
      ASSERT_EQ(joints->name, (std::vector<std::string>{"travel", "arm", "wing_left", "wing_right"}));
      EXPECT_EQ(joints->header.stamp, m.getTime());
      EXPECT_NEAR(joints->position[0], travelOf(k), 1e-9);
      EXPECT_NEAR(joints->position[1], 0.01 * k, 1e-9);
      EXPECT_NEAR(joints->position[2], leftOf(k), 1e-9);
      EXPECT_NEAR(joints->position[3], rightOf(k), 1e-9);
    } else if (const auto state = m.instantiate<ModeState>()) {
      EXPECT_EQ(state->mode, travelOf(k) < 0.0301 ? ModeState::FIXED_WING : ModeState::QUADROTOR);
      EXPECT_NEAR(state->wing_angle, 0.5 * (leftOf(k) + rightOf(k)), 1e-9);
    } else if (const auto frames = m.instantiate<tf2_msgs::TFMessage>()) {
      ASSERT_EQ(frames->transforms.size(), 2U);
      EXPECT_NEAR(frames->transforms[0].transform.translation.z, 0.1 * k, 1e-9);
      const double height = frames->transforms[1].transform.translation.z;
      if (k == 0) drawn = height;
      EXPECT_NEAR(drawn - height, travelOf(k), 1e-9);
    }
  }
  for (const char* topic : {"/tf", "/joint_states", "/mode_state", "/truth"}) EXPECT_EQ(count[topic], ROWS) << topic;
  EXPECT_GE(count["/markers"], 10);
  EXPECT_LE(count["/markers"], 13);
}

TEST_F(TrialBag, WingsAreDrawnAtTheirOwnAngles) {
  const auto vehicle = snapwing::vehicle::loadVehicle(test::sourceDir() + "/config/vehicles/arris_x220.yaml");
  const snapwing::vehicle::WingTable wing = snapwing::vehicle::loadWingTable(vehicle.wing.table_file);
  const double sign = std::copysign(1.0, wing.wing_angle.back());
  for (const double angle : {0.0, 0.7, 1.6, 2.4}) {
    EXPECT_NEAR(sign * wing.at(wing.wing_angle, travelOfWingAngle(wing, angle)), angle, 1e-9);
  }
  EXPECT_NEAR(travelOfWingAngle(wing, -0.5), 0, 1e-3);
  rosbag::Bag bag(writeTrialBag(folder_));
  for (const rosbag::MessageInstance& m : rosbag::View(bag, rosbag::TopicQuery("/markers"))) {
    if (m.getTime().toSec() < BAG_BEGIN + timeOf(ROWS - 1) - 1e-6) continue;
    for (const auto& marker : m.instantiate<visualization_msgs::MarkerArray>()->markers) {
      if (marker.ns != "linkage" || marker.id % 2 != 0) continue;
      const double u = travelOfWingAngle(wing, marker.id == 0 ? leftOf(ROWS - 1) : rightOf(ROWS - 1));
      EXPECT_NEAR(std::abs(marker.points.back().y) - wing.axle[0], wing.at(wing.tip_x, u), 1e-9) << marker.id;
    }
  }
}

TEST_F(TrialBag, WithoutWingsHasNone) {
  summary("null");
  rosbag::Bag bag(writeTrialBag(folder_));
  for (const rosbag::MessageInstance& m : rosbag::View(bag)) {
    if (const auto joints = m.instantiate<sensor_msgs::JointState>()) {
      EXPECT_EQ(joints->name.size(), 2U);
    } else if (const auto state = m.instantiate<ModeState>()) {
      EXPECT_TRUE(std::isnan(state->wing_angle));
    } else if (const auto picture = m.instantiate<visualization_msgs::MarkerArray>()) {
      for (const auto& marker : picture->markers) EXPECT_NE(marker.ns, "wings");
    }
  }
}

TEST_F(TrialBag, BadSeriesAreRefusedByFileAndLine) {
  const std::string head =
      "time_s,travel_m,travel_rate_m_per_s,arm_rotation_rad,wing_left_rad,wing_right_rad,ring_position_m,"
      "ring_speed_m_per_s,thrust_N\n";
  const std::string row = "0.1,0,0,0,0,0,0,0,0\n";
  const std::pair<std::string, std::string> cases[] = {
      {"time_s\n0\n", "travel_m"},  {head, "no rows"},
      {head + "0.1,0\n", "line 2"}, {head + row + "0.2,0,0,0,0,0,0,0,x\n", "line 3"},
      {head + row + row, "line 3"}, {head + "-1,0,0,0,0,0,0,0,0\n", "line 2"}};
  for (const auto& [text, words] : cases) {
    std::ofstream(file("series.csv")) << text;
    EXPECT_NE(refused().find(words), std::string::npos) << text << refused();
    EXPECT_NE(refused().find("series.csv"), std::string::npos);
    EXPECT_FALSE(std::ifstream(file("run.bag")).good());
  }
}

}  // namespace
}  // namespace snapwing::nodes
