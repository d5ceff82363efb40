#pragma once
/// The main function that all nodes share: init, construct, spin; what is thrown is logged once and makes the exit
/// code non-zero.

#include <ros/node_handle.h>

#include <functional>
#include <memory>
#include <string>

namespace snapwing::nodes {

/// Handles a node is built from: relative names, and its private parameters.
struct Handles {
  ros::NodeHandle relative;
  ros::NodeHandle own{"~"};
};

/// Callbacks run one after the other; a node that needs more threads owns them.
/// @param make  builds the node; whatever it returns lives until the node shuts down
/// @return 0 after a normal shutdown, 2 if construction or a callback threw
int runNode(int argc, char** argv, const std::string& name, const std::function<std::shared_ptr<void>(Handles&)>& make);

/// runNode() for a class that is constructed from Handles.
template <class Node>
int runNode(int argc, char** argv, const std::string& name) {
  return runNode(argc, argv, name, [](Handles& handles) { return std::make_shared<Node>(handles); });
}

}  // namespace snapwing::nodes
